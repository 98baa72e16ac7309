#include "worker/scene/triangulate.h"

namespace tilefarm {

std::vector<glm::uvec3> triangulate(PrimitiveMode mode, std::span<const uint32_t> v) {
    std::vector<glm::uvec3> triangles;
    if (v.size() < 3 || !makesTriangles(mode)) {
        return triangles;
    }
    const size_t count = mode == PrimitiveMode::triangles ? v.size() / 3 : v.size() - 2;
    triangles.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        if (mode == PrimitiveMode::triangles) {
            triangles.emplace_back(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
        } else if (mode == PrimitiveMode::triangleStrip) {
            triangles.emplace_back(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
        } else {
            triangles.emplace_back(v[i + 1], v[i + 2], v[0]);
        }
    }
    return triangles;
}

}  // namespace tilefarm
