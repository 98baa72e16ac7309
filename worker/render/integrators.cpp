#include "worker/render/integrators.h"

#include <algorithm>
#include <initializer_list>

#include "ambient_occlusion.comp.h"
#include "path_trace.comp.h"
#include "raster_shade.comp.h"
#include "surface_view.comp.h"
#include "whitted.comp.h"
#include "worker/render/environment_irradiance.h"

namespace tilefarm {
namespace {

constexpr uint64_t bits(std::initializer_list<uint32_t> features) {
    uint64_t mask = 0;
    for (const uint32_t feature : features) mask |= gpu::bit(feature);
    return mask;
}

constexpr uint64_t kCameras =
    bits({gpu::FEATURE_ORTHOGRAPHIC, gpu::FEATURE_THIN_LENS, gpu::FEATURE_PANORAMA,
          gpu::FEATURE_CAMERA_MOTION, gpu::FEATURE_CULLING, gpu::FEATURE_PIXEL_FILTER,
          gpu::FEATURE_SOBOL_SAMPLER, gpu::FEATURE_STRATIFIED_SAMPLER});
// What decides where a ray meets which colour and normal.
constexpr uint64_t kSurfaces =
    bits({gpu::FEATURE_TEXTURES, gpu::FEATURE_NORMAL_MAPS, gpu::FEATURE_VERTEX_COLORS, gpu::FEATURE_CUTOUT,
          gpu::FEATURE_FLOAT_TEXTURES, gpu::FEATURE_TEXTURE_TRANSFORMS, gpu::FEATURE_SECOND_UV_SET,
          gpu::FEATURE_NEAREST_FILTER, gpu::FEATURE_SHAPES, gpu::FEATURE_FIELDS, gpu::FEATURE_UV_CHANNEL,
          gpu::FEATURE_CRYPTOMATTE, gpu::FEATURE_COINCIDENT_FACES});
constexpr uint64_t kLighting =
    bits({gpu::FEATURE_SPECULAR, gpu::FEATURE_MIRROR, gpu::FEATURE_TRANSMISSION, gpu::FEATURE_ATTENUATION,
          gpu::FEATURE_EMISSIVE_TRIANGLES, gpu::FEATURE_PUNCTUAL_LIGHTS, gpu::FEATURE_ENVIRONMENT,
          gpu::FEATURE_UNLIT, gpu::FEATURE_SPECULAR_COLOR, gpu::FEATURE_CONDUCTOR, gpu::FEATURE_SPHERE_LIGHTS,
          gpu::FEATURE_QUAD_LIGHTS, gpu::FEATURE_SUN_LIGHTS, gpu::FEATURE_ENVIRONMENT_ROTATION,
          gpu::FEATURE_HIDDEN_ENVIRONMENT});
constexpr uint64_t kEstimators =
    bits({gpu::FEATURE_ENERGY_COMPENSATION, gpu::FEATURE_LIGHT_TREE, gpu::FEATURE_ALL_LIGHTS,
          gpu::FEATURE_SINGLE_SAMPLING, gpu::FEATURE_TRACE, gpu::FEATURE_FAULT_INJECTION});

uint32_t viewOf(Integrator integrator) {
    switch (integrator) {
        case Integrator::normal: return gpu::VIEW_NORMAL;
        case Integrator::geometricNormal: return gpu::VIEW_GEOMETRIC_NORMAL;
        case Integrator::depth: return gpu::VIEW_DEPTH;
        case Integrator::uv: return gpu::VIEW_UV;
        case Integrator::material: return gpu::VIEW_MATERIAL;
        case Integrator::object: return gpu::VIEW_OBJECT;
        default: return gpu::VIEW_ALBEDO;
    }
}

}  // namespace

IntegratorKernel kernelOf(Integrator integrator) {
    // A view does not pretend to show how light goes: nothing is missing from it.
    constexpr uint64_t all = ~uint64_t{0};
    switch (integrator) {
        case Integrator::path: return {path_trace_comp, "path_trace", all, all, 0};
        case Integrator::whitted:
            return {whitted_comp, "whitted",
                    kCameras | kSurfaces | kLighting | gpu::bit(gpu::FEATURE_GLASS_SHADOWS), kEstimators, 0};
        case Integrator::raster:
            return {raster_shade_comp,
                    "raster_shade",
                    kCameras | kSurfaces | kLighting,
                    kEstimators | gpu::bit(gpu::FEATURE_GLASS_SHADOWS),
                    0,
                    true};
        case Integrator::ambientOcclusion:
            return {ambient_occlusion_comp, "ambient_occlusion", kCameras | kSurfaces, all, 0};
        // Without textures no scene keeps its texture coordinates.
        case Integrator::uv:
            return {surface_view_comp, "surface_view", kCameras | kSurfaces, all,
                    gpu::bit(gpu::FEATURE_TEXTURES)};
        default: return {surface_view_comp, "surface_view", kCameras | kSurfaces, all, 0};
    }
}

IntegratorParameters::IntegratorParameters(const RenderSettings& settings, const Environment& environment)
    : aoDistance_(settings.aoDistance), view_(viewOf(settings.integrator)) {
    if (settings.integrator == Integrator::whitted || settings.integrator == Integrator::raster)
        irradiance_ = environmentIrradiance(environment);
}

void IntegratorParameters::set(gpu::FrameParameters& parameters, const glm::vec3& lower,
                               const glm::vec3& upper) const {
    for (size_t i = 0; i < irradiance_.size(); ++i) parameters.irradiance[i] = irradiance_[i];
    const double extent = std::max(glm::distance(glm::dvec3(lower), glm::dvec3(upper)), 1e-30);
    const double away =
        glm::distance(glm::dvec3(parameters.cameraOrigin), 0.5 * (glm::dvec3(lower) + glm::dvec3(upper)));
    // Near: depths are reversed floats, so it costs no resolution. Far, of orthographic cameras alone: with
    // room for one that moves.
    parameters.integrator = {aoDistance_ > 0 ? aoDistance_ : 0.5 * extent, view_, 1e-5 * extent,
                             4 * (extent + away)};
}

}  // namespace tilefarm
