// libFuzzer: EXR and Radiance pictures, and the PNG and JPEG of textures, are read whole or refused with an
// Error.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "worker/scene/decode_image.h"
#include "worker/scene/environment_picture.h"

namespace {

using namespace tilefarm;

template <typename Read>
void readOrRefuse(const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        if (error.code != ErrorCode::invalidArgument) std::abort();
    }
}

void require(bool sound) {
    if (!sound) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto startsWith = [&](std::string_view magic) {
        return std::string_view(reinterpret_cast<const char*>(data), size).starts_with(magic);
    };
    const auto texels = [](const Image& image) { return size_t{4} * image.width * image.height; };
    if (startsWith("#?")) {
        readOrRefuse([&] {
            const Image image = decodeRadianceHdr(bytes).image;
            require(image.rgbaFloat.size() == texels(image));
        });
    } else if (startsWith("\x89PNG") || startsWith("\xff\xd8")) {
        readOrRefuse([&] {
            const Image image = decodeImage(bytes, size % 2 == 0);
            require(image.rgba8.size() + image.rgbaFloat.size() == texels(image) && texels(image) > 0);
        });
    } else {
        readOrRefuse([&] {
            const FloatImage image = readExr(bytes, "input");
            for (const auto& plane : image.planes) require(plane.size() == image.pixelCount());
        });
    }
    return 0;
}
