#include <array>

#include "worker/scene/decode_image.h"
#include "worker/scene/environment_picture.h"
#include "worker/scene/srgb.h"

namespace tilefarm {
namespace {

std::vector<float> linearOf(const std::vector<uint8_t>& rgba) {
    std::array<float, 256> colors;
    for (size_t i = 0; i < colors.size(); ++i)
        colors[i] = static_cast<float>(srgbToLinear(static_cast<double>(i) / 255));
    std::vector<float> floats(rgba.size());
    for (size_t i = 0; i < rgba.size(); ++i) floats[i] = i % 4 == 3 ? rgba[i] / 255.0f : colors[rgba[i]];
    return floats;
}

}  // namespace

EnvironmentPicture decodeDisplayPicture(std::span<const std::byte> bytes) {
    EnvironmentPicture picture;
    Image& image = picture.image = decodeImage(bytes, true);
    if (image.rgbaFloat.empty()) image.rgbaFloat = linearOf(image.rgba8);
    image.rgba8 = {};
    picture.aspect = static_cast<double>(image.width) / image.height;
    for (size_t i = 0; i < image.rgbaFloat.size(); i += 4) {
        float* texel = &image.rgbaFloat[i];
        for (size_t c = 0; c < 3; ++c) texel[c] *= texel[3];
        texel[3] = 1;
    }
    return picture;
}

}  // namespace tilefarm
