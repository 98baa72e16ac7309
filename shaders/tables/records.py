"""Records that the host packs into texel buffers and shaders read, 16 bytes a texel. generate.py makes of this the structs
of C++ and GLSL and the readers of GLSL, so that both sides have the same layout."""

from collections import namedtuple

import materials

# type: float, uint, vec2, vec3; feature: without it the member is `neutral`, so that the code of others finds nothing.
Member = namedtuple("Member", "type name meaning feature neutral", defaults=("", None, None))
# texels: the constant that counts them. With a buffer and a prefix GLSL gets a reader of each member, such as
# `float materialIor(uint index)`; with a buffer alone one of the whole record, `LightRecord loadLightRecord(uint index)`;
# without, what makes a record of its texels, `AliasRecord unpackAliasRecord(uvec4 t0)`.
Record = namedtuple("Record", "name texels meaning members buffer prefix", defaults=(None, None))


def neutral(row):
    return f"vec3({row.default})" if row.type == "color" else str(row.default)


def material_member(name):
    """What a word of materials.TEXELS stands for."""
    if name in materials.DERIVED:
        kind, feature = materials.DERIVED[name]
        return Member(kind, name, "", feature, "vec3(0)" if feature else None)
    row = next(p for p in materials.of_material() if p.name == name)
    kind = {"color": "vec3", "texture": "uint"}.get(row.type, row.type)
    return Member(kind, name, "", row.feature, neutral(row) if row.feature else None)


MATERIAL = Record(
    "MaterialRecord", "MATERIAL_TEXELS",
    "One per material. What the members mean stands in materials.py; textures are indices of TextureRecord or NO_INDEX.",
    [material_member(name) for name in materials.TEXELS.split()], "materialTexels", "material")

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
