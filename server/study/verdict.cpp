#include "server/study/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

namespace tilefarm {
namespace {

using nlohmann::json;

// A variant at the most samples of the study.
struct Contender {
    std::string label;
    double ratio = 0, low = 0, high = 0;
    double biasPercent = 0, z = 0;
    bool biased = false;
};

std::vector<Contender> contenders(const json& result) {
    std::vector<Contender> found;
    const json& variants = result.at("variants");
    for (size_t i = 1; i < variants.size(); ++i) {
        const json& cell = variants[i].at("cells").back();
        const json& ratio = cell.at("efficiencyRatio");
        if (!ratio.is_object()) continue;  // an error that cannot be told from the reference's
        const json& percent = cell.at("bias").at("percent");
        found.push_back({variants[i].at("label"), ratio.at("value"), ratio.at("low"), ratio.at("high"),
                         percent.is_number() ? percent.get<double>() : 0, cell.at("bias").at("z"),
                         cell.at("biased")});
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.ratio > b.ratio; });
    return found;
}

std::string times(double ratio) {
    return ratio > 9.99 ? fmt::format("{:.0f}", ratio) : fmt::format("{:.2f}", ratio);
}

std::string praise(const Contender& best) {
    std::string words = fmt::format("{} is worth its time: {} times the base's efficiency (95 %: {} to {})",
                                    best.label, times(best.ratio), times(best.low), times(best.high));
    if (!best.biased) return words + ".";
    if (std::abs(best.z) <= 4)
        return words + ", but it is biased: most of its error would stay at any number of samples.";
    return words + fmt::format(", but it is biased: its mean is {:.2g} % too {} (z = {:.1f}).",
                               std::abs(best.biasPercent), best.biasPercent > 0 ? "bright" : "dark", best.z);
}

// A wide interval is no finding: more seeds would make one.
std::string nearest(const std::vector<Contender>& all) {
    if (all.empty() || all.front().ratio <= 1) return {};
    const Contender& first = all.front();
    return fmt::format(" The nearest is {}: {} times, but 95 %: {} to {}; more seeds would tell.",
                       first.label, times(first.ratio), times(first.low), times(first.high));
}

std::string losers(const std::vector<Contender>& all) {
    std::string words;
    for (const Contender& one : all)
        if (one.high < 1)
            words += (words.empty() ? "" : "; ") + one.label + fmt::format(" ({} times)", times(one.ratio));
    return words.empty() ? words : " Not worth it: " + words + ".";
}

}  // namespace

std::string studyVerdict(const json& result) {
    const auto all = contenders(result);
    const auto worth = [](const Contender& one) { return one.low > 1; };
    const auto best = std::find_if(all.begin(), all.end(), worth);
    if (best == all.end())
        return "No setting is worth its time here: none is more efficient than the base beyond chance." +
               nearest(all) + losers(all);
    if (!best->biased) return "Without a bias that can be seen, " + praise(*best) + losers(all);
    const auto fair =
        std::find_if(all.begin(), all.end(), [&](const auto& one) { return worth(one) && !one.biased; });
    return praise(*best) +
           (fair == all.end() ? " Nothing without bias is worth its time."
                              : " Without bias, " + praise(*fair)) +
           losers(all);
}

}  // namespace tilefarm
