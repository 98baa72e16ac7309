#pragma once

#include <optional>

#include "worker/scene/skins.h"

namespace tilefarm {

/// Checks what a mesh primitive refers to, without reading it.
void checkPrimitive(const LoadContext& load, const JsonNode& primitive);

/// What a morph target adds to a mesh at weight 1; empty or one per vertex.
struct MorphTarget {
    std::vector<glm::vec3> positions, normals, tangents;
};

/// The triangles of a primitive as they stand in the file, and what may move them.
struct RawPrimitive {
    Mesh mesh;
    std::vector<MorphTarget> targets;
    Influences influences;
};

/// Reads a checked primitive from accessors or from Draco data. Every index is in range. Nothing, and a
/// warning, for points, lines and what has no positions. The material is that of load.variant, else its own,
/// as an index into /materials or kNone.
std::optional<RawPrimitive> readPrimitive(LoadContext& load, const JsonNode& primitive);

/// Adds the targets to a mesh, each as much as it weighs; weights that are missing are 0.
void blendTargets(Mesh& mesh, const std::vector<MorphTarget>& targets, const std::vector<double>& weights);

}  // namespace tilefarm
