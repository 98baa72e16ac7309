#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "shared/image/float_image.h"
#include "shared/image/tone.h"

namespace tilefarm {

/// An image and its reference, of equal size and with finite R, G and B, as `difference` requires.
struct ImagePair {
    const FloatImage& image;
    const FloatImage& reference;
    ToneMapping tone{};  // of what a viewer sees
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
