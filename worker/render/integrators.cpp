#include "worker/render/integrators.h"

#include <algorithm>

#include "ambient_occlusion.comp.h"
#include "gpu_tables_host.h"
#include "path_trace.comp.h"
#include "raster_shade.comp.h"
#include "surface_view.comp.h"
#include "whitted.comp.h"
#include "worker/render/environment_irradiance.h"

namespace tilefarm {
namespace {

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
    constexpr uint64_t all = ~uint64_t{0}, surfaces = gpu::kCameraFeatures | gpu::kSurfaceFeatures;
    switch (integrator) {
        case Integrator::path: return {path_trace_comp, "path_trace", all, all, 0};
        case Integrator::whitted:
            return {whitted_comp, "whitted", surfaces | gpu::kLightingFeatures | gpu::kTracingFeatures,
                    gpu::kEstimatorFeatures, 0};
        case Integrator::raster:
            return {raster_shade_comp,
                    "raster_shade",
                    surfaces | gpu::kLightingFeatures,
                    gpu::kEstimatorFeatures | gpu::kTracingFeatures,
                    0,
                    true};
        case Integrator::ambientOcclusion:
            return {ambient_occlusion_comp, "ambient_occlusion", surfaces, all, 0};
        // Without textures no scene keeps its texture coordinates.
        case Integrator::uv:
            return {surface_view_comp, "surface_view", surfaces, all, gpu::bit(gpu::FEATURE_TEXTURES)};
        default: return {surface_view_comp, "surface_view", surfaces, all, 0};
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
    parameters.nearPlane = static_cast<float>(1e-5 * extent);
    parameters.farPlane = static_cast<float>(4 * (extent + away));
    parameters.occlusionDistance = static_cast<float>(aoDistance_ > 0 ? aoDistance_ : 0.5 * extent);
    parameters.view = static_cast<float>(view_);
}

}  // namespace tilefarm
