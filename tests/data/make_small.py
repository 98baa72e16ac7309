#!/usr/bin/env python3
"""Writes the small scenes that tests use: cornell.gltf, furnace.glb, mirrors.glb, tiny.gltf.

    tests/data/make_small.py [FOLDER]
"""
import pathlib
import sys

import shapes
from gltf_writer import Gltf, Mesh, png, quaternion


def rectangle(corner, u, v):
    """Two triangles; the outside is where u x v points."""
    mesh = Mesh()
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    corners = [corner, [c + a for c, a in zip(corner, u)], [c + a + b for c, a, b in zip(corner, u, v)],
               [c + b for c, b in zip(corner, v)]]
    mesh.quad(*(mesh.vertex(c, normal, uv) for c, uv in zip(corners, ((0, 1), (1, 1), (1, 0), (0, 0)))))
    return mesh


def box(width, height, depth):
    """Centred on the origin in x and z, on y = 0; flat faces."""
    x, z = width / 2, depth / 2
    mesh = Mesh()
    for corner, u, v in (((-x, 0, z), (width, 0, 0), (0, height, 0)), ((x, 0, -z), (-width, 0, 0), (0, height, 0)),
                         ((x, 0, z), (0, 0, -depth), (0, height, 0)), ((-x, 0, -z), (0, 0, depth), (0, height, 0)),
                         ((-x, height, z), (width, 0, 0), (0, 0, -depth)), ((-x, 0, -z), (width, 0, 0), (0, 0, depth))):
        mesh.append(rectangle(corner, u, v))
    return mesh


def cornell(path):
    """The box of Goral et al. 1984 on [-1, 1] x [0, 2] x [-1, 1], open to the camera: 36 triangles with its light."""
    gltf = Gltf("tests/data/make_small.py")
    white = gltf.material("White", (0.725, 0.71, 0.68))
    red = gltf.material("Red", (0.63, 0.065, 0.05))
    green = gltf.material("Green", (0.14, 0.45, 0.091))
    light = gltf.material("Light", (0, 0, 0), emissiveFactor=[1.0, 0.7059, 0.2353],
                          extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 17.0}})

    def put(name, mesh, material, solid=False, **more):
        gltf.node(name, mesh=gltf.mesh(name, gltf.geometry(mesh, name, uvs=False, solid=solid), material), **more)

    put("Floor", rectangle((-1, 0, 1), (2, 0, 0), (0, 0, -2)), white)
    put("Ceiling", rectangle((-1, 2, -1), (2, 0, 0), (0, 0, 2)), white)
    put("Back wall", rectangle((-1, 0, -1), (2, 0, 0), (0, 2, 0)), white)
    put("Left wall", rectangle((-1, 0, 1), (0, 0, -2), (0, 2, 0)), red)
    put("Right wall", rectangle((1, 0, -1), (0, 0, 2), (0, 2, 0)), green)
    put("Short block", box(0.6, 0.6, 0.6), white, solid=True, translation=[0.33, 0, 0.35], rotation=quaternion((0, 1, 0), -17))
    put("Tall block", box(0.6, 1.2, 0.6), white, solid=True, translation=[-0.33, 0, -0.29], rotation=quaternion((0, 1, 0), 18))
    put("Lamp", rectangle((-0.24, 1.98, -0.22), (0.47, 0, 0), (0, 0, 0.38)), light)
    gltf.camera("Camera", (0, 1, 3.9), (0, 1, 0), 39.3, aspect=1.0)
    assert gltf.triangle_count == 36, gltf.triangle_count
    gltf.write_gltf(path)


def furnace(path):
    """A unit sphere without light of its own: under a constant environment it shows its albedo."""
    gltf = Gltf("tests/data/make_small.py")
    ball = gltf.geometry(shapes.sphere(1.0, 64, 32), "Sphere", uvs=False, solid=True)
    gltf.node("Sphere", mesh=gltf.mesh("Sphere", ball, gltf.material("White", roughness=1.0)))
    gltf.camera("Camera", (0, 0, 4), (0, 0, 0), 40.0)
    gltf.write_glb(path)


def mirrors(path):
    """Two mirrors that face each other, and between them a ball on a floor and a row of small lamps, which the
    mirrors repeat until the bounce limit. With a lens focused on the ball the far lamps become its aperture's shape.
    docs/mirrors.png: 300 x 220 pixels, 64 samples, --max-bounces 4, 10 and 25, then 256 samples and --max-bounces 10
    --view-aperture-radius 0.05 --view-focus-distance 1.6 --view-blades 6."""
    gltf = Gltf("tests/data/make_small.py")
    silver = gltf.material("Silver", (0.95, 0.93, 0.9), metallic=1.0, roughness=0.0)
    floor = gltf.material("Floor", (0.4, 0.4, 0.42), roughness=0.8)
    ball = gltf.material("Ball", (0.75, 0.1, 0.08), roughness=0.25)
    colors = ((1.0, 0.3, 0.1), (0.2, 1.0, 0.3), (0.2, 0.4, 1.0))
    lamps = [gltf.material(f"Lamp {i}", (0, 0, 0), emissiveFactor=list(c),
                           extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 40.0}})
             for i, c in enumerate(colors)]

    def put(name, mesh, material, **more):
        gltf.node(name, mesh=gltf.mesh(name, gltf.geometry(mesh, name, uvs=False), material), **more)

    put("Near mirror", rectangle((2, 0, 1.5), (-4, 0, 0), (0, 2.5, 0)), silver)
    put("Far mirror", rectangle((-2, 0, -1.5), (4, 0, 0), (0, 2.5, 0)), silver)
    put("Floor", rectangle((-2, 0, 1.5), (4, 0, 0), (0, 0, -3)), floor)
    put("Ball", shapes.sphere(0.3, 48, 24), ball, translation=[0.35, 0.3, -0.2])
    panel = gltf.material("Panel", (0, 0, 0), emissiveFactor=[1, 1, 1],
                          extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 2.0}})
    put("Panel", rectangle((-1.5, 2.5, -1), (3, 0, 0), (0, 0, 2)), panel)
    for i, material in enumerate(lamps):
        put(f"Lamp {i}", shapes.sphere(0.02, 24, 12), material, translation=[-0.9 + 0.35 * i, 1.1 - 0.2 * i, -0.9])
    gltf.camera("Camera", (0.1, 0.9, 1.3), (-0.25, 0.75, -1.5), 55.0)
    gltf.write_glb(path)


def tiny(path):
    """One quad that shows a picture of 2 x 2 texels straight on, filling a square image; unlit, so that pixels
    are texels: red and green above blue and white."""
    gltf = Gltf("tests/data/make_small.py")
    picture = gltf.image("four", png(2, 2, [[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)]]))
    gltf._push("samplers", {"magFilter": 9728, "minFilter": 9728, "wrapS": 33071, "wrapT": 33071})
    material = gltf.material("Picture", extensions={"KHR_materials_unlit": {}},
                             baseColorTexture={"index": gltf.texture(picture)})
    quad = rectangle((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    gltf.node("Quad", mesh=gltf.mesh("Quad", gltf.geometry(quad, "Quad"), material))
    gltf._push("cameras", {"name": "Camera", "type": "orthographic",
                           "orthographic": {"xmag": 1.0, "ymag": 1.0, "znear": 0.01, "zfar": 10.0}})
    gltf.node("Camera", camera=0, translation=[0, 0, 2])
    gltf.write_gltf(path)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    folder.mkdir(parents=True, exist_ok=True)
    cornell(folder / "cornell.gltf")
    furnace(folder / "furnace.glb")
    mirrors(folder / "mirrors.glb")
    tiny(folder / "tiny.gltf")


if __name__ == "__main__":
    main()
