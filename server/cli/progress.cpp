#include "server/cli/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace tilefarm {

namespace {

constexpr Milliseconds kPaceWindow{30'000}, kPlainInterval{10'000};
constexpr double kPlainStep = 0.05;
constexpr int kBarCells = 24;

std::string describe(const JobProgress& p, const std::optional<std::chrono::seconds>& left) {
    std::string text = fmt::format("{:3.0f} %  {}", std::floor(100 * p.fraction), p.state);
    if (p.frames > 1) text += fmt::format("  frame {} of {}", std::min(p.framesDone + 1, p.frames), p.frames);
    text +=
        fmt::format("  {} of {}{} samples", p.samples, p.errorWanted > 0 ? "at most " : "", p.samplesWanted);
    if (p.relativeError) text += fmt::format("  relative error {:.4f}", *p.relativeError);
    if (p.relativeError && p.errorWanted > 0) text += fmt::format(" (target {:.4g})", p.errorWanted);
    if (left) text += fmt::format("  {} left", clockFace(*left));
    return text;
}

std::string bar(double fraction) {
    const int full = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarCells);
    return fmt::format("[{:=<{}}{:<{}}] ", "", full, "", kBarCells - full);
}

}  // namespace

std::string clockFace(std::chrono::seconds duration) {
    const auto total = duration.count();
    const auto hours = total / 3600, minutes = total / 60 % 60, seconds = total % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, seconds)
                     : fmt::format("{}:{:02}", minutes, seconds);
}

void Eta::add(TimePoint now, double fraction) {
    points_.push_back({now, fraction});
    // One point stays from before the window, as the pace over it needs.
    while (points_.size() > 2 && now - points_[1].time >= kPaceWindow) points_.pop_front();
}

std::optional<std::chrono::seconds> Eta::left() const {
    if (points_.size() < 2) return std::nullopt;
    const double done = points_.back().fraction - points_.front().fraction;
    const double seconds = std::chrono::duration<double>(points_.back().time - points_.front().time).count();
    if (done <= 0 || seconds <= 0) return std::nullopt;
    const double left = seconds / done * std::max(0.0, 1 - points_.back().fraction);
    return std::chrono::seconds(std::llround(std::min(left, 1e9)));
}

ProgressLine::~ProgressLine() {
    if (barWidth_ > 0) console_.err << std::endl;
}

bool ProgressLine::dueWithoutTerminal(const JobProgress& p) const {
    if (!printed_ || printed_->state != p.state) return true;
    const double step = p.fraction - printed_->fraction;
    return step >= kPlainStep || (step > 0 && console_.clock.now() - printedAt_ >= kPlainInterval);
}

void ProgressLine::show(const JobProgress& p) {
    const bool moving = p.state == "running" || p.state == "queued";
    eta_.add(console_.clock.now(), p.fraction);
    const std::string text = describe(p, moving ? eta_.left() : std::nullopt);
    if (console_.terminal) {
        const std::string line = bar(p.fraction) + text;
        console_.err << '\r' << fmt::format("{:<{}}", line, barWidth_) << std::flush;
        barWidth_ = line.size();
    } else if (dueWithoutTerminal(p)) {
        console_.err << text << std::endl;
        printed_ = p;
        printedAt_ = console_.clock.now();
    }
}

void ProgressLine::note(const std::string& text) {
    if (barWidth_ > 0) console_.err << '\n';
    barWidth_ = 0;
    console_.err << text << std::endl;
}

}  // namespace tilefarm
