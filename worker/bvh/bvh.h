#pragma once
// Four-wide bounding volume hierarchy over triangles and other shapes, in the flat form that
// shaders/intersect.glsl reads.
//
// Both arrays are texels of four 32-bit words, bound as RGBA32UI uniform texel buffers; floats are stored as
// their bits. A node is kBvhNodeTexels texels:
//     0  min.x of the four children      1  max.x
//     2  min.y                           3  max.y
//     4  min.z                           5  max.z
//     6  references of the four children
// A reference is the first texel of an inner node; or kBvhLeaf | (count - 1) << kBvhCountShift | first texel
// of the leaf's triangles; or, for a child that is not there, kBvhLeaf with a box that no ray enters. A
// triangle is kBvhTriangleTexels texels, one per axis, so that a permutation of the axes is one of addresses:
//     0  x of the three corners, tag     1  y of the corners, tag     2  z of the corners, tag
// The tag is the index of the triangle as given, with kBvhNonOpaque set where the kernel has to ask
// acceptHit and kBvhSingleSided where rays may pass its back. With kBvhShape set the primitive is no triangle
// but a shape, whose index stands in the first word of all three texels.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace tilefarm {

inline constexpr uint32_t kBvhNodeTexels = 7;
inline constexpr uint32_t kBvhTriangleTexels = 3;
inline constexpr uint32_t kBvhLeafTriangles = 4;  // at most
inline constexpr uint32_t kBvhMostDepth = 96;
inline constexpr uint32_t kBvhLeaf = 0x80000000u;
inline constexpr uint32_t kBvhCountShift = 29;
inline constexpr uint32_t kBvhNonOpaque = 0x80000000u;
inline constexpr uint32_t kBvhShape = 0x40000000u;
inline constexpr uint32_t kBvhSingleSided = 0x20000000u;

// What buildBvh may be told of a primitive.
inline constexpr uint8_t kAsksAccept = 1;
inline constexpr uint8_t kIsSingleSided = 2;

/// The bounds of a shape; finite, not empty.
struct BvhBox {
    glm::vec3 lower{0}, upper{0};
};

struct Bvh {
    std::vector<glm::uvec4> nodes;      // node 0 is the root, always there
    std::vector<glm::uvec4> triangles;  // in leaf order, by index within a leaf
    uint32_t nodeCount = 0;
    uint32_t triangleCount = 0;  // and shapes
    uint32_t maxDepth = 0;       // nodes on the longest path from the root
    /// Entries that a depth-first traversal can have waiting at once, at most: what it needs for a stack.
    uint32_t stackSize = 0;
};

/// Builds over triangles given as three world-space corners each; all corners must be finite. `flags` is
/// empty or has kAsksAccept and kIsSingleSided for each primitive that the kernel is to treat so. Shapes are
/// numbered as primitives after the triangles. The tree
/// depends on the input alone, not on thread timing. Throws Error(unprocessable) above what 29 bits of texel
/// address hold (178 million triangles).
Bvh buildBvh(std::span<const glm::vec3> corners, std::span<const uint8_t> flags = {},
             std::span<const BvhBox> shapes = {});

/// The specialization constant kBvhStackSize of shaders/intersect.glsl, which keeps one entry for itself: in
/// steps, so that scenes share kernels. At least 32: below, NVIDIA's compiler places the stack where it is
/// slower (4.9 instead of 6.7 Grays/s in a Cornell box on an H200; lavapipe does not mind).
inline uint32_t bvhStackConstant(const Bvh& bvh) {
    return bvh.stackSize < 32 ? 32 : (bvh.stackSize + 1 + 7) / 8 * 8;
}

}  // namespace tilefarm
