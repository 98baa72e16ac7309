#pragma once

#include <cstdint>
#include <vector>

#include "shared/film/film.h"

namespace tilefarm {

/// Side of the blocks within which a pixel looks for others like it; pixels of the image, from its top left.
/// Tiles are a multiple of it wide and high, so that a block never lies in two of them: the estimate needs no
/// other tile, and tile size and order of arrival do not show in it.
inline constexpr uint32_t kErrorBlock = 8;

/// What one pixel adds to the squared relative error of its frame.
struct PixelError {
    double squared = 0;   // estimate of (L − Lref)² / (Lref² + 0.01²)
    double borrowed = 0;  // 0 … 1: how far neighbours stand for Lref rather than the pixel itself
};

/// Of all pixels of the tile, rows from the top: the measured variance of the mean luminance over a luminance
/// that stands for Lref. The pixel's own would hide the pixels that matter, since one bright path brightens
/// its pixel. So the own luminance is shrunk towards the mean of pixels that look alike (by albedo, normal
/// and depth), as far as its own noise is larger than the spread among them (empirical Bayes; Efron and
/// Morris 1973). Depends on the block's pixels alone; linear in pixels. A pixel without variance gives 0.
std::vector<PixelError> pixelErrors(const FilmTile& tile);

}  // namespace tilefarm
