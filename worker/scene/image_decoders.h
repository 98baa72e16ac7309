#pragma once

#include <cstddef>
#include <span>

#include "worker/scene/scene.h"

namespace tilefarm {

/// One format each; what decodeImage (decode_image.h) says holds. `bytes` begin with the format's signature.
Image decodeJpeg(std::span<const std::byte> bytes);
Image decodePng(std::span<const std::byte> bytes, bool srgb);

/// Throws Error(invalidArgument) where an image is empty or too large for limits.h, or where its bytes cannot
/// hold as many texels at `texelsPerByte`, the most of its format: so a small file cannot claim the memory of
/// a large one.
void requireModestImage(uint64_t width, uint64_t height, size_t bytes, uint64_t texelsPerByte);

}  // namespace tilefarm
