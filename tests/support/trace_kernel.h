#pragma once

#include <span>
#include <vector>

#include "tests/support/triangle_scenes.h"
#include "worker/bvh/bvh.h"
#include "worker/vk/commands.h"

namespace tilefarm {

/// A hit as shaders/trace_rays.comp writes it.
struct TracedHit {
    float t = 0;
    uint32_t primitive = 0xffffffffu;
    glm::vec2 barycentrics{0};
    bool missed() const { return primitive == 0xffffffffu; }
    friend bool operator==(const TracedHit&, const TracedHit&) = default;
};

struct TraceOptions {
    bool anyHit = false;
    std::vector<uint8_t> nonOpaque = {};
    std::vector<BvhBox> shapeBoxes = {};
    std::vector<glm::uvec4> shapes = {};  // their ShapeRecords
    std::span<const uint32_t> spirv =
        {};  // another build of the kernel; empty: the one of the shaders folder
};

/// Triangles on a device and the kernel shaders/trace_rays.comp over their BVH.
class TraceKernel {
public:
    TraceKernel(const gpu::Device& device, std::span<const glm::vec3> corners,
                const TraceOptions& options = {});

    /// Traces them all, `times` over for the sake of the clock.
    std::vector<TracedHit> trace(std::span<const TestRay> rays, int times = 1);
    TracedHit trace(const TestRay& ray) { return trace(std::span(&ray, 1)).front(); }
    /// Device seconds of one dispatch of the last call, and processor seconds of this process meanwhile.
    double seconds() const { return seconds_; }
    double processorSeconds() const { return processorSeconds_; }
    const Bvh& bvh() const { return bvh_; }

private:
    const gpu::Device& device_;
    Bvh bvh_;
    gpu::ComputePipeline pipeline_;
    gpu::TexelBuffer nodes_, triangles_, shapes_;
    double seconds_ = 0, processorSeconds_ = 0;
};

}  // namespace tilefarm
