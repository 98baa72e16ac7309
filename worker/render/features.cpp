#include "worker/render/features.h"

#include <array>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

// In the order of the bits of gpu_types.h.
constexpr std::array<std::string_view, gpu::FEATURE_COUNT> kNames{
    "textures",
    "normal maps",
    "vertex colours",
    "alpha cutout",
    "specular reflection",
    "mirror",
    "transmission",
    "volume attenuation",
    "emissive triangles",
    "punctual lights",
    "environment",
    "unlit materials",
    "orthographic camera",
    "float textures",
    "texture transforms",
    "second UV set",
    "nearest filtering",
    "specular colour",
    "clearcoat",
    "sheen",
    "anisotropy",
    "iridescence",
    "dispersion",
    "diffuse transmission",
    "measured conductors",
    "energy compensation",
    "Oren-Nayar",
    "Disney diffuse",
    "Disney sheen",
    "GTR1 clearcoat",
    "Beckmann distribution",
    "Phong distribution",
    "Schlick Fresnel",
    "sphere lights",
    "quad lights",
    "sun lights",
    "light tree",
    "all lights at once",
    "single sampling of lights",
    "shadow rays through glass",
    "environment rotation",
    "hidden environment",
    "shapes",
    "distance fields",
    "depth of field",
    "panorama camera",
    "camera motion",
    "pixel filter",
    "Sobol sampler",
    "stratified sampler",
    "fog",
    "light path channels",
    "uv channel",
    "Cryptomatte",
    "nested media",
    "clamping",
    "path regularisation",
    "direction sampling",
    "shadow depth",
    "roulette rule",
    "culling",
    "coincident faces",
};
static_assert(!kNames.back().empty());

}  // namespace

std::string_view featureName(uint32_t bit) {
    return kNames.at(bit);
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
