#pragma once

#include <map>
#include <optional>
#include <vector>

#include "shaders/gpu_types.h"
#include "worker/render/texture_packer.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// Turns materials into the records that shaders/material.glsl reads.
class MaterialPacker {
public:
    explicit MaterialPacker(TexturePacker& textures) : textures_(textures) {}

    /// `used`: some triangle has the material; only then do its effects and textures count.
    void add(const Material& material, bool used);

    std::vector<gpu::MaterialRecord> records;
    std::vector<glm::vec4> albedoTables;  // one table per index of refraction, and those of the layers
    uint64_t features = 0;                // FEATURE_* that the used materials call for

private:
    uint32_t albedoTableFor(float ior);
    uint32_t addTable(const std::vector<glm::vec4>& table);
    void bindLayerTables(gpu::MaterialRecord& record, const Material& material);
    gpu::MaterialRecord pack(const Material& material);
    void bindTextures(gpu::MaterialRecord& record, const Material& material);

    TexturePacker& textures_;
    std::map<float, uint32_t> tableOfIor_;
    std::optional<uint32_t> gtr1Table_, sheenTable_;
};

/// σ_a = −ln(colour) / distance per channel, 1/m: zero for an infinite distance; a colour of zero
/// absorbs everything within the distance without becoming infinite.
glm::vec3 absorptionCoefficient(const glm::vec3& color, float distance);

}  // namespace tilefarm
