#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shaders/gpu_types.h"
#include "shared/job/render_settings.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// The kernel of an integrator: a compute shader that takes the bindings of path_trace.comp.
struct IntegratorKernel {
    std::span<const uint32_t> spirv;
    const char* name;
    uint64_t shows;        // FEATURE_* that it knows; others are not compiled in
    uint64_t indifferent;  // of the others, those that say how to estimate rather than what there is
    uint64_t calls;        // FEATURE_* that it calls for itself
    bool draws = false;    // it shades what RasterPass has drawn
};
IntegratorKernel kernelOf(Integrator integrator);

/// What the parameters of a frame say to an integrator alone. Holds what is costly to compute.
class IntegratorParameters {
public:
    IntegratorParameters(const RenderSettings& settings, const Environment& environment);
    /// `lower`, `upper`: the box of the scene in the space of its geometry, as the camera that `parameters`
    /// has already.
    void set(gpu::FrameParameters& parameters, const glm::vec3& lower, const glm::vec3& upper) const;

private:
    std::array<glm::vec4, 9> irradiance_{};
    double aoDistance_;
    uint32_t view_;
};

}  // namespace tilefarm
