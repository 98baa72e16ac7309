#include "worker/render/alias_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tilefarm {
namespace {

constexpr double kFull = 4294967296.0;  // 2^32: always keep the entry itself

uint32_t thresholdOf(double probability) {
    const double scaled = std::nearbyint(probability * kFull);
    return scaled >= kFull ? 0xffffffffu : scaled <= 0 ? 0u : static_cast<uint32_t>(scaled);
}

}  // namespace

std::vector<gpu::AliasRecord> buildAliasTable(std::span<const double> weights) {
    const size_t n = weights.size();
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<gpu::AliasRecord> table(n);
    std::vector<double> share(n);
    std::vector<uint32_t> small, large;
    for (uint32_t i = 0; i < n; ++i) {
        table[i].pmf = static_cast<float>(weights[i] / total);
        share[i] = weights[i] / total * static_cast<double>(n);
        (share[i] < 1 ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
        const uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        table[poor].threshold = thresholdOf(share[poor]);
        table[poor].alias = rich;
        share[rich] -= 1 - share[poor];
        if (share[rich] < 1) {
            large.pop_back();
            small.push_back(rich);
        }
    }
    // What rounding left over has the share 1 but for its last digits. An entry of weight 0 among it
    // must still never be drawn: it hands all to one that has weight.
    const auto some =
        static_cast<uint32_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
    for (const auto& rest : {small, large})
        for (const uint32_t i : rest) {
            table[i].threshold = weights[i] > 0 ? 0xffffffffu : 0u;
            table[i].alias = weights[i] > 0 ? i : some;
        }
    return table;
}

}  // namespace tilefarm
