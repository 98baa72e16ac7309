#pragma once

#include <cstdint>
#include <vector>

#include "shared/job/image_spec.h"

namespace tilefarm {

/// The sample indices [first, first + count) of one pass.
struct SampleRange {
    uint32_t first = 0;
    uint32_t count = 0;
    uint32_t end() const { return first + count; }
    friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// Longest pass. Bounds how much a lost lease costs and how far a running mean in fp32 may drift.
inline constexpr uint32_t kMaxPassSamples = 256;

/// Ranges of 1, 1, 2, 4, 8 … samples up to kMaxPassSamples that cover [0, samples); the last is cut
/// to fit. Fixed by the job alone: the split decides how merging rounds, so a worker's speed must not.
std::vector<SampleRange> passSchedule(uint32_t samples);

/// A rectangle of pixels; x to the right, y down from the top left of the image.
struct Rect {
    uint32_t x = 0, y = 0, width = 0, height = 0;
    uint64_t area() const { return uint64_t{width} * height; }
    friend bool operator==(const Rect&, const Rect&) = default;
};

/// Tiles of an image row by row from the top left; those at the right and bottom are cut to fit.
struct TileGrid {
    explicit TileGrid(const ImageSpec& image);
    uint32_t columns, rows;
    uint32_t count() const { return columns * rows; }
    Rect rect(uint32_t tile) const;

private:
    ImageSpec image_;
};

}  // namespace tilefarm
