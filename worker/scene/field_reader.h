#pragma once

#include <vector>

#include "worker/scene/json_node.h"
#include "worker/scene/shapes.h"

namespace tilefarm {

/// An expression tree of TILEFARM_shapes (docs/vendor-extensions.md) in postfix order. Throws
/// Error(invalidArgument) with the place of a fault, also where it is longer than the kernel runs.
std::vector<FieldInstruction> readField(const JsonNode& expression);

/// A number above zero, below 1e9.
double positiveOr(const JsonNode& node, double fallback);

}  // namespace tilefarm
