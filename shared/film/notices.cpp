#include "shared/film/notices.h"

#include <fmt/format.h>

namespace tilefarm {

std::vector<std::string> noticesOf(const PassFaults& faults, uint64_t paths) {
    std::vector<std::string> notices;
    if (faults.truncatedPaths > 0 && paths > 0) {
        const double percent = 100.0 / static_cast<double>(paths);
        notices.push_back(fmt::format(
            "the bounce limit ended {:.2g} % of the paths, which still carried {:.2g} % of what all began "
            "with: what light they would have found is missing (settings.maxBounces)",
            percent * static_cast<double>(faults.truncatedPaths), percent * faults.truncatedThroughput));
    }
    if (faults.lightsBehindGlass > 0)
        notices.push_back(fmt::format(
            "{} samples of lights without extent ended at smooth solid glass, through which no path finds "
            "such lights: what it shades is too dark unless the lights get a size or the glass is thin",
            faults.lightsBehindGlass));
    return notices;
}

}  // namespace tilefarm
