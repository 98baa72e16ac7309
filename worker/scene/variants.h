#pragma once

#include "worker/scene/load_context.h"

/// KHR_materials_variants.
namespace tilefarm {

/// The variant of that name, kNone for an empty one. Throws Error(invalidArgument) that lists the names
/// there are.
uint32_t findVariant(const JsonNode& root, const std::string& name);

/// Throws Error(invalidArgument) with the place of an index of the primitive's mappings that leads nowhere.
void checkMappings(const JsonNode& root, const JsonNode& primitive);

/// The material that load.variant gives the primitive, else its own; kNone if it names none.
uint32_t materialOf(const LoadContext& load, const JsonNode& primitive);

}  // namespace tilefarm
