#include "worker/render/features.h"

#include <array>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

// In the order of the bits of gpu_types.h.
constexpr std::array<std::string_view, gpu::FEATURE_COUNT> kNames{
    "textures",      "normal maps",       "vertex colours",      "alpha cutout",       "specular reflection",
    "mirror",        "transmission",      "volume attenuation",  "emissive triangles", "punctual lights",
    "environment",   "unlit materials",   "orthographic camera", "float textures",     "texture transforms",
    "second UV set", "nearest filtering",
};
static_assert(!kNames.back().empty());

}  // namespace

std::string_view featureName(uint32_t bit) {
    return kNames.at(bit);
}

FeatureReport reportFeatures(uint32_t features) {
    FeatureReport report;
    for (uint32_t bit = 0; bit < gpu::FEATURE_COUNT; ++bit)
        ((features >> bit & 1u) != 0 ? report.used : report.leftOut).emplace_back(featureName(bit));
    return report;
}

}  // namespace tilefarm
