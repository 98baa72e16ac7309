#pragma once

#include <string_view>

#include "worker/scene/scene.h"

namespace tilefarm {

struct MaterialOverride;

/// Lays what is given over a material. Factors are replaced; textures of the file go on multiplying them.
/// Throws Error(invalidArgument) for a conductor that is not known.
void applyOverride(Material& material, const MaterialOverride& given);

/// Whether the pattern, in which * stands for any run of characters, is the name.
bool matchesName(std::string_view pattern, std::string_view name);

/// Applies each to all materials of its name, in order; one that finds none is a warning of the scene.
void applyOverrides(Scene& scene, const std::vector<MaterialOverride>& overrides);

}  // namespace tilefarm
