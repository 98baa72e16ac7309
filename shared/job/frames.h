#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tilefarm {

inline constexpr uint32_t kMostFrames = 100000;

/// Which frames a job renders: first, first + step, … or, where there is a list, those that it names.
struct FrameSet {
    int32_t first = 0;
    uint32_t count = 1;
    uint32_t step = 1;
    std::string list = {};  // "1,5,9", "1-100x10,205"; then `first` and `count` say what follows from it
    friend bool operator==(const FrameSet&, const FrameSet&) = default;
};

/// Frames and ranges between commas: "7", "1-240", "1-100x10" (every tenth), "1-100x10,205", ends with a sign
/// if need be. What is one range becomes first, count and step. Throws Error(invalidArgument) that says what
/// it should be.
FrameSet framesFrom(const std::string& text);

/// The numbers, in the order given; one that is named again counts once, where it stands first.
std::vector<int32_t> frameNumbers(const FrameSet& frames);
/// Likewise from the lowest to the highest, as movies and archives have them.
std::vector<int32_t> sortedFrameNumbers(const FrameSet& frames);

/// Such that framesFrom gives the frames again.
std::string textOf(const FrameSet& frames);

}  // namespace tilefarm
