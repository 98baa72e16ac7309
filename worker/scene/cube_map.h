#pragma once

#include "worker/scene/scene.h"

namespace tilefarm {

/// An equirectangular picture of a cube map in OpenEXR's layout (ImfEnvmap.h), N x 6 N: its +X face is seen
/// towards +x of the world, and so on. Bilinear within faces, whose outermost texels lie on the edges. Throws
/// Error(invalidArgument) where the picture has another shape.
Image equirectangularOf(const Image& cube);

}  // namespace tilefarm
