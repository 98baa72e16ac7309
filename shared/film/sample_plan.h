#pragma once

// Which tiles of a frame get further samples. Between pass levels a frame comes to fixed points: no pass is
// out, and what is merged there follows from the job alone. There, and only there, server and local render
// ask `decide`, which sees merged data only, in the order of tiles: so the same job gives the same bits.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/film/stop_reason.h"
#include "shared/job/pass_schedule.h"

namespace tilefarm {

/// What is known of a tile's error at a fixed point.
struct TileError {
    uint64_t pixels = 0;
    uint32_t samples = 0;  // of every pixel
    double variance = 0;   // ErrorSums::relativeVariance
    /// The same, as far as it was known one pass level or fixed point before. It decides where samples go:
    /// with the latest data the tiles whose light is underestimated would be the ones that stop.
    double earlier = 0;

    /// Takes what the tile measures after one more pass level.
    void reach(uint32_t newSamples, double newVariance);
    /// Gets no pass at this fixed point: what it measures now is known before the next one.
    void rest() { earlier = variance; }
    friend bool operator==(const TileError&, const TileError&) = default;
};

/// What a frame has cost so far, in seconds.
struct FrameCost {
    double deviceSeconds = 0, wallSeconds = 0;
};

struct SampleDecision {
    std::vector<uint32_t> tiles;     // ascending: each gets its next pass; empty where the frame is complete
    std::optional<StopReason> stop;  // why it is
    uint64_t passes = 0, pixelSamples = 0;  // of the frame in all, as far as can be foreseen
};

/// Pass levels that every tile gets before the first fixed point; the whole schedule where nothing decides.
uint32_t freeLevels(const StopCondition& stop, const std::vector<SampleRange>& schedule);

/// The pass that follows `samples` samples, or nullptr after the last.
const SampleRange* nextPass(const std::vector<SampleRange>& schedule, uint32_t samples);

/// Passes of a tile that has so many samples.
uint32_t passesUpTo(const std::vector<SampleRange>& schedule, uint32_t samples);

/// Samples per pixel, the mean over the frame, rounded down.
uint32_t meanSamples(std::span<const TileError> tiles);

/// Pixel samples in all once the tiles' summed variance is at most `allowed`, as `decide` would promote them
/// by what is known now; nothing where the schedule ends before.
std::optional<uint64_t> samplesUntil(const std::vector<SampleRange>& schedule,
                                     std::span<const TileError> tiles, double allowed);

/// `tiles` are all of the frame, every one past the free levels. Pure. Tiles are promoted, the one first
/// whose error falls most per sample, until the error expected then meets the target; each of these gets one
/// pass. A round that would exceed a time limit, by the pace so far, is not begun.
SampleDecision decide(const StopCondition& stop, const std::vector<SampleRange>& schedule,
                      std::span<const TileError> tiles, const FrameCost& cost);

}  // namespace tilefarm
