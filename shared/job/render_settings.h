#pragma once

#include <cstdint>

#include "shaders/knobs.h"
#include "shared/job/facets.h"
#include "shared/job/lighting.h"
#include "shared/job/viewing.h"

namespace tilefarm {

/// Which light a surface point asks.
enum class LightSelection : uint8_t {
    tree,     // one, by its estimated share at this point
    power,    // one, by its power
    uniform,  // one, all alike
    all,      // every one
};

/// How light that comes straight from a light is estimated.
enum class DirectLight : uint8_t {
    mis,     // by sampling lights and by sampling the BSDF, weighted by the power heuristic
    lights,  // by sampling lights alone
    bsdf,    // by sampling the BSDF alone: never finds lights without extent
};

/// What decides a sample's value, beside scene, frame, pixel and sample index.
struct RenderSettings {
    uint32_t seed = 0;
    uint32_t maxBounces = 8;     // scatterings after the camera ray, at surfaces and in fog; 0: emission only
    uint32_t rouletteStart = 4;  // bounces before Russian roulette; unbiased at any value
    Integrator integrator = Integrator::path;
    double aoDistance = 0;  // m that ambient occlusion reaches; 0: half the diagonal of the scene's box
    RouletteRule roulette = RouletteRule::throughput;
    DirectionSampling directionSampling = DirectionSampling::bsdf;
    double clampDirect = 0;    // greatest channel of what one sample gathers at once, W/(sr m²); 0: no bound
    double clampIndirect = 0;  // likewise of light that scattered more than once; both are biased
    LightSelection lightSelection = LightSelection::power;
    DirectLight directLight = DirectLight::mis;
    Microfacets microfacets = Microfacets::ggx;  // of materials that do not say theirs
    Fresnel fresnel = Fresnel::exact;            // likewise
    bool energyCompensation = true;              // light that scatters more than once between microfacets
    PixelFilter filter = PixelFilter::box;
    double filterRadius = 0;  // pixels; 0: the filter's usual one
    bool jitter = true;       // else every sample goes through its pixel's centre
    Sampler sampler = Sampler::random;
    uint32_t strata = 8;  // per side of the stratified sampler's grids
    CameraFit cameraFit = CameraFit::fit;
    bool cameraClip = false;  // camera rays see between the camera's znear and zfar alone
    Culling culling = Culling::camera;
    LightUnits lightUnits = LightUnits::radiometric;
#define TILEFARM_MEMBER(type, parameterType, name, value) type name = value;
    KERNEL_KNOBS(TILEFARM_MEMBER)
#undef TILEFARM_MEMBER
    friend bool operator==(const RenderSettings&, const RenderSettings&) = default;
};

}  // namespace tilefarm
