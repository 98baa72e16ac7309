#pragma once

#include <optional>

#include "worker/scene/load_context.h"

namespace tilefarm {

/// Every camera of the file, not yet placed. Throws Error(invalidArgument) with the place of a fault.
std::vector<Camera> parseCameras(LoadContext& load);

/// A light as it stands in its node's space: an area light where TILEFARM_lights makes it one.
struct GltfLight {
    PunctualLight punctual;
    std::optional<AreaLight> area;
};

/// Every light of KHR_lights_punctual, not yet placed. Throws as parseCameras does.
std::vector<GltfLight> parseLights(LoadContext& load);

}  // namespace tilefarm
