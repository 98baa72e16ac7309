#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tilefarm {

/// Named planes of fp32 values, rows from the top. Planes are indexed as in `channels`.
struct FloatImage {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<std::string> channels;        // "R", "G", "B", "A", "variance.R", …
    std::vector<std::vector<float>> planes;   // each width * height

    size_t pixelCount() const { return size_t{width} * height; }
    /// Index of a channel or -1.
    int find(const std::string& channel) const;
    /// Throws Error(invalidArgument) that names the channel if it is missing.
    const std::vector<float>& plane(const std::string& channel) const;
};

}  // namespace tilefarm
