#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "worker/scene/scene.h"

namespace tilefarm {

/// Decodes a PNG or JPEG, the formats of glTF. 8-bit sources keep their bytes; 16-bit ones become
/// linear floats, for which `srgb` says how they are encoded. Throws Error(invalidArgument) with the fault
/// alone: the caller names the place.
Image decodeImage(std::span<const std::byte> bytes, bool srgb);

}  // namespace tilefarm
