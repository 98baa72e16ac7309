#include "shared/film/estimate_json.h"

#include <nlohmann/json.hpp>

namespace tilefarm {

using nlohmann::json;

json intervalJson(const std::optional<ErrorEstimate>& estimate) {
    return estimate ? json::array({estimate->low, estimate->high}) : json();
}

json tailJson(const std::optional<ErrorEstimate>& estimate) {
    if (!estimate) return {};
    json pixels = json::array();
    for (const WorstPixel& p : estimate->worst)
        pixels.push_back({{"x", p.x}, {"y", p.y}, {"share", p.squared / estimate->sum}});
    return {{"worstShare", estimate->worstShare}, {"pixels", pixels}};
}

}  // namespace tilefarm
