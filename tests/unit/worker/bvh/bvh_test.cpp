#include "worker/bvh/bvh.h"

#include <gtest/gtest.h>

#include <bit>
#include <functional>

#include "tests/support/expect_error.h"
#include "tests/support/triangle_scenes.h"

namespace tilefarm {
namespace {

using Box = std::pair<glm::vec3, glm::vec3>;  // least, most

// One child of a node as intersect.glsl reads it.
struct Child {
    uint32_t reference;
    Box box;
    bool leaf() const { return reference & kBvhLeaf; }
    uint32_t count() const { return (reference >> kBvhCountShift & 3) + 1; }
    uint32_t first() const { return reference & ((1u << kBvhCountShift) - 1); }
    bool absent() const { return box.first.x > box.second.x; }
};

float asFloat(uint32_t bits) { return std::bit_cast<float>(bits); }

Child childOf(const Bvh& bvh, uint32_t node, int slot) {
    const auto plane = [&](uint32_t texel) { return asFloat(bvh.nodes[node + texel][slot]); };
    return {bvh.nodes[node + 6][slot], {{plane(0), plane(2), plane(4)}, {plane(1), plane(3), plane(5)}}};
}

glm::vec3 cornerOf(const Bvh& bvh, uint32_t triangle, int corner) {
    return {asFloat(bvh.triangles[triangle][corner]), asFloat(bvh.triangles[triangle + 1][corner]),
            asFloat(bvh.triangles[triangle + 2][corner])};
}

bool inside(const Box& box, glm::vec3 point) {
    return glm::all(glm::lessThanEqual(box.first, point)) && glm::all(glm::lessThanEqual(point, box.second));
}

struct Walk {
    std::vector<uint32_t> seen;  // how often each primitive is in a leaf
    uint32_t nodes = 0, depth = 0, stack = 0;
};

// Visits everything, checks what must hold everywhere, and finds the deepest stack of any depth-first order.
Walk walk(const Bvh& bvh, std::span<const glm::vec3> corners) {
    Walk result;
    result.seen.resize(corners.size() / 3);
    const auto leaf = [&](const Child& child, const Box& outer) {
        uint32_t last = 0;
        for (uint32_t i = 0; i < child.count(); ++i) {
            const uint32_t at = child.first() + i * kBvhTriangleTexels;
            const uint32_t primitive = bvh.triangles[at].w & ~kBvhNonOpaque;
            EXPECT_TRUE(i == 0 || primitive > last) << "leaves are sorted";
            last = primitive;
            ++result.seen.at(primitive);
            for (int corner = 0; corner < 3; ++corner) {
                EXPECT_EQ(cornerOf(bvh, at, corner), corners[3 * primitive + uint32_t(corner)]);
                EXPECT_TRUE(inside(outer, cornerOf(bvh, at, corner)));
            }
        }
    };
    const std::function<void(uint32_t, uint32_t, uint32_t, const Box*)> visit = [&](uint32_t node, uint32_t depth,
                                                                                    uint32_t waiting,
                                                                                    const Box* outer) {
        ++result.nodes;
        result.depth = std::max(result.depth, depth);
        uint32_t children = 0;
        for (int slot = 0; slot < 4; ++slot) children += !childOf(bvh, node, slot).absent();
        if (children) result.stack = std::max(result.stack, waiting + children - 1);
        for (int slot = 0; slot < 4; ++slot) {
            const Child child = childOf(bvh, node, slot);
            if (child.absent()) continue;
            if (outer) {
                EXPECT_TRUE(inside(*outer, child.box.first) && inside(*outer, child.box.second));
            }
            if (child.leaf())
                leaf(child, child.box);
            else
                visit(child.reference, depth + 1, waiting + children - 1, &child.box);
        }
    };
    visit(0, 1, 0, nullptr);
    return result;
}

void expectSound(const Triangles& triangles) {
    const Bvh bvh = buildBvh(triangles);
    const Walk result = walk(bvh, triangles);
    for (size_t i = 0; i < result.seen.size(); ++i) ASSERT_EQ(result.seen[i], 1u) << "triangle " << i;
    EXPECT_EQ(result.nodes, bvh.nodeCount);
    EXPECT_EQ(bvh.nodes.size(), size_t(bvh.nodeCount) * kBvhNodeTexels);
    EXPECT_EQ(bvh.triangles.size(), size_t(bvh.triangleCount) * kBvhTriangleTexels);
    EXPECT_EQ(result.depth, bvh.maxDepth);
    EXPECT_EQ(result.stack, bvh.stackSize);
    EXPECT_GT(bvhStackConstant(bvh), bvh.stackSize);
}

TEST(Bvh, HoldsEveryTriangleOnceWithinItsBoxes) {
    expectSound(triangleSoup(5'000, 0.1f, 1));
    expectSound(terrain(40));
    expectSound(cornellBox());
}

TEST(Bvh, HoldsTrianglesThatCannotBeToldApart) {
    Triangles same;
    for (int i = 0; i < 1000; ++i) same.insert(same.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    expectSound(same);
    Triangles points(3 * 1000, glm::vec3(0.5f));
    expectSound(points);
}

TEST(Bvh, HoldsTrianglesFarApartInSizeAndPlace) {
    Triangles wide;
    for (int exponent = -30; exponent < 30; ++exponent) {
        const float size = std::ldexp(1.0f, exponent);
        wide.insert(wide.end(), {{size, 0, 0}, {2 * size, 0, 0}, {size, size, 0}});
        wide.insert(wide.end(), {{-size, 0, 1e9f}, {-2 * size, 0, 1e9f}, {-size, size, 1e9f}});
    }
    expectSound(wide);
}

TEST(Bvh, HoldsNoneToFiveTriangles) {
    for (uint32_t count = 0; count <= 5; ++count) {
        SCOPED_TRACE(count);
        expectSound(triangleSoup(count, 0.1f, 2));
    }
}

TEST(Bvh, IsTheSameEveryTime) {
    const Triangles ground = terrain(150);  // enough for Embree to build in parallel
    const Bvh first = buildBvh(ground);
    for (int again = 0; again < 4; ++again) {
        const Bvh next = buildBvh(ground);
        ASSERT_EQ(next.nodes, first.nodes);
        ASSERT_EQ(next.triangles, first.triangles);
    }
}

TEST(Bvh, MarksTheTrianglesThatAskTheHook) {
    const Triangles soup = triangleSoup(100, 0.1f, 3);
    std::vector<uint8_t> nonOpaque(100, 0);
    nonOpaque[17] = nonOpaque[99] = 1;
    const Bvh bvh = buildBvh(soup, nonOpaque);
    for (const glm::uvec4& texel : bvh.triangles) {
        const uint32_t primitive = texel.w & ~kBvhNonOpaque;
        EXPECT_EQ(bool(texel.w & kBvhNonOpaque), primitive == 17 || primitive == 99);
    }
}

TEST(Bvh, RefusesMoreTrianglesThanItCanAddress) {
    const glm::vec3 corner(0);
    const std::span<const glm::vec3> tooMany(&corner, size_t(3) * ((1u << kBvhCountShift) / kBvhTriangleTexels + 1));
    EXPECT_EQ(codeOf([&] { buildBvh(tooMany); }), ErrorCode::unprocessable);
}

TEST(Bvh, FullIsTheSameEveryTimeForAMillionTriangles) {
    const Triangles ground = terrain(708);
    const Bvh first = buildBvh(ground), second = buildBvh(ground);
    ASSERT_EQ(second.nodes, first.nodes);
    ASSERT_EQ(second.triangles, first.triangles);
}

}  // namespace
}  // namespace tilefarm
