#pragma once

#include <vector>

#include "shared/job/viewing.h"
#include "worker/scene/back_faces.h"

namespace tilefarm {

/// What a camera's picture shows or leaves out otherwise than some viewer of the same file: geometry within
/// the picture that lies outside of znear and zfar where those do not clip, and backs that culling leaves
/// out, by how much of the picture they would fill. `camera` is in the space of the geometry.
std::vector<SceneWarning> viewWarnings(const Scene& scene, const WorldGeometry& world, const Camera& camera,
                                       double imageAspect, const BackFaces& backFaces, Culling culling);

}  // namespace tilefarm
