"""Records that the host packs into texel buffers and shaders read, 16 bytes a texel. generate.py makes of this the structs
of C++ and GLSL and the readers of GLSL, so that both sides have the same layout."""

from collections import namedtuple

# type: float, uint, vec2, vec3; feature: without it the member is `neutral`, so that the code of others finds nothing.
Member = namedtuple("Member", "type name meaning feature neutral", defaults=("", None, None))
# texels: the constant that counts them. With a buffer and a prefix GLSL gets a reader of each member, such as
# `float materialIor(uint index)`; with a buffer alone one of the whole record, `LightRecord loadLightRecord(uint index)`;
# without, what makes a record of its texels, `AliasRecord unpackAliasRecord(uvec4 t0)`.
Record = namedtuple("Record", "name texels meaning members buffer prefix", defaults=(None, None))

MATERIAL = Record(
    "MaterialRecord", "MATERIAL_TEXELS",
    "One per material. What the members mean stands at Material (worker/scene/scene.h); textures are indices of\n"
    "TextureRecord or NO_INDEX.",
    [
        Member("vec3", "baseColor"), Member("float", "alpha"),
        Member("vec3", "emission"), Member("float", "alphaCutoff"),
        Member("float", "metallic"), Member("float", "roughness"), Member("float", "normalScale"),
        Member("float", "ior"),
        Member("float", "transmission", "", "TRANSMISSION", "0"), Member("uint", "flags", "MATERIAL_*"),
        Member("uint", "albedoTable"), Member("float", "dispersion", "", "DISPERSION", "0"),
        Member("vec3", "absorption", "1/m", "ATTENUATION", "vec3(0)"),
        Member("float", "orenNayarSigma", "rad", "OREN_NAYAR", "0"),
        Member("uint", "baseColorTexture"), Member("uint", "metallicRoughnessTexture"),
        Member("uint", "normalTexture"), Member("uint", "emissionTexture"),
        Member("uint", "transmissionTexture"), Member("uint", "specularTexture"),
        Member("uint", "specularColorTexture"), Member("uint", "clearcoatTexture"),
        Member("vec3", "specularColor", "", "SPECULAR_COLOR", "vec3(1)"),
        Member("float", "specular", "", "SPECULAR_COLOR", "1"),
        Member("float", "clearcoat", "", "CLEARCOAT", "0"), Member("float", "clearcoatRoughness"),
        Member("float", "clearcoatNormalScale"), Member("float", "specularTint", "", "SPECULAR_COLOR", "0"),
        Member("uint", "clearcoatRoughnessTexture"), Member("uint", "clearcoatNormalTexture"),
        Member("uint", "sheenColorTexture"), Member("uint", "sheenRoughnessTexture"),
        Member("vec3", "sheenColor", "", "SHEEN", "vec3(0)"), Member("float", "sheenRoughness"),
        Member("float", "anisotropy", "", "ANISOTROPY", "0"), Member("float", "anisotropyCos"),
        Member("float", "anisotropySin"), Member("float", "subsurface", "", "DISNEY_DIFFUSE", "0"),
        Member("float", "iridescence", "", "IRIDESCENCE", "0"), Member("float", "iridescenceIor"),
        Member("float", "iridescenceThicknessMinimum", "nm"), Member("float", "iridescenceThicknessMaximum", "nm"),
        Member("uint", "anisotropyTexture"), Member("uint", "iridescenceTexture"),
        Member("uint", "iridescenceThicknessTexture"), Member("uint", "diffuseTransmissionTexture"),
        Member("vec3", "diffuseTransmissionColor"),
        Member("float", "diffuseTransmission", "", "DIFFUSE_TRANSMISSION", "0"),
        Member("vec3", "conductorEta"), Member("float", "disneySheen", "", "DISNEY_SHEEN", "0"),
        Member("vec3", "conductorK"), Member("float", "disneySheenTint"),
        Member("uint", "diffuseTransmissionColorTexture"), Member("uint", "coatTable"), Member("uint", "sheenTable"),
        Member("uint", "unused"),
    ], "materialTexels", "material")

TEXTURE = Record(
    "TextureRecord", "TEXTURE_TEXELS", "uv' = du * u + dv * v + offset",
    [
        Member("uint", "firstTexel"), Member("uint", "width"), Member("uint", "height"),
        Member("uint", "flags", "TEXTURE_*"),
        Member("vec2", "du"), Member("vec2", "dv"),
        Member("vec2", "offset"), Member("uint", "unused0"), Member("uint", "unused1"),
    ], "textureTexels")

LIGHT = Record(
    "LightRecord", "LIGHT_TEXELS",
    "What p, a and b are stands at each kind (shaders/lights). Red, green and blue: radiance, W/(sr m²); intensity,\n"
    "W/sr, of point and spot lights; irradiance, W/m², of directional ones. LIGHT_ENVIRONMENT has its own texels.\n"
    "`pmf` is the probability of being chosen where no tree chooses; with LIGHTS_ALL within the light's group.",
    [
        Member("uint", "type", "LIGHT_*"), Member("uint", "primitive"), Member("float", "pmf"),
        Member("float", "area", "m²"),
        Member("vec3", "p"), Member("float", "red"),
        Member("vec3", "a"), Member("float", "green"),
        Member("vec3", "b"), Member("float", "blue"),
    ], "lightTexels")

SHAPE = Record(
    "ShapeRecord", "SHAPE_TEXELS",
    "A surface that is not made of triangles. World space is `centre` + toWorld · own space; rows of the matrices.",
    [
        Member("uint", "kind", "SHAPE_*"), Member("uint", "material"), Member("uint", "flags"),
        Member("uint", "program", "first texel of a field's instructions in the same buffer"),
        Member("vec3", "toShape0"), Member("float", "centreX"),
        Member("vec3", "toShape1"), Member("float", "centreY"),
        Member("vec3", "toShape2"), Member("float", "centreZ"),
        Member("vec3", "toWorld0"), Member("float", "size0"),
        Member("vec3", "toWorld1"), Member("float", "size1"),
        Member("vec3", "toWorld2"), Member("float", "size2"),
        Member("vec3", "extent", "of a field: half sides of the box around the origin that holds it"),
        Member("uint", "instructions"),
    ])

ALIAS = Record(
    "AliasRecord", "ALIAS_TEXELS",
    "Walker's alias method: keep the index when 32 random bits are below `threshold`, else take `alias`.\n"
    "The table of lights also has each light's way down the light tree: bit k is set where it takes the second\n"
    "child of the k-th node. With LIGHTS_ALL there is a table for each group, all in one, and the k-th `trail` is the\n"
    "first light of the k-th group.",
    [Member("uint", "threshold"), Member("uint", "alias"), Member("float", "pmf"), Member("uint", "trail")])

LIGHT_TREE_CHILD = Record(
    "LightTreeChild", "LIGHT_TREE_CHILD_TEXELS",
    "A subtree of lights: a sphere around them, a cone of half angle θo around `axis` with all their normals, the\n"
    "angle θe beyond their normals into which they still emit, and the sum of their greatest intensities\n"
    "(luminance, W/sr, in units of the largest of the scene). LIGHT_TREE_INFINITE: the cone holds the directions\n"
    "towards the lights and `intensity` is irradiance.",
    [
        Member("vec3", "centre"), Member("float", "radius"),
        Member("vec3", "axis"), Member("float", "intensity"),
        Member("float", "cosThetaO"), Member("float", "cosThetaE"), Member("uint", "flags"),
        Member("uint", "reference"),
    ])

RECORDS = [MATERIAL, TEXTURE, LIGHT, SHAPE, ALIAS, LIGHT_TREE_CHILD]
