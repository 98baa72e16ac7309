#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace tilefarm {

/// The numbers that glTF gives them.
enum class PrimitiveMode : uint32_t {
    points,
    lines,
    lineLoop,
    lineStrip,
    triangles,
    triangleStrip,
    triangleFan
};

inline bool makesTriangles(PrimitiveMode mode) {
    return mode >= PrimitiveMode::triangles;
}

/// The triangles of a list, strip or fan, wound as glTF 3.7.2.1 says. Indices that do not complete a
/// triangle are left out; points and lines give none.
std::vector<glm::uvec3> triangulate(PrimitiveMode mode, std::span<const uint32_t> indices);

}  // namespace tilefarm
