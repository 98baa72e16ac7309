#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "shared/error/error.h"
#include "worker/scene/environment_picture.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

std::string lowerExtension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

EnvironmentPicture readPicture(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".exr") return readExrEnvironment(path);
    if (extension == ".hdr") return decodeRadianceHdr(readFileBytes(path));
    if (extension == ".png" || extension == ".jpg" || extension == ".jpeg")
        return decodeDisplayPicture(readFileBytes(path));
    throw Error(ErrorCode::invalidArgument, "an environment must be a .hdr, .exr, .png or .jpg file");
}

/// The readers do not all name the file.
EnvironmentPicture readNamed(const std::filesystem::path& path) {
    try {
        return readPicture(path);
    } catch (const Error& fault) {
        const std::string message = fault.what();
        throw Error(ErrorCode::invalidArgument, message.find(path.string()) != std::string::npos
                                                    ? message
                                                    : fmt::format("{}: {}", path.string(), message));
    }
}

/// Pictures that are no map of the sphere are stretched over it all the same.
void noteShape(EnvironmentPicture& picture) {
    constexpr double kSphere = 2, kRounding = 0.01;
    if (!(std::abs(picture.aspect / kSphere - 1) <= kRounding))
        picture.notes.push_back(fmt::format(
            "stretched over the sphere: it is {:.3g} times as wide as high, where a whole sphere is twice",
            picture.aspect));
}

constexpr float kLargestRadiance = std::numeric_limits<float>::max();

/// Makes radiance of whatever a texel holds, and counts what was none.
class TexelRepair {
public:
    explicit TexelRepair(const EnvironmentPicture& picture) : toScene_(picture.toScene) {
        for (size_t i = 0; i < picture.image.rgbaFloat.size(); ++i)
            if (i % 4 != 3 && std::isfinite(picture.image.rgbaFloat[i]))
                largest_ = std::max(largest_, picture.image.rgbaFloat[i]);
        for (size_t c = 0; c < 3; ++c) infinity_[c] = std::max(largest_, picture.infinity[c]);
    }

    void repair(float* texel) {
        if (std::any_of(texel, texel + 3, [](float v) { return std::isnan(v); })) {
            std::fill_n(texel, 3, 0.0f);
            ++unknown_;
            return;
        }
        const bool infinite = makeFinite(texel);
        if (toScene_) convert(texel);
        const bool negative = std::any_of(texel, texel + 3, [](float v) { return v < 0; });
        std::for_each(texel, texel + 3, [](float& v) { v = std::clamp(v, 0.0f, kLargestRadiance); });
        infinite_ += infinite;
        negative_ += negative && !infinite;
    }

    uint64_t count() const { return unknown_ + infinite_ + negative_; }
    std::string text() const {
        std::vector<std::string> parts;
        if (unknown_ > 0) parts.push_back(fmt::format("{} that are not a number are black", unknown_));
        if (infinite_ > 0)
            parts.push_back(fmt::format("{} have an infinite channel, which becomes the largest finite value",
                                        infinite_));
        if (negative_ > 0)
            parts.push_back(fmt::format("{} have a negative channel, which becomes 0", negative_));
        return fmt::format("{} texels that are not finite or negative: {}", count(), fmt::join(parts, ", "));
    }

private:
    bool makeFinite(float* texel) const {
        bool infinite = false;
        for (size_t c = 0; c < 3; ++c) {
            if (std::isfinite(texel[c])) continue;
            infinite = true;
            texel[c] = texel[c] > 0 ? infinity_[c] : 0;
        }
        return infinite;
    }

    void convert(float* texel) const {
        const std::array<double, 3> from{texel[0], texel[1], texel[2]};
        for (size_t r = 0; r < 3; ++r) {
            const auto& row = (*toScene_)[r];
            const double value = row[0] * from[0] + row[1] * from[1] + row[2] * from[2];
            texel[r] = static_cast<float>(std::clamp<double>(value, -kLargestRadiance, kLargestRadiance));
        }
    }

    const std::optional<ColorMatrix>& toScene_;
    float largest_ = 0;
    std::array<float, 3> infinity_;
    uint64_t unknown_ = 0, infinite_ = 0, negative_ = 0;
};

}  // namespace

void loadEnvironment(Scene& scene, const std::filesystem::path& path, bool strict) {
    EnvironmentPicture picture = readNamed(path);
    const std::string name = picture.image.name = path.filename().string();
    for (const std::string& departure : picture.departures) {
        if (strict) throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}", path.string(), departure));
        scene.warnings.push_back({"not valid Radiance", name, departure});
    }
    TexelRepair repair(picture);
    std::vector<float>& texels = picture.image.rgbaFloat;
    for (size_t i = 0; i < texels.size(); i += 4) repair.repair(&texels[i]);
    noteShape(picture);
    if (repair.count() > 0) picture.notes.push_back(repair.text());
    for (std::string& note : picture.notes) scene.warnings.push_back({"environment", name, std::move(note)});
    scene.sanitisedTexels = repair.count();
    scene.environment.name = name;
    scene.environment.image = std::move(picture.image);
}

}  // namespace tilefarm
