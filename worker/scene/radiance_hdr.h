#pragma once

#include <cstddef>
#include <span>

#include "worker/scene/scene.h"

namespace tilefarm {

/// Decodes a Radiance picture (.hdr, RGBE, flat or run-length encoded, rows from the top) to linear floats
/// with alpha 1. Throws Error(invalidArgument) with the fault alone: the caller names the file.
Image decodeRadianceHdr(std::span<const std::byte> bytes);

}  // namespace tilefarm
