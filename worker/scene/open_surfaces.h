#pragma once

#include <span>
#include <vector>

#include "worker/scene/scene.h"

/// Surfaces with an edge, of which no side is the inside: a window that is one plane, a box without a lid.
namespace tilefarm {

/// For each triangle of each mesh whether its surface is open. The meshes are the primitives of one object:
/// what they enclose together is closed, and so is what those of one material enclose by themselves. Surfaces
/// hang together where exactly two triangles share an edge; corners at the same place are the same one,
/// whatever their other attributes. A surface is open where an edge without a neighbour runs around more than
/// a thousandth of its area: cracks between triangles that meet at other corners, seams and pinholes let next
/// to no ray through. Winding does not matter.
std::vector<std::vector<bool>> openTriangles(std::span<const Mesh* const> meshes);

}  // namespace tilefarm
