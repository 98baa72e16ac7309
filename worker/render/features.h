#pragma once

#include <cstdint>
#include <string_view>

#include "worker/render/renderer.h"

namespace tilefarm {

/// The word for one FEATURE_* bit in reports: "normal maps". `bit` is the bit's number.
std::string_view featureName(uint32_t bit);

/// Which effects a kernel with these bits holds and which it leaves out, by name.
FeatureReport reportFeatures(uint64_t features);

}  // namespace tilefarm
