#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "shaders/gpu_types.h"
#include "shared/film/film.h"

namespace tilefarm {

/// The counter buffer of one dispatch as shaders/counters.glsl leaves it: COUNTER_* words, then TILE_* words
/// of each of its tiles.
class DispatchCounts {
public:
    explicit DispatchCounts(std::span<const uint32_t> words) : words_(words) {}

    /// Words that a buffer for so many tiles holds.
    static uint64_t words(uint64_t tiles) { return gpu::COUNTER_COUNT + gpu::TILE_COUNTERS * tiles; }

    uint32_t droppedSamples() const { return words_[gpu::COUNTER_DROPPED_SAMPLES]; }
    /// Of all tiles.
    uint64_t rays() const;
    /// Dropped samples, as many as were recorded: pixel of the image and index.
    template <typename Visit>
    void forEachDropped(Visit&& visit) const {
        const uint32_t recorded = std::min<uint32_t>(words_[gpu::COUNTER_RECORDED], gpu::RECORDED_SAMPLES);
        for (uint32_t i = 0; i < recorded; ++i) {
            const uint32_t* record = &words_[gpu::COUNTER_FIRST_DROPPED + 2 * i];
            visit(DroppedSample{record[0] & 0xffffu, record[0] >> 16, record[1]});
        }
    }
    /// Adds what was counted of a tile of the dispatch.
    void addTile(size_t tile, PassFaults& faults) const;

private:
    std::span<const uint32_t> ofTile(size_t tile) const {
        return words_.subspan(gpu::COUNTER_COUNT + gpu::TILE_COUNTERS * tile, gpu::TILE_COUNTERS);
    }

    std::span<const uint32_t> words_;
};

/// A fixed-point sum of SUM_LIMBS words: multiples of 2^-32, exact up to the double's rounding.
double exactSum(std::span<const uint32_t> limbs);

}  // namespace tilefarm
