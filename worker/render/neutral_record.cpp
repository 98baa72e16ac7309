#include "worker/render/neutral_record.h"

namespace tilefarm {
namespace {

// Interface (shaders/bsdf/interface.glsl) and its facets.
void neutraliseInterface(gpu::MaterialRecord& record, auto lacks) {
    // The index stays without one: light in solids that only scatter diffusely goes by it.
    if (!lacks(gpu::FEATURE_SPECULAR)) record.flags |= gpu::MATERIAL_INTERFACE;
    if (lacks(gpu::FEATURE_TRANSMISSION)) record.transmission = 0;
    if (lacks(gpu::FEATURE_DISPERSION)) record.dispersion = 0;
    if (lacks(gpu::FEATURE_GLASS_SHADOWS)) record.flags &= ~gpu::MATERIAL_PANE;
    if (lacks(gpu::FEATURE_ATTENUATION)) record.absorption = gpu::vec3(0);
    if (lacks(gpu::FEATURE_SPECULAR_COLOR)) {
        record.specular = 1;
        record.specularColor = gpu::vec3(1);
        record.specularTint = 0;
        if (record.ior == 0) record.ior = 1.5f;  // of metals: 0 is read by that feature alone
    }
    if (lacks(gpu::FEATURE_ANISOTROPY)) record.anisotropy = 0;
    if (lacks(gpu::FEATURE_IRIDESCENCE)) record.iridescence = 0;
    if (lacks(gpu::FEATURE_CONDUCTOR)) record.flags &= ~gpu::MATERIAL_CONDUCTOR;
    if (lacks(gpu::FEATURE_SCHLICK)) record.flags &= ~gpu::MATERIAL_SCHLICK;
    if (lacks(gpu::FEATURE_BECKMANN)) record.flags &= ~gpu::MATERIAL_BECKMANN;
    if (lacks(gpu::FEATURE_PHONG)) record.flags &= ~gpu::MATERIAL_PHONG;
}

// Layers and diffuse base (shaders/material_layers.glsl).
void neutraliseLayers(gpu::MaterialRecord& record, auto lacks) {
    if (lacks(gpu::FEATURE_CLEARCOAT)) record.clearcoat = 0;
    if (lacks(gpu::FEATURE_GTR1)) record.flags &= ~gpu::MATERIAL_GTR1;
    if (lacks(gpu::FEATURE_SHEEN)) record.sheenColor = gpu::vec3(0);
    if (lacks(gpu::FEATURE_DISNEY_SHEEN)) record.disneySheen = 0;
    if (lacks(gpu::FEATURE_DIFFUSE_TRANSMISSION)) record.diffuseTransmission = 0;
    if (lacks(gpu::FEATURE_OREN_NAYAR)) record.orenNayarSigma = 0;
    if (lacks(gpu::FEATURE_DISNEY_DIFFUSE)) {
        record.flags &= ~gpu::MATERIAL_DISNEY_DIFFUSE;
        record.subsurface = 0;
    }
}

}  // namespace

void neutralise(gpu::MaterialRecord& record, uint64_t called) {
    const auto lacks = [called](uint32_t feature) { return (called & gpu::bit(feature)) == 0; };
    neutraliseInterface(record, lacks);
    neutraliseLayers(record, lacks);
}

}  // namespace tilefarm
