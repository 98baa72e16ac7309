#include "worker/scene/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "worker/scene/extensions.h"

namespace tilefarm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

/// Reads one material; the members follow the sections of the specification.
class MaterialParser {
public:
    MaterialParser(LoadContext& load, Textures& textures, const JsonNode& node)
        : load_(load), textures_(textures), node_(node), extensions_(node["extensions"]) {}

    Material parse() {
        material_.name = node_["name"].textOr("");
        parseMetallicRoughness();
        parseSpecularGlossiness();
        parseNormal();
        parseEmission();
        parseAlpha();
        parseTransmission();
        material_.doubleSided = node_["doubleSided"].booleanOr(false);
        material_.unlit = static_cast<bool>(extensions_["KHR_materials_unlit"]);
        warnOfNotRendered(load_, node_);
        return std::move(material_);
    }

private:
    float clamped(const JsonNode& value, double given, double lower, double upper) {
        const double result = std::clamp(given, lower, upper);
        if (result != given) {
            load_.warn(value.place().substr(value.place().rfind('/') + 1), node_,
                       fmt::format("{} is out of range, rendered with {}", given, result));
        }
        return static_cast<float>(result);
    }

    float factor(const JsonNode& value, double fallback, double upper = 1) {
        return clamped(value, value.numberOr(fallback), 0, upper);
    }

    glm::vec3 color(const JsonNode& value, glm::vec3 fallback) {
        if (!value) {
            return fallback;
        }
        const std::vector<double> v = value.numbers(3);
        return {clamped(value, v[0], 0, 1), clamped(value, v[1], 0, 1), clamped(value, v[2], 0, 1)};
    }

    void parseBaseColor(const JsonNode& value) {
        if (!value) {
            return;
        }
        const std::vector<double> v = value.numbers(4);
        material_.baseColor = {clamped(value, v[0], 0, 1), clamped(value, v[1], 0, 1),
                               clamped(value, v[2], 0, 1)};
        material_.alpha = clamped(value, v[3], 0, 1);
    }

    void parseMetallicRoughness() {
        const JsonNode pbr = node_["pbrMetallicRoughness"];
        parseBaseColor(pbr["baseColorFactor"]);
        material_.baseColorTexture = textures_.parse(pbr["baseColorTexture"], true);
        material_.metallic = factor(pbr["metallicFactor"], 1);
        material_.roughness = factor(pbr["roughnessFactor"], 1);
        material_.metallicRoughnessTexture = textures_.parse(pbr["metallicRoughnessTexture"], false);
    }

    /// Close enough for the dielectrics that this archived extension mostly describes; warned of.
    void parseSpecularGlossiness() {
        const JsonNode pbr = extensions_["KHR_materials_pbrSpecularGlossiness"];
        if (!pbr || node_["pbrMetallicRoughness"]) {
            return;
        }
        parseBaseColor(pbr["diffuseFactor"]);
        material_.baseColorTexture = textures_.parse(pbr["diffuseTexture"], true);
        material_.metallic = 0;
        material_.roughness = 1 - factor(pbr["glossinessFactor"], 1);
    }

    void parseNormal() {
        const JsonNode normal = node_["normalTexture"];
        material_.normalTexture = textures_.parse(normal, false);
        const JsonNode scale = normal["scale"];
        material_.normalScale = clamped(scale, scale.numberOr(1), -kLargest, kLargest);
    }

    void parseEmission() {
        const JsonNode strength = extensions_["KHR_materials_emissive_strength"]["emissiveStrength"];
        const float scale = factor(strength, 1, kLargest);
        const JsonNode emissive = node_["emissiveFactor"];
        material_.emission = glm::min(color(emissive, glm::vec3(0)) * scale, kLargest);
        if (material_.emission != glm::vec3(0)) {
            material_.emissionTexture = textures_.parse(node_["emissiveTexture"], true);
        }
    }

    void parseAlpha() {
        const JsonNode mode = node_["alphaMode"];
        const std::string name = mode.textOr("OPAQUE");
        if (name == "MASK") {
            material_.alphaMode = AlphaMode::mask;
        } else if (name == "BLEND") {
            material_.alphaMode = AlphaMode::blend;
        } else if (name != "OPAQUE") {
            mode.fail(fmt::format("is \"{}\", must be OPAQUE, MASK or BLEND", name));
        }
        material_.alphaCutoff = factor(node_["alphaCutoff"], 0.5, kLargest);
    }

    void parseTransmission() {
        const JsonNode transmission = extensions_["KHR_materials_transmission"];
        material_.transmission = factor(transmission["transmissionFactor"], 0);
        if (material_.transmission > 0) {
            material_.transmissionTexture = textures_.parse(transmission["transmissionTexture"], false);
        }
        const JsonNode ior = extensions_["KHR_materials_ior"]["ior"];
        // 0 stands for "reflect as if it were infinite", which only helps converted specular-glossiness.
        if (ior && ior.number() == 0) {
            load_.warn("KHR_materials_ior", node_, "an index of refraction of 0 is rendered as 1.5");
        } else {
            material_.ior = clamped(ior, ior.numberOr(1.5), 1, 1000);
        }
        const JsonNode volume = extensions_["KHR_materials_volume"];
        material_.thickness = factor(volume["thicknessFactor"], 0, kLargest);
        material_.attenuationColor = color(volume["attenuationColor"], glm::vec3(1));
        const JsonNode distance = volume["attenuationDistance"];
        const double value = distance.numberOr(kInfinity);
        if (!(value > 0)) {
            distance.fail(fmt::format("must be greater than 0, is {}", value));
        }
        // A distance that a float rounds to 0 would divide by it.
        material_.attenuationDistance =
            std::max(static_cast<float>(value), std::numeric_limits<float>::min());
    }

    LoadContext& load_;
    Textures& textures_;
    JsonNode node_, extensions_;
    Material material_;
};

}  // namespace

std::vector<Material> parseMaterials(LoadContext& load, Textures& textures) {
    const JsonNode nodes = load.file.root()["materials"];
    std::vector<Material> materials;
    materials.reserve(nodes.size() + 1);
    for (size_t i = 0; i < nodes.size(); ++i) {
        materials.push_back(MaterialParser(load, textures, nodes[i]).parse());
    }
    materials.emplace_back();
    materials.back().name = "default";
    return materials;
}

}  // namespace tilefarm
