#pragma once

#include <optional>

#include "worker/scene/load_context.h"

namespace tilefarm {

/// Checks what a mesh primitive refers to, without reading it.
void checkPrimitive(const LoadContext& load, const JsonNode& primitive);

/// The triangles of a checked primitive as they stand in the file, from accessors or from Draco data, with
/// its morph targets blended by `weights`. Every index is in range. Nothing, and a warning, for points,
/// lines and what has no positions. The material is an index into /materials or kNone.
std::optional<Mesh> readPrimitive(LoadContext& load, const JsonNode& primitive,
                                  const std::vector<double>& weights);

}  // namespace tilefarm
