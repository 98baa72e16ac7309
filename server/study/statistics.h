#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "shared/image/float_image.h"

namespace tilefarm {

/// A mean over independent seeds with its 95 % interval by Student's t; of one value, no interval.
struct Estimate {
    double value = 0;
    double standardError = 0;  // of the mean
    double low = 0, high = 0;
};

/// 97.5 % quantile of Student's t. Relative error ≤ 2e-3; `freedom` ≥ 1.
double studentQuantile(size_t freedom);

/// Throws Error(invalidArgument) for no values.
Estimate estimateOf(std::span<const double> values);

/// The geometric mean of positive values, its interval that of the mean of logarithms.
/// Nothing where a value is not positive.
std::optional<Estimate> geometricEstimate(std::span<const double> values);

/// How many of its standard deviations a mean is off, where `referenceVariance` is that of what it was
/// compared with; 0 where neither has any.
double zOf(const Estimate& mean, double referenceVariance);

/// What pictures of one frame with different seeds are off by, added up a picture at a time: over R, G and B
/// of all pixels, weighted by 1, or by 1 / (r² + 0.01²) of the reference r as relMSE is.
///   mean square error = variance + squared bias
/// of which the first two are estimated without bias, and the third is their difference: it may come out
/// below 0, and stands for "none that can be seen" then. The reference's own variance, where its picture has
/// channels of it, is taken off the error.
class SeedSpread {
public:
    enum class Weight { plain, relative };
    SeedSpread(const FloatImage& reference, Weight weight);
    /// Same size as the reference. Throws Error(invalidArgument) otherwise.
    void add(const FloatImage& image);

    double meanSquare() const;  // of one picture from the truth
    double variance() const;    // of one picture; 0 with one picture
    double squaredBias() const { return meanSquare() - variance(); }
    double referenceVariance() const { return referenceVariance_; }  // weighted like the others

private:
    double weightOf(double reference) const;
    const FloatImage& reference_;
    Weight weight_;
    double referenceVariance_ = 0;
    size_t pictures_ = 0;
    double squares_ = 0;                      // Σ over pictures of the mean square
    std::vector<std::vector<double>> means_;  // of each channel's values so far
    double spread_ = 0;                       // Σ of squared deviations from the running means
};

/// A point of error against time. Nothing is better in both than those of the front.
struct CostPoint {
    double seconds = 0, error = 0;
};
/// By point: whether no other one is at most as dear and as wrong, and better in one.
std::vector<bool> paretoFront(std::span<const CostPoint> points);

}  // namespace tilefarm
