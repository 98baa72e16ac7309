#include "worker/bvh/bvh.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <new>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr uint32_t kWidth = 4;
constexpr uint64_t kMaxTexels = 1ull << kBvhCountShift;

// What Embree's builder makes, in memory of its own.
struct BuildNode {
    uint32_t children = 0;  // none: this is a BuildLeaf
};
struct BuildInner : BuildNode {
    BuildNode* child[kWidth];
    RTCBounds bounds[kWidth];
};
struct BuildLeaf : BuildNode {
    uint32_t primitives = 0;
    uint32_t primitive[kBvhLeafTriangles];
};

template <typename Handle, void (*release)(Handle)>
struct Release {
    using pointer = Handle;
    void operator()(Handle handle) const { release(handle); }
};
using EmbreeDevice = std::unique_ptr<RTCDevice, Release<RTCDevice, rtcReleaseDevice>>;
using EmbreeBvh = std::unique_ptr<RTCBVH, Release<RTCBVH, rtcReleaseBVH>>;

template <typename Node>
Node* allocate(RTCThreadLocalAllocator allocator) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
}

// The callbacks; Embree calls them from several threads.
void* createNode(RTCThreadLocalAllocator allocator, unsigned children, void*) {
    auto* node = allocate<BuildInner>(allocator);
    node->children = children;
    return node;
}

void setChildren(void* at, void** children, unsigned count, void*) {
    auto* node = static_cast<BuildInner*>(at);
    for (unsigned i = 0; i < count; ++i) node->child[i] = static_cast<BuildNode*>(children[i]);
}

void setBounds(void* at, const RTCBounds** bounds, unsigned count, void*) {
    auto* node = static_cast<BuildInner*>(at);
    for (unsigned i = 0; i < count; ++i) node->bounds[i] = *bounds[i];
}

void* createLeaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count,
                 void*) {
    auto* leaf = allocate<BuildLeaf>(allocator);
    leaf->primitives = static_cast<uint32_t>(count);
    for (size_t i = 0; i < count; ++i) leaf->primitive[i] = primitives[i].primID;
    std::sort(leaf->primitive, leaf->primitive + count);
    return leaf;
}

std::vector<RTCBuildPrimitive> boxesOf(std::span<const glm::vec3> corners, std::span<const BvhBox> shapes) {
    const size_t triangles = corners.size() / 3;
    std::vector<RTCBuildPrimitive> boxes(triangles + shapes.size());
    for (size_t i = 0; i < shapes.size(); ++i) {
        const auto [low, high] = shapes[i];
        boxes[triangles + i] = {low.x,  low.y,  low.z,  0,
                                high.x, high.y, high.z, static_cast<unsigned>(triangles + i)};
    }
    for (size_t i = 0; i < triangles; ++i) {
        const glm::vec3* corner = &corners[3 * i];
        const glm::vec3 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
        const glm::vec3 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
        boxes[i] = {low.x, low.y, low.z, 0, high.x, high.y, high.z, static_cast<unsigned>(i)};
    }
    return boxes;
}

RTCBounds boundsOf(std::span<const glm::vec3> corners, std::span<const BvhBox> shapes) {
    glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    for (const glm::vec3& corner : corners) low = glm::min(low, corner), high = glm::max(high, corner);
    for (const BvhBox& box : shapes) low = glm::min(low, box.lower), high = glm::max(high, box.upper);
    return {low.x, low.y, low.z, 0, high.x, high.y, high.z, 0};
}

BuildNode* build(RTCDevice device, RTCBVH bvh, std::vector<RTCBuildPrimitive> boxes) {
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
    arguments.maxBranchingFactor = kWidth;
    arguments.maxDepth = kBvhMostDepth;
    arguments.minLeafSize = 1;
    arguments.maxLeafSize = kBvhLeafTriangles;
    arguments.bvh = bvh;
    arguments.primitives = boxes.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = boxes.size();
    arguments.createNode = createNode;
    arguments.setNodeChildren = setChildren;
    arguments.setNodeBounds = setBounds;
    arguments.createLeaf = createLeaf;
    auto* root = static_cast<BuildNode*>(rtcBuildBVH(&arguments));
    if (!root)
        throw Error(ErrorCode::internal, fmt::format("Embree cannot build the BVH (error {})",
                                                     static_cast<int>(rtcGetDeviceError(device))));
    return root;
}

uint32_t bits(float value) {
    return std::bit_cast<uint32_t>(value);
}

class Packer {
public:
    Packer(Bvh& bvh, std::span<const glm::vec3> corners, std::span<const uint8_t> flags)
        : bvh_(bvh), corners_(corners), flags_(flags) {}

    /// Appends `node` and what is below it, depth first. Gives the stack that its traversal needs.
    uint32_t addNode(const BuildInner& node, uint32_t depth) {
        const size_t at = bvh_.nodes.size();
        bvh_.nodes.resize(at + kBvhNodeTexels);
        ++bvh_.nodeCount;
        bvh_.maxDepth = std::max(bvh_.maxDepth, depth);
        uint32_t below = 0;
        for (uint32_t slot = 0; slot < kWidth; ++slot) {
            if (slot >= node.children) {
                setChild(at, slot, emptyBounds(), kBvhLeaf);
                continue;
            }
            const BuildNode* child = node.child[slot];
            if (child->children) {
                setChild(at, slot, node.bounds[slot], reference(bvh_.nodes.size()));
                below = std::max(below, addNode(static_cast<const BuildInner&>(*child), depth + 1));
            } else {
                const auto& leaf = static_cast<const BuildLeaf&>(*child);
                setChild(at, slot, node.bounds[slot], leafReference(leaf));
                addLeaf(leaf);
            }
        }
        // While one child is visited the others wait.
        return below + (node.children ? node.children - 1 : 0);
    }

private:
    static RTCBounds emptyBounds() {
        constexpr float far = std::numeric_limits<float>::infinity();
        return {far, far, far, 0, -far, -far, -far, 0};
    }

    static uint32_t reference(size_t texel) {
        if (texel >= kMaxTexels)
            throw Error(ErrorCode::unprocessable,
                        fmt::format("The scene has more triangles than a BVH holds ({} texels)", kMaxTexels));
        return static_cast<uint32_t>(texel);
    }

    uint32_t leafReference(const BuildLeaf& leaf) const {
        return kBvhLeaf | (leaf.primitives - 1) << kBvhCountShift | reference(bvh_.triangles.size());
    }

    void setChild(size_t node, uint32_t slot, const RTCBounds& box, uint32_t child) {
        const float planes[6] = {box.lower_x, box.upper_x, box.lower_y,
                                 box.upper_y, box.lower_z, box.upper_z};
        const int index = static_cast<int>(slot);
        for (size_t plane = 0; plane < 6; ++plane) bvh_.nodes[node + plane][index] = bits(planes[plane]);
        bvh_.nodes[node + 6][index] = child;
    }

    void addLeaf(const BuildLeaf& leaf) {
        for (uint32_t i = 0; i < leaf.primitives; ++i) {
            const uint32_t primitive = leaf.primitive[i];
            const uint8_t flags = flags_.empty() ? uint8_t{0} : flags_[primitive];
            const uint32_t tag = primitive | ((flags & kAsksAccept) != 0 ? kBvhNonOpaque : 0u) |
                                 ((flags & kIsSingleSided) != 0 ? kBvhSingleSided : 0u);
            ++bvh_.triangleCount;
            const size_t triangles = corners_.size() / 3;
            if (primitive >= triangles) {
                const auto shape = static_cast<uint32_t>(primitive - triangles);
                bvh_.triangles.insert(bvh_.triangles.end(), kBvhTriangleTexels,
                                      glm::uvec4(shape, 0, 0, tag | kBvhShape));
                continue;
            }
            const glm::vec3* corner = &corners_[3 * size_t(primitive)];
            for (int axis = 0; axis < 3; ++axis)
                bvh_.triangles.emplace_back(bits(corner[0][axis]), bits(corner[1][axis]),
                                            bits(corner[2][axis]), tag);
        }
    }

    Bvh& bvh_;
    std::span<const glm::vec3> corners_;
    std::span<const uint8_t> flags_;
};

}  // namespace

Bvh buildBvh(std::span<const glm::vec3> corners, std::span<const uint8_t> flags,
             std::span<const BvhBox> shapes) {
    const size_t count = corners.size() / 3 + shapes.size();
    if (count * kBvhTriangleTexels >= kMaxTexels)
        throw Error(ErrorCode::unprocessable, fmt::format("{} triangles are more than a BVH holds ({})",
                                                          count, kMaxTexels / kBvhTriangleTexels));
    Bvh bvh;
    Packer packer(bvh, corners, flags);
    BuildInner above;
    if (count == 0) {
        packer.addNode(above, 1);
        return bvh;
    }
    const EmbreeDevice device(rtcNewDevice(nullptr));
    if (!device) throw Error(ErrorCode::internal, "Embree does not start");
    const EmbreeBvh memory(rtcNewBVH(device.get()));
    const BuildNode* root = build(device.get(), memory.get(), boxesOf(corners, shapes));
    if (root->children == 0) {  // few triangles: one leaf, which needs a node above it
        above.children = 1;
        above.child[0] = const_cast<BuildNode*>(root);
        above.bounds[0] = boundsOf(corners, shapes);
        root = &above;
    }
    bvh.triangles.reserve(count * kBvhTriangleTexels);
    bvh.stackSize = packer.addNode(static_cast<const BuildInner&>(*root), 1);
    return bvh;
}

}  // namespace tilefarm
