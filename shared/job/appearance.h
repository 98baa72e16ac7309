#pragma once

#include <optional>
#include <string>

#include "shared/job/color.h"
#include "shared/job/facets.h"

namespace tilefarm {

/// What a job says of materials beyond their glTF file; what is not given stays as the file has it. The
/// members mean what those of Material (worker/scene/scene.h) do, and are what the vendor extension
/// TILEFARM_materials of a glTF material may hold.
struct MaterialOverride {
    std::string material;  // name of the materials; "*" stands for any run of characters
    std::optional<Color> baseColor, emission;
    std::optional<float> metallic, roughness, ior, transmission, thickness;
    std::optional<Color> attenuationColor;
    std::optional<float> attenuationDistance;  // m: Disney's extinction at a distance
    std::optional<float> specular;
    std::optional<Color> specularColor;
    std::optional<float> specularTint, clearcoat, clearcoatRoughness;
    std::optional<float> clearcoatGloss;  // Disney: GTR1 with α from 0.1 (gloss 0) to 0.001 (gloss 1)
    std::optional<Color> sheenColor;
    std::optional<float> sheenRoughness;
    std::optional<float> sheen, sheenTint;  // Disney's
    std::optional<float> anisotropy, anisotropyRotation;
    std::optional<float> iridescence, iridescenceIor, iridescenceThickness;  // thickness nm
    std::optional<float> dispersion;
    std::optional<float> diffuseTransmission;
    std::optional<Color> diffuseTransmissionColor;
    std::optional<float> subsurface;
    std::optional<bool> disneyDiffuse;
    std::optional<float> orenNayarSigma;   // rad
    std::optional<std::string> conductor;  // "gold", "silver", …: measured n and k
    std::optional<Microfacets> microfacets;
    std::optional<Fresnel> fresnel;
    friend bool operator==(const MaterialOverride&, const MaterialOverride&) = default;
};

}  // namespace tilefarm
