#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tilefarm {

/// A pixel of the image and what it adds to the frame's squared relative error.
struct WorstPixel {
    uint32_t x = 0, y = 0;
    double squared = 0;
    friend bool operator==(const WorstPixel&, const WorstPixel&) = default;
};
inline constexpr size_t kMostWorstPixels = 16;

/// How a frame's error is spread over its pixels: the worst ones by name and all of them counted by octave.
/// Adding in any grouping gives the same tail up to double rounding. About 1 KiB.
class ErrorTail {
public:
    void add(const WorstPixel& pixel);
    void add(const ErrorTail& other);

    /// At most kMostWorstPixels, the worst first; of equal ones the upper left first.
    const std::vector<WorstPixel>& worst() const { return worst_; }
    /// Of all squared errors together the share, 0 … 1, that the worst `count` pixels hold. Of the octave
    /// that `count` cuts, pixels count as equal.
    double shareOfWorst(uint64_t count) const;

    /// One line each; `parse` of it gives an equal tail. Parse throws Error(internal) for other texts.
    std::string text() const;
    static ErrorTail parse(const std::string& text);
    friend bool operator==(const ErrorTail&, const ErrorTail&) = default;

private:
    struct Octave {
        uint64_t pixels = 0;
        double sum = 0;
        friend bool operator==(const Octave&, const Octave&) = default;
    };
    std::vector<WorstPixel> worst_;
    std::array<Octave, 64> octaves_{};
};

}  // namespace tilefarm
