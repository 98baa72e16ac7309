#pragma once

#include "worker/scene/extensions.h"
#include "worker/scene/textures.h"

namespace tilefarm {

/// Reads the members of one glTF material: factors in their range, textures, warnings that name the
/// material.
class MaterialReader {
public:
    MaterialReader(LoadContext& load, Textures& textures, const JsonNode& node)
        : load_(load), textures_(textures), node_(node) {}

    const JsonNode& node() const { return node_; }
    JsonNode extension(const char* name) const { return node_["extensions"][name]; }
    Textures& textures() { return textures_; }

    /// A member within its range; one outside is clamped with a warning.
    float clamped(const JsonNode& value, double fallback, double lower, double upper);
    float factor(const JsonNode& value, double fallback, double upper = 1) {
        return clamped(value, fallback, 0, upper);
    }
    /// Three numbers, each within 0 … upper.
    glm::vec3 color(const JsonNode& value, glm::vec3 fallback, double upper = 1);
    /// Red, green, blue and alpha, each within 0 … 1.
    glm::vec4 colorAndAlpha(const JsonNode& value);
    TextureRef colorTexture(const JsonNode& info) { return textures_.parse(info, true); }
    TextureRef dataTexture(const JsonNode& info) { return textures_.parse(info, false); }
    void warn(const std::string& feature, const std::string& instead) { load_.warn(feature, node_, instead); }
    /// Of what is known and not rendered.
    void warnOfExtensions() { warnOfNotRendered(load_, node_); }

private:
    float clampedValue(const JsonNode& value, double given, double lower, double upper);

    LoadContext& load_;
    Textures& textures_;
    JsonNode node_;
};

/// KHR_materials_ ior, specular, clearcoat, sheen, anisotropy, iridescence, dispersion,
/// diffuse_transmission, transmission and volume.
void readMaterialExtensions(MaterialReader& reader, Material& material);

/// KHR_materials_pbrSpecularGlossiness, which replaces metallic-roughness where a material has both.
/// False if it has none.
bool readSpecularGlossiness(MaterialReader& reader, Material& material);

}  // namespace tilefarm
