#!/usr/bin/env python3
"""Writes flower.glb: a stem bent by a skin of three joints while its bud opens by a morph target, both animated.

    tests/data/make_animated.py [FOLDER]

Four seconds long and the same at its end as at its beginning. Made once by this script and kept, for tests and demos.
"""
import math
import pathlib
import struct
import sys

from gltf_writer import ARRAY, FLOAT, Gltf, Mesh, cross, length, normalize, quaternion, sub
from make_small import rectangle

SIDES, RINGS, HEIGHT = 20, 48, 1.5
JOINTS = (0.0, 0.5, 1.0)  # heights


def radius(height, open_):
    """Of stem and bud, a closed surface of revolution; `open_` 0 … 1 spreads the bud."""
    stem = 0.05 * (1 - 0.3 * height / HEIGHT)
    bud = max(0.0, (height - 1.05) / (HEIGHT - 1.05))
    spread = math.sin(math.pi * min(bud, 1.0)) if bud < 1 else 0.0
    return (stem * (1 - bud) + (0.13 + 0.22 * open_ * bud) * spread) if height < HEIGHT else 0.0


def lathe(open_):
    """Positions and smooth normals, ring after ring, poles at both ends."""
    rings = [HEIGHT * i / RINGS for i in range(RINGS + 1)]
    grid = [[(radius(h, open_) * (0.0 if i == 0 else 1.0) * math.cos(2 * math.pi * s / SIDES), h,
              radius(h, open_) * (0.0 if i == 0 else 1.0) * math.sin(2 * math.pi * s / SIDES))
             for s in range(SIDES + 1)] for i, h in enumerate(rings)]
    normals = []
    for i in range(RINGS + 1):
        for s in range(SIDES + 1):
            if i in (0, RINGS):
                normals.append((0.0, -1.0 if i == 0 else 1.0, 0.0))
                continue
            along = sub(grid[min(i + 1, RINGS)][s], grid[max(i - 1, 0)][s])
            around = sub(grid[i][(s + 1) % SIDES], grid[i][(s - 1) % SIDES])
            n = cross(along, around)
            normals.append(normalize(n) if length(n) > 0 else (math.cos(2 * math.pi * s / SIDES), 0.0, math.sin(2 * math.pi * s / SIDES)))
    return [p for ring in grid for p in ring], normals


def flower():
    mesh = Mesh()
    positions, normals = lathe(0.0)
    for p, n in zip(positions, normals):
        mesh.vertex(p, n, (p[0], p[1]))
    at = lambda i, s: i * (SIDES + 1) + s
    for i in range(RINGS):
        for s in range(SIDES):
            mesh.quad(at(i, s), at(i + 1, s), at(i + 1, s + 1), at(i, s + 1))
    return mesh


def weights_of(height):
    """The two joints that a point hangs between, and how much on each."""
    span = JOINTS[1] - JOINTS[0]
    x = min(max(height / span, 0.0), len(JOINTS) - 1.0)
    first = min(int(x), len(JOINTS) - 2)
    return (first, first + 1, 0, 0), (1 - (x - first), x - first, 0.0, 0.0)


def rows(gltf, values, kind, target=None):
    flat = [c for row in values for c in row] if kind != "SCALAR" else list(values)
    view = gltf._view(struct.pack(f"<{len(flat)}f", *flat), **({"target": target} if target else {}))
    accessor = {"bufferView": view, "componentType": FLOAT, "count": len(values), "type": kind}
    if kind == "SCALAR":
        stored = struct.unpack(f"<{len(flat)}f", struct.pack(f"<{len(flat)}f", *flat))
        accessor["min"], accessor["max"] = [min(stored)], [max(stored)]
    if kind == "VEC3":
        stored = [struct.unpack("<3f", struct.pack("<3f", *row)) for row in values]
        accessor["min"] = [min(r[i] for r in stored) for i in range(3)]
        accessor["max"] = [max(r[i] for r in stored) for i in range(3)]
    return gltf._push("accessors", accessor)


def joint_rows(gltf, values):
    view = gltf._view(b"".join(struct.pack("<4B", *row) for row in values), target=ARRAY)
    return gltf._push("accessors", {"bufferView": view, "componentType": 5121, "count": len(values), "type": "VEC4"})


def animated(path):
    gltf = Gltf("tests/data/make_animated.py")
    ground = gltf.material("Ground", (0.5, 0.45, 0.4))
    petal = gltf.material("Petal", (0.8, 0.12, 0.25), roughness=0.35)
    lamp = gltf.material("Lamp", (0, 0, 0), emissiveFactor=[1, 0.95, 0.85],
                         extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 30.0}})
    floor = rectangle((-3, 0, 3), (6, 0, 0), (0, 0, -6))
    gltf.node("Ground", mesh=gltf.mesh("Ground", gltf.geometry(floor, "Ground", uvs=False), ground))
    panel = rectangle((-2.2, 2.2, -0.4), (0.6, 0.6, 0), (0, 0, 0.8))
    gltf.node("Lamp", mesh=gltf.mesh("Lamp", gltf.geometry(panel, "Lamp", uvs=False), lamp))

    mesh = flower()
    primitive, triangles = gltf.geometry(mesh, "Flower", uvs=False)
    opened, opened_normals = lathe(1.0)
    primitive["attributes"]["JOINTS_0"] = joint_rows(gltf, [weights_of(p[1])[0] for p in mesh.positions])
    primitive["attributes"]["WEIGHTS_0"] = rows(gltf, [weights_of(p[1])[1] for p in mesh.positions], "VEC4", ARRAY)
    primitive["targets"] = [{
        "POSITION": rows(gltf, [sub(b, a) for a, b in zip(mesh.positions, opened)], "VEC3", ARRAY),
        "NORMAL": rows(gltf, [sub(b, a) for a, b in zip(mesh.normals, opened_normals)], "VEC3", ARRAY)}]
    index = gltf.mesh("Flower", (primitive, triangles), petal)
    gltf.json["meshes"][index]["weights"] = [0.0]

    # Joints in a chain, each half a metre above the last.
    joints = []
    for i, height in enumerate(JOINTS):
        joints.append(gltf._push("nodes", {"name": f"Joint {i}", "translation": [0, height - (JOINTS[i - 1] if i else 0), 0]}))
        if i:
            gltf.json["nodes"][joints[i - 1]]["children"] = [joints[i]]
    gltf.json["scenes"][0]["nodes"].append(joints[0])
    inverse = [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -h, 0, 1] for h in JOINTS]
    skin = gltf._push("skins", {"joints": joints, "skeleton": joints[0], "inverseBindMatrices": rows(gltf, inverse, "MAT4")})
    flower_node = len(gltf.json["nodes"])
    gltf.node("Flower", mesh=index, skin=skin)
    gltf.camera("Camera", (0.6, 1.2, 4.2), (0, 0.75, 0), 28.0)

    # Two sways to each opening and closing.
    times = [i * 0.25 for i in range(17)]
    clock = rows(gltf, times, "SCALAR")
    animation = {"name": "Sway and open", "samplers": [], "channels": []}

    def channel(node, path_, output, interpolation="LINEAR"):
        animation["samplers"].append({"input": clock, "output": output, "interpolation": interpolation})
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path_}})

    for i, joint in enumerate(joints):
        angles = [(8 + 10 * i) * math.sin(math.pi * t - 0.6 * i) for t in times]
        channel(joint, "rotation", rows(gltf, [quaternion((0, 0, 1), a) for a in angles], "VEC4"))
    channel(flower_node, "weights", rows(gltf, [0.5 - 0.5 * math.cos(math.pi * t / 2) for t in times], "SCALAR"))
    gltf.json["animations"] = [animation]
    gltf.write_glb(path)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    folder.mkdir(parents=True, exist_ok=True)
    animated(folder / "flower.glb")


if __name__ == "__main__":
    main()
