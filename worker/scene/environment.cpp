#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/load.h"
#include "worker/scene/radiance_hdr.h"

namespace tilefarm {
namespace {

std::string lowerExtension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// R, G and B, or the one channel Y for all three.
Image readExrImage(const std::filesystem::path& path) {
    const FloatImage exr = readExr(path);
    const bool gray = exr.find("R") < 0 && exr.find("Y") >= 0;
    const std::vector<float>* planes[] = {&exr.plane(gray ? "Y" : "R"), &exr.plane(gray ? "Y" : "G"),
                                          &exr.plane(gray ? "Y" : "B")};
    Image image;
    image.width = exr.width;
    image.height = exr.height;
    image.rgbaFloat.assign(exr.pixelCount() * 4, 1.0f);
    for (size_t c = 0; c < 3; ++c) {
        for (size_t i = 0; i < exr.pixelCount(); ++i) {
            image.rgbaFloat[i * 4 + c] = (*planes[c])[i];
        }
    }
    return image;
}

Image readImage(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension != ".hdr" && extension != ".exr") {
        throw Error(ErrorCode::invalidArgument, "an environment must be a .hdr or .exr file");
    }
    return extension == ".hdr" ? decodeRadianceHdr(readFileBytes(path)) : readExrImage(path);
}

/// The readers below do not all name the file.
Image readNamed(const std::filesystem::path& path) {
    try {
        return readImage(path);
    } catch (const Error& fault) {
        const std::string message = fault.what();
        throw Error(ErrorCode::invalidArgument, message.find(path.string()) != std::string::npos
                                                    ? message
                                                    : fmt::format("{}: {}", path.string(), message));
    }
}

/// Radiance that is not finite or negative cannot be sampled; gives how many texels had some.
uint64_t dropBadTexels(Image& image) {
    uint64_t bad = 0;
    for (size_t i = 0; i < image.rgbaFloat.size(); i += 4) {
        float* texel = image.rgbaFloat.data() + i;
        const auto usable = [](float value) { return std::isfinite(value) && value >= 0; };
        if (!std::all_of(texel, texel + 3, usable)) {
            std::fill_n(texel, 3, 0.0f);
            ++bad;
        }
    }
    return bad;
}

}  // namespace

void loadEnvironment(Scene& scene, const std::filesystem::path& path) {
    Image image = readNamed(path);
    image.name = path.filename().string();
    if (const uint64_t bad = dropBadTexels(image)) {
        scene.sanitisedTexels = bad;
        scene.warnings.push_back(
            {"environment", image.name,
             fmt::format("{} texels that are not finite or negative are rendered black", bad)});
    }
    scene.environment.name = image.name;
    scene.environment.image = std::move(image);
}

}  // namespace tilefarm
