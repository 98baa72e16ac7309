#pragma once

#include <cstdint>
#include <string_view>

#include "worker/render/renderer.h"

namespace tilefarm {

/// The word for one FEATURE_* bit in reports: "normal maps". `bit` is the bit's number.
std::string_view featureName(uint32_t bit);

/// Which effects a kernel with the bits `compiled` holds and which it leaves out, by name; `wanted` are those
/// that scene and job call for.
FeatureReport reportFeatures(uint64_t compiled, uint64_t wanted);

}  // namespace tilefarm
