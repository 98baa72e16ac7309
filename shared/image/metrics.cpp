#include "shared/image/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "shared/image/flip.h"

namespace tilefarm {
namespace {

using Value = std::optional<double>;

constexpr double kDark = 0.01;  // as in the error estimate of a frame: black pixels must not decide alone
constexpr double kTrimmed = 0.001;

Value rootMeanSquare(const ImagePair& pair) {
    return pair.difference.rmse;
}

Value relativeSquare(const ImagePair& pair) {
    return pair.difference.relMse;
}

// Of R, G and B of each pixel, added up.
std::vector<double> overPixels(const ImagePair& pair, double (*term)(double step, double reference)) {
    std::vector<double> terms(pair.image.pixelCount());
    for (const char* channel : {"R", "G", "B"}) {
        const auto &a = pair.image.plane(channel), &b = pair.reference.plane(channel);
        for (size_t i = 0; i < terms.size(); ++i) terms[i] += term(double{a[i]} - b[i], b[i]);
    }
    return terms;
}

Value trimmedRelativeSquare(const ImagePair& pair) {
    std::vector<double> terms = overPixels(pair, [](double step, double reference) {
        return step * step / (reference * reference + kDark * kDark);
    });
    std::sort(terms.begin(), terms.end());
    const auto kept =
        terms.size() - static_cast<size_t>(std::ceil(kTrimmed * static_cast<double>(terms.size())));
    if (kept == 0) return {};
    double sum = 0;
    for (size_t i = 0; i < kept; ++i) sum += terms[i];
    return sum / (3.0 * static_cast<double>(kept));
}

Value absolutePercentage(const ImagePair& pair) {
    double sum = 0;
    for (const double term : overPixels(pair, [](double step, double reference) {
             return std::abs(step) / (std::abs(reference) + kDark);
         }))
        sum += term;
    return 100 * sum / (3.0 * static_cast<double>(pair.image.pixelCount()));
}

Value flip(const ImagePair& pair) {
    return meanFlip(pair.image, pair.reference, pair.tone);
}

Value largest(const ImagePair& pair) {
    return pair.difference.max;
}

Value meanDifference(const ImagePair& pair) {
    return pair.difference.meanDifference;
}

Value meanReference(const ImagePair& pair) {
    return pair.difference.meanReference;
}

Value meanPercent(const ImagePair& pair) {
    const ImageDifference& d = pair.difference;
    return d.meanReference == 0 ? Value() : 100 * d.meanDifference / d.meanReference;
}

Value meanZ(const ImagePair& pair) {
    return pair.agreement ? Value(pair.agreement->meanZ) : Value();
}

Value withinFourSigma(const ImagePair& pair) {
    return pair.agreement ? Value(pair.agreement->withinFourSigma) : Value();
}

constexpr std::array kMetrics{
    ImageMetric{"rmse", "RMSE", "sqrt(mean (a − b)²)", rootMeanSquare},
    ImageMetric{"relMse", "relMSE", "mean (a − b)² / (b² + 0.01²)", relativeSquare},
    ImageMetric{"relMseTrimmed", "relMSE trimmed", "the same without the worst 0.1 % of pixels",
                trimmedRelativeSquare},
    ImageMetric{"mape", "MAPE %", "100 mean |a − b| / (|b| + 0.01)", absolutePercentage},
    ImageMetric{"flip", "FLIP", "mean LDR-FLIP at 67 pixels per degree, of the tone-mapped pictures", flip},
    ImageMetric{"max", "largest", "largest |a − b|", largest},
    ImageMetric{"meanDifference", "mean difference", "mean (a − b)", meanDifference},
    ImageMetric{"meanReference", "mean of B", "mean b", meanReference},
    ImageMetric{"meanPercent", "difference %", "100 mean (a − b) / mean b", meanPercent},
    ImageMetric{"meanZ", "mean z", "Σ (a − b) over its standard deviation, by the images' variances", meanZ},
    ImageMetric{"withinFourSigma", "within 4 sigma", "share of values with |a − b| ≤ 4 σ", withinFourSigma},
};

}  // namespace

std::span<const ImageMetric> imageMetrics() {
    return kMetrics;
}

}  // namespace tilefarm
