#pragma once

#include "shaders/gpu_types.h"
#include "shared/job/image_spec.h"
#include "shared/job/viewing.h"
#include "worker/scene/back_faces.h"

namespace tilefarm {

/// Fills the camera of a frame. `camera` is in the space of the geometry. The vertical field of view
/// (or ymag) is kept and the image's own aspect decides the width.
void setCamera(gpu::FrameParameters& parameters, const Camera& camera, const ImageSpec& image);

/// Likewise for a camera on its way, with its lens; also parameters.cameraKeyCount. Throws Error(invalidArgument)
/// if there are more keys than CAMERA_KEYS.
void setCameraPath(gpu::FrameParameters& parameters, const CameraPath& path, const ImageSpec& image);

/// Which back faces and which depths the camera's rays pass. `backFaces` are those of the scene, in the space
/// of `path`. Gives the FEATURE_* that they call for.
uint64_t setCulling(gpu::FrameParameters& parameters, const BackFaces& backFaces, const CameraPath& path,
                    Culling culling);

/// The FEATURE_* that a camera calls for.
uint64_t featuresOf(const CameraPath& path);

}  // namespace tilefarm
