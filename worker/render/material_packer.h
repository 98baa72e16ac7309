#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "shaders/gpu_types.h"
#include "shared/job/render_settings.h"
#include "worker/render/albedo_table.h"
#include "worker/render/texture_packer.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// Turns materials into the records that shaders/material.glsl reads.
class MaterialPacker {
public:
    /// Materials without a distribution or Fresnel term of their own take those of `settings`.
    explicit MaterialPacker(TexturePacker& textures, const RenderSettings& settings = {})
        : textures_(textures), settings_(settings) {}

    /// `used`: some triangle has the material; only then do its effects and textures count.
    void add(const Material& material, bool used);

    std::vector<gpu::MaterialRecord> records;
    std::vector<glm::vec4> albedoTables;  // one after another: those of InterfaceKinds, and those of the layers
    uint64_t features = 0;                // FEATURE_* that the used materials call for

private:
    uint32_t tablesFor(const Material& material);
    uint32_t addTable(const std::vector<glm::vec4>& table);
    void bindLayerTables(gpu::MaterialRecord& record, const Material& material);
    gpu::MaterialRecord pack(const Material& material);
    void bindTextures(gpu::MaterialRecord& record, const Material& material);

    TexturePacker& textures_;
    RenderSettings settings_;
    std::map<std::pair<InterfaceKind, float>, uint32_t> tableOfInterface_;  // by dispersion, too
    std::optional<uint32_t> coatTable_, gtr1Table_, sheenTable_;
};

/// σ_a = −ln(colour) / distance per channel, 1/m: zero for an infinite distance; a colour of zero
/// absorbs everything within the distance without becoming infinite.
glm::vec3 absorptionCoefficient(const glm::vec3& color, float distance);

}  // namespace tilefarm
