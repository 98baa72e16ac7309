#!/usr/bin/env python3
"""Writes materials.glb, which shows every lobe of the renderer, and layers.glb, which shows textures under a coat.

    tests/data/make_materials.py [FOLDER]
"""
import math
import pathlib
import sys

import shapes
from gltf_writer import Gltf, png
from make_small import rectangle

STEPS = [0.0, 0.25, 0.5, 0.75, 1.0]


def khr(name, **members):
    return {"KHR_materials_" + name: members}


def ours(**members):
    """The vendor extension: members of MaterialOverride in shared/job/appearance.h."""
    return {"TILEFARM_materials": members}


def glass(strength, **more):
    return {"KHR_materials_transmission": {"transmissionFactor": strength},
            "KHR_materials_volume": {"thicknessFactor": 0.8, "attenuationColor": [0.55, 0.85, 0.7], "attenuationDistance": 1.0},
            **more}


# (name, arguments of Gltf.material at strength t from 0 to 1), rows of the picture from the top: left, right.
ROWS = [
    (("Clearcoat", lambda t: dict(color=(0.5, 0.02, 0.02), roughness=0.7,
                                  extensions=khr("clearcoat", clearcoatFactor=t, clearcoatRoughnessFactor=0.05))),
     ("Clearcoat gloss GTR1", lambda t: dict(color=(0.02, 0.1, 0.35), roughness=0.7,
                                             extensions=ours(clearcoat=1.0, clearcoatGloss=t)))),
    (("Sheen", lambda t: dict(color=(0.08, 0.02, 0.15), roughness=1.0,
                              extensions=khr("sheen", sheenColorFactor=[0.9 * t, 0.75 * t, t], sheenRoughnessFactor=0.35))),
     ("Disney sheen", lambda t: dict(color=(0.25, 0.06, 0.02), roughness=1.0, extensions=ours(sheen=t, sheenTint=0.5, disneyDiffuse=True)))),
    (("Anisotropy", lambda t: dict(color=(0.9, 0.6, 0.35), metallic=1.0, roughness=0.45,
                                   extensions=khr("anisotropy", anisotropyStrength=t))),
     ("Iridescence", lambda t: dict(color=(0.25, 0.25, 0.25), metallic=1.0, roughness=0.15,
                                    extensions=khr("iridescence", iridescenceFactor=1.0, iridescenceIor=1.6,
                                                   iridescenceThicknessMinimum=100.0, iridescenceThicknessMaximum=150 + 400 * t)))),
    (("Transmission", lambda t: dict(roughness=0.05, extensions=glass(t))),
     ("Dispersion", lambda t: dict(roughness=0.0, extensions={
         "KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_volume": {"thicknessFactor": 0.8},
         **khr("ior", ior=1.6), **khr("dispersion", dispersion=3.0 * t)}))),
    (("Diffuse transmission", lambda t: dict(color=(0.2, 0.35, 0.08), roughness=0.8, doubleSided=True,
                                             extensions=khr("diffuse_transmission", diffuseTransmissionFactor=t,
                                                            diffuseTransmissionColorFactor=[0.75, 0.85, 0.2]))),
     ("Specular", lambda t: dict(color=(0.03, 0.12, 0.05), roughness=0.25,
                                 extensions=khr("specular", specularFactor=t, specularColorFactor=[1.0, 1.0, 1.0])))),
    (("Oren-Nayar", lambda t: dict(color=(0.55, 0.4, 0.3), roughness=1.0,
                                   extensions={**khr("ior", ior=1.0), **ours(orenNayarSigma=round(t * math.pi / 3, 6))})),
     ("Subsurface", lambda t: dict(color=(0.75, 0.4, 0.3), roughness=0.6, extensions=ours(disneyDiffuse=True, subsurface=t)))),
]


def chequer(cells, dark, light, size):
    step = size // cells
    return png(size, size, [[(light if (x // step + y // step) % 2 else dark) for x in range(size)] for y in range(size)])


def stage(gltf, x0, x1, top):
    """A chequered wall behind, a floor, a large lamp before, a small bright one, and one behind the spheres."""
    picture = gltf.texture(gltf.image("chequer", chequer(8, (120, 120, 124), (70, 70, 74), 64)))
    wall = gltf.material("Wall", baseColorTexture={"index": picture}, extensions=khr("ior", ior=1.0))
    quad = rectangle((x0 - 1, -1.5, -1.6), (x1 - x0 + 2, 0, 0), (0, top + 3, 0))
    quad.uvs = [(u * (x1 - x0 + 2) / 4, v * (top + 3) / 4) for u, v in quad.uvs]
    gltf.node("Wall", mesh=gltf.mesh("Wall", gltf.geometry(quad, "Wall"), wall))

    def lamp(name, corner, u, v, strength, color):
        material = gltf.material(name, (0, 0, 0), emissiveFactor=list(color),
                                 extensions=khr("emissive_strength", emissiveStrength=strength))
        gltf.node(name, mesh=gltf.mesh(name, gltf.geometry(rectangle(corner, u, v), name, uvs=False), material))

    middle = (x0 + x1) / 2
    lamp("Softbox", (middle - 7, top + 3, 9), (5, 0, 0), (0, 3, 3), 34.0, (1.0, 0.95, 0.85))
    lamp("Fill", (middle + 9, 0, 8), (0, 0, 5), (0, 5, 0), 7.0, (0.75, 0.85, 1.0))
    lamp("Rim", (x0, top + 1.6, -1.4), (x1 - x0, 0, 0), (0, 0, 1.0), 16.0, (1.0, 1.0, 1.0))


def materials(path):
    gltf = Gltf("tests/data/make_materials.py")
    ball = gltf.geometry(shapes.sphere(0.42, 48, 24), "Ball", solid=True)
    for j, row in enumerate(ROWS):
        for block, (name, make) in enumerate(row):
            for i, t in enumerate(STEPS):
                label = f"{name} {t:g}"
                gltf.node(label, mesh=gltf.mesh(label, ball, gltf.material(label, **make(t))),
                          translation=[i + block * 5.4, float(len(ROWS) - 1 - j), 0])
    stage(gltf, -1.2, 10.6, len(ROWS) - 0.5)
    gltf.camera("Camera", (4.7, 2.9, 26), (4.7, 2.5, 0), 13.6, aspect=1.75)
    gltf.write_glb(path)


def rounded(size):
    """A bumpy surface as heights of a normal map: hammered dents."""
    return [[0.5 + 0.25 * math.sin(8 * math.pi * x / size) * math.sin(8 * math.pi * y / size) for x in range(size)] for y in range(size)]


def layers(path):
    """Four spheres: bumps under a smooth coat, a coat with bumps of its own over a smooth base, a coat and a sheen
    that follow textures, and a shade that glows through."""
    gltf = Gltf("tests/data/make_materials.py")
    bumps = gltf.texture(gltf.image("bumps", normal_image(64)))
    stripes = gltf.texture(gltf.image("stripes", png(32, 32, [[(255, 255, 255) if y // 4 % 2 else (0, 40, 0) for _ in range(32)] for y in range(32)])))
    ball = gltf.geometry(shapes.sphere(0.45, 64, 32), "Ball", solid=True)
    red = dict(color=(0.45, 0.03, 0.02), metallic=0.6, roughness=0.4)
    looks = [
        ("Bumps under the coat", dict(red, normalTexture={"index": bumps}, extensions=khr("clearcoat", clearcoatFactor=1.0))),
        ("Bumps of the coat", dict(red, extensions=khr("clearcoat", clearcoatFactor=1.0, clearcoatNormalTexture={"index": bumps, "scale": 0.6}))),
        ("Striped coat", dict(color=(0.02, 0.05, 0.3), roughness=0.7, extensions=khr(
            "clearcoat", clearcoatFactor=1.0, clearcoatTexture={"index": stripes}, clearcoatRoughnessFactor=0.1))),
        ("Striped sheen", dict(color=(0.05, 0.1, 0.06), roughness=1.0, extensions=khr(
            "sheen", sheenColorFactor=[1.0, 0.9, 0.7], sheenColorTexture={"index": stripes}, sheenRoughnessFactor=0.4))),
        ("Wax", dict(color=(0.6, 0.5, 0.3), roughness=0.5, extensions={
            **khr("diffuse_transmission", diffuseTransmissionFactor=0.8, diffuseTransmissionColorFactor=[1.0, 0.9, 0.75]),
            **khr("volume", thicknessFactor=0.9, attenuationColor=[0.9, 0.4, 0.15], attenuationDistance=0.5)})),
    ]
    for i, (name, look) in enumerate(looks):
        gltf.node(name, mesh=gltf.mesh(name, ball, gltf.material(name, **look)), translation=[float(i), 0, 0])
    stage(gltf, -1.2, 5.2, 1.5)
    gltf.camera("Camera", (2, 0.4, 12), (2, 0.1, 0), 9.0, aspect=3.0)
    gltf.write_glb(path)


def normal_image(size):
    rows, strength = [], 3.0
    height = rounded(size)
    for y in range(size):
        row = []
        for x in range(size):
            dx = (height[y][(x + 1) % size] - height[y][x - 1]) * strength
            dy = (height[(y + 1) % size][x] - height[y - 1][x]) * strength
            length = math.sqrt(dx * dx + dy * dy + 1)
            row.append(tuple(round(127.5 + 127.5 * c / length) for c in (-dx, dy, 1.0)))
        rows.append(row)
    return png(size, size, rows)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    folder.mkdir(parents=True, exist_ok=True)
    materials(folder / "materials.glb")
    layers(folder / "layers.glb")


if __name__ == "__main__":
    main()
