#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "worker/scene/world.h"

namespace tilefarm {

/// How many of the vertex texels of gpu_types.h the given effects read: 1 … 4.
uint32_t vertexTexelsFor(uint64_t features);

/// Vertices as shaders/surface.glsl reads them, `texels` each.
std::vector<glm::vec4> packVertices(const WorldGeometry& world, uint32_t texels);

/// PrimitiveRecords: corner vertices and material of every triangle; then of every shape
/// NO_INDEX, NO_INDEX, its index and its material.
std::vector<glm::uvec4> packPrimitives(const WorldGeometry& world);

}  // namespace tilefarm
