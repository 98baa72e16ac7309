#include "worker/render/path_rules.h"

#include <limits>

namespace tilefarm {
namespace {

uint32_t kindOf(RouletteRule rule) {
    switch (rule) {
        case RouletteRule::throughput: return gpu::ROULETTE_THROUGHPUT;
        case RouletteRule::constant: return gpu::ROULETTE_CONSTANT;
        case RouletteRule::none: return gpu::ROULETTE_NONE;
    }
    return gpu::ROULETTE_THROUGHPUT;
}

uint32_t kindOf(DirectionSampling sampling) {
    switch (sampling) {
        case DirectionSampling::bsdf: return gpu::DIRECTION_BSDF;
        case DirectionSampling::cosine: return gpu::DIRECTION_COSINE;
        case DirectionSampling::uniform: return gpu::DIRECTION_UNIFORM;
    }
    return gpu::DIRECTION_BSDF;
}

double boundOf(double clamp) {
    return clamp > 0 ? clamp : std::numeric_limits<double>::infinity();
}

}  // namespace

void setPathRules(gpu::FrameParameters& parameters, const RenderSettings& settings) {
    parameters.rouletteRule = kindOf(settings.roulette);
    parameters.directionSampling = kindOf(settings.directionSampling);
    parameters.clampDirect = boundOf(settings.clampDirect);
    parameters.clampIndirect = boundOf(settings.clampIndirect);
#define TILEFARM_SET(type, parameterType, name, value) parameters.name = settings.name;
    KERNEL_KNOBS(TILEFARM_SET)
#undef TILEFARM_SET
}

uint64_t pathRuleFeatures(const RenderSettings& settings) {
    uint64_t features = 0;
    const auto add = [&](bool called, uint32_t feature) {
        if (called) features |= gpu::bit(feature);
    };
    add(settings.clampDirect > 0 || settings.clampIndirect > 0, gpu::FEATURE_CLAMP);
    add(settings.regularisation > 0, gpu::FEATURE_REGULARISATION);
    add(settings.directionSampling != DirectionSampling::bsdf, gpu::FEATURE_DIRECTION_SAMPLING);
    add(settings.shadowDepth < settings.maxBounces, gpu::FEATURE_SHADOW_DEPTH);
    add(settings.roulette != RouletteRule::throughput, gpu::FEATURE_ROULETTE_RULE);
    return features;
}

}  // namespace tilefarm
