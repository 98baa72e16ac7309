#pragma once

#include <glm/glm.hpp>

#include "worker/scene/world.h"

namespace tilefarm {

/// Mean linear colour of a texture over a triangle, from its texels at a fixed set of points; one
/// where `ref` refers to none. Only chooses lights: its error costs noise, never bias.
glm::dvec3 averageOverTriangle(const Scene& scene, const TextureRef& ref, const WorldGeometry& world,
                               uint32_t triangle);

}  // namespace tilefarm
