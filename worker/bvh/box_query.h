#pragma once

#include <array>
#include <bit>

#include "worker/bvh/bvh.h"

namespace tilefarm {

/// Calls visit(texel) with the first texel in Bvh::triangles of every primitive whose leaf touches `box`.
template <typename Visit>
void visitTouching(const Bvh& bvh, const BvhBox& box, Visit&& visit) {
    constexpr uint32_t kAddress = (1u << kBvhCountShift) - 1;
    std::array<uint32_t, 1 + 3 * kBvhMostDepth> waiting;
    waiting[0] = 0;
    for (uint32_t top = 1; top > 0;) {
        const glm::uvec4* node = &bvh.nodes[waiting[--top]];
        for (int slot = 0; slot < 4; ++slot) {
            const auto plane = [&](int texel) { return std::bit_cast<float>(node[texel][slot]); };
            if (plane(0) > box.upper.x || plane(1) < box.lower.x || plane(2) > box.upper.y ||
                plane(3) < box.lower.y || plane(4) > box.upper.z || plane(5) < box.lower.z)
                continue;
            const uint32_t reference = node[6][slot], first = reference & kAddress;
            if ((reference & kBvhLeaf) == 0) {
                waiting[top++] = reference;
                continue;
            }
            const uint32_t more = reference >> kBvhCountShift & 3u;
            for (uint32_t i = 0; i <= more; ++i) visit(first + i * kBvhTriangleTexels);
        }
    }
}

}  // namespace tilefarm
