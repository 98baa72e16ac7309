#pragma once

#include <optional>

#include "shared/image/float_image.h"

namespace tilefarm {

/// How far image `a` is from reference `b`, over the channels R, G and B.
struct ImageDifference {
    double rmse = 0;            // sqrt(mean (a − b)²)
    double relMse = 0;          // mean (a − b)² / (b² + 0.01²)
    double max = 0;             // largest |a − b|
    double meanDifference = 0;  // mean (a − b), the bias
    double meanReference = 0;   // mean b
    bool identical = false;     // every fp32 value has the same bits
};

/// Sums in double. Throws Error(invalidArgument) when sizes differ or a value is not finite, naming
/// the first such pixel.
ImageDifference difference(const FloatImage& a, const FloatImage& b);

/// Whether two independent renders estimate the same image, by their own variances.
struct StatisticalAgreement {
    double meanZ = 0;  // Σ (a − b) over its standard deviation: |z| ≤ 4 but for 1 in 16,000 pairs that agree
    double withinFourSigma =
        0;  // share of values with |a − b| ≤ 4 σ; heavy tails keep it below the normal's 0.99994
};

/// Over R, G and B, by the channels variance.R … of both (variance of the mean); values that neither
/// image has a variance for are left out. Nothing where a channel is missing or all variances are 0.
/// Throws as `difference` does.
std::optional<StatisticalAgreement> statisticalAgreement(const FloatImage& a, const FloatImage& b);

}  // namespace tilefarm
