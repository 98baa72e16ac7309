#include "shared/job/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <unordered_set>

#include "shared/error/error.h"

namespace tilefarm {

namespace {

// With those that are named again: a short text may name all of them thousands of times.
constexpr uint64_t kMostNamed = 4 * uint64_t{kMostFrames};

[[noreturn]] void refuse(const std::string& text, const std::string& rule) {
    throw Error(ErrorCode::invalidArgument,
                fmt::format("frames '{}{}' {}", text.substr(0, 100), text.size() > 100 ? "…" : "", rule));
}

std::vector<std::string> parts(const std::string& text) {
    std::vector<std::string> list;
    for (size_t at = 0; at <= text.size();) {
        const size_t comma = std::min(text.find(',', at), text.size());
        const size_t begin = std::min(text.find_first_not_of(' ', at), comma);
        const size_t end = text.find_last_not_of(' ', comma - 1) + 1;
        list.push_back(begin < comma ? text.substr(begin, end - begin) : "");
        at = comma + 1;
    }
    return list;
}

/// One frame or range. `text` is all that it stands in, for the fault.
FrameSet rangeFrom(const std::string& part, const std::string& text) {
    static const std::regex form("(-?[0-9]{1,10})(?:-(-?[0-9]{1,10})(?:x([0-9]{1,9}))?)?");
    std::smatch found;
    if (!std::regex_match(part, found, form))
        refuse(text, "must be frames and ranges between commas, like 7, 1-240, 1-100x10 or 1,5,9");
    const int64_t first = std::stoll(found[1]), last = found[2].matched ? std::stoll(found[2]) : first;
    const int64_t step = found[3].matched ? std::stoll(found[3]) : 1;
    if (step == 0 || last < first) refuse(text, "has a range that holds no frame");
    if (first < INT32_MIN || last > INT32_MAX) refuse(text, "has numbers that are no frames");
    const int64_t count = (last - first) / step + 1;
    if (count > kMostFrames) refuse(text, fmt::format("holds more than {} frames", kMostFrames));
    return {static_cast<int32_t>(first),
            static_cast<uint32_t>(count),
            count > 1 ? static_cast<uint32_t>(step) : 1,
            {}};
}

std::vector<FrameSet> rangesFrom(const std::string& text) {
    std::vector<FrameSet> ranges;
    for (const std::string& part : parts(text)) ranges.push_back(rangeFrom(part, text));
    return ranges;
}

void append(const FrameSet& range, std::vector<int32_t>& numbers, std::unordered_set<int32_t>& known) {
    for (uint32_t i = 0; i < range.count; ++i) {
        const auto number = static_cast<int32_t>(range.first + int64_t{i} * range.step);
        if (known.insert(number).second) numbers.push_back(number);
    }
}

std::vector<int32_t> numbersOf(const std::vector<FrameSet>& ranges, const std::string& text) {
    std::vector<int32_t> numbers;
    std::unordered_set<int32_t> known;
    uint64_t named = 0;
    for (const FrameSet& range : ranges) {
        named += range.count;
        if (named > kMostNamed) refuse(text, fmt::format("names frames more than {} times", kMostNamed));
        append(range, numbers, known);
        if (numbers.size() > kMostFrames) refuse(text, fmt::format("holds more than {} frames", kMostFrames));
    }
    return numbers;
}

std::string textOfRange(const FrameSet& range) {
    const int64_t last = range.first + int64_t{range.count - 1} * range.step;
    if (range.count == 1) return fmt::format("{}", range.first);
    return range.step == 1 ? fmt::format("{}-{}", range.first, last)
                           : fmt::format("{}-{}x{}", range.first, last, range.step);
}

}  // namespace

FrameSet framesFrom(const std::string& text) {
    const std::vector<FrameSet> ranges = rangesFrom(text);
    if (ranges.size() == 1) return ranges.front();
    std::string list;
    for (const FrameSet& range : ranges) list += (list.empty() ? "" : ",") + textOfRange(range);
    return {ranges.front().first, static_cast<uint32_t>(numbersOf(ranges, text).size()), 1, list};
}

std::vector<int32_t> frameNumbers(const FrameSet& frames) {
    if (!frames.list.empty()) return numbersOf(rangesFrom(frames.list), frames.list);
    return numbersOf({frames}, textOfRange(frames));
}

std::vector<int32_t> sortedFrameNumbers(const FrameSet& frames) {
    std::vector<int32_t> numbers = frameNumbers(frames);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

std::string textOf(const FrameSet& frames) {
    return frames.list.empty() ? textOfRange(frames) : frames.list;
}

}  // namespace tilefarm
