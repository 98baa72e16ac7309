#pragma once

#include <cstdint>
#include <vector>

#include "shared/film/error_tail.h"
#include "shared/film/film.h"

namespace tilefarm {

/// What a frame reports of its accuracy.
struct ErrorEstimate {
    double relativeError = 0;         // of sqrt(mean over pixels of (L − Lref)² / (Lref² + 0.01²))
    double low = 0, high = 0;         // of 95 % of frames the true error lies in between
    double worstShare = 0;            // of the squared error, held by the worst 0.1 % of pixels
    std::vector<WorstPixel> worst{};  // the worst first
    double sum = 0;                   // of squared errors over all pixels, of which each has its share
};

/// Sums over pixels from which the error estimate of a frame comes (shared/film/pixel_error.h); adding tiles
/// in any grouping gives the same estimate up to double rounding.
struct ErrorSums {
    double relativeVariance = 0;  // Σ of estimated squared relative errors
    double squares = 0;           // Σ of their squares
    double borrowed = 0;          // Σ of them, as far as neighbours stood for the true luminance
    uint64_t pixels = 0;
    uint64_t droppedSamples = 0;
    ErrorTail tail{};
    void add(const FilmTile& tile);
    void add(const ErrorSums& other);
    /// sqrt(relativeVariance / pixels), DESIGN.md's relative_error; 0 for no pixels.
    double relativeError() const;
    /// With an interval on the scale of logarithms. Its width adds up the noise of the estimate and of the
    /// true error itself, three times the squares (each pixel's estimate has about the variance of its
    /// square, the true squared error of a normal pixel twice that), and what luminance borrowed from
    /// neighbours was off by, which the scenes of docs/accuracy.md show.
    ErrorEstimate estimate() const;
};

}  // namespace tilefarm
