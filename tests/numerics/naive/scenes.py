"""The scenes of pictures.py: each makes a glTF that shows one hard case and gives the options to render it with."""
import math
import pathlib
import random
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
DATA = ROOT / "tests/data"
sys.path.insert(0, str(DATA))
import shapes  # noqa: E402
from gltf_writer import Gltf, normalize, png  # noqa: E402

WHITE_SKY = ["--environment-kind", "constant", "--environment-color", "1", "1", "1"]
DUSK = ["--environment", str(DATA / "demo/sky.hdr")]
VIEW = ((0.4, 2.3, 5.2), (0.08, 0.6, 0), 32)  # of still_life
GLASS = {"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_volume": {"thicknessFactor": 1.0}}


def under_one_parent(gltf, **transform):
    """Puts everything under one node."""
    scene = gltf.json["scenes"][0]["nodes"]
    gltf.json["nodes"].append({"name": "All", "children": list(scene), **transform})
    scene[:] = [len(gltf.json["nodes"]) - 1]


def implicit(gltf, *kinds):
    gltf.json["extensionsUsed"] = sorted(set(gltf.json.get("extensionsUsed", [])) | {"KHR_implicit_shapes", "TILEFARM_shapes"})
    gltf.json["extensions"] = {"KHR_implicit_shapes": {"shapes": list(kinds)}, "TILEFARM_shapes": {"surfaces": []}}


def put(gltf, name, shape, material, **more):
    gltf.node(name, extensions={"TILEFARM_shapes": {"shape": shape, "material": material}}, **more)


def lamp(gltf, position, intensity, radius=None):
    gltf.json["extensionsUsed"] = sorted(set(gltf.json.get("extensionsUsed", [])) | {"KHR_lights_punctual", "TILEFARM_lights"})
    light = {"type": "point", "intensity": intensity}
    if radius:
        light["extensions"] = {"TILEFARM_lights": {"radius": radius}}
    gltf.json.setdefault("extensions", {})["KHR_lights_punctual"] = {"lights": [light]}
    gltf.node("Lamp", translation=list(position), extensions={"KHR_lights_punctual": {"light": 0}})


def still_life():
    """A knot and a ball on a floor."""
    gltf = Gltf("tests/numerics/naive/pictures.py")
    floor = gltf.material("Floor", (0.7, 0.7, 0.7))
    red, blue = gltf.material("Red", (0.75, 0.25, 0.15)), gltf.material("Blue", (0.2, 0.4, 0.75))
    gltf.node("Floor", mesh=gltf.mesh("Floor", gltf.geometry(shapes.plane(-8, 8, -8, 8), "Floor"), floor))
    knot = shapes.torus_knot(2, 3, 0.5, 0.22, 0.16, 120, 12)
    gltf.node("Knot", mesh=gltf.mesh("Knot", gltf.geometry(knot, "Knot", uvs=False), red), translation=[-0.75, 0.87, 0])
    gltf.node("Ball", mesh=gltf.mesh("Ball", gltf.geometry(shapes.sphere(0.6, 32, 16), "Ball"), blue), translation=[0.95, 0.6, 0.2])
    return gltf


def scaled(path, scale):
    gltf = still_life()
    gltf.camera("Camera", *VIEW)
    under_one_parent(gltf, scale=[scale] * 3)
    gltf.write_glb(path)
    return WHITE_SKY


def moved(path, distance):
    gltf = still_life()
    gltf.camera("Camera", *VIEW)
    under_one_parent(gltf, translation=[distance, distance, -distance])
    gltf.write_glb(path)
    return DUSK


def cracks(path):
    """From within a closed ball that glows a little, towards a vertex of it, through a very long lens; outside is white."""
    gltf = Gltf("tests/numerics/naive/pictures.py")
    inside = gltf.material("Inside", (0, 0, 0), emissiveFactor=[0.05, 0.12, 0.3], doubleSided=True)
    ball = shapes.sphere(2, 48, 24)
    gltf.node("Ball", mesh=gltf.mesh("Ball", gltf.geometry(ball, "Ball"), inside))
    vertex = next(p for p in ball.positions if p[0] > 1 and p[1] > 0.5 and p[2] > 0.5)
    gltf.camera("Camera", (0.31, -0.22, 0.17), vertex, 0.0002)
    gltf.write_glb(path)
    return WHITE_SKY


def thin_gap(path):
    gltf = Gltf("tests/numerics/naive/pictures.py")
    implicit(gltf, {"type": "sphere", "sphere": {"radius": 1}}, {"type": "sphere", "sphere": {"radius": 1 + 4e-5}})
    put(gltf, "Ball", 0, gltf.material("Red", (0.85, 0.1, 0.08)))
    put(gltf, "Glass", 1, gltf.material("Glass", (1, 1, 1), roughness=0.0, extensions=GLASS))
    gltf.camera("Camera", (0, 0.6, 4.2), (0, 0, 0), 32)
    gltf.write_glb(path)
    return WHITE_SKY


def far_ball(path):
    """A ball of radius 1, 20 km away, through a telescope."""
    gltf = Gltf("tests/numerics/naive/pictures.py")
    implicit(gltf, {"type": "sphere", "sphere": {"radius": 1}})
    put(gltf, "Ball", 0, gltf.material("Plastic", (0.7, 0.35, 0.1), roughness=0.3))
    gltf.camera("Camera", (0, 3e3, 2e4), (0, 0, 0), math.degrees(2.8 / 2.02e4))
    gltf.write_glb(path)
    return DUSK


def small_far_lamp(path):
    gltf = still_life()
    gltf.camera("Camera", *VIEW)
    lamp(gltf, (17, 32, 17), 6500, 5e-3)
    gltf.write_glb(path)
    return []


def steep_bumps(path):
    """A metal floor whose normal map has slopes up to 80°, seen at a grazing angle."""
    gltf = Gltf("tests/numerics/naive/pictures.py")
    size = 64
    steepest = math.tan(math.radians(80))

    def texel(x, y):
        a, b = 2 * math.pi * x / size, 2 * math.pi * y / size
        n = normalize((steepest * math.sin(a) * math.cos(b), steepest * math.cos(a) * math.sin(b), 1.0))
        return tuple(int(round(127.5 + 127.5 * c)) for c in n)

    bumps = gltf.texture(gltf.image("bumps", png(size, size, [[texel(x, y) for x in range(size)] for y in range(size)])))
    metal = gltf.material("Metal", (0.95, 0.8, 0.55), metallic=1.0, roughness=0.3, normalTexture={"index": bumps})
    gltf.node("Floor", mesh=gltf.mesh("Floor", gltf.geometry(shapes.plane(-40, 40, -40, 40, uv_scale=0.25), "Floor"), metal))
    gltf.camera("Camera", (0, 1.1, 12), (0, 0, 0), 14)
    gltf.write_glb(path)
    return DUSK


def tiny_highlight(path):
    """The highlight of a point lamp on a nearly polished floor, α = 1.001e-3, through a long lens."""
    gltf = Gltf("tests/numerics/naive/pictures.py")
    metal = gltf.material("Metal", (0.9, 0.8, 0.6), metallic=1.0, roughness=math.sqrt(1.001e-3))
    gltf.node("Floor", mesh=gltf.mesh("Floor", gltf.geometry(shapes.plane(-1, 1, -1, 1), "Floor"), metal))
    lamp(gltf, (0, 1, -1), 1.2e-5)
    gltf.camera("Camera", (0, 1, 1), (0, 0, 0), 0.2)
    gltf.write_glb(path)
    return []


def gem(path):
    gltf = still_life()
    del gltf.json["scenes"][0]["nodes"][1:]
    del gltf.json["nodes"][1:]
    glass = gltf.material("Glass", (1, 1, 1), roughness=0.0, extensions={**GLASS, "KHR_materials_ior": {"ior": 2.0}})
    gltf.node("Gem", mesh=gltf.mesh("Gem", gltf.geometry(shapes.gem(1.0), "Gem", uvs=False), glass), translation=[0, 0.9, 0])
    gltf.camera("Camera", (0.3, 2.0, 4.2), (0, 0.75, 0), 30)
    gltf.write_glb(path)
    return DUSK


def lamp_around(path):
    """A lamp of radius 4 that holds the whole still life: the floor is a disk within it."""
    gltf = still_life()
    lamp(gltf, (0, 1, 0), 50, 4.0)
    gltf.camera("Camera", (0.3, 1.9, 3.2), (0, 0.6, 0), 45)
    gltf.write_glb(path)
    return []


def plain(path):
    gltf = still_life()
    gltf.camera("Camera", *VIEW)
    gltf.write_glb(path)
    return DUSK
