#pragma once

#include <optional>

#include "worker/scene/load_context.h"

/// The extensions of our own, docs/vendor-extensions.md.
namespace tilefarm {

/// TILEFARM_materials: the members of a job's material override. Throws Error(invalidArgument) with every
/// fault and its place.
void readVendorMaterial(const JsonNode& extension, Material& material);

/// TILEFARM_lights gives a light of KHR_lights_punctual a size: a point light with a radius becomes a
/// sphere, a point or spot light with width and height a rectangle, both given back in the node's space; a
/// directional light gets its angular radius. Far away and on the axis the intensity stays the light's.
/// Throws as above.
std::optional<AreaLight> readVendorLight(const JsonNode& extension, PunctualLight& light);

}  // namespace tilefarm
