#pragma once

#include "shared/image/float_image.h"
#include "shared/image/tone.h"

namespace tilefarm {

/// Pixels per degree of visual angle of the viewer that FLIP's authors assume: a screen 0.7 m wide with 3,840
/// pixels, seen from 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67;

/// Mean LDR-FLIP of two images, 0 … 1: how different they look when shown in turn, as 8 bit sRGB of the given
/// tone mapping. After Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "FLIP: A Difference
/// Evaluator for Alternating Images" (2020). Sizes are equal and not 0. Memory: about 100 bytes per pixel.
double meanFlip(const FloatImage& test, const FloatImage& reference, const ToneMapping& tone,
                double pixelsPerDegree = kFlipPixelsPerDegree);

}  // namespace tilefarm
