#include "worker/render/sample_parameters.h"

#include <bit>

namespace tilefarm {
namespace {

uint32_t kindOf(const RenderSettings& settings) {
    if (!settings.jitter) return gpu::FILTER_POINT;
    switch (settings.filter) {
        case PixelFilter::box: return filterRadiusOf(settings) == 0.5 ? gpu::FILTER_PIXEL : gpu::FILTER_BOX;
        case PixelFilter::tent: return gpu::FILTER_TENT;
        case PixelFilter::gaussian: return gpu::FILTER_GAUSSIAN;
        case PixelFilter::blackmanHarris: return gpu::FILTER_BLACKMAN_HARRIS;
    }
    return gpu::FILTER_PIXEL;
}

uint32_t kindOf(Sampler sampler) {
    switch (sampler) {
        case Sampler::random: return gpu::SAMPLER_RANDOM;
        case Sampler::stratified: return gpu::SAMPLER_STRATIFIED;
        case Sampler::sobol: return gpu::SAMPLER_SOBOL;
    }
    return gpu::SAMPLER_RANDOM;
}

// Of MurmurHash3.
uint32_t mixed(uint32_t h) {
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
}

}  // namespace

double filterRadiusOf(const RenderSettings& settings) {
    if (settings.filterRadius > 0) return settings.filterRadius;
    switch (settings.filter) {
        case PixelFilter::box: return 0.5;
        case PixelFilter::tent: return 1;
        default: return 1.5;
    }
}

void setSampling(gpu::FrameParameters& parameters, const RenderSettings& settings) {
    parameters.filterKind = static_cast<float>(kindOf(settings));
    parameters.filterRadius = static_cast<float>(filterRadiusOf(settings));
    parameters.samplerKind = kindOf(settings.sampler);
    parameters.strata = settings.strata;
}

uint64_t samplingFeatures(const RenderSettings& settings) {
    uint64_t features = 0;
    if (kindOf(settings) != gpu::FILTER_PIXEL) features |= gpu::bit(gpu::FEATURE_PIXEL_FILTER);
    if (settings.sampler == Sampler::sobol) features |= gpu::bit(gpu::FEATURE_SOBOL_SAMPLER);
    if (settings.sampler == Sampler::stratified) features |= gpu::bit(gpu::FEATURE_STRATIFIED_SAMPLER);
    return features;
}

uint32_t shutterStep(uint32_t sample, uint32_t steps, uint32_t seed, int32_t frame) {
    const auto bits = static_cast<uint32_t>(std::bit_width(steps) - 1);
    uint32_t reversed = 0;
    for (uint32_t i = 0; i < bits; ++i) reversed |= (sample >> i & 1u) << (bits - 1 - i);
    return reversed ^ (mixed(mixed(seed) + static_cast<uint32_t>(frame)) & (steps - 1));
}

}  // namespace tilefarm
