#pragma once

#include "shared/job/lighting.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// Irradiance of the sun outside the atmosphere in the scene's units, the same in all channels: so that a white
/// Lambert plane under a high sun and its sky has a radiance near 1. One unit is 1361 / 3.4 = 400 W/m².
inline constexpr double kSolarIrradiance = 3.4;

/// Towards the sun: azimuth clockwise from north (−z) seen from above. World space before any rotation.
glm::dvec3 sunDirection(const SkySettings& settings);

/// Surrounds the scene with the clear sky of worker/scene/atmosphere.h above a ground of even albedo, as an
/// equirectangular image of 512×256, and adds the sun's disk as a directional light with an angular size where its
/// middle is above the horizon. `intensity` scales both, `rotation` (rad, around +y, counter-clockwise seen from above)
/// turns both. The sky's own image of the sun is not in the image. Takes some tenths of a second.
void addSky(Scene& scene, const SkySettings& settings, double intensity, double rotation);

}  // namespace tilefarm
