#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shaders/gpu_types.h"
#include "shared/job/job.h"
#include "worker/scene/world.h"

namespace tilefarm {

/// The kernel of an integrator: a compute shader that takes the bindings of path_trace.comp.
struct IntegratorKernel {
    std::span<const uint32_t> spirv;
    const char* name;
    uint64_t shows;        // FEATURE_* that it knows; others are not compiled in
    uint64_t indifferent;  // of the others, those that say how to estimate rather than what there is
    uint64_t calls;        // FEATURE_* that it calls for itself
};
IntegratorKernel kernelOf(Integrator integrator);

/// What the parameters of a frame say to an integrator alone. Holds what is costly to compute.
class IntegratorParameters {
public:
    IntegratorParameters(const RenderSettings& settings, const Environment& environment);
    /// `extent`: diagonal of the box of the scene, m.
    void set(gpu::FrameParameters& parameters, double extent) const;

private:
    std::array<glm::vec4, 9> irradiance_{};
    double aoDistance_;
    uint32_t view_;
};

/// Diagonal of the box of all surfaces, m.
double extentOf(const WorldGeometry& world);

}  // namespace tilefarm
