#pragma once

// Part of the table in fields.h: the material parameters of a job and of TILEFARM_materials.

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

/// What lies over the base (clearcoat, sheen) or shapes its highlights.
template <typename Visitor>
void describeLayers(Visitor& v, auto& m) {
    v.number({"clearcoat", "strength of the clearcoat layer (KHR_materials_clearcoat)"}, m.clearcoat, kShare);
    v.number({"clearcoatRoughness", "perceptual roughness of the clearcoat, GGX"}, m.clearcoatRoughness,
             kShare);
    v.number({"clearcoatGloss", "Disney 2012: clearcoat with GTR1, α from 0.1 (gloss 0) to 0.001 (gloss 1)"},
             m.clearcoatGloss, kShare);
    v.triple({"sheenColor", "colour of the sheen layer (KHR_materials_sheen, Charlie), linear Rec. 709"},
             m.sheenColor, kShare);
    v.number({"sheenRoughness", "perceptual roughness of the sheen layer"}, m.sheenRoughness, kShare);
    v.number({"sheen", "Disney 2012: strength of the sheen lobe"}, m.sheen, kShare);
    v.number({"sheenTint", "Disney 2012: tints the sheen towards the hue of the base colour"}, m.sheenTint,
             kShare);
    v.number({"anisotropy", "strength of the specular anisotropy (KHR_materials_anisotropy)"}, m.anisotropy,
             kShare);
    v.number({"anisotropyRotation", "direction of the anisotropy, rad, counter-clockwise from the tangent"},
             m.anisotropyRotation, {-1000, 1000});
    v.number({"iridescence", "strength of the thin-film interference (KHR_materials_iridescence)"},
             m.iridescence, kShare);
    v.number({"iridescenceIor", "index of refraction of the thin film"}, m.iridescenceIor, kIorRange);
    v.number({"iridescenceThickness", "thickness of the thin film, nm"}, m.iridescenceThickness, {0, 1e6});
}

/// The members of a MaterialOverride except the name of its materials.
template <typename Visitor>
void describeAppearance(Visitor& v, auto& m) {
    v.triple({"baseColor", "base colour, linear Rec. 709"}, m.baseColor, kShare);
    v.triple({"emission", "emitted radiance, W/(sr m²)"}, m.emission, kLightAmount);
    v.number({"metallic", "0 dielectric, 1 metal"}, m.metallic, kShare);
    v.number({"roughness", "perceptual roughness: the microfacet α is its square"}, m.roughness, kShare);
    v.number({"ior", "index of refraction"}, m.ior, kIorRange);
    v.number({"transmission",
              "fraction of the light entering the surface that is refracted instead of scattered diffusely"},
             m.transmission, kShare);
    v.number({"thickness",
              "0: thin-walled; above 0: the mesh bounds a solid, whose thickness is that of the mesh itself"},
             m.thickness, {0, 1e9});
    v.triple({"attenuationColor", "transmittance of the volume over attenuationDistance"}, m.attenuationColor,
             kShare);
    v.number({"attenuationDistance",
              "distance in the volume after which its transmittance is attenuationColor, m"},
             m.attenuationDistance, {1e-9, 1e9});
    v.number({"specular", "scales the specular reflection of dielectrics (KHR_materials_specular)"},
             m.specular, kShare);
    v.triple({"specularColor", "multiplies F0 of dielectrics, linear Rec. 709 (KHR_materials_specular)"},
             m.specularColor, {0, 1000});
    v.number({"specularTint", "Disney 2012: tints F0 of dielectrics towards the hue of the base colour"},
             m.specularTint, kShare);
    describeLayers(v, m);
    v.number({"dispersion", "20 / Abbe number of the glass (KHR_materials_dispersion)"}, m.dispersion,
             {0, 100});
    v.number({"diffuseTransmission",
              "fraction of the diffusely scattered light that is transmitted "
              "(KHR_materials_diffuse_transmission)"},
             m.diffuseTransmission, kShare);
    v.triple({"diffuseTransmissionColor", "colour of the diffusely transmitted light, linear Rec. 709"},
             m.diffuseTransmissionColor, kShare);
    v.number(
        {"subsurface",
         "Disney 2012: blends the diffuse base with the flat (Hanrahan-Krueger) subsurface approximation"},
        m.subsurface, kShare);
    v.flag({"disneyDiffuse",
            "Disney 2012: diffuse base with roughness-dependent retro-reflection in place of Lambert"},
           m.disneyDiffuse);
    v.number({"orenNayarSigma",
              "Oren-Nayar roughness: standard deviation of the facets' slope angle, rad; 0 is Lambert"},
             m.orenNayarSigma, {0, std::numbers::pi / 2});
    v.word({"conductor", "metal with its measured complex index of refraction"}, m.conductor,
           kConductorNames);
    v.choice({"microfacets", "normal distribution function; settings.microfacets if not given"},
             m.microfacets, kMicrofacetChoices);
    v.choice({"fresnel", "Fresnel reflectance of dielectrics; settings.fresnel if not given"}, m.fresnel,
             kFresnelChoices);
}

template <typename Visitor>
void describe(Visitor& v, Is<MaterialOverride> auto& m) {
    v.text({"material", "name of the materials to change; * matches any characters", kRequired}, m.material,
           {1, 1024});
    describeAppearance(v, m);
}

}  // namespace tilefarm
