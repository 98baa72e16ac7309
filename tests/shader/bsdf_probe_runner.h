#pragma once

#include <vector>

#include "tests/shader/bsdf_probe.h"
#include "worker/vk/buffer.h"
#include "worker/vk/pipeline.h"

namespace tilefarm {

/// Runs the BSDF code of the shaders on lists of queries. The albedo table is that of one `ior`.
class BsdfProbe {
public:
    BsdfProbe(const gpu::Device& device, float ior);
    std::vector<BsdfAnswer> ask(const std::vector<BsdfQuery>& queries);

private:
    static gpu::ComputePipeline makePipeline(const gpu::Device& device);

    const gpu::Device& device_;
    gpu::ComputePipeline pipeline_;
    std::vector<gpu::TexelBuffer> texels_;
};

}  // namespace tilefarm
