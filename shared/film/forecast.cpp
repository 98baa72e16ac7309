#include "shared/film/forecast.h"

#include <algorithm>
#include <cmath>

namespace tilefarm {
namespace {

constexpr double kLeastSpread = 0.02;
constexpr double kNormal95 = 1.96;

double slope(const CostPoint& from, const CostPoint& to) {
    return (to.deviceSeconds - from.deviceSeconds) / static_cast<double>(to.pixelSamples - from.pixelSamples);
}

uint64_t pixelsOf(const FrameOutlook& frame) {
    uint64_t pixels = 0;
    for (const TileError& tile : frame.tiles) pixels += tile.pixels;
    return pixels;
}

double pixelSamplesOf(const FrameOutlook& frame) {
    double sum = 0;
    for (const TileError& tile : frame.tiles) sum += static_cast<double>(tile.pixels * tile.samples);
    return sum;
}

// The frame's variances times `scale`, as they would be at the ends of the error's interval.
std::optional<double> pixelSamplesTo(const FrameOutlook& frame, const std::vector<SampleRange>& schedule,
                                     double relativeError, double scale) {
    const double allowed = relativeError * relativeError * static_cast<double>(pixelsOf(frame)) / scale;
    if (frame.tiles.size() > 1) {
        const auto samples = samplesUntil(schedule, frame.tiles, allowed);
        return samples ? std::optional(static_cast<double>(*samples)) : std::nullopt;
    }
    const TileError& all = frame.tiles.front();
    const double samples = std::max(all.samples * all.variance / allowed, double(all.samples));
    if (samples > schedule.back().end()) return {};
    return samples * static_cast<double>(all.pixels);
}

struct Scales {
    double low = 1, high = 1;  // of the summed squared error
};

Scales scalesOf(const ErrorEstimate& error) {
    const auto squared = [&](double bound) { return std::pow(bound / error.relativeError, 2); };
    return {squared(error.low), squared(error.high)};
}

// Both ends move away from the value independently.
double combined(double value, double end, double spread) {
    return std::hypot(value - end, value * kNormal95 * spread);
}

Forecast priced(const FrameOutlook& frame, double samples, double low, double high) {
    const double done = pixelSamplesOf(frame), pace = frame.pace.seconds;
    const auto left = [&](double all) { return std::max(all - done, 0.0) * pace; };
    Forecast f;
    f.samples = samples / static_cast<double>(pixelsOf(frame));
    f.deviceSeconds = frame.deviceSeconds + left(samples);
    f.low = std::max(frame.deviceSeconds,
                     f.deviceSeconds - combined(left(samples), left(low), frame.pace.spread));
    f.high = f.deviceSeconds + combined(left(samples), left(high), frame.pace.spread);
    return f;
}

}  // namespace

std::optional<Pace> paceOf(std::span<const CostPoint> curve) {
    if (curve.size() < 2) return {};
    const CostPoint &last = curve.back(), &before = curve[curve.size() - 2];
    Pace pace{slope(before, last), 0};
    if (!(pace.seconds > 0)) return {};
    const double earlier = curve.size() > 2 ? slope(curve[curve.size() - 3], before)
                                            : before.deviceSeconds / static_cast<double>(before.pixelSamples);
    pace.spread = std::max(kLeastSpread, std::abs(earlier / pace.seconds - 1) / 2);
    return pace;
}

std::optional<Forecast> forecast(const FrameOutlook& frame, const std::vector<SampleRange>& schedule,
                                 double relativeError) {
    if (!(frame.error.relativeError > 0)) return {};
    const Scales scales = scalesOf(frame.error);
    const auto samples = pixelSamplesTo(frame, schedule, relativeError, 1);
    if (!samples) return {};
    const double most = static_cast<double>(pixelsOf(frame)) * schedule.back().end();
    Forecast f =
        priced(frame, *samples, pixelSamplesTo(frame, schedule, relativeError, scales.low).value_or(most),
               pixelSamplesTo(frame, schedule, relativeError, scales.high).value_or(most));
    f.relativeError = relativeError;
    return f;
}

Forecast forecastSamples(const FrameOutlook& frame, uint32_t samples) {
    const double pixels = static_cast<double>(pixelsOf(frame)), all = pixels * samples;
    Forecast f = priced(frame, all, all, all);
    f.relativeError = frame.error.relativeError * std::sqrt(pixelSamplesOf(frame) / all);
    return f;
}

}  // namespace tilefarm
