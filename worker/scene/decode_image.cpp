#include "worker/scene/decode_image.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>

#include "shared/error/error.h"
#include "worker/scene/limits.h"

// Compiled in with just the two formats: other libraries of the program (Draco's among them) export copies of
// stb_image of their own, older ones, that would take the place of a shared one.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb_image.h>

namespace tilefarm {
namespace {

template <typename T>
using StbPixels = std::unique_ptr<T, void (*)(void*)>;

[[noreturn]] void failImage(const std::string& fault) {
    throw Error(ErrorCode::invalidArgument, fault);
}

struct Encoded {
    const stbi_uc* data;
    int size;
};

/// stb_image counts bytes in int, and its readers trust sizes in headers: both are checked first.
Encoded check(std::span<const std::byte> bytes) {
    if (bytes.empty() || bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max())) {
        failImage(fmt::format("the image has {} bytes", bytes.size()));
    }
    const Encoded encoded{reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size())};
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(encoded.data, encoded.size, &width, &height, &channels)) {
        failImage(fmt::format("the image cannot be decoded: {}", stbi_failure_reason()));
    }
    if (width <= 0 || height <= 0 || uint64_t(width) * uint64_t(height) > kMaxImageTexels) {
        failImage(fmt::format("the image has {} x {} texels, at most {} are allowed", width, height,
                              kMaxImageTexels));
    }
    return encoded;
}

template <typename T>
StbPixels<T> own(T* pixels) {
    if (!pixels) {
        failImage(fmt::format("the image cannot be decoded: {}", stbi_failure_reason()));
    }
    return {pixels, stbi_image_free};
}

/// IEC 61966-2-1.
float srgbToLinear(double encoded) {
    return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92
                                                 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

}  // namespace

Image decodeImage(std::span<const std::byte> bytes, bool srgb) {
    const Encoded encoded = check(bytes);
    int width = 0, height = 0, channels = 0;
    Image image;
    if (stbi_is_16_bit_from_memory(encoded.data, encoded.size)) {
        const auto pixels =
            own(stbi_load_16_from_memory(encoded.data, encoded.size, &width, &height, &channels, 4));
        image.rgbaFloat.resize(size_t(width) * size_t(height) * 4);
        for (size_t i = 0; i < image.rgbaFloat.size(); ++i) {
            const double value = pixels.get()[i] / 65535.0;
            image.rgbaFloat[i] = srgb && i % 4 != 3 ? srgbToLinear(value) : static_cast<float>(value);
        }
    } else {
        const auto pixels =
            own(stbi_load_from_memory(encoded.data, encoded.size, &width, &height, &channels, 4));
        image.rgba8.assign(pixels.get(), pixels.get() + size_t(width) * size_t(height) * 4);
    }
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    return image;
}

}  // namespace tilefarm
