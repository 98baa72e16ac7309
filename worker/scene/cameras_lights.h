#pragma once

#include "worker/scene/load_context.h"

namespace tilefarm {

/// Every camera of the file, not yet placed. Throws Error(invalidArgument) with the place of a fault.
std::vector<Camera> parseCameras(const JsonNode& root);

/// Every light of KHR_lights_punctual, not yet placed. Throws as parseCameras does.
std::vector<PunctualLight> parseLights(const JsonNode& root);

}  // namespace tilefarm
