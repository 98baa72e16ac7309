#include <algorithm>
#include <string_view>
#include <utility>

#include "worker/scene/animations.h"

// The properties of the glTF object model that the loader reads and that may change over time. A '*' stands
// for an index or for the name of a texture; the widths are those of the object model.
namespace tilefarm {
namespace {

struct Movable {
    std::string_view pattern;
    AnimationTarget target;
};

constexpr AnimationTarget kNumber{1}, kPair{2}, kTriple{3}, kQuadruple{4};

constexpr Movable kMovable[] = {
    {"/nodes/*/translation", kTriple},
    {"/nodes/*/rotation", {4, true}},
    {"/nodes/*/scale", kTriple},
    {"/nodes/*/weights", {0}},
    {"/nodes/*/extensions/KHR_node_visibility/visible", {1, false, true}},
    {"/meshes/*/weights", {0}},
    {"/cameras/*/perspective/yfov", kNumber},
    {"/cameras/*/orthographic/xmag", kNumber},
    {"/cameras/*/orthographic/ymag", kNumber},
    {"/extensions/KHR_lights_punctual/lights/*/color", kTriple},
    {"/extensions/KHR_lights_punctual/lights/*/intensity", kNumber},
    {"/extensions/KHR_lights_punctual/lights/*/range", kNumber},
    {"/extensions/KHR_lights_punctual/lights/*/spot/innerConeAngle", kNumber},
    {"/extensions/KHR_lights_punctual/lights/*/spot/outerConeAngle", kNumber},
    {"/materials/*/pbrMetallicRoughness/baseColorFactor", kQuadruple},
    {"/materials/*/pbrMetallicRoughness/metallicFactor", kNumber},
    {"/materials/*/pbrMetallicRoughness/roughnessFactor", kNumber},
    {"/materials/*/emissiveFactor", kTriple},
    {"/materials/*/alphaCutoff", kNumber},
    {"/materials/*/normalTexture/scale", kNumber},
    {"/materials/*/extensions/KHR_materials_emissive_strength/emissiveStrength", kNumber},
    {"/materials/*/extensions/KHR_materials_ior/ior", kNumber},
    {"/materials/*/extensions/KHR_materials_transmission/transmissionFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_volume/thicknessFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_volume/attenuationDistance", kNumber},
    {"/materials/*/extensions/KHR_materials_volume/attenuationColor", kTriple},
    {"/materials/*/extensions/KHR_materials_specular/specularFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_specular/specularColorFactor", kTriple},
    {"/materials/*/extensions/KHR_materials_clearcoat/clearcoatFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale", kNumber},
    {"/materials/*/extensions/KHR_materials_sheen/sheenColorFactor", kTriple},
    {"/materials/*/extensions/KHR_materials_sheen/sheenRoughnessFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_anisotropy/anisotropyStrength", kNumber},
    {"/materials/*/extensions/KHR_materials_anisotropy/anisotropyRotation", kNumber},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceIor", kNumber},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", kNumber},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", kNumber},
    {"/materials/*/extensions/KHR_materials_dispersion/dispersion", kNumber},
    {"/materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", kNumber},
    {"/materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", kTriple},
    // Of any texture of a material, at any depth.
    {"/materials/**/extensions/KHR_texture_transform/offset", kPair},
    {"/materials/**/extensions/KHR_texture_transform/scale", kPair},
    {"/materials/**/extensions/KHR_texture_transform/rotation", kNumber},
};

/// '*' matches within one name, "**" across several.
bool matches(std::string_view pattern, std::string_view text) {
    if (pattern.empty()) {
        return text.empty();
    }
    if (!pattern.starts_with('*')) {
        return !text.empty() && text[0] == pattern[0] && matches(pattern.substr(1), text.substr(1));
    }
    const bool across = pattern.starts_with("**");
    const std::string_view rest = pattern.substr(across ? 2 : 1);
    const size_t most = across ? text.size() : std::min(text.find('/'), text.size());
    for (size_t length = 1; length <= most; ++length) {
        if (matches(rest, text.substr(length))) {
            return true;
        }
    }
    return false;
}

}  // namespace

std::optional<AnimationTarget> animationTarget(const std::string& pointer) {
    for (const Movable& movable : kMovable) {
        if (matches(movable.pattern, pointer)) {
            return movable.target;
        }
    }
    return std::nullopt;
}

}  // namespace tilefarm
