#!/usr/bin/env python3
"""Writes the demo scene of Tilefarm: demo/demo.glb and demo/sky.hdr.

A still life on a terrace at dusk, made to call for most of what the renderer does: solid glass with
absorption, smooth and brushed metal, glazed and rough dielectrics, base colour, roughness and normal
textures, a soft box as area light and a sky. Needs nothing but Python; the same files come out every time.

    tests/data/make_demo.py [FOLDER]
"""
import math
import pathlib
import sys

import shapes
import textures
from gltf_writer import Gltf, Mesh, normalize, dot, png, quaternion, write_hdr

SUN = normalize((-0.86, 0.40, 0.30))  # towards it: low, from the left and behind the camera


def sky(direction):
    """Linear radiance of a clear dusk opposite a low sun: blue overhead, the earth's shadow and the pink belt
    above it at the horizon, a dark sea below."""
    x, y, z = direction
    def mix(a, b, t):
        t = min(max(t, 0.0), 1.0)
        t = t * t * (3 - 2 * t)
        return tuple(p + (q - p) * t for p, q in zip(a, b))
    towards = 0.5 + 0.5 * (x * SUN[0] + z * SUN[2]) / math.hypot(SUN[0], SUN[2]) / max(math.hypot(x, z), 1e-6)
    rose = mix((0.98, 0.47, 0.40), (1.60, 0.84, 0.38), towards)
    lilac, blue, zenith = (0.44, 0.32, 0.64), (0.13, 0.24, 0.58), (0.055, 0.12, 0.33)
    if y >= 0:
        color = mix(rose, lilac, y / 0.17)
        color = mix(color, blue, (y - 0.10) / 0.26)
        color = mix(color, zenith, (y - 0.32) / 0.60)
    else:
        color = mix(mix((0.26, 0.28, 0.50), (0.80, 0.50, 0.32), towards), (0.03, 0.07, 0.14), -y / 0.22)
    angle = math.degrees(math.acos(min(1.0, dot(direction, SUN))))
    disc = 1 / (1 + math.exp((angle - 9.0) / 0.6))
    glow = math.exp(-angle / 16)
    sun = 58.0 * disc + 0.8 * glow
    return tuple(0.8 * c + sun * w for c, w in zip(color, (1.0, 0.74, 0.46)))


def write_sky(path, width=256, height=128):
    def radiance(x, y):
        # The middle column looks along +x, columns run to the right: as shaders/lights/environment.glsl has it.
        phi, theta = 2 * math.pi * ((x + 0.5) / width - 0.5), math.pi * (y + 0.5) / height
        return sky((math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)))
    write_hdr(path, width, height, radiance)


def materials(gltf):
    """Name -> index of every material."""
    def texture(name, rows):
        return {"index": gltf.texture(gltf.image(name, png(len(rows[0]), len(rows), rows)))}

    base, orm, height = textures.terrazzo(
        512, 7, (0.72, 0.66, 0.58),
        [((0.62, 0.25, 0.17), 3), ((0.80, 0.50, 0.22), 2), ((0.10, 0.22, 0.21), 2.4), ((0.88, 0.85, 0.79), 2.4), ((0.16, 0.14, 0.14), 1.4)], 2.6)
    floor = {"baseColorTexture": texture("terrazzo colour", base),
             "metallicRoughnessTexture": texture("terrazzo roughness, metal", orm),
             "normalTexture": {**texture("terrazzo normals", textures.normal_map(512, height, 0.10)), "scale": 1.0}}
    plaster = texture("plaster normals", textures.normal_map(192, textures.plaster_height(192, 3), 5.0))
    grain, grain_height = textures.wood(256, 11, (0.42, 0.20, 0.085), (0.115, 0.045, 0.018))
    brushed_orm, brushed_height = textures.brushed(64, 128, 5)

    glass = lambda ior, color, distance: {
        "KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior},
        "KHR_materials_volume": {"thicknessFactor": 1.0, "attenuationColor": list(color), "attenuationDistance": distance}}
    add = gltf.material
    return {
        "floor": add("Terrazzo with brass strips", metallic=1.0, roughness=1.0, **floor),
        "wall": add("Coral plaster", (0.64, 0.265, 0.185), roughness=0.85, normalTexture={**plaster, "scale": 0.7}),
        "cream": add("Cream plaster", (0.80, 0.72, 0.60), roughness=0.7, normalTexture={**plaster, "scale": 0.45}),
        "sage": add("Sage lacquer", (0.20, 0.34, 0.27), roughness=0.38),
        "copper": add("Polished copper", (0.955, 0.52, 0.36), metallic=1.0, roughness=0.12),
        "gold": add("Polished gold", (1.0, 0.72, 0.32), metallic=1.0, roughness=0.06),
        "chrome": add("Chrome", (0.80, 0.81, 0.83), metallic=1.0, roughness=0.02),
        "steel": add("Brushed steel", (0.74, 0.73, 0.71), metallic=1.0, roughness=1.0,
                     metallicRoughnessTexture=texture("brushed roughness", brushed_orm),
                     normalTexture={**texture("brushed normals", textures.normal_map(128, brushed_height, 0.5)), "scale": 1.0}),
        "blue": add("Cobalt glaze", (0.020, 0.075, 0.30), roughness=0.10),
        "teal": add("Teal glaze", (0.02, 0.24, 0.24), roughness=0.22),
        "white": add("White glaze", (0.85, 0.82, 0.76), roughness=0.16),
        "wood": add("Oiled walnut", roughness=0.42, baseColorTexture=texture("walnut colour", grain),
                    normalTexture={**texture("walnut normals", textures.normal_map(256, grain_height, 0.8)), "scale": 0.6}),
        "glass": add("Clear glass", extensions=glass(1.5, (0.90, 0.97, 0.94), 1.2), roughness=0.0),
        "green": add("Bottle-green glass", extensions=glass(1.5, (0.42, 0.86, 0.66), 0.10), roughness=0.0),
        "amber": add("Amber gem", extensions=glass(1.72, (0.98, 0.42, 0.12), 0.22), roughness=0.0),
        "lamp": add("Soft box", (0, 0, 0), emissiveFactor=[1.0, 0.93, 0.84],
                    extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 3.0}}),
        "halo": add("Neon", (0, 0, 0), emissiveFactor=[1.0, 0.48, 0.16],
                    extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 2.6}}),
    }


def vase():
    """Solid of revolution with a wall of even thickness and a thick base."""
    outer = shapes.spline([(0.20, 0.02), (0.29, 0.14), (0.335, 0.36), (0.27, 0.62), (0.145, 0.84), (0.125, 0.98), (0.185, 1.13)], 6)
    wall = 0.028
    inner = shapes.spline([(0.185 - 2 * wall + 0.028, 1.13), (0.125 - wall, 0.98), (0.145 - wall, 0.84), (0.27 - wall, 0.62),
                           (0.335 - wall, 0.36), (0.285 - wall, 0.18), (0.19 - wall, 0.10), (0.08, 0.078)], 5)
    lip = shapes.arc((0.171, 1.13), 0.014, 0, 180, 6)
    return shapes.lathe([[(0.0, 0.0), (0.185, 0.0)], [(0.185, 0.0), (0.196, 0.006), (0.20, 0.02)],
                         outer[:-1] + lip + inner[1:] + [(0.04, 0.0765), (0.0, 0.076)]], 60)


def finial():
    """A turned top: foot, ball and long tapering spire."""
    return shapes.lathe([[(0.0, 0.0), (0.21, 0.0)], shapes.arc((0.21, 0.02), 0.02, -90, 90, 6),
                         shapes.spline([(0.21, 0.04), (0.10, 0.075), (0.075, 0.12), (0.17, 0.20), (0.215, 0.31), (0.17, 0.43),
                                        (0.07, 0.55), (0.035, 0.75), (0.012, 1.02), (0.0, 1.05)], 6)], 64, (1.0, 4.0))


def still_life(gltf, mat):
    def put(name, mesh, material, at=(0, 0, 0), solid=False, uvs=False, **more):
        if isinstance(mesh, Mesh):
            mesh = gltf.geometry(mesh, name, uvs, solid)
        gltf.node(name, mesh=gltf.mesh(name, mesh, mat[material]), translation=list(at), **more)
        return mesh

    put("Terrace", shapes.plane(-5.6, 6.4, -6.5, 5.5, uv_scale=1 / 1.8), "floor", uvs=True)
    put("Wall", shapes.arch_wall(-4.6, 2.05, 4.4, -0.25, 1.05, 1.35, 0.5, 0.03, 0.55), "wall", (0, 0, -1.95), uvs=True)
    put("Round plinth", shapes.drum(0.78, 0.24, 0.03, 80), "cream", (-0.92, 0, -0.35), uvs=True)
    put("Tall plinth", shapes.drum(0.43, 0.66, 0.025, 72), "sage", (0.86, 0, -0.62))
    put("Vase", vase(), "green", (-1.08, 0.2402, -0.45), solid=True)
    put("Knot", shapes.torus_knot(2, 3, 0.30, 0.115, 0.078, 224, 20), "copper", (0.86, 0.66 + 0.49, -0.62), solid=True,
        rotation=quaternion((0, 1, 0), 24))
    put("Column", shapes.twisted_column(0.20, 2.35, 4, 0.17, 0.75, 80, 48), "blue", (-2.12, 0, -1.15))
    put("Finial", finial(), "steel", (1.70, 0, -0.35), uvs=True)
    put("Walnut block", shapes.rounded_box((0.26, 0.26, 0.26), 0.035), "wood", (0.10, 0.26, 0.33), uvs=True,
        rotation=quaternion((0, 1, 0), 31))
    # Stands on the block, on its culet's facets: the cone of the pavilion rests along one side.
    lean = math.degrees(math.atan2(0.86 - 0.04, 1.0))
    put("Gem", shapes.gem(0.20), "amber", (0.74, 0.2 * 0.78, 0.47), solid=True, rotation=quaternion((0.35, 0, -1), 90 - lean))
    ball = put("Glass ball", shapes.sphere(0.25), "glass", (0.10, 0.52 + 0.2502, 0.33), solid=True)
    put("Gold ball", ball, "gold", (-0.52, 0.30, 0.68), scale=[1.2] * 3)
    put("Teal ball", ball, "teal", (-0.52, 0.24 + 0.135, -0.02), scale=[0.54] * 3)
    put("White ball", ball, "white", (1.22, 0.17, 0.22), scale=[0.68] * 3)
    put("Chrome ball", ball, "chrome", (0.20, 0.09, 0.86), scale=[0.36] * 3)
    put("Coral ball", ball, "wall", (-1.02, 0.08, 0.66), scale=[0.32] * 3)
    put("Pearl", ball, "white", (-0.78, 0.05, 0.93), scale=[0.2] * 3)
    halo = lambda u, v: ((0.56 + 0.022 * math.cos(2 * math.pi * v)) * math.cos(2 * math.pi * u),
                         (0.56 + 0.022 * math.cos(2 * math.pi * v)) * math.sin(2 * math.pi * u),
                         0.022 * math.sin(2 * math.pi * v))
    put("Halo", shapes.surface(halo, 72, 8, True, True), "halo", (-0.25, 1.45, -1.95), solid=True)
    # Soft box overhead and to the right, out of the picture, facing the group.
    light = shapes.plane(-0.9, 0.9, -0.6, 0.6)
    put("Soft box", light, "lamp", (2.6, 3.5, 1.5), rotation=quaternion((0.35, 0, 1), 180 - 42))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "demo")
    folder.mkdir(parents=True, exist_ok=True)
    gltf = Gltf("tests/data/make_demo.py")
    still_life(gltf, materials(gltf))
    gltf.camera("Front", (1.5, 1.66, 5.45), (0.0, 0.84, -0.35), 29.0)
    gltf.write_glb(folder / "demo.glb")
    write_sky(folder / "sky.hdr")
    sizes = ", ".join(f"{p.name} {p.stat().st_size / 1024:.0f} KiB" for p in sorted(folder.iterdir()))
    print(f"{gltf.triangle_count} triangles, {sizes}")


if __name__ == "__main__":
    main()
