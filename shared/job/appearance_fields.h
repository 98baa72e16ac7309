#pragma once

// Part of the table in fields.h: what a job or a glTF material may say of a material.

#include <numbers>

#include "shared/job/appearance.h"
#include "shared/job/conductor_names.h"
#include "shared/job/json_reader.h"

namespace tilefarm {

inline constexpr NumberRange kShare{0, 1};
inline constexpr NumberRange kLightAmount{0, 1e18};  // its squares and sums still fit a float
inline constexpr NumberRange kIorRange{1, 1000};

inline constexpr std::array kMicrofacetChoices{
    Choice<Microfacets>{"ggx", Microfacets::ggx},
    Choice<Microfacets>{"beckmann", Microfacets::beckmann},
    Choice<Microfacets>{"phong", Microfacets::phong},
};
inline constexpr std::array kFresnelChoices{
    Choice<Fresnel>{"exact", Fresnel::exact},
    Choice<Fresnel>{"schlick", Fresnel::schlick},
};

/// The members of a MaterialOverride but for the name of its materials.
template <typename Visitor>
void describeAppearance(Visitor& v, auto& m) {
    v.triple({"baseColor", "linear Rec. 709"}, m.baseColor, kShare);
    v.triple({"emission", "radiance, W/(sr m²)"}, m.emission, kLightAmount);
    v.number({"metallic", ""}, m.metallic, kShare);
    v.number({"roughness", "perceptual: α is its square"}, m.roughness, kShare);
    v.number({"ior", "index of refraction"}, m.ior, kIorRange);
    v.number({"transmission", "share of light that is refracted instead of scattered diffusely"},
             m.transmission, kShare);
    v.number({"thickness", "m; 0 is thin-walled, anything else a solid of the mesh's own thickness"},
             m.thickness, {0, 1e9});
    v.triple({"attenuationColor", "what is left of white light at attenuationDistance"}, m.attenuationColor,
             kShare);
    v.number({"attenuationDistance", "m"}, m.attenuationDistance, {1e-9, 1e9});
    v.number({"specular", "scales the dielectric's reflection"}, m.specular, kShare);
    v.triple({"specularColor", "multiplies the dielectric's F0"}, m.specularColor, {0, 1000});
    v.number({"specularTint", "Disney: pulls specularColor to the base colour's hue"}, m.specularTint,
             kShare);
    v.number({"clearcoat", ""}, m.clearcoat, kShare);
    v.number({"clearcoatRoughness", "perceptual; GGX"}, m.clearcoatRoughness, kShare);
    v.number({"clearcoatGloss", "Disney: GTR1 with α from 0.1 (0) to 0.001 (1)"}, m.clearcoatGloss, kShare);
    v.triple({"sheenColor", "Charlie sheen of glTF"}, m.sheenColor, kShare);
    v.number({"sheenRoughness", "perceptual"}, m.sheenRoughness, kShare);
    v.number({"sheen", "Disney's"}, m.sheen, kShare);
    v.number({"sheenTint", "Disney: pulls the sheen to the base colour's hue"}, m.sheenTint, kShare);
    v.number({"anisotropy", "strength"}, m.anisotropy, kShare);
    v.number({"anisotropyRotation", "rad, counter-clockwise from the tangent"}, m.anisotropyRotation,
             {-1000, 1000});
    v.number({"iridescence", ""}, m.iridescence, kShare);
    v.number({"iridescenceIor", "of the film"}, m.iridescenceIor, kIorRange);
    v.number({"iridescenceThickness", "nm"}, m.iridescenceThickness, {0, 1e6});
    v.number({"dispersion", "20 / Abbe number"}, m.dispersion, {0, 100});
    v.number({"diffuseTransmission", "share of diffuse light that goes through"}, m.diffuseTransmission,
             kShare);
    v.triple({"diffuseTransmissionColor", ""}, m.diffuseTransmissionColor, kShare);
    v.number({"subsurface", "Disney 2012: mixes in the flat subsurface approximation"}, m.subsurface, kShare);
    v.flag({"disneyDiffuse", "Disney 2012: diffuse base with retro-reflection"}, m.disneyDiffuse);
    v.number({"orenNayarSigma", "rad, spread of the facets' slope; 0 is Lambert"}, m.orenNayarSigma,
             {0, std::numbers::pi / 2});
    v.word({"conductor", "metal with measured index of refraction"}, m.conductor, kConductorNames);
    v.choice({"microfacets", "distribution of normals"}, m.microfacets, kMicrofacetChoices);
    v.choice({"fresnel", "of dielectrics"}, m.fresnel, kFresnelChoices);
}

template <typename Visitor>
void describe(Visitor& v, Is<MaterialOverride> auto& m) {
    v.text({"material", "name of the materials; * stands for any run of characters", kRequired}, m.material,
           {1, 1024});
    describeAppearance(v, m);
}

}  // namespace tilefarm
