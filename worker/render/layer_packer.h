#pragma once

#include <cstdint>

#include "shaders/gpu_types.h"
#include "worker/scene/scene.h"

/// The part of a material record that shaders/material_layers.glsl reads: clearcoat, sheen, and what the
/// diffuse base may be besides Lambert's.
namespace tilefarm {

/// FEATURE_* that these lobes call for beyond parameterFeatures (gpu_material_host.h); the material is lit.
uint64_t layerFeatures(const Material& material);

/// MATERIAL_* of these lobes.
uint32_t layerFlags(const Material& material);

/// Whether one of their textures is read.
bool hasLayerTextures(const Material& material);

/// `add` gives the index of a texture, or NO_INDEX for none.
template <typename Add>
void bindLayerTextures(const Material& m, gpu::MaterialRecord& record, Add add) {
    if (m.clearcoat > 0) {
        record.clearcoatTexture = add(m.clearcoatTexture);
        record.clearcoatRoughnessTexture = add(m.clearcoatRoughnessTexture);
        record.clearcoatNormalTexture = add(m.clearcoatNormalTexture);
    }
    if (m.sheenColor != glm::vec3(0)) {
        record.sheenColorTexture = add(m.sheenColorTexture);
        record.sheenRoughnessTexture = add(m.sheenRoughnessTexture);
    }
    if (m.diffuseTransmission > 0) {
        record.diffuseTransmissionTexture = add(m.diffuseTransmissionTexture);
        record.diffuseTransmissionColorTexture = add(m.diffuseTransmissionColorTexture);
    }
}

}  // namespace tilefarm
