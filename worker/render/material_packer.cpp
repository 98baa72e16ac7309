#include "worker/render/material_packer.h"

#include <algorithm>
#include <cmath>

#include "gpu_material_host.h"
#include "worker/render/albedo_table.h"
#include "worker/render/interface_packer.h"
#include "worker/render/layer_packer.h"
#include "worker/render/layer_tables.h"
#include "worker/render/neutral_record.h"
#include "worker/render/table_cache.h"

namespace tilefarm {
namespace {

// exp(−kOpaque) is 0 in fp32, so a colour of zero transmits exactly nothing at its distance.
constexpr double kOpaque = 120;

uint32_t flagsOf(const Material& m) {
    uint32_t flags = 0;
    if (m.doubleSided) flags |= gpu::MATERIAL_DOUBLE_SIDED;
    if (m.unlit) flags |= gpu::MATERIAL_UNLIT;
    if (m.alphaMode == AlphaMode::mask) flags |= gpu::MATERIAL_MASK;
    if (m.alphaMode == AlphaMode::blend) flags |= gpu::MATERIAL_BLEND;
    if (m.thickness == 0) flags |= gpu::MATERIAL_THIN;
    if (m.emission != glm::vec3(0)) flags |= gpu::MATERIAL_EMISSIVE;
    return flags | layerFlags(m);
}

uint64_t lobesOf(const Material& m, const RenderSettings& settings) {
    uint64_t features = interfaceFeatures(m, settings);
    if ((m.transmission > 0 || m.diffuseTransmission > 0) && m.thickness > 0 &&
        absorptionCoefficient(m.attenuationColor, m.attenuationDistance) != glm::vec3(0))
        features |= gpu::bit(gpu::FEATURE_ATTENUATION);
    return features | layerFeatures(m) | parameterFeatures(m);
}

uint64_t featuresOf(const Material& m, const RenderSettings& settings) {
    uint64_t features = m.unlit ? gpu::bit(gpu::FEATURE_UNLIT) : lobesOf(m, settings);
    if (!m.unlit && hasLayerTextures(m)) features |= gpu::bit(gpu::FEATURE_TEXTURES);
    if (m.normalTexture && !m.unlit) features |= gpu::bit(gpu::FEATURE_NORMAL_MAPS);
    if (m.alphaMode != AlphaMode::opaque) features |= gpu::bit(gpu::FEATURE_CUTOUT);
    return features;
}

/// Whether the record reads any texture but a normal map.
bool readsTextures(const gpu::MaterialRecord& r) {
    for (const uint32_t texture : {r.baseColorTexture, r.metallicRoughnessTexture, r.emissionTexture,
                                   r.transmissionTexture, r.specularTexture, r.specularColorTexture,
                                   r.anisotropyTexture, r.iridescenceTexture, r.iridescenceThicknessTexture})
        if (texture != gpu::NO_INDEX) return true;
    return false;
}

}  // namespace

glm::vec3 absorptionCoefficient(const glm::vec3& color, float distance) {
    if (!(distance > 0) || std::isinf(distance)) return glm::vec3(0);
    glm::vec3 sigma;
    for (int c = 0; c < 3; ++c)
        sigma[c] = static_cast<float>(std::clamp(-std::log(double{color[c]}), 0.0, kOpaque) / distance);
    return sigma;
}

uint32_t MaterialPacker::tablesFor(const Material& material) {
    const InterfaceKind kind = interfaceKind(material, settings_);
    const float dispersion = kind.solid ? material.dispersion : 0;
    const auto [at, isNew] = tableOfInterface_.try_emplace({kind, dispersion}, 0);
    if (isNew && dispersion > 0) {
        at->second = addTable(dispersedTables(kind, dispersion)) + kDispersedTablesBeforeNamed;
    } else if (isNew) {
        at->second = addTable(interfaceTables(kind));
    }
    return at->second;
}

uint32_t MaterialPacker::addTable(const std::vector<glm::vec4>& table) {
    constexpr size_t kTexels = gpu::ALBEDO_TABLE_SIZE * (gpu::ALBEDO_TABLE_SIZE + 1);
    const auto index = static_cast<uint32_t>(albedoTables.size() / kTexels);
    albedoTables.insert(albedoTables.end(), table.begin(), table.end());
    return index;
}

void MaterialPacker::bindLayerTables(gpu::MaterialRecord& record, const Material& m) {
    if (m.clearcoat > 0 && m.clearcoatGtr1) {
        if (!gtr1Table_) gtr1Table_ = addTable(tableOnce("gtr1", buildGtr1Table));
        record.coatTable = *gtr1Table_;
    } else if (m.clearcoat > 0) {
        if (!coatTable_) coatTable_ = addTable(tableOnce("coat", [] { return buildAlbedoTable(1.5); }));
        record.coatTable = *coatTable_;
    }
    if (m.sheenColor != glm::vec3(0)) {
        if (!sheenTable_) sheenTable_ = addTable(tableOnce("sheen", buildSheenTable));
        record.sheenTable = *sheenTable_;
    }
}

void MaterialPacker::bindTextures(gpu::MaterialRecord& record, const Material& m) {
    record.baseColorTexture = textures_.add(m.baseColorTexture);
    if (m.unlit) return;
    record.metallicRoughnessTexture = textures_.add(m.metallicRoughnessTexture);
    record.normalTexture = textures_.add(m.normalTexture);
    if (m.emission != glm::vec3(0)) record.emissionTexture = textures_.add(m.emissionTexture);
    bindLayerTextures(m, record, [&](const TextureRef& t) { return textures_.add(t); });
}

gpu::MaterialRecord MaterialPacker::pack(const Material& m) {
    gpu::MaterialRecord record{};
    packParameters(m, record);
    record.flags = flagsOf(m);
    packInterface(record, m, settings_);
    record.albedoTable = gpu::NO_INDEX;
    record.absorption =
        m.thickness > 0 ? absorptionCoefficient(m.attenuationColor, m.attenuationDistance) : glm::vec3(0);
    return record;
}

void MaterialPacker::add(const Material& material, bool used) {
    gpu::MaterialRecord record = pack(material);
    if (used) {
        const uint64_t called = featuresOf(material, settings_);
        if ((called & gpu::bit(gpu::FEATURE_SPECULAR)) != 0) record.albedoTable = tablesFor(material);
        if (!material.unlit) bindLayerTables(record, material);
        bindTextures(record, material);
        bindInterfaceTextures(record, material, called, textures_);
        neutralise(record, called);
        features |= called | (readsTextures(record) ? gpu::bit(gpu::FEATURE_TEXTURES) : 0);
    }
    records.push_back(record);
}

}  // namespace tilefarm
