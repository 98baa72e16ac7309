#include "worker/render/features.h"

#include "gpu_tables_host.h"

namespace tilefarm {
std::string_view featureName(uint32_t bit) {
    return gpu::kFeatureNames.at(bit);
}

FeatureReport reportFeatures(uint64_t compiled, uint64_t wanted) {
    FeatureReport report;
    for (uint32_t bit = 0; bit < gpu::FEATURE_COUNT; ++bit)
        ((compiled >> bit & 1u) != 0 ? report.used
         : (wanted >> bit & 1u) != 0 ? report.notShown
                                     : report.leftOut)
            .emplace_back(featureName(bit));
    return report;
}

}  // namespace tilefarm
