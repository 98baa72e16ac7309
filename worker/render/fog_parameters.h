#pragma once

#include "shaders/gpu_types.h"
#include "worker/scene/world.h"

namespace tilefarm {

/// Fog in the space of the geometry, and the bounds of the surfaces that it may have to fill.
struct PlacedFog {
    Fog fog;                           // its box, if it has one, re-centred
    std::optional<Fog::Box> surfaces;  // none: there are no surfaces
};

PlacedFog placeFog(const Fog& fog, const WorldGeometry& world);

/// Fills the members of FrameParameters about fog. `camera` is in the space of the geometry. Fog without a
/// box of its own fills the one around all surfaces and wherever rays start: the camera's path and its lens.
void setFog(gpu::FrameParameters& parameters, const PlacedFog& placed, const CameraPath& camera);

}  // namespace tilefarm
