#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace tilefarm {

/// Tangents as MikkTSpace defines them, which bakers of normal maps assume: Mikkelsen, "Simulation of
/// Wrinkled Surfaces Revisited", 2008, and the rules published at mikktspace.com. A tangent belongs to a
/// vertex of position, normal and texture coordinate; the triangles around it that hang together by edges
/// and have the same orientation in texture space share one, weighted by their angles.
///
/// Gives three per triangle (xyz unit length and orthogonal to the normal, w the handedness +1 or -1).
/// The bitangent is cross(normal, tangent) * w and follows +v. Corners for which the texture coordinates
/// give no direction get some tangent orthogonal to the normal. Normals must be unit length, triangles must
/// have an area, and all arrays must be as long as `positions`.
std::vector<glm::vec4> mikkTangents(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                    std::span<const glm::vec2> uvs, std::span<const glm::uvec3> triangles);

/// Some unit vector orthogonal to a unit vector.
glm::dvec3 anyOrthogonal(glm::dvec3 normal);

}  // namespace tilefarm
