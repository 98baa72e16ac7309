#include "shared/image/difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "shared/error/error.h"

namespace tilefarm {

namespace {

void requireFinite(const FloatImage& image, const char* which, const char* channel) {
    const std::vector<float>& plane = image.plane(channel);
    const auto bad =
        std::find_if_not(plane.begin(), plane.end(), [](float value) { return std::isfinite(value); });
    if (bad == plane.end()) return;
    const auto pixel = static_cast<size_t>(bad - plane.begin());
    throw Error(ErrorCode::invalidArgument,
                fmt::format("the {} image has {} in channel {} at pixel ({}, {})", which, *bad, channel,
                            pixel % image.width, pixel / image.width));
}

}  // namespace

ImageDifference difference(const FloatImage& a, const FloatImage& b) {
    if (a.width != b.width || a.height != b.height)
        throw Error(ErrorCode::invalidArgument, fmt::format("the images differ in size: {}x{} and {}x{}",
                                                            a.width, a.height, b.width, b.height));
    if (a.pixelCount() == 0) throw Error(ErrorCode::invalidArgument, "the images have no pixels");

    // Keeps dark pixels from deciding alone, as in the error estimate of a frame.
    constexpr double floor = 0.01 * 0.01;
    double squares = 0, relativeSquares = 0, sum = 0, sumReference = 0;
    ImageDifference d;
    d.identical = true;
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>&planeA = a.plane(channel), &planeB = b.plane(channel);
        d.identical &= std::memcmp(planeA.data(), planeB.data(), planeA.size() * sizeof(float)) == 0;
        requireFinite(a, "first", channel);
        requireFinite(b, "second", channel);
        for (size_t i = 0; i < planeA.size(); ++i) {
            const double step = double{planeA[i]} - planeB[i];
            squares += step * step;
            relativeSquares += step * step / (double{planeB[i]} * planeB[i] + floor);
            d.max = std::max(d.max, std::abs(step));
            sum += step;
            sumReference += planeB[i];
        }
    }
    const double values = 3.0 * static_cast<double>(a.pixelCount());
    d.rmse = std::sqrt(squares / values);
    d.relMse = relativeSquares / values;
    d.meanDifference = sum / values;
    d.meanReference = sumReference / values;
    return d;
}

std::optional<StatisticalAgreement> statisticalAgreement(const FloatImage& a, const FloatImage& b) {
    difference(a, b);  // refuses what cannot be compared
    double sum = 0, variance = 0, within = 0, values = 0;
    for (const std::string channel : {"R", "G", "B"}) {
        const std::string name = "variance." + channel;
        if (a.find(name) < 0 || b.find(name) < 0) return {};
        const std::vector<float>&planeA = a.plane(channel), &planeB = b.plane(channel);
        const std::vector<float>&varianceA = a.plane(name), &varianceB = b.plane(name);
        for (size_t i = 0; i < planeA.size(); ++i) {
            const double step = double{planeA[i]} - planeB[i], both = double{varianceA[i]} + varianceB[i];
            if (!(both > 0)) continue;
            sum += step;
            variance += both;
            within += step * step <= 16 * both ? 1 : 0;
            values += 1;
        }
    }
    if (values == 0) return {};
    return StatisticalAgreement{sum / std::sqrt(variance), within / values};
}

}  // namespace tilefarm
