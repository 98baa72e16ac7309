#pragma once

#include <vector>

#include "shared/job/render_settings.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// A warning for each material of smooth solid glass, where the scene has lights without extent: the surface
/// that refracts is a mirror and the light a point, so no path through the one finds the other. PassFaults
/// counts what of their light ends there.
std::vector<SceneWarning> hiddenLights(const Scene& scene, const RenderSettings& settings);

}  // namespace tilefarm
