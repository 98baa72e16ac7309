#pragma once

#include <array>
#include <glm/glm.hpp>

namespace tilefarm {

using Triangle = std::array<glm::dvec3, 3>;

/// Whether two triangles lie in one plane, within what rounding to float moves their corners by, and share
/// more of it than an edge. Neighbours in a mesh do not.
bool overlapInOnePlane(const Triangle& a, const Triangle& b);

}  // namespace tilefarm
