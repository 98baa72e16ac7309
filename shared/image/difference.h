#pragma once

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

}  // namespace tilefarm
