#pragma once

#include <vector>

#include "shared/job/render_settings.h"
#include "tests/shader/light_probe.h"
#include "worker/render/gpu_scene.h"
#include "worker/vk/pipeline.h"

namespace tilefarm {

/// Runs the light sampling code of the shaders over a scene on lists of queries.
class LightProbe {
public:
    LightProbe(const gpu::Device& device, const Scene& scene, const RenderSettings& settings = {});
    std::vector<LightAnswer> ask(std::vector<LightQuery> queries);
    uint32_t lightCount() const { return scene_.lightCount; }
    /// World space position from which the kernels measure.
    const glm::dvec3& centre() const { return centre_; }

private:
    LightProbe(const gpu::Device& device, const Scene& scene, const WorldGeometry& world,
               const RenderSettings& settings);
    gpu::ComputePipeline makePipeline() const;

    const gpu::Device& device_;
    glm::dvec3 centre_;
    PrepareTimes times_;
    GpuScene scene_;
    gpu::ComputePipeline pipeline_;
};

}  // namespace tilefarm
