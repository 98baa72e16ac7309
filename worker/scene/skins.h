#pragma once

#include <vector>

#include "worker/scene/load_context.h"

namespace tilefarm {

/// What binds a mesh to joints: vertices follow world(joints[i]) * inverseBind[i].
struct Skin {
    std::vector<uint32_t> joints;  // indices into /nodes, at least one
    std::vector<glm::dmat4> inverseBind;
};

/// Every skin of the file; the fault of a broken one comes when it is used.
PartList<Skin> parseSkins(LoadContext& load);

/// Up to eight joints of each vertex of a mesh: JOINTS_n and WEIGHTS_n.
struct Influences {
    std::vector<glm::vec4> joints[2];   // indices into Skin::joints; empty or one per vertex
    std::vector<glm::vec4> weights[2];  // likewise
    explicit operator bool() const { return !joints[0].empty(); }
};

/// Moves the vertices of a mesh along with their joints, in double: positions by Σ w M, normals by its
/// inverse transpose, tangents by itself. Weights are scaled to a sum of 1; a vertex of none follows the
/// first joint that it names, with a warning. Triangles that the joints mirror are turned round. Faults (a
/// joint that is not there, a weight that is not finite or, beyond rounding, negative) are reported at
/// `primitive`.
void applySkin(Mesh& mesh, const Influences& influences, const std::vector<glm::dmat4>& jointMatrices,
               const JsonNode& primitive);

}  // namespace tilefarm
