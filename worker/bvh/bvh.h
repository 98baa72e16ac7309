#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace tilefarm {

/// Four-wide BVH in the flat form that shaders/intersect.glsl reads. One 16-byte texel per glm::vec4
/// or glm::uvec4; see the layout beside `packBvh`.
struct Bvh {
    std::vector<glm::vec4> nodes;      // kBvhNodeTexels per node, node 0 is the root
    std::vector<uint32_t> primitives;  // leaf order -> index of the triangle as given
    uint32_t nodeCount = 0;
    uint32_t maxDepth = 0;  // longest path from the root in nodes: bounds the traversal stack
};

/// Builds over triangles given as three world-space corners each. All corners must be finite. Within a
/// leaf primitives are sorted by index and the tree depends on the input alone, not on thread timing.
Bvh buildBvh(std::span<const glm::vec3> corners);

}  // namespace tilefarm
