#include "worker/render/layer_packer.h"

namespace tilefarm {
namespace {

// Where a metallic texture may leave something that is not metal. It can only lower the factor.
bool hasDielectric(const Material& m) {
    return m.metallic < 1 || m.metallicRoughnessTexture;
}

bool hasDiffuse(const Material& m) {
    return hasDielectric(m) && (m.transmission < 1 || m.transmissionTexture);
}

bool hasDisneyDiffuse(const Material& m) {
    return m.disneyDiffuse || m.subsurface > 0;
}

}  // namespace

uint64_t layerFeatures(const Material& m) {
    uint64_t features = 0;
    if (m.clearcoat > 0) {
        features |= gpu::bit(gpu::FEATURE_CLEARCOAT);
        if (m.clearcoatGtr1) features |= gpu::bit(gpu::FEATURE_GTR1);
        if (m.clearcoatNormalTexture) features |= gpu::bit(gpu::FEATURE_NORMAL_MAPS);
    }
    if (m.sheenColor != glm::vec3(0)) features |= gpu::bit(gpu::FEATURE_SHEEN);
    if (m.disneySheen > 0 && hasDielectric(m)) features |= gpu::bit(gpu::FEATURE_DISNEY_SHEEN);
    if (!hasDiffuse(m)) return features;
    if (m.diffuseTransmission > 0) features |= gpu::bit(gpu::FEATURE_DIFFUSE_TRANSMISSION);
    if (hasDisneyDiffuse(m))
        features |= gpu::bit(gpu::FEATURE_DISNEY_DIFFUSE);
    else if (m.orenNayarSigma > 0)
        features |= gpu::bit(gpu::FEATURE_OREN_NAYAR);
    return features;
}

uint32_t layerFlags(const Material& m) {
    uint32_t flags = 0;
    if (m.clearcoatGtr1) flags |= gpu::MATERIAL_GTR1;
    if (hasDisneyDiffuse(m)) flags |= gpu::MATERIAL_DISNEY_DIFFUSE;
    return flags;
}

bool hasLayerTextures(const Material& m) {
    return (m.clearcoat > 0 && (m.clearcoatTexture || m.clearcoatRoughnessTexture)) ||
           (m.sheenColor != glm::vec3(0) && (m.sheenColorTexture || m.sheenRoughnessTexture)) ||
           (m.diffuseTransmission > 0 && (m.diffuseTransmissionTexture || m.diffuseTransmissionColorTexture));
}

void packLayers(const Material& m, gpu::MaterialRecord& record) {
    record.clearcoat = m.clearcoat;
    record.clearcoatRoughness = m.clearcoatRoughness;
    record.clearcoatNormalScale = m.clearcoatNormalScale;
    record.sheenColor = m.sheenColor;
    record.sheenRoughness = m.sheenRoughness;
    record.disneySheen = m.disneySheen;
    record.disneySheenTint = m.disneySheenTint;
    record.subsurface = m.subsurface;
    record.orenNayarSigma = m.orenNayarSigma;
    record.diffuseTransmission = m.diffuseTransmission;
    record.diffuseTransmissionColor = m.diffuseTransmissionColor;
}

}  // namespace tilefarm
