#pragma once

#include <cstdint>

#include "shared/film/layout.h"

namespace tilefarm {

/// FEATURE_* bits of the channels that a job asks for.
uint64_t outputFeatures(const FilmLayout& layout);
/// The layout of films that a kernel with these FEATURE_* bits leaves.
FilmLayout layoutOf(uint64_t features);

/// Bytes of a pixel in the kernel's film: the texels of gpu_types.h, padded.
uint64_t kernelBytes(const FilmLayout& layout);
/// The extra floats of a pixel, `layout.floats()` of them, out of its texels behind those of PassPixel.
void takeExtra(const FilmLayout& layout, const float* texels, float* floats);

}  // namespace tilefarm
