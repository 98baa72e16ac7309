"""The parameters of a material, in the order of a job's members. generate.py makes of each row its member of Material
(worker/scene/scene.h), its member of a job's MaterialOverride with JSON, schema and command lines, what applies that,
its place in MaterialRecord with the reader of GLSL, and what packs it."""

from collections import namedtuple

Parameter = namedtuple("Parameter", "name type default meaning range job note feature needed point",
                       defaults=(None, None, None, None, None, None))
Parameter.__doc__ = """
name     of the member of Material, and of MaterialRecord if TEXELS has it
type     float, color, bool, texture, an enumeration of shared/job/facets.h, or, of jobs alone, word
default  what glTF says of a material without it; without effect where there is a feature. None: not of Material
meaning  the help text of a job's member; without a range a comment
range    of a job's member, or the constant of shared/job/appearance_fields.h that has it; None: no member of jobs
job      the job's name for it, if that is another. A tuple: the members of Material that it sets; () is set by hand
note     what scene.h adds to the meaning
feature  reads it: without, the record has the default
needed   a condition in C++ on the material `m`, beside a value other than the default, under which the feature is
         compiled in. None: another row or worker/render/interface_packer.cpp says when
point    MaterialPoint has it as the record does, read under the feature: "base", or "outside" if not within a solid"""

ALWAYS = "true"


def texture(name, channels, **columns):
    return Parameter(name, "texture", "", channels, **columns)


PARAMETERS = [
    Parameter("baseColor", "color", 1, "base colour, linear Rec. 709", "kShare"),
    Parameter("alpha", "float", 1, "of the base colour"),
    texture("baseColorTexture", "rgb, sRGB; a"),
    Parameter("emission", "color", 0, "emitted radiance, W/(sr m²)", "kLightAmount",
              note="emissiveFactor times emissive strength, up to the scene's scale"),
    texture("emissionTexture", "rgb, sRGB"),
    Parameter("alphaCutoff", "float", 0.5, "of AlphaMode::mask"),
    Parameter("metallic", "float", 1, "0 dielectric, 1 metal", "kShare"),
    Parameter("roughness", "float", 1, "perceptual roughness: the microfacet α is its square", "kShare"),
    texture("metallicRoughnessTexture", "g: roughness, b: metallic"),
    texture("normalTexture", "rgb"),
    Parameter("normalScale", "float", 1, "of normalTexture"),
    Parameter("ior", "float", 1.5, "index of refraction", "kIorRange",
              note="0 stands for F0 = 1, as converted specular-glossiness has it"),
    Parameter("transmission", "float", 0,
              "fraction of the light entering the surface that is refracted instead of scattered diffusely", "kShare",
              note="KHR_materials_transmission", feature="TRANSMISSION", needed=ALWAYS),
    texture("transmissionTexture", "r"),
    Parameter("thickness", "float", 0,
              "0: thin-walled; above 0: the mesh bounds a solid, whose thickness is that of the mesh itself", (0, "1e9"),
              note="KHR_materials_volume"),
    Parameter("attenuationColor", "color", 1, "transmittance of the volume over attenuationDistance", "kShare"),
    Parameter("attenuationDistance", "float", "infinity",
              "distance in the volume after which its transmittance is attenuationColor, m", ("1e-9", "1e9")),

    Parameter("specular", "float", 1, "scales the specular reflection of dielectrics (KHR_materials_specular)", "kShare",
              note="F0 is min(F0(ior) * specularColor, 1) * specular, F90 is specular", feature="SPECULAR_COLOR"),
    texture("specularTexture", "a"),
    Parameter("specularColor", "color", 1, "multiplies F0 of dielectrics, linear Rec. 709 (KHR_materials_specular)",
              (0, 1000), feature="SPECULAR_COLOR"),
    texture("specularColorTexture", "rgb, sRGB"),
    Parameter("specularTint", "float", 0, "Disney 2012: tints F0 of dielectrics towards the hue of the base colour",
              "kShare", feature="SPECULAR_COLOR"),

    Parameter("clearcoat", "float", 0, "strength of the clearcoat layer (KHR_materials_clearcoat)", "kShare",
              feature="CLEARCOAT", needed=ALWAYS),
    texture("clearcoatTexture", "r"),
    Parameter("clearcoatRoughness", "float", 0, "perceptual roughness of the clearcoat, GGX", "kShare"),
    texture("clearcoatRoughnessTexture", "g"),
    texture("clearcoatNormalTexture", "rgb"),
    Parameter("clearcoatNormalScale", "float", 1, "of clearcoatNormalTexture"),
    Parameter("clearcoatGtr1", "bool", False, "Disney's distribution GTR1 with α = clearcoatRoughness², not GGX"),
    Parameter("clearcoatGloss", "float", None,
              "Disney 2012: clearcoat with GTR1, α from 0.1 (gloss 0) to 0.001 (gloss 1)", "kShare", job=()),

    Parameter("sheenColor", "color", 0, "colour of the sheen layer (KHR_materials_sheen, Charlie), linear Rec. 709",
              "kShare", feature="SHEEN", needed=ALWAYS),
    texture("sheenColorTexture", "rgb, sRGB"),
    Parameter("sheenRoughness", "float", 0, "perceptual roughness of the sheen layer", "kShare"),
    texture("sheenRoughnessTexture", "a"),
    Parameter("disneySheen", "float", 0, "Disney 2012: strength of the sheen lobe", "kShare", job="sheen",
              feature="DISNEY_SHEEN", needed="hasDielectric(m)", point="outside"),
    Parameter("disneySheenTint", "float", 0, "Disney 2012: tints the sheen towards the hue of the base colour", "kShare",
              job="sheenTint", feature="DISNEY_SHEEN", point="outside"),

    Parameter("anisotropy", "float", 0, "strength of the specular anisotropy (KHR_materials_anisotropy)", "kShare",
              feature="ANISOTROPY", needed="hasInterface(m)"),
    Parameter("anisotropyRotation", "float", 0,
              "direction of the anisotropy, rad, counter-clockwise from the tangent", (-1000, 1000)),
    texture("anisotropyTexture", "rg: direction, b: strength"),

    Parameter("iridescence", "float", 0, "strength of the thin-film interference (KHR_materials_iridescence)", "kShare",
              feature="IRIDESCENCE", needed=ALWAYS),
    texture("iridescenceTexture", "r"),
    Parameter("iridescenceIor", "float", 1.3, "index of refraction of the thin film", "kIorRange"),
    Parameter("iridescenceThicknessMinimum", "float", 100, "nm"),
    Parameter("iridescenceThicknessMaximum", "float", 400, "nm"),
    Parameter("iridescenceThickness", "float", None, "thickness of the thin film, nm", (0, "1e6"),
              job=("iridescenceThicknessMinimum", "iridescenceThicknessMaximum")),
    texture("iridescenceThicknessTexture", "g"),

    Parameter("dispersion", "float", 0, "20 / Abbe number of the glass (KHR_materials_dispersion)", (0, 100),
              feature="DISPERSION", needed="refracts(m)", point="base"),

    Parameter("diffuseTransmission", "float", 0,
              "fraction of the diffusely scattered light that is transmitted (KHR_materials_diffuse_transmission)",
              "kShare", feature="DIFFUSE_TRANSMISSION", needed="hasDiffuse(m)"),
    texture("diffuseTransmissionTexture", "a"),
    Parameter("diffuseTransmissionColor", "color", 1, "colour of the diffusely transmitted light, linear Rec. 709",
              "kShare"),
    texture("diffuseTransmissionColorTexture", "rgb, sRGB"),

    Parameter("subsurface", "float", 0,
              "Disney 2012: blends the diffuse base with the flat (Hanrahan-Krueger) subsurface approximation", "kShare",
              feature="DISNEY_DIFFUSE", needed="hasDiffuse(m)", point="base"),
    Parameter("disneyDiffuse", "bool", False,
              "Disney 2012: diffuse base with roughness-dependent retro-reflection in place of Lambert", "",
              feature="DISNEY_DIFFUSE", needed="hasDiffuse(m)"),
    Parameter("orenNayarSigma", "float", 0,
              "Oren-Nayar roughness: standard deviation of the facets' slope angle, rad; 0 is Lambert",
              (0, "std::numbers::pi / 2"),
              feature="OREN_NAYAR", needed="hasDiffuse(m) && !hasDisneyDiffuse(m)", point="base"),

    Parameter("conductor", "word", None, "metal with its measured complex index of refraction", "kConductorNames", job=()),
    Parameter("conductor", "bool", False, "a metal of measured η + i k instead of the base colour's Schlick"),
    Parameter("conductorEta", "color", 1, "η of red, green and blue"),
    Parameter("conductorK", "color", 0, "k of red, green and blue"),
    Parameter("microfacets", "Microfacets", "ggx",
              "normal distribution function; settings.microfacets if not given", "kMicrofacetChoices"),
    Parameter("fresnel", "Fresnel", "exact", "Fresnel reflectance of dielectrics; settings.fresnel if not given",
              "kFresnelChoices"),
]

# MaterialRecord, a texel a line: parameters, and what the packers derive from them (type, feature).
TEXELS = """
baseColor alpha
emission alphaCutoff
metallic roughness normalScale ior
transmission flags albedoTable dispersion
absorption orenNayarSigma
baseColorTexture metallicRoughnessTexture normalTexture emissionTexture
transmissionTexture specularTexture specularColorTexture clearcoatTexture
specularColor specular
clearcoat clearcoatRoughness clearcoatNormalScale specularTint
clearcoatRoughnessTexture clearcoatNormalTexture sheenColorTexture sheenRoughnessTexture
sheenColor sheenRoughness
anisotropy anisotropyCos anisotropySin subsurface
iridescence iridescenceIor iridescenceThicknessMinimum iridescenceThicknessMaximum
anisotropyTexture iridescenceTexture iridescenceThicknessTexture diffuseTransmissionTexture
diffuseTransmissionColor diffuseTransmission
conductorEta disneySheen
conductorK disneySheenTint
diffuseTransmissionColorTexture coatTable sheenTable unused
"""

DERIVED = {
    "flags": ("uint", None), "albedoTable": ("uint", None), "coatTable": ("uint", None), "sheenTable": ("uint", None),
    "unused": ("uint", None), "absorption": ("vec3", "ATTENUATION"), "anisotropyCos": ("float", None),
    "anisotropySin": ("float", None),
}


def of_material():
    return [p for p in PARAMETERS if p.default is not None]


def of_jobs():
    return [p for p in PARAMETERS if p.range is not None]


def in_record():
    """The parameters that the record has as Material does."""
    return [p for p in of_material() if p.name in TEXELS.split()]
