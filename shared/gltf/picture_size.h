#pragma once

#include <optional>

#include "shared/gltf/gltf_bytes.h"
#include "shared/job/image_spec.h"

namespace tilefarm {

struct JobSpec;

/// Width over height of the view that a job's camera frames: the aspectRatio, or xmag / ymag, of the scene's
/// camera that it names, 2 of a panorama. Nothing where nobody framed one: a camera without an aspectRatio,
/// one that the job places, a scene without cameras, a file that is no glTF.
std::optional<double> cameraAspect(const GltfBytes& gltf, const JobSpec& job);

/// The size of a job's picture, both sides above 0. A side that the job leaves open follows from the other
/// and the camera's aspect; if it leaves both, the longer is 640 pixels. Without an aspect they are 640 and
/// 360. Client, server and local render all ask this, so that they agree.
ImageSpec pictureSize(const GltfBytes& gltf, const JobSpec& job);

}  // namespace tilefarm
