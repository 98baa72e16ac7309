#include "worker/render/output_features.h"

#include <algorithm>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

static_assert(gpu::LIGHT_PATH_COUNT == FilmLayout::kLightPaths && gpu::MATTE_RANKS == kMatteRanks);

uint64_t texelsOf(const FilmLayout& layout) {
    return gpu::FILM_TEXELS + (layout.lightPaths ? gpu::LIGHT_PATH_COUNT : 0) + (layout.uv ? 1 : 0) +
           (layout.cryptomatte ? 2 * gpu::MATTE_TEXELS : 0);
}

}  // namespace

uint64_t outputFeatures(const FilmLayout& layout) {
    return (layout.lightPaths ? gpu::bit(gpu::FEATURE_LIGHT_PATHS) : 0) |
           (layout.uv ? gpu::bit(gpu::FEATURE_UV_CHANNEL) : 0) |
           (layout.cryptomatte ? gpu::bit(gpu::FEATURE_CRYPTOMATTE) : 0);
}

FilmLayout layoutOf(uint64_t features) {
    const auto has = [&](uint32_t feature) { return (features & gpu::bit(feature)) != 0; };
    return {.lightPaths = has(gpu::FEATURE_LIGHT_PATHS),
            .uv = has(gpu::FEATURE_UV_CHANNEL),
            .cryptomatte = has(gpu::FEATURE_CRYPTOMATTE)};
}

uint64_t kernelBytes(const FilmLayout& layout) {
    return texelsOf(layout) * sizeof(gpu::vec4);
}

void takeExtra(const FilmLayout& layout, const float* texels, float* floats) {
    const auto take = [&](uint32_t count, uint32_t used) {
        for (uint32_t i = 0; i < count; ++i, texels += 4) floats = std::copy_n(texels, used, floats);
    };
    if (layout.lightPaths) take(gpu::LIGHT_PATH_COUNT, 3);
    if (layout.uv) take(1, 2);
    if (layout.cryptomatte) take(2 * gpu::MATTE_TEXELS, 4);
}

}  // namespace tilefarm
