#pragma once

#include <cstdint>

#include "worker/scene/scene.h"

/// What makes a mesh as it was read safe to render. The order of the functions is the order of use.
namespace tilefarm {

/// Removes triangles with repeated or non-finite corners and those without area (in double) and gives
/// their number.
uint64_t dropDegenerateTriangles(Mesh& mesh);

/// Makes normals unit length. A corner whose normal is zero or not finite gets the geometric normal of its
/// triangle, as if it had none; a mesh with no usable normal at all loses them.
void repairNormals(Mesh& mesh);

/// Gives every triangle corners of its own with the geometric normal.
void makeFlat(Mesh& mesh);

/// Replaces texture coordinates and colours that are not finite by 0 and 1.
void repairSurface(Mesh& mesh);

/// Removes vertices that no triangle uses.
void dropUnusedVertices(Mesh& mesh);

/// Copies a vertex with all its attributes to the end and gives its index.
uint32_t duplicateVertex(Mesh& mesh, uint32_t vertex);

/// Of unit length in double; zero where the triangle has no area.
glm::dvec3 geometricNormal(const Mesh& mesh, glm::uvec3 triangle);

/// Unit length, or zero for what is zero or not finite.
glm::dvec3 normalizeOrZero(glm::dvec3 v);

}  // namespace tilefarm
