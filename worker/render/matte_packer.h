#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "worker/scene/world.h"

namespace tilefarm {

/// Cryptomatte ids of each primitive's object and material (shared/matte), two primitives to a texel. Objects
/// are nodes, and lights of a job; instances of a node are one.
std::vector<glm::uvec4> packMattes(const Scene& scene, const WorldGeometry& world);

}  // namespace tilefarm
