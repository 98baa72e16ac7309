#!/usr/bin/env python3
"""Writes fog.gltf: a hall whose left wall has gaps, for beams of light in fog (docs/fog.png).

    tests/data/make_fog.py [FOLDER]

The picture: tilefarm-worker render tests/data/fog.gltf -o fog.exr --png docs/fog.png --width 768 --height 432 --samples 8192
--light '{"kind": "directional", "direction": [1, -0.62, 0.45], "intensity": 14, "color": [1, 0.86, 0.66], "angularDiameter":
0.5}' --environment-kind constant --environment-color 0.5 0.75 1.1 --light-selection all --max-bounces 6 --exposure 0.7
--fog-extinction 0.12 0.12 0.12 --fog-anisotropy 0.5
"""
import pathlib
import sys

from gltf_writer import Gltf

SHAPES = [{"type": "box", "box": {"size": [1, 1, 1]}}, {"type": "sphere", "sphere": {"radius": 0.5}}]
BOX, SPHERE = range(len(SHAPES))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    gltf = Gltf("tests/data/make_fog.py")
    gltf.json["extensionsUsed"] = ["KHR_implicit_shapes", "TILEFARM_shapes"]
    gltf.json["extensions"] = {"KHR_implicit_shapes": {"shapes": SHAPES}}
    wall = gltf.material("Wall", (0.6, 0.57, 0.52), roughness=1.0)
    floor = gltf.material("Floor", (0.35, 0.3, 0.26), roughness=0.45)
    red = gltf.material("Red", (0.7, 0.12, 0.08), roughness=0.5)
    chrome = gltf.material("Chrome", (0.9, 0.9, 0.92), metallic=1.0, roughness=0.05)
    glass = gltf.material("Glass", (1, 1, 1), roughness=0.0, extensions={
        "KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_volume": {"thicknessFactor": 1.0}})

    def put(name, material, translation, scale, shape=BOX):
        gltf.node(name, translation=translation, scale=scale, extensions={"TILEFARM_shapes": {"shape": shape, "material": material}})

    put("Floor", floor, [0, -0.1, 0], [8.4, 0.2, 12.4])
    put("Ceiling", wall, [0, 4.1, 0], [8.4, 0.2, 12.4])
    put("Right wall", wall, [4.1, 2, 0], [0.2, 4, 12])
    put("Back wall", wall, [0, 2, -6.1], [8.4, 4, 0.2])
    put("Front wall", wall, [0, 2, 6.1], [8.4, 4, 0.2])
    # The left wall: below and above the windows, and the pillars between them.
    put("Sill", wall, [-4.1, 0.5, 0], [0.2, 1, 12])
    put("Lintel", wall, [-4.1, 3.8, 0], [0.2, 0.4, 12])
    edges = [-6, -4.6, -3.9, -2.5, -1.8, -0.4, 0.3, 1.7, 2.4, 6]
    for i in range(0, len(edges), 2):
        near, far = edges[i], edges[i + 1]
        put(f"Pillar {i // 2}", wall, [-4.1, 2.3, (near + far) / 2], [0.2, 2.6, far - near])
    put("Red ball", red, [0.2, 0.6, -1.9], [1.2, 1.2, 1.2], SPHERE)
    put("Chrome ball", chrome, [1.9, 0.7, -0.4], [1.4, 1.4, 1.4], SPHERE)
    put("Glass ball", glass, [-0.6, 0.5, 0.6], [1.0, 1.0, 1.0], SPHERE)
    gltf.camera("Camera", (1.6, 1.7, 5.6), (-0.7, 1.5, -2.5), 50.0)
    gltf.write_gltf(folder / "fog.gltf")


if __name__ == "__main__":
    main()
