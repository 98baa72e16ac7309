#!/usr/bin/env python3
"""Writes shapes.gltf: every kind of surface that is not made of triangles, and a mesh among them.

    tests/data/make_shapes.py [FOLDER]
"""
import pathlib
import sys

import shapes
from gltf_writer import Gltf, png, quaternion

IMPLICIT = [
    {"type": "sphere", "sphere": {"radius": 0.5}},
    {"type": "box", "box": {"size": [0.8, 0.8, 0.8]}},
    {"type": "cylinder", "cylinder": {"height": 1.0, "radiusBottom": 0.4, "radiusTop": 0.4}},
    {"type": "cylinder", "cylinder": {"height": 1.1, "radiusBottom": 0.5, "radiusTop": 0.0}},
    {"type": "capsule", "capsule": {"height": 0.6, "radiusBottom": 0.3, "radiusTop": 0.3}},
    {"type": "capsule", "capsule": {"height": 0.6, "radiusBottom": 0.35, "radiusTop": 0.15}},
    {"type": "plane", "plane": {"sizeX": 14, "sizeZ": 14}},
]
SPHERE, BOX, CYLINDER, CONE, CAPSULE, TAPERED, PLANE = range(len(IMPLICIT))

CROSS = [{"box": {"size": [1.4, 0.3, 0.3]}}, {"box": {"size": [0.3, 1.4, 0.3]}}, {"box": {"size": [0.3, 0.3, 1.4]}}]
SURFACES = [
    {"rectangle": {"size": [3, 1.2]}},
    {"disk": {"radius": 0.5}},
    {"field": {"torus": {"radius": 0.4, "tube": 0.14}}},
    {"field": {"box": {"size": [0.8, 0.8, 0.8], "rounding": 0.15}}},
    {"field": {"cone": {"height": 0.9, "radiusBottom": 0.5, "radiusTop": 0.2}}},
    {"field": {"smooth": 0.25, "union": [{"sphere": {"radius": 0.35}, "translation": [-0.25, -0.1, 0]},
                                         {"sphere": {"radius": 0.3}, "translation": [0.25, 0.15, 0.05]},
                                         {"torus": {"radius": 0.35, "tube": 0.1}, "translation": [0, -0.3, 0]}]}},
    {"field": {"smooth": 0.02, "difference": [
        {"smooth": 0.02, "intersection": [{"box": {"size": [0.9, 0.9, 0.9]}}, {"sphere": {"radius": 0.58}}]}, {"union": CROSS, "translation": [0, 0, 0]}]}},
    {"field": {"mandelbulb": {"power": 8, "iterations": 8}}},
]
LAMP, DISK, TORUS, ROUNDED, FRUSTUM, BLEND, CARVED, BULB = range(len(SURFACES))


def checker(squares, light, dark, texels=8):
    """`texels` to the side of a square, so that filtering softens edges only."""
    size = squares * texels
    return png(size, size, [[light if (x // texels + y // texels) % 2 else dark for x in range(size)] for y in range(size)])


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    gltf = Gltf("tests/data/make_shapes.py")
    gltf.json["extensionsUsed"] = ["KHR_implicit_shapes", "TILEFARM_shapes"]
    gltf.json["extensions"] = {"KHR_implicit_shapes": {"shapes": IMPLICIT}, "TILEFARM_shapes": {"surfaces": SURFACES}}
    squares = gltf.texture(gltf.image("squares", checker(8, (235, 235, 225), (40, 70, 120))))
    tiles = gltf.texture(gltf.image("tiles", checker(28, (200, 196, 190), (150, 146, 142))))

    floor = gltf.material("Floor", baseColorTexture={"index": tiles}, roughness=0.9)
    checked = gltf.material("Checked", baseColorTexture={"index": squares}, roughness=0.5)
    matte = gltf.material("Matte", (0.75, 0.3, 0.2), roughness=1.0)
    plastic = gltf.material("Plastic", (0.1, 0.45, 0.25), roughness=0.25)
    gold = gltf.material("Gold", (1.0, 0.77, 0.34), metallic=1.0, roughness=0.2)
    chrome = gltf.material("Chrome", (0.9, 0.9, 0.92), metallic=1.0, roughness=0.0)
    glass = gltf.material("Glass", (1, 1, 1), roughness=0.0, extensions={
        "KHR_materials_transmission": {"transmissionFactor": 1.0},
        "KHR_materials_volume": {"thicknessFactor": 1.0, "attenuationColor": [0.6, 0.85, 0.95], "attenuationDistance": 0.8}})
    holes = gltf.material("Holes", alphaMode="MASK", alphaCutoff=0.5, doubleSided=True, roughness=0.6, baseColorTexture={
        "index": gltf.texture(gltf.image("holes", checker(10, (230, 160, 40, 255), (230, 160, 40, 0))))})
    lamp = gltf.material("Lamp", (0, 0, 0), emissiveFactor=[1, 0.94, 0.85], extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 18}})
    bulb = gltf.material("Bulb", (0, 0, 0), emissiveFactor=[1, 0.55, 0.25], doubleSided=True,
                         extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 30}})

    def put(name, material, translation, shape=None, surface=None, **more):
        which = {"shape": shape} if shape is not None else {"surface": surface}
        gltf.node(name, translation=translation, extensions={"TILEFARM_shapes": {**which, "material": material}}, **more)

    put("Floor", floor, [0, 0, 0], shape=PLANE)
    put("Lamp", lamp, [-1.5, 4.2, 2.5], surface=LAMP, rotation=quaternion((1, 0.15, 0), 122))
    put("Bulb light", bulb, [2.05, 0.12, 1.65], shape=SPHERE, scale=[0.24, 0.24, 0.24])

    put("Glass sphere", glass, [-1.9, 0.5, 1.2], shape=SPHERE)
    put("Checked sphere", checked, [-0.75, 0.5, 1.35], shape=SPHERE)
    put("Ellipsoid", gold, [0.35, 0.3, 1.5], shape=SPHERE, scale=[1.0, 0.6, 0.7], rotation=quaternion((0, 1, 0), 30))
    put("Sphere with holes", holes, [1.35, 0.5, 1.3], shape=SPHERE)

    put("Box", checked, [-2.6, 0.4, -0.1], shape=BOX, rotation=quaternion((0, 1, 0), 25))
    put("Cylinder", checked, [-1.45, 0.5, -0.1], shape=CYLINDER)
    put("Cone", matte, [-0.35, 0.55, -0.05], shape=CONE)
    put("Capsule", plastic, [0.65, 0.6, 0.0], shape=CAPSULE)
    put("Tapered capsule", chrome, [1.55, 0.65, -0.1], shape=TAPERED)
    put("Disk", gold, [2.55, 0.55, 0.1], surface=DISK, rotation=quaternion((1, 0, 0), -20))

    put("Torus", gold, [-2.9, 0.45, -1.6], surface=TORUS, rotation=quaternion((1, 0, 0), 70))
    put("Rounded box", plastic, [-1.85, 0.45, -1.6], surface=ROUNDED, rotation=quaternion((0, 1, 0), 30))
    put("Frustum", matte, [-0.8, 0.45, -1.6], surface=FRUSTUM)
    put("Blend", chrome, [0.35, 0.5, -1.6], surface=BLEND)
    put("Carved", matte, [1.5, 0.55, -1.6], surface=CARVED, rotation=quaternion((0, 1, 0), 35))
    put("Mandelbulb", matte, [2.8, 0.75, -1.7], surface=BULB, scale=[0.65, 0.65, 0.65], rotation=quaternion((1, 0, 0), -90))

    knot = shapes.torus_knot(2, 3, 0.32, 0.14, 0.09, 160, 12)
    gltf.node("Mesh knot", mesh=gltf.mesh("Knot", gltf.geometry(knot, "Knot", uvs=False), plastic), translation=[2.75, 0.55, 1.0])
    gltf.camera("Camera", (0.2, 3.0, 6.2), (0.1, 0.35, -0.2), 38.0)
    gltf.write_gltf(folder / "shapes.gltf")


if __name__ == "__main__":
    main()
