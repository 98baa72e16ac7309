#include "worker/render/environment_packer.h"

#include <cmath>
#include <numbers>

#include "worker/render/alias_table.h"

namespace tilefarm {

using std::numbers::pi;

double PackedEnvironment::flux() const {
    return width == 0 ? 0 : weightSum * 2 * pi * pi / (double(width) * height);
}

PackedEnvironment packEnvironment(const Environment& environment) {
    PackedEnvironment packed;
    const Image& image = environment.image;
    if (image.width == 0 || image.height == 0) return packed;
    packed.width = image.width;
    packed.height = image.height;
    std::vector<double> weights;
    weights.reserve(size_t{image.width} * image.height);
    packed.texels.reserve(weights.capacity());
    for (uint32_t y = 0; y < image.height; ++y) {
        const double sinTheta = std::sin(pi * (y + 0.5) / image.height);
        for (uint32_t x = 0; x < image.width; ++x) {
            const float* rgba = &image.rgbaFloat[4 * (size_t{y} * image.width + x)];
            const double luminance = 0.2126 * rgba[0] + 0.7152 * rgba[1] + 0.0722 * rgba[2];
            // The shader interpolates the fp32 value, so that is what must be summed.
            const auto weight = static_cast<float>(luminance * sinTheta);
            packed.texels.emplace_back(rgba[0], rgba[1], rgba[2], weight);
            weights.push_back(weight);
            packed.weightSum += weight;
        }
    }
    if (packed.lit()) packed.alias = buildAliasTable(weights);
    return packed;
}

}  // namespace tilefarm
