#include "shared/film/notices.h"

#include <fmt/format.h>

namespace tilefarm {
namespace {

// Of the squared error: from here on the worst 0.1 % of pixels decide more than all others together, and the
// estimate rests on the few samples that they met.
constexpr double kFewPixelsDecide = 0.5;

}  // namespace

std::vector<std::string> noticesOf(const PassFaults& faults, uint64_t paths) {
    std::vector<std::string> notices;
    if (faults.truncatedPaths > 0 && paths > 0) {
        const double percent = 100.0 / static_cast<double>(paths);
        notices.push_back(fmt::format(
            "the bounce limit (settings.maxBounces) ended {:.2g} % of the paths, which still carried {:.2g} "
            "% of the initial throughput: the light that they would have found is missing",
            percent * static_cast<double>(faults.truncatedPaths), percent * faults.truncatedThroughput));
    }
    if (faults.lightsBehindGlass > 0)
        notices.push_back(fmt::format(
            "{} shadow rays to point, spot or directional lights were blocked by smooth solid glass, through "
            "which such lights cannot be found: the shadow of the glass is too dark; give the lights a size "
            "or make the glass thin-walled",
            faults.lightsBehindGlass));
    return notices;
}

std::vector<std::string> noticesOf(const ErrorEstimate& estimate) {
    if (estimate.worstShare < kFewPixelsDecide || estimate.worst.empty()) return {};
    const WorstPixel& worst = estimate.worst.front();
    return {fmt::format(
        "{:.0f} % of the squared error lies in 0.1 % of the pixels, hit by rare bright paths: the error is "
        "known to its interval only, and more samples help slowly; `tilefarm-worker render --pixel {},{}` "
        "shows such a path; settings.clampIndirect, settings.regularisation and fewer settings.maxBounces "
        "remove such paths, at a bias",
        100 * estimate.worstShare, worst.x, worst.y)};
}

}  // namespace tilefarm
