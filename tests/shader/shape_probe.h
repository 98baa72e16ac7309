#pragma once

#include <span>
#include <vector>

#include "tests/support/triangle_scenes.h"
#include "worker/bvh/bvh.h"
#include "worker/scene/scene.h"
#include "worker/vk/commands.h"

namespace tilefarm {

/// What shape_probe.comp says of one ray.
struct ShapeHit {
    float t = -1, primitive = -1, material = 0, unused0 = 0;
    glm::vec3 position{0};
    float u = 0;
    glm::vec3 error{0};
    float v = 0;
    glm::vec3 normal{0};
    float handedness = 0;
    glm::vec3 tangent{0};
    float unused1 = 0;
    /// What a ray that goes on from the hit, or straight back, hits next; negative: nothing.
    float nextForwards = -1, nextBack = -1, unused2[2] = {0, 0};
    bool missed() const { return primitive < 0; }
};
static_assert(sizeof(ShapeHit) == 96);

Shape shapeOf(ShapeKind kind, const glm::dvec3& size);
Shape fieldOf(std::vector<FieldInstruction> field);

/// Shapes on a device, numbered from 0, in a world that is not re-centred.
class ShapeProbe {
public:
    ShapeProbe(const gpu::Device& device, std::vector<Shape> shapes, bool nonOpaque = false);
    std::vector<ShapeHit> trace(std::span<const TestRay> rays);
    const glm::dvec3& centre() const { return centre_; }

private:
    const gpu::Device& device_;
    glm::dvec3 centre_{0};
    bool fields_ = false;
    std::vector<glm::uvec4> records_;
    Bvh bvh_;
    gpu::ComputePipeline pipeline_;
    gpu::TexelBuffer nodes_, triangles_, shapes_;
};

}  // namespace tilefarm
