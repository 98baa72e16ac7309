"""Runs in Blender's own Python (3.4, Cycles): renders one comparison's scene once for every seed.

    blender --background --factory-startup --python in_blender.py -- comparison.json

The glTF importer brings geometry and camera. Materials, lights and surroundings are built here from the recipes of
the comparison, because Blender's Principled BSDF is another model than glTF's.

Units. Tilefarm and Cycles both hold radiance in a pixel, and an Emission node of strength 1 has radiance 1. A lamp's
`energy` P is another matter; intern/cycles divides it so that
    point, spot   I = P / (4 pi)        W/sr     radiance P / (4 pi^2 r^2) on a disk of radius r that faces the point
    sun           E = P                 W/m^2    through a surface that faces it, whatever its angle
    area          L = P / (4 A)         W/(sr m^2)
An area lamp's flux is thus pi/4 P. `power_of` inverts these.

Axes. glTF has y up, Blender z: (x, y, z) becomes (x, -z, y). An equirectangular picture then stands alike in both:
u = 1/2 + atan2(z, x) / 2 pi in glTF's axes.
"""
import json
import math
import sys

import numpy
numpy.bool = bool  # glTF importer of Blender 3.4 with numpy 1.24 or newer
import bpy
from mathutils import Vector


def to_blender(v):
    return Vector((v[0], -v[2], v[1]))


# ---- Materials


class Nodes:
    """A material's node tree under construction."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()
        self.output = self.node("ShaderNodeOutputMaterial")

    def node(self, kind, inputs=(), **properties):
        node = self.tree.nodes.new(kind)
        for key, value in properties.items():
            setattr(node, key, value)
        for key, value in dict(inputs).items():
            self.set(node.inputs[key], value)
        return node

    def set(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif isinstance(value, (list, tuple)) and len(value) == 3 and socket.type == "RGBA":
            socket.default_value = (*value, 1.0)
        else:
            socket.default_value = value

    def math(self, operation, *values):
        node = self.node("ShaderNodeMath", operation=operation)
        for socket, value in zip(node.inputs, values):
            self.set(socket, value)
        return node.outputs[0]

    def mix(self, factor, first, second):
        node = self.node("ShaderNodeMixShader")
        for socket, value in zip(node.inputs, (factor, first, second)):
            self.set(socket, value)
        return node.outputs[0]


def color_of(nodes, recipe, images):
    """A constant, or the texture that the importer found for the base colour."""
    if not recipe.get("textured"):
        return recipe.get("color", [1, 1, 1]), None
    texture = nodes.node("ShaderNodeTexImage", image=images[0], interpolation=recipe.get("filter", "Closest"))
    return texture.outputs["Color"], texture.outputs["Alpha"]


def diffuse(nodes, recipe, images):
    color, alpha = color_of(nodes, recipe, images)
    shader = nodes.node("ShaderNodeBsdfDiffuse", {"Color": color, "Roughness": recipe.get("sigma", 0.0)}).outputs[0]
    if "cutoff" in recipe:  # alpha mask
        clear = nodes.node("ShaderNodeBsdfTransparent", {"Color": [1, 1, 1]}).outputs[0]
        return nodes.mix(nodes.math("LESS_THAN", alpha, recipe["cutoff"]), shader, clear)
    if "alpha" in recipe:
        clear = nodes.node("ShaderNodeBsdfTransparent", {"Color": [1, 1, 1]}).outputs[0]
        return nodes.mix(recipe["alpha"], clear, shader)
    return shader


def emission(nodes, recipe, images):
    """glTF's single-sided emitters are dark from behind, Blender's shine both ways."""
    light = nodes.node("ShaderNodeEmission", {"Color": recipe["color"], "Strength": recipe.get("strength", 1.0)})
    if recipe.get("both"):
        return light.outputs[0]
    dark = nodes.node("ShaderNodeBsdfDiffuse", {"Color": [0, 0, 0]})
    back = nodes.node("ShaderNodeNewGeometry").outputs["Backfacing"]
    return nodes.mix(back, light.outputs[0], dark.outputs[0])


def glossy(nodes, recipe, images):
    """Reflectance `color` at every angle; "schlick": glTF's metal, exact where the surface is smooth, for nodes know the
    angle to the normal and not to the microfacet."""
    color = recipe["color"]
    if recipe.get("schlick"):
        incoming = nodes.node("ShaderNodeNewGeometry")
        dot = nodes.node("ShaderNodeVectorMath", operation="DOT_PRODUCT")
        nodes.set(dot.inputs[0], incoming.outputs["Incoming"])
        nodes.set(dot.inputs[1], incoming.outputs["Normal"])
        fresnel = nodes.math("POWER", nodes.math("SUBTRACT", 1.0, nodes.math("ABSOLUTE", dot.outputs["Value"])), 5.0)
        mixed = nodes.node("ShaderNodeMixRGB", {"Fac": fresnel, "Color1": color, "Color2": [1, 1, 1]})
        color = mixed.outputs[0]
    if "anisotropy" in recipe:
        tangent = nodes.node("ShaderNodeTangent", direction_type="UV_MAP")
        return nodes.node("ShaderNodeBsdfAnisotropic",
                          {"Color": color, "Roughness": recipe["roughness"], "Anisotropy": recipe["anisotropy"],
                           "Rotation": recipe.get("rotation", 0.0), "Tangent": tangent.outputs[0]},
                          distribution=recipe.get("distribution", "GGX")).outputs[0]
    return nodes.node("ShaderNodeBsdfGlossy", {"Color": color, "Roughness": recipe["roughness"]},
                      distribution=recipe.get("distribution", "GGX")).outputs[0]


def glass(nodes, recipe, images):
    """A closed solid; "absorption" in 1/m inside it."""
    absorption = recipe.get("absorption")
    if absorption and max(absorption) > 0:
        density = max(absorption)
        volume = nodes.node("ShaderNodeVolumeAbsorption",
                            {"Color": [1 - a / density for a in absorption], "Density": density})
        nodes.set(nodes.output.inputs["Volume"], volume.outputs[0])
    return nodes.node("ShaderNodeBsdfGlass", {"Color": recipe.get("color", [1, 1, 1]), "IOR": recipe["ior"],
                                              "Roughness": recipe["roughness"]},
                      distribution=recipe.get("distribution", "SHARP")).outputs[0]


def thin(nodes, recipe, images):
    """A smooth sheet without thickness: reflects by Fresnel's equations, the rest goes straight on, tinted."""
    back = nodes.node("ShaderNodeNewGeometry").outputs["Backfacing"]
    # The Fresnel node takes the inverse of its index on back faces, which for a sheet are front faces too.
    index = nodes.math("MULTIPLY_ADD", back, 1 / recipe["ior"] - recipe["ior"], recipe["ior"])
    fresnel = nodes.node("ShaderNodeFresnel", {"IOR": index}).outputs[0]
    through = nodes.node("ShaderNodeBsdfTransparent", {"Color": recipe["color"]}).outputs[0]
    mirror = nodes.node("ShaderNodeBsdfGlossy", {"Color": [1, 1, 1], "Roughness": 0.0}, distribution="SHARP").outputs[0]
    return nodes.mix(fresnel, through, mirror)


def principled(nodes, recipe, images):
    return nodes.node("ShaderNodeBsdfPrincipled", recipe["inputs"],
                      distribution=recipe.get("distribution", "GGX")).outputs[0]


def translucent(nodes, recipe, images):
    return nodes.mix(recipe["share"], nodes.node("ShaderNodeBsdfDiffuse", {"Color": recipe["color"]}).outputs[0],
                     nodes.node("ShaderNodeBsdfTranslucent", {"Color": recipe["through"]}).outputs[0])


RECIPES = {f.__name__: f for f in (diffuse, emission, glossy, glass, thin, principled, translucent)}


def set_materials(recipes):
    for material in bpy.data.materials:
        name = material.name
        recipe = recipes.get(name, recipes.get("*"))
        if recipe is None:
            raise SystemExit(f"no recipe for the material '{name}'")
        if recipe["kind"] == "imported":
            continue
        images = [n.image for n in material.node_tree.nodes if n.type == "TEX_IMAGE"]
        nodes = Nodes(material.node_tree)
        nodes.set(nodes.output.inputs["Surface"], RECIPES[recipe["kind"]](nodes, recipe, images))


# ---- Lights


def power_of(light):
    kind, intensity = light["kind"], light["intensity"]
    if kind in ("point", "spot"):
        return 4 * math.pi * intensity
    if kind == "quad":
        return 4 * light["width"] * light["height"] * intensity
    return intensity


def add_sphere(light):
    """As a mesh: a lamp with a radius is a disk that faces the shaded point."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=light["radius"],
                                         location=to_blender(light["position"]))
    material = bpy.data.materials.new("sphere light")
    material.use_nodes = True
    nodes = Nodes(material.node_tree)
    recipe = {"color": light["color"], "strength": light["intensity"], "both": True}
    nodes.set(nodes.output.inputs["Surface"], emission(nodes, recipe, []))
    bpy.context.object.data.materials.append(material)


def undo_spot_cosine(data):
    """Cycles multiplies the radiance of a spot by the cosine of the angle to its axis (spot_light_attenuation): glTF's
    is constant within the inner cone."""
    data.use_nodes = True
    tree = data.node_tree
    axis = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Normal"], axis.inputs[0])
    cosine, inverse = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
    cosine.operation, inverse.operation = "ABSOLUTE", "DIVIDE"
    tree.links.new(axis.outputs["Z"], cosine.inputs[0])
    inverse.inputs[0].default_value = 1.0
    tree.links.new(cosine.outputs[0], inverse.inputs[1])
    tree.links.new(inverse.outputs[0], tree.nodes["Emission"].inputs["Strength"])


def add_light(light):
    if light["kind"] == "sphere":
        return add_sphere(light)
    kinds = {"point": "POINT", "spot": "SPOT", "directional": "SUN", "quad": "AREA"}
    data = bpy.data.lights.new(light["kind"], kinds[light["kind"]])
    data.color, data.energy = light["color"], power_of(light)
    if light["kind"] in ("point", "spot"):
        data.shadow_soft_size = 0
    if light["kind"] == "spot":  # a sharp edge: the two programs' soft ones have other curves
        data.spot_size, data.spot_blend = 2 * math.radians(light["outerCone"]), 0
        undo_spot_cosine(data)
    if light["kind"] == "directional":
        data.angle = math.radians(light.get("angularDiameter", 0))
    if light["kind"] == "quad":
        data.shape, data.size, data.size_y = "RECTANGLE", light["width"], light["height"]
    made = bpy.data.objects.new(light["kind"], data)
    made.location = to_blender(light.get("position", (0, 0, 0)))
    made.rotation_euler = to_blender(light.get("direction", (0, -1, 0))).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(made)


def set_world(environment, sampled):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    background = tree.nodes["Background"]
    background.inputs["Strength"].default_value = environment.get("intensity", 1.0) if environment else 0.0
    if not environment:
        return
    if "file" not in environment:
        background.inputs["Color"].default_value = (*environment["color"], 1.0)
        return
    image = tree.nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(environment["file"])
    image.image.colorspace_settings.name = "Linear"
    tree.links.new(image.outputs[0], background.inputs["Color"])
    mapping, place = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    # A picture turned counter-clockwise is looked up in a direction turned clockwise.
    mapping.inputs["Rotation"].default_value[2] = -math.radians(environment.get("rotation", 0.0))
    tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], image.inputs["Vector"])
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL" if sampled else "NONE", 1024


# ---- Settings


def set_render(scene, comparison):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = comparison["size"]
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", comparison["threads"]
    scene.render.use_persistent_data = True
    scene.render.dither_intensity = 0
    scene.view_settings.view_transform, scene.sequencer_colorspace_settings.name = "Raw", "Linear"
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode, settings.exr_codec = "OPEN_EXR", "32", "RGB", "NONE"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.blur_glossy = 0
    cycles.light_sampling_threshold = 0
    cycles.pixel_filter_type = "BOX"
    # Cycles counts bounces after the first surface, Tilefarm surfaces that scatter. Emission that the last bounce
    # finds counts in both.
    bounces = comparison["bounces"] - 1
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.transparent_max_bounces = 256
    cycles.volume_bounces = 0


def main():
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        comparison = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=comparison["scene"])
    for thing in [o for o in bpy.data.objects if o.type == "LIGHT"]:
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    scene.camera = scene.objects[comparison["camera"]]
    scene.camera.data.clip_start, scene.camera.data.clip_end = 1e-3, 1e6
    for thing in scene.objects:
        if thing.type == "MESH":
            thing.cycles.shadow_terminator_geometry_offset = thing.cycles.shadow_terminator_offset = 0
    set_materials(comparison["materials"])
    for light in comparison["lights"]:
        add_light(light)
    set_world(comparison["environment"], comparison["sample_environment"])
    set_render(scene, comparison)
    scene.cycles.samples = comparison["samples"]
    for seed, path in enumerate(comparison["outputs"]):
        scene.cycles.seed = seed + 1
        scene.render.filepath = path
        bpy.ops.render.render(write_still=True)


main()
