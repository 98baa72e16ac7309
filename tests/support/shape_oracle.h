#pragma once

#include <glm/glm.hpp>

#include "worker/scene/shapes.h"

namespace tilefarm {

/// Shapes in double, met by sphere tracing of their exact distances: another way than the kernel's.
struct ExactShapeHit {
    bool hit = false;
    double t = 0;
    glm::dvec3 position{0}, normal{0};  // outwards; of a flat shape its front
    double nearest = 0;                 // how near the ray comes to the surface before the hit, or at all
};

/// Signed distance in the shape's own space; of flat shapes unsigned.
double exactDistance(const Shape& shape, const glm::dvec3& own);

/// `direction` of any length; t counts in it. The transform has to be a similarity.
ExactShapeHit exactHit(const Shape& shape, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace tilefarm
