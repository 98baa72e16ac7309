#pragma once

#include <string>

#include "shared/image/float_image.h"

namespace tilefarm {

/// What a study measures of a frame's EXR: R, G and B with their variances; or, without these, the denoised
/// picture in their place. Throws Error(invalidArgument) that names the channel if one is missing.
FloatImage studiedPicture(const FloatImage& exr, bool denoised);

/// R, G, B and their variances at another size: of each new pixel the mean over the area that it covers. A
/// variance is that of the mean of independent pixels.
FloatImage resized(const FloatImage& image, uint32_t width, uint32_t height);

/// How far a picture is from its reference in each pixel, for the eye: red where it is too bright, blue where
/// it is too dark, by (l − r) / (r + 0.01) of luminance, full at ½.
FloatImage differencePicture(const FloatImage& image, const FloatImage& reference);

/// "data:image/png;base64,…", at most `width` pixels wide.
std::string pngUrl(const FloatImage& image, uint32_t width);

}  // namespace tilefarm
