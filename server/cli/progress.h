#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "server/cli/console.h"

namespace tilefarm {

/// What a look at a job shows.
struct JobProgress {
    std::string state;
    double fraction = 0;  // of all passes
    uint64_t samples = 0, samplesWanted = 0;
    uint32_t framesDone = 0, frames = 1;
    std::optional<double> relativeError;
    double errorWanted = 0;  // 0: as it comes
};

/// "0:07", "12:30", "3:05:00".
std::string clockFace(std::chrono::seconds duration);

/// Predicts the time that is left from the pace of the last half minute.
class Eta {
public:
    void add(TimePoint now, double fraction);
    /// Nothing while there is no pace to go by.
    std::optional<std::chrono::seconds> left() const;

private:
    struct Point {
        TimePoint time;
        double fraction;
    };
    std::deque<Point> points_;
};

/// Shows a job's progress on console.err: a bar that redraws itself on a terminal, else a plain line
/// at every change of state and then whenever 5 % or 10 s have gone by with some progress.
class ProgressLine {
public:
    explicit ProgressLine(const Console& console) : console_(console) {}
    /// Ends the bar's line, so that what follows starts on a fresh one.
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    void show(const JobProgress& progress);
    /// A remark that does not disturb the bar.
    void note(const std::string& text);

private:
    bool dueWithoutTerminal(const JobProgress& progress) const;

    const Console& console_;
    Eta eta_;
    size_t barWidth_ = 0;  // characters on the line now
    std::optional<JobProgress> printed_;
    TimePoint printedAt_{};
};

}  // namespace tilefarm
