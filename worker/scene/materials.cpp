#include "worker/scene/materials.h"

#include <fmt/format.h>

#include "worker/scene/material_reader.h"
#include "worker/scene/vendor_extensions.h"

namespace tilefarm {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

void readMetallicRoughness(MaterialReader& reader, Material& m) {
    const JsonNode pbr = reader.node()["pbrMetallicRoughness"];
    const glm::vec4 color = reader.colorAndAlpha(pbr["baseColorFactor"]);
    m.baseColor = glm::vec3(color);
    m.alpha = color.w;
    m.baseColorTexture = reader.colorTexture(pbr["baseColorTexture"]);
    m.metallic = reader.factor(pbr["metallicFactor"], 1);
    m.roughness = reader.factor(pbr["roughnessFactor"], 1);
    m.metallicRoughnessTexture = reader.dataTexture(pbr["metallicRoughnessTexture"]);
}

void readNormal(MaterialReader& reader, Material& m) {
    const JsonNode normal = reader.node()["normalTexture"];
    m.normalTexture = reader.dataTexture(normal);
    m.normalScale = reader.clamped(normal["scale"], 1, -kLargest, kLargest);
}

void readEmission(MaterialReader& reader, Material& m) {
    const JsonNode strength = reader.extension("KHR_materials_emissive_strength")["emissiveStrength"];
    const float scale = reader.factor(strength, 1, kLargest);
    const glm::vec3 factor = reader.color(reader.node()["emissiveFactor"], glm::vec3(0));
    m.emission = glm::min(factor * scale, kLargest);
    if (m.emission != glm::vec3(0)) {
        m.emissionTexture = reader.colorTexture(reader.node()["emissiveTexture"]);
    }
}

void readAlpha(MaterialReader& reader, Material& m) {
    const JsonNode mode = reader.node()["alphaMode"];
    const std::string name = mode.textOr("OPAQUE");
    if (name == "MASK") {
        m.alphaMode = AlphaMode::mask;
    } else if (name == "BLEND") {
        m.alphaMode = AlphaMode::blend;
    } else if (name != "OPAQUE") {
        mode.fail(fmt::format("is \"{}\", must be OPAQUE, MASK or BLEND", name));
    }
    m.alphaCutoff = reader.factor(reader.node()["alphaCutoff"], 0.5, kLargest);
}

void warnOfOcclusion(MaterialReader& reader) {
    const JsonNode occlusion = reader.node()["occlusionTexture"];
    if (occlusion && occlusion["strength"].numberOr(1) != 0) {
        reader.warn("occlusionTexture", "light is occluded by the geometry itself");
    }
}

Material readMaterial(MaterialReader& reader, const GltfOptions& options) {
    const JsonNode& node = reader.node();
    Material m;
    m.microfacets = options.microfacets;
    m.fresnel = options.fresnel;
    m.name = node["name"].textOr("");
    readMaterialExtensions(reader, m);
    if (!readSpecularGlossiness(reader, m)) {
        readMetallicRoughness(reader, m);
    }
    readNormal(reader, m);
    readEmission(reader, m);
    readAlpha(reader, m);
    m.doubleSided = node["doubleSided"].booleanOr(false);
    m.unlit = static_cast<bool>(reader.extension("KHR_materials_unlit"));
    readVendorMaterial(reader.extension("TILEFARM_materials"), m);
    warnOfOcclusion(reader);
    reader.warnOfExtensions();
    return m;
}

}  // namespace

std::vector<Material> parseMaterials(LoadContext& load, Textures& textures, const GltfOptions& options) {
    const JsonNode nodes = load.file.root()["materials"];
    load.brokenMaterials.clear();
    std::vector<Material> materials;
    materials.reserve(nodes.size() + 1);
    for (size_t i = 0; i < nodes.size(); ++i) {
        Material& material = materials.emplace_back();
        const std::optional<Error> fault = readIfSound(nodes[i], [&] {
            MaterialReader reader(load, textures, nodes[i]);
            material = readMaterial(reader, options);
        });
        if (fault) load.brokenMaterials.emplace(static_cast<uint32_t>(i), *fault);
    }
    Material& last = materials.emplace_back();
    last.name = "default";
    last.microfacets = options.microfacets;
    last.fresnel = options.fresnel;
    return materials;
}

}  // namespace tilefarm
