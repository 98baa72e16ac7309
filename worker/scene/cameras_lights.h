#pragma once

#include <optional>

#include "worker/scene/load_context.h"
#include "worker/scene/part_list.h"

namespace tilefarm {

/// Every camera of the file, not yet placed; the fault of a broken one comes when it is placed.
PartList<Camera> parseCameras(LoadContext& load);

/// A light as it stands in its node's space: an area light where TILEFARM_lights makes it one.
struct GltfLight {
    PunctualLight punctual;
    std::optional<AreaLight> area;
};

/// Every light of KHR_lights_punctual, not yet placed; likewise.
PartList<GltfLight> parseLights(LoadContext& load);

}  // namespace tilefarm
