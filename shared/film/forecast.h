#pragma once

// What a frame will take until it meets an error target, told from what is merged of it.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/film/error_sums.h"
#include "shared/film/sample_plan.h"

namespace tilefarm {

/// A point of a frame's error curve as a forecast needs it.
struct CostPoint {
    uint64_t pixelSamples = 0;  // of the frame so far
    double deviceSeconds = 0;   // likewise
};

/// Device seconds per pixel sample, and how far that may be off.
struct Pace {
    double seconds = 0;
    double spread = 0;  // relative, one standard deviation
};

/// The pace of the latest samples; nothing before two points. Early passes are short and fill a device badly,
/// so that they say little of what later ones take: between the last two points the pace counts, and how
/// it moved from the points before is its spread, at least 2 %.
std::optional<Pace> paceOf(std::span<const CostPoint> curve);

/// What is known of a frame.
struct FrameOutlook {
    std::vector<TileError>
        tiles;                 // of a frame that samples all pixels alike: one that stands for all of them
    ErrorEstimate error{};     // of the frame as it is
    double deviceSeconds = 0;  // that it has taken
    Pace pace{};
};

struct Forecast {
    double relativeError = 0;                     // the target
    double samples = 0;                           // per pixel in all, mean over the frame
    double deviceSeconds = 0, low = 0, high = 0;  // in all, with an interval that holds in 95 % of cases
    friend bool operator==(const Forecast&, const Forecast&) = default;
};

/// Nothing where the schedule ends before the target is met, or where the frame shows no error. Variances of
/// tiles fall as 1 / samples; where there is more than one tile, those are promoted first that gain most, as
/// `decide` does. The interval holds what the error estimate and the pace leave open.
std::optional<Forecast> forecast(const FrameOutlook& frame, const std::vector<SampleRange>& schedule,
                                 double relativeError);

/// The same for samples that are given: the error that they reach is `relativeError`.
Forecast forecastSamples(const FrameOutlook& frame, uint32_t samples);

}  // namespace tilefarm
