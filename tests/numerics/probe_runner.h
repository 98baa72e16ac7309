#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "tests/numerics/probe.h"
#include "worker/render/environment_packer.h"
#include "worker/render/gpu_scene.h"
#include "worker/vk/pipeline.h"

namespace tilefarm {

/// probe.comp over a scene.
class Probe {
public:
    explicit Probe(const gpu::Device& device, const Scene& scene = {});

    struct Answer {
        std::vector<glm::vec4> values;
        std::vector<uint32_t> counters;
    };
    Answer run(uint32_t mode, uint32_t count, const std::vector<glm::vec4>& queries, uint32_t valuesEach);

private:
    const gpu::Device& device_;
    GpuScene scene_;
    gpu::ComputePipeline pipeline_;
};

}  // namespace tilefarm
