#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "shared/image/difference.h"
#include "shared/image/float_image.h"
#include "shared/image/tone.h"

namespace tilefarm {

/// An image and its reference, which outlive it, with what several metrics share. Throws as `difference`.
struct ImagePair {
    ImagePair(const FloatImage& a, const FloatImage& b, const ToneMapping& shown = {})
        : image(a),
          reference(b),
          tone(shown),
          difference(tilefarm::difference(a, b)),
          agreement(statisticalAgreement(a, b)) {}
    const FloatImage& image;
    const FloatImage& reference;
    const ToneMapping tone;  // of what a viewer sees
    const ImageDifference difference;
    const std::optional<StatisticalAgreement> agreement;
};

/// A number that says how far an image is from its reference. A new metric is one entry of the table.
struct ImageMetric {
    std::string_view name;                               // in JSON
    std::string_view title;                              // in a table for people
    std::string_view means;                              // with its formula
    std::optional<double> (*of)(const ImagePair& pair);  // nothing where the images lack what it takes
};

/// In the order of display.
std::span<const ImageMetric> imageMetrics();

}  // namespace tilefarm
