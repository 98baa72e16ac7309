#pragma once

#include <glm/glm.hpp>

#include "worker/scene/json_node.h"

namespace tilefarm {

/// A node's matrix, or its translation, rotation and scale, in double.
glm::dmat4 localTransform(const JsonNode& node);

/// translation * rotation (xyzw, normalised here) * scale.
glm::dmat4 composeTransform(glm::dvec3 translation, glm::dvec4 rotation, glm::dvec3 scale);

/// The rotation and translation of a camera's transform: x right, y up, looks along -z. Scale, shear and
/// mirroring are left out.
glm::dmat4 withoutScale(const glm::dmat4& transform);

}  // namespace tilefarm
