#include "shared/film/error_sums.h"

#include <algorithm>
#include <cmath>

#include "shared/film/pixel_error.h"

namespace tilefarm {
namespace {

constexpr double kSquaresInVariance = 3;  // see ErrorSums::estimate
constexpr double kBorrowedDoubt = 0.2;    // standard deviation of borrowed squared errors, as a share of them
constexpr double kQuantile = 1.96;        // of the normal distribution, for 95 %
constexpr uint64_t kPixelsPerWorst = 1000;  // the worst 0.1 %

}  // namespace

void ErrorSums::add(const FilmTile& tile) {
    const std::vector<PixelError> errors = pixelErrors(tile);
    for (size_t i = 0; i < errors.size(); ++i) {
        const auto [squared, share] = errors[i];
        relativeVariance += squared;
        squares += squared * squared;
        borrowed += squared * share;
        tail.add(WorstPixel{tile.rect.x + static_cast<uint32_t>(i % tile.rect.width),
                            tile.rect.y + static_cast<uint32_t>(i / tile.rect.width), squared});
        droppedSamples += static_cast<uint64_t>(tile.pixels[i].dropped);
    }
    pixels += errors.size();
}

void ErrorSums::add(const ErrorSums& other) {
    relativeVariance += other.relativeVariance;
    squares += other.squares;
    borrowed += other.borrowed;
    pixels += other.pixels;
    droppedSamples += other.droppedSamples;
    tail.add(other.tail);
}

double ErrorSums::relativeError() const {
    return pixels == 0 ? 0 : std::sqrt(relativeVariance / static_cast<double>(pixels));
}

ErrorEstimate ErrorSums::estimate() const {
    ErrorEstimate e{.relativeError = relativeError(), .worst = tail.worst(), .sum = relativeVariance};
    e.low = e.high = e.relativeError;
    if (!(relativeVariance > 0) || !std::isfinite(squares)) return e;
    const double doubt = kBorrowedDoubt * borrowed;
    const double deviation = std::sqrt(kSquaresInVariance * squares + doubt * doubt) / relativeVariance;
    const double factor = std::exp(0.5 * kQuantile * deviation);  // half: of the root
    e.low = e.relativeError / factor;
    e.high = e.relativeError * factor;
    e.worstShare = tail.shareOfWorst((pixels + kPixelsPerWorst - 1) / kPixelsPerWorst);
    return e;
}

}  // namespace tilefarm
