#include "worker/render/layer_packer.h"

#include "worker/render/material_needs.h"

namespace tilefarm {

uint64_t layerFeatures(const Material& m) {
    uint64_t features = 0;
    if (m.clearcoat > 0) {
        if (m.clearcoatGtr1) features |= gpu::bit(gpu::FEATURE_GTR1);
        if (m.clearcoatNormalTexture) features |= gpu::bit(gpu::FEATURE_NORMAL_MAPS);
    }
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

}  // namespace tilefarm
