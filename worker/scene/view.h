#pragma once

#include "shared/job/viewing.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// The camera that a job places itself, without its lens. `view.kind` must not be scene.
Camera placedCamera(const ViewSettings& view);

/// A camera whose view, if its aspect is known, lies in a picture of another aspect as a job asks for.
Camera fitted(Camera camera, CameraFit fit, double imageAspect);

/// Gives a camera the lens that a job asks for. `middle`: of the scene, which a scene's camera is focused on
/// by default. Only perspective cameras have a lens.
void setLens(Camera& camera, const ViewSettings& view, double imageAspect, const glm::dvec3& middle);

/// A camera turned around the vertical line through `centre`, counter-clockwise seen from above (+y).
Camera turnedAround(Camera camera, const glm::dvec3& centre, double degrees);

}  // namespace tilefarm
