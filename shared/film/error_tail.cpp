#include "shared/film/error_tail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <tuple>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr int kLeastExponent = -40;  // of the first octave; what is smaller decides nothing

bool isWorse(const WorstPixel& a, const WorstPixel& b) {
    return std::tuple(-a.squared, a.y, a.x) < std::tuple(-b.squared, b.y, b.x);
}

}  // namespace

void ErrorTail::add(const WorstPixel& pixel) {
    if (!(pixel.squared > 0) || std::isinf(pixel.squared)) return;
    const auto last = static_cast<int>(octaves_.size()) - 1;
    Octave& octave =
        octaves_[static_cast<size_t>(std::clamp(std::ilogb(pixel.squared) - kLeastExponent, 0, last))];
    ++octave.pixels;
    octave.sum += pixel.squared;
    if (worst_.size() == kMostWorstPixels && !isWorse(pixel, worst_.back())) return;
    worst_.insert(std::upper_bound(worst_.begin(), worst_.end(), pixel, isWorse), pixel);
    if (worst_.size() > kMostWorstPixels) worst_.pop_back();
}

void ErrorTail::add(const ErrorTail& other) {
    for (size_t i = 0; i < octaves_.size(); ++i) {
        octaves_[i].pixels += other.octaves_[i].pixels;
        octaves_[i].sum += other.octaves_[i].sum;
    }
    worst_.insert(worst_.end(), other.worst_.begin(), other.worst_.end());
    std::sort(worst_.begin(), worst_.end(), isWorse);
    worst_.resize(std::min(worst_.size(), kMostWorstPixels));
}

double ErrorTail::shareOfWorst(uint64_t count) const {
    double all = 0, worst = 0;
    for (auto octave = octaves_.rbegin(); octave != octaves_.rend(); ++octave) {
        if (octave->pixels == 0) continue;
        const uint64_t taken = std::min(count, octave->pixels);
        worst += octave->sum * static_cast<double>(taken) / static_cast<double>(octave->pixels);
        count -= taken;
        all += octave->sum;
    }
    return all > 0 ? worst / all : 0;
}

std::string ErrorTail::text() const {
    std::string text;
    for (const WorstPixel& p : worst_) text += fmt::format("pixel {} {} {}\n", p.x, p.y, p.squared);
    for (size_t i = 0; i < octaves_.size(); ++i)
        if (octaves_[i].pixels > 0)
            text += fmt::format("octave {} {} {}\n", i, octaves_[i].pixels, octaves_[i].sum);
    return text;
}

ErrorTail ErrorTail::parse(const std::string& text) {
    ErrorTail tail;
    std::istringstream words(text);
    for (std::string kind; words >> kind;) {
        uint64_t a = 0, b = 0;
        double value = 0;
        const bool whole = static_cast<bool>(words >> a >> b >> value);
        if (whole && kind == "pixel" && tail.worst_.size() < kMostWorstPixels)
            tail.worst_.push_back({static_cast<uint32_t>(a), static_cast<uint32_t>(b), value});
        else if (whole && kind == "octave" && a < tail.octaves_.size())
            tail.octaves_[a] = {b, value};
        else
            throw Error(ErrorCode::internal, "not the tail of a frame's error: " + text);
    }
    return tail;
}

}  // namespace tilefarm
