#include "shared/job/pass_schedule.h"

#include <algorithm>

namespace tilefarm {

std::vector<SampleRange> passSchedule(uint32_t samples) {
    std::vector<SampleRange> ranges;
    uint32_t first = 0;
    while (first < samples) {
        // Every range is as long as all before it, so that each pass level doubles the samples.
        const uint32_t length = std::clamp(first, 1u, kMaxPassSamples);
        const uint32_t count = std::min(length, samples - first);
        ranges.push_back({first, count});
        first += count;
    }
    return ranges;
}

namespace {
// Without a sum that could overflow.
uint32_t ceilDivide(uint32_t a, uint32_t b) {
    return a / b + (a % b != 0);
}
}  // namespace

TileGrid::TileGrid(const ImageSpec& image)
    : columns(ceilDivide(image.width, image.tileSize)),
      rows(ceilDivide(image.height, image.tileSize)),
      image_(image) {}

Rect TileGrid::rect(uint32_t tile) const {
    const uint32_t x = tile % columns * image_.tileSize;
    const uint32_t y = tile / columns * image_.tileSize;
    return {x, y, std::min(image_.tileSize, image_.width - x), std::min(image_.tileSize, image_.height - y)};
}

}  // namespace tilefarm
