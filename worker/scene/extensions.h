#pragma once

#include "worker/scene/load_context.h"

namespace tilefarm {

/// An extension that is not known and required is an Error(invalidArgument) that names it; one that is
/// merely used becomes a warning.
void checkExtensions(LoadContext& load);

/// A warning for each extension of `object` that is known and not rendered yet.
void warnOfNotRendered(LoadContext& load, const JsonNode& object);

}  // namespace tilefarm
