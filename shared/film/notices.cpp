#include "shared/film/notices.h"

#include <fmt/format.h>

namespace tilefarm {

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

}  // namespace tilefarm
