"""The scenes that compare_radiance.py renders twice: geometry and camera as glTF, and for each material the nodes that
make Cycles' model the same."""
import dataclasses
import json
import math
import pathlib
import struct
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
SHARED = ROOT.parent / "shared"
sys.path.append(str(ROOT / "tests/data"))
import make_small
import shapes
from gltf_writer import Gltf, write_hdr
from textures import to_srgb

GENERATOR = "tests/bench/radiance/scenes.py"
CAMERA = "Camera made"  # files may have a "Camera" of their own


@dataclasses.dataclass
class Comparison:
    name: str
    what: str                     # which model stands on either side
    scene: pathlib.Path
    materials: dict               # name or "*" -> recipe of in_blender.py
    environment: dict = None      # {"color"} or {"file", "rotation"}, and "intensity"; None: black
    lights: list = dataclasses.field(default_factory=list)  # as the job's JSON has them
    settings: dict = dataclasses.field(default_factory=dict)  # options of tilefarm-worker render
    bounces: int = 8              # surface scatterings
    camera: str = CAMERA          # the name of its node
    samples: int = 128            # of either program, per pixel
    # False: Cycles finds the environment by its BSDFs alone. Its Multiscatter GGX is not the same to light sampling: a
    # glass sphere of roughness 0.2 under the sky has 0.4582 ± 0.0001 with it, 0.4630 ± 0.0004 without; 0.4629 ± 0.0003 here.
    sample_environment: bool = True
    same: bool = True             # the models are the same; otherwise `why` explains what differs
    why: str = ""


# ---- Surroundings


def sky(folder):
    """Smooth, with a soft bright lobe on one side and another colour on each: shows turns and mirrorings."""
    width, height = 64, 32
    lobe = (0.6, 0.5, 0.62)

    def radiance(x, y):
        phi, theta = (2 * (x + 0.5) / width - 1) * math.pi, (y + 0.5) / height * math.pi
        d = (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
        sun = 12 * math.exp(12 * (sum(a * b for a, b in zip(d, lobe)) - 1))
        up, side = 0.5 + 0.5 * d[1], 0.5 + 0.5 * d[0]
        return (0.3 + 0.3 * side + sun, 0.35 + 0.2 * up + 0.8 * sun, 0.3 + 0.5 * up + 0.2 * (1 - side) + 0.55 * sun)

    path = folder / "sky.hdr"
    write_hdr(path, width, height, radiance)
    return {"file": str(path)}


def constant(folder, color):
    path = folder / ("constant_" + "_".join(f"{c:g}" for c in color) + ".hdr")
    write_hdr(path, 8, 4, lambda x, y: color)
    return {"file": str(path)}


def studio(folder):
    real = SHARED / "environments/brown_photostudio_02_1k.hdr"
    return {"file": str(real)} if real.exists() else sky(folder)


# ---- Materials on both sides


class Stage:
    """A floor, a camera and solids, each with a glTF material and the recipe that matches it."""

    def __init__(self, floor=(0.5, 0.45, 0.4)):
        self.gltf, self.recipes = Gltf(GENERATOR), {}
        self.camera = ((0, 2.3, 6.2), (0, 0.55, 0), 36.0)
        if floor:
            self.put("Floor", shapes.plane(-4, 4, -4, 4), self.matte("Floor", floor), solid=False)

    def matte(self, name, color, **more):
        """ior 1: no interface above the diffuse base."""
        self.recipes[name] = {"kind": "diffuse", "color": list(color)}
        return self.gltf.material(name, color, extensions={"KHR_materials_ior": {"ior": 1.0}}, **more)

    def light(self, name, radiance):
        peak = max(radiance)
        self.recipes[name] = {"kind": "emission", "color": [c / peak for c in radiance], "strength": peak}
        return self.gltf.material(name, (0, 0, 0), emissiveFactor=[c / peak for c in radiance], extensions={
            "KHR_materials_ior": {"ior": 1.0}, "KHR_materials_emissive_strength": {"emissiveStrength": peak}})

    def metal(self, name, color, roughness, extensions=None, **recipe):
        self.recipes[name] = {"kind": "glossy", "color": list(color), "roughness": roughness, **recipe}
        return self.gltf.material(name, color, metallic=1.0, roughness=roughness, extensions=extensions)

    def glass(self, name, ior, roughness=0.0, color=(1, 1, 1), distance=None, distribution="SHARP"):
        """A solid: absorption -ln(color) / distance, 1/m, inside it."""
        volume = {"thicknessFactor": 1.0}
        absorption = [0, 0, 0]
        if distance:
            volume.update(attenuationColor=list(color), attenuationDistance=distance)
            absorption = [-math.log(c) / distance for c in color]
        self.recipes[name] = {"kind": "glass", "ior": ior, "roughness": roughness, "absorption": absorption,
                              "distribution": distribution}
        return self.gltf.material(name, roughness=roughness, extensions={
            "KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior},
            "KHR_materials_volume": volume})

    def put(self, name, mesh, material, at=(0, 0, 0), uvs=False, solid=True, **more):
        self.gltf.node(name, mesh=self.gltf.mesh(name, self.gltf.geometry(mesh, name, uvs=uvs, solid=solid), material),
                       translation=list(at), **more)

    def spheres(self, materials, radius=0.62, y=None):
        ball = shapes.sphere(radius, 128, 64, uv_scale=(1, 1))
        step = 2.25 * radius
        for i, material in enumerate(materials):
            x = step * (i - (len(materials) - 1) / 2)
            self.put(f"Ball {i}", ball, material, (x, radius + 0.02 if y is None else y, 0), uvs=True)

    def write(self, folder, name):
        self.gltf.camera(CAMERA, *self.camera, aspect=1.0)
        path = folder / f"{name}.glb"
        self.gltf.write_glb(path)
        return path


def read_gltf(path):
    """JSON and binary chunk."""
    data = path.read_bytes()
    if data[:4] != b"glTF":
        return json.loads(data), b""
    size, = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + size]), data[28 + size:]


def write_gltf(path, document, binary, source):
    text = json.dumps(document).encode()
    if binary:
        text += b" " * (-len(text) % 4)
        text = (struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A) + text +
                struct.pack("<II", len(binary), 0x004E4942) + binary)
    path.write_bytes(text)
    for part in document["buffers"] + document.get("images", []):
        if "uri" in part and not part["uri"].startswith("data:"):
            (path.parent / part["uri"]).write_bytes((source.parent / part["uri"]).read_bytes())


def add_camera(document, eye, target, yfov_degrees, aspect=1.0, half_height=None):
    """`half_height` in metres makes it orthographic."""
    made = Gltf(GENERATOR)
    made.camera(CAMERA, eye, target, yfov_degrees, aspect=aspect)
    if half_height:
        made.json["cameras"][0] = {"type": "orthographic", "orthographic": {
            "xmag": half_height * aspect, "ymag": half_height, "znear": 0.01, "zfar": 1000}}
    document.setdefault("cameras", []).append(made.json["cameras"][0])
    document["nodes"].append({**made.json["nodes"][0], "camera": len(document["cameras"]) - 1})
    document["scenes"][document.get("scene", 0)]["nodes"].append(len(document["nodes"]) - 1)


def with_camera(source, target, camera, **more):
    document, binary = read_gltf(source)
    add_camera(document, *camera, **more)
    write_gltf(target, document, binary, source)
    return target


def matte_of(material, name):
    """Turns a material of glTF into a matte one of its base colour factor or a plain light. Gives the recipe."""
    factor = material.get("pbrMetallicRoughness", {}).get("baseColorFactor", [0.8, 0.8, 0.8, 1.0])[:3]
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
    emissive = material.get("emissiveFactor", [0, 0, 0])
    material.clear()
    material.update(name=name, doubleSided=True, extensions={"KHR_materials_ior": {"ior": 1.0}},
                    pbrMetallicRoughness={"metallicFactor": 0.0, "roughnessFactor": 1.0, "baseColorFactor": [*factor, 1.0]})
    if not any(emissive):
        return {"kind": "diffuse", "color": factor}
    material["pbrMetallicRoughness"]["baseColorFactor"] = [0, 0, 0, 1]
    material.update(emissiveFactor=emissive, doubleSided=False)
    material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
    return {"kind": "emission", "color": emissive, "strength": strength}


def as_matte(source, target, camera=None):
    """A copy of a glTF file whose materials are matte, lights aside. Gives the recipes."""
    document, binary = read_gltf(source)
    recipes = {f"material {i}": matte_of(material, f"material {i}") for i, material in enumerate(document["materials"])}
    document["extensionsUsed"] = sorted(set(document.get("extensionsUsed", [])) |
                                        {"KHR_materials_ior", "KHR_materials_emissive_strength"})
    for mesh in document["meshes"]:  # vertex colours are not the subject
        for primitive in mesh["primitives"]:
            primitive["attributes"].pop("COLOR_0", None)
    for key in ("textures", "images", "samplers"):
        document.pop(key, None)
    if camera:
        add_camera(document, *camera)
    write_gltf(target, document, binary, source)
    return recipes


# ---- Matte


def cornell(folder):
    plain = folder / "cornell_plain.gltf"
    make_small.cornell(plain)
    path = folder / "cornell.gltf"
    return Comparison("cornell", "Lambert, emissive triangles | Diffuse BSDF, Emission", path, as_matte(plain, path),
                      samples=192, camera="Camera")


def matte_sky(folder):
    stage = Stage()
    for i, color in enumerate(((0.8, 0.8, 0.8), (0.7, 0.15, 0.1), (0.1, 0.25, 0.7))):
        material = stage.matte(f"Matte {i}", color)
        if i == 1:
            stage.put("Knot", shapes.torus_knot(2, 3, 0.4, 0.2, 0.13, 192, 24), material, (0, 0.82, 0))
        else:
            stage.put(f"Ball {i}", shapes.sphere(0.6, 96, 48), material, (1.5 * (i - 1), 0.62, 0))
    return Comparison("matte-sky", "Lambert, HDR environment | Diffuse BSDF, Environment Texture",
                      stage.write(folder, "matte-sky"), stage.recipes, sky(folder))


def matte_turned_sky(folder):
    result = matte_sky(folder)
    turned = {**result.environment, "rotation": 70.0, "intensity": 1.5}
    return dataclasses.replace(result, name="matte-turned-sky", environment=turned,
                               what="the same, environment turned by 70 degrees at 1.5 times its intensity")


def cutout(folder):
    """Nearest texels: Cycles blends 8-bit texels before it decodes sRGB, Tilefarm afterwards."""
    stage, size = Stage(), 32
    rows = [[(to_srgb(0.15 + 0.7 * x / size), to_srgb(0.8 - 0.6 * y / size), to_srgb(0.2 + 0.5 * ((x ^ y) & 7) / 7))
             for x in range(size)] for y in range(size)]
    image = stage.gltf.image("picture", png_alpha(rows, lambda x, y: 255 if ((x // 4) + (y // 4)) % 3 else 40))
    stage.gltf._push("samplers", {"magFilter": 9728, "minFilter": 9728, "wrapS": 10497, "wrapT": 10497})
    material = stage.gltf.material("Leaf", extensions={"KHR_materials_ior": {"ior": 1.0}}, alphaMode="MASK",
                                   alphaCutoff=0.5, doubleSided=True,
                                   baseColorTexture={"index": stage.gltf.texture(image)})
    stage.recipes["Leaf"] = {"kind": "diffuse", "textured": True, "cutoff": 0.5}
    for i in range(3):
        stage.put(f"Leaf {i}", make_small.rectangle((-0.8, 0, 0), (1.6, 0, 0), (0, 1.6, 0)), material,
                  (-0.9 + 0.9 * i, 0.05, 0.7 - 0.7 * i), uvs=True, solid=False)
    return Comparison("cutout", "textured Lambert, alpha mask | Diffuse BSDF and Transparent BSDF by the texture",
                      stage.write(folder, "cutout"), stage.recipes, sky(folder))


def blend(folder):
    stage = Stage()
    for i, alpha in enumerate((0.25, 0.5, 0.75)):
        name = f"Veil {i}"
        material = stage.matte(name, (0.8, 0.3, 0.2), alphaMode="BLEND", doubleSided=True)
        stage.gltf.json["materials"][material]["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha
        stage.recipes[name]["alpha"] = alpha
        stage.put(name, shapes.sphere(0.6, 96, 48), material, (1.4 * (i - 1), 0.62, 0))
    return Comparison("blend", "Lambert with alpha 0.25, 0.5, 0.75 | Diffuse BSDF and Transparent BSDF mixed",
                      stage.write(folder, "blend"), stage.recipes, sky(folder))


# ---- Lights on a matte scene


def lit(folder, name, what, lights, **more):
    stage = Stage()
    stage.put("Ball", shapes.sphere(0.6, 96, 48), stage.matte("Ball", (0.75, 0.7, 0.6)), (-0.8, 0.62, 0))
    stage.put("Box", make_small.box(0.9, 0.9, 0.9), stage.matte("Box", (0.3, 0.5, 0.75)), (0.8, 0.02, 0.1))
    return Comparison(name, what, stage.write(folder, name), stage.recipes, None, lights, **more)


def point(folder):
    return lit(folder, "point", "point light of 20 W/sr | lamp of 20 * 4 pi W", [
        {"kind": "point", "position": [1.2, 2.6, 1.6], "color": [1.0, 0.8, 0.6], "intensity": 20.0}])


def spot(folder):
    return lit(folder, "spot", "spot with a sharp edge, 40 W/sr | the same of 40 * 4 pi W", [
        {"kind": "spot", "position": [-2.0, 3.0, 2.0], "direction": [2.0, -2.6, -2.0], "color": [0.7, 0.9, 1.0],
         "intensity": 40.0, "innerCone": 21.999, "outerCone": 22.0}])


def directional(folder):
    return lit(folder, "directional", "parallel light of 3 W/m^2 | sun of strength 3, angle 0", [
        {"kind": "directional", "direction": [-1.0, -1.5, -0.7], "color": [1.0, 0.95, 0.8], "intensity": 3.0}])


def sun(folder):
    return lit(folder, "sun", "parallel light of 3 W/m^2, 8 degrees across | sun of strength 3, angle 8 degrees", [
        {"kind": "directional", "direction": [-1.0, -1.5, -0.7], "color": [1.0, 0.95, 0.8], "intensity": 3.0,
         "angularDiameter": 8.0}])


def quad(folder):
    return lit(folder, "quad", "quad light of radiance 6 | area lamp of 4 A 6 W, unseen by the camera", [
        {"kind": "quad", "position": [1.5, 2.8, 1.0], "direction": [-1.5, -2.3, -1.0], "color": [1.0, 0.8, 0.6],
         "intensity": 6.0, "width": 1.2, "height": 0.8}])


def sphere(folder):
    return lit(folder, "sphere", "sphere light of radiance 20 in view, radius 0.3 m | emissive sphere of 65,000 triangles", [
        {"kind": "sphere", "position": [1.3, 1.9, 0.6], "color": [0.9, 1.0, 0.7], "intensity": 20.0, "radius": 0.3}])


# ---- Metal


def metal_smooth(folder):
    stage = Stage()
    stage.spheres([stage.metal("Gold", (1.0, 0.766, 0.336), 0.0, schlick=True, distribution="SHARP"),
                   stage.metal("Copper", (0.955, 0.637, 0.538), 0.0, schlick=True, distribution="SHARP"),
                   stage.metal("Iron", (0.56, 0.57, 0.58), 0.0, schlick=True, distribution="SHARP")])
    return Comparison("metal-smooth", "smooth metal, Schlick | sharp Glossy BSDF, Schlick by nodes",
                      stage.write(folder, "metal-smooth"), stage.recipes, sky(folder))


def metal_single(folder):
    stage = Stage()
    stage.spheres([stage.metal(f"White {r}", (1, 1, 1), r) for r in (0.15, 0.3, 0.45)])
    return Comparison("metal-ggx", "white metal, GGX, no energy compensation, roughness 0.15, 0.3, 0.45 | Glossy BSDF, GGX",
                      stage.write(folder, "metal-ggx"), stage.recipes, sky(folder), settings={"energyCompensation": False})


def metal_compensated(folder, name, roughnesses, **more):
    stage = Stage()
    stage.spheres([stage.metal(f"White {r}", (1, 1, 1), r, distribution="MULTI_GGX") for r in roughnesses])
    return Comparison(name, f"white metal, GGX with energy compensation, roughness {', '.join(map(str, roughnesses))} | "
                      "Glossy BSDF, Multiscatter GGX (Heitz et al. 2016)", stage.write(folder, name), stage.recipes,
                      sky(folder), sample_environment=False, **more)


def metal_multi(folder):
    return metal_compensated(folder, "metal-multi", (0.15, 0.3, 0.45))


# ---- Glass


def glass_smooth(folder):
    stage = Stage()
    stage.spheres([stage.glass("Clear", 1.5), stage.glass("Amber", 1.33, color=(0.9, 0.5, 0.15), distance=0.6),
                   stage.glass("Flint", 1.8, color=(0.5, 0.8, 0.7), distance=0.4)])
    return Comparison("glass-smooth", "smooth solid glass, ior 1.5, 1.33, 1.8, Beer-Lambert | sharp Glass BSDF, Volume "
                      "Absorption", stage.write(folder, "glass-smooth"), stage.recipes, sky(folder), bounces=16,
                      samples=256)


def glass_thin(folder):
    stage, materials = Stage(), []
    for i, (ior, color) in enumerate(((1.5, (0.9, 0.6, 0.3)), (2.0, (0.4, 0.8, 0.9)))):
        name = f"Sheet {i}"
        materials.append(stage.gltf.material(name, color, roughness=0.0, doubleSided=True, extensions={
            "KHR_materials_ior": {"ior": ior}, "KHR_materials_transmission": {"transmissionFactor": 1.0}}))
        stage.recipes[name] = {"kind": "thin", "ior": ior, "color": color}
    stage.spheres(materials, radius=0.7)
    return Comparison("glass-thin", "thin-walled glass, tinted, ior 1.5 and 2 | Transparent BSDF and sharp Glossy BSDF mixed "
                      "by the Fresnel node", stage.write(folder, "glass-thin"), stage.recipes, sky(folder), bounces=24)


def glass_constant(folder):
    stage = Stage(floor=None)
    stage.camera = ((0, 0.6, 6.2), (0, 0.6, 0), 36.0)
    stage.spheres([stage.glass("Amber", 1.5, color=(0.9, 0.5, 0.15), distance=0.6),
                   stage.glass("Rough", 1.5, 0.5, distribution="MULTI_GGX", color=(0.4, 0.7, 0.9), distance=0.5),
                   stage.glass("Flint", 1.8, color=(0.5, 0.8, 0.7), distance=0.4)])
    return Comparison("glass-constant", "absorbing glass, the middle one rough, under a constant environment | Glass BSDF "
                      "(Multiscatter GGX), Volume Absorption", stage.write(folder, "glass-constant"), stage.recipes,
                      constant(folder, (1.0, 1.0, 1.0)), bounces=24)


def glass_compensated(folder, name, roughnesses, **more):
    stage = Stage()
    stage.spheres([stage.glass(f"Rough {r}", 1.5, r, distribution="MULTI_GGX") for r in roughnesses])
    return Comparison(name, f"rough glass with energy compensation, roughness {', '.join(map(str, roughnesses))} | Glass "
                      "BSDF, Multiscatter GGX", stage.write(folder, name), stage.recipes, sky(folder), bounces=16,
                      samples=256, sample_environment=False, **more)


def glass_rough(folder):
    return glass_compensated(folder, "glass-rough", (0.1, 0.15, 0.2))


# ---- Beside GGX and Lambert


def oren_nayar(folder):
    stage = Stage()
    materials = []
    for sigma in (0.2, 0.5, 1.0):
        name = f"Chalk {sigma}"
        materials.append(stage.matte(name, (0.8, 0.75, 0.7)))
        stage.gltf.json["materials"][materials[-1]]["extensions"]["TILEFARM_materials"] = {"orenNayarSigma": sigma}
        stage.recipes[name]["sigma"] = sigma
    stage.gltf.json["extensionsUsed"] = sorted({*stage.gltf.json["extensionsUsed"], "TILEFARM_materials"})
    stage.spheres(materials)
    return Comparison("oren-nayar", "Oren-Nayar, sigma 0.2, 0.5, 1 | Diffuse BSDF of roughness 0.2, 0.5, 1",
                      stage.write(folder, "oren-nayar"), stage.recipes, sky(folder), same=False,
                      why="Cycles has Fujii's fit, A = 1 / (pi + (pi/2 - 2/3) s) and B = s A with s in 0 ... 1; Tilefarm the "
                      "qualitative model of Oren and Nayar 1994 with sigma in radians")


def translucent(folder):
    stage = Stage()
    materials = []
    for share in (0.3, 0.6, 1.0):
        name, color, through = f"Leaf {share}", (0.7, 0.6, 0.4), (0.4, 0.8, 0.3)
        materials.append(stage.gltf.material(name, color, doubleSided=True, extensions={
            "KHR_materials_ior": {"ior": 1.0}, "KHR_materials_diffuse_transmission": {
                "diffuseTransmissionFactor": share, "diffuseTransmissionColorFactor": list(through)}}))
        stage.recipes[name] = {"kind": "translucent", "color": color, "through": through, "share": share}
    for i, material in enumerate(materials):
        stage.put(f"Leaf {i}", make_small.rectangle((-0.7, 0, 0), (1.4, 0, 0), (0, 1.4, 0)), material,
                  (1.1 * (i - 1), 0.05, 0.3 * (i - 1)), solid=False)
    return Comparison("translucent", "diffuse transmission 0.3, 0.6, 1 | Diffuse and Translucent BSDF mixed",
                      stage.write(folder, "translucent"), stage.recipes, sky(folder))


def dielectric(folder):
    """The specular lobe of Principled alone: exact Fresnel at the microfacet."""
    stage, materials = Stage(), []
    for r in (0.1, 0.3, 0.5):
        name = f"Black {r}"
        materials.append(stage.gltf.material(name, (0, 0, 0), roughness=r))
        stage.recipes[name] = {"kind": "principled", "inputs": {"Base Color": [0, 0, 0], "Roughness": r, "Specular": 0.5}}
    stage.spheres(materials)
    return Comparison("dielectric", "black dielectric, ior 1.5, GGX, roughness 0.1, 0.3, 0.5, no energy compensation | "
                      "Principled BSDF, black", stage.write(folder, "dielectric"), stage.recipes, sky(folder),
                      settings={"energyCompensation": False})


def anisotropic(folder):
    """Cycles: alpha_x = r^2 (1 - a), alpha_y = r^2 / (1 - a) for a >= 0; glTF: alpha_t = mix(alpha, 1, s^2), alpha_b =
    alpha. Along Cycles' tangent, turned by a quarter, lies glTF's bitangent."""
    stage, materials = Stage(), []
    for roughness, strength in ((0.2, 0.3), (0.3, 0.5), (0.4, 0.6)):
        name, alpha = f"Brushed {strength}", roughness**2
        along, across = alpha + (1 - alpha) * strength**2, alpha
        materials.append(stage.metal(name, (1, 1, 1), roughness, {"KHR_materials_anisotropy": {
            "anisotropyStrength": strength}}))
        stage.recipes[name].update(roughness=math.sqrt(math.sqrt(along * across)),
                                   anisotropy=1 - math.sqrt(across / along), rotation=0.25)
    stage.spheres(materials)
    return Comparison("anisotropic", "white anisotropic GGX, no energy compensation | Anisotropic BSDF, GGX",
                      stage.write(folder, "anisotropic"), stage.recipes, sky(folder),
                      settings={"energyCompensation": False})


# ---- Scenes of others


def shared_cornell(folder):
    source = SHARED / "scenes/cornell-box/CornellBox.glb"
    if not source.exists():
        return None
    path = folder / "shared-cornell.glb"
    recipes = as_matte(source, path, camera=((-278, 273, 800), (-278, 273, -280), 39.0))
    return Comparison("shared-cornell", "Bevy's Cornell box, hundreds of metres wide, all matte | Diffuse BSDF", path,
                      recipes, samples=192)


def shared_dragon(folder):
    source = SHARED / "scenes/chinese-dragon/chinesedragon.gltf"
    if not source.exists():
        return None
    path = folder / "shared-dragon.gltf"
    recipes = as_matte(source, path, camera=((2.4, 0.9, 4.4), (0, 0.2, 0), 36.0))
    return Comparison("shared-dragon", "a scanned dragon of 100,000 triangles, matte, studio light | Diffuse BSDF", path,
                      recipes, studio(folder))


# ---- Other models: the difference is explained, not judged


def metal_rough(folder):
    stage = Stage()
    stage.spheres([stage.metal(f"White {r}", (1, 1, 1), r) for r in (0.6, 0.8, 1.0)])
    return Comparison("metal-rough", "white metal, GGX, no energy compensation, roughness 0.6, 0.8, 1 | Glossy BSDF, GGX",
                      stage.write(folder, "metal-rough"), stage.recipes, sky(folder), settings={"energyCompensation": False},
                      same=False, why="Cycles 3.4 masks and shadows independently, G1(wo) G1(wi); Tilefarm uses the "
                      "height-correlated form, which loses less: a sphere of roughness 1 in a white "
                      "furnace shows 0.408 here and 0.377 there, the integrals of the two formulas (0.408, 0.376)")


SHAPE = ("the light that facets scatter more than once comes back in a wide lobe here (Kulla, Conty 2017), in Heitz's walk "
         "nearer to the mirror's direction; the energy is the same, as the white and the absorbing furnace show")


def metal_multi_rough(folder):
    return metal_compensated(folder, "metal-multi-rough", (0.6, 0.8, 1.0), same=False, why=SHAPE)


def glass_rougher(folder):
    return glass_compensated(folder, "glass-rougher", (0.3, 0.5, 0.7), same=False, why=SHAPE)


def gold_rough(folder):
    stage, color = Stage(), (1.0, 0.766, 0.336)
    materials = []
    for r in (0.3, 0.6):
        materials.append(stage.metal(f"Gold {r}", color, r))
        stage.recipes[f"Gold {r}"] = {"kind": "principled", "distribution": "MULTI_GGX", "inputs": {
            "Base Color": color, "Metallic": 1.0, "Roughness": r}}
    stage.spheres(materials, radius=0.7)
    return Comparison("gold-rough", "rough gold, Schlick, energy compensation | Principled BSDF, Multiscatter GGX",
                      stage.write(folder, "gold-rough"), stage.recipes, sky(folder), same=False,
                      sample_environment=False,
                      why="the Principled BSDF interpolates between base colour and white by the exact Fresnel curve of an "
                      "index of 1.5, glTF by Schlick's")


def plastic(folder):
    stage, materials = Stage(), []
    for r in (0.1, 0.4, 0.8):
        name, color = f"Plastic {r}", (0.8, 0.2, 0.1)
        materials.append(stage.gltf.material(name, color, roughness=r))
        stage.recipes[name] = {"kind": "principled", "inputs": {"Base Color": color, "Roughness": r, "Specular": 0.5}}
    stage.spheres(materials)
    return Comparison("plastic", "dielectric over Lambert, ior 1.5, roughness 0.1, 0.4, 0.8 | Principled BSDF",
                      stage.write(folder, "plastic"), stage.recipes, sky(folder), same=False,
                      why="Principled adds its specular lobe to a Burley diffuse one that is not dimmed by it; here the "
                      "base gets what the interface lets through")


def clearcoat(folder):
    stage, materials = Stage(), []
    for coat in (0.25, 1.0):
        name, color = f"Coat {coat}", (0.1, 0.3, 0.7)
        materials.append(stage.gltf.material(name, color, extensions={
            "KHR_materials_ior": {"ior": 1.0}, "KHR_materials_clearcoat": {
                "clearcoatFactor": coat, "clearcoatRoughnessFactor": 0.1}}))
        stage.recipes[name] = {"kind": "principled", "inputs": {
            "Base Color": color, "Roughness": 1.0, "Specular": 0.0, "Clearcoat": coat, "Clearcoat Roughness": 0.1}}
    stage.spheres(materials, radius=0.7)
    return Comparison("clearcoat", "clearcoat 0.25 and 1, roughness 0.1, over Lambert | Principled BSDF",
                      stage.write(folder, "clearcoat"), stage.recipes, sky(folder), same=False,
                      why="Cycles' clearcoat is Disney's: a quarter of the weight, GTR1, masking of roughness 0.25, and "
                      "nothing taken from the layers below")


def sheen(folder):
    stage, materials = Stage(), []
    for r in (0.3, 0.7):
        name, color = f"Cloth {r}", (0.4, 0.1, 0.1)
        materials.append(stage.gltf.material(name, color, extensions={
            "KHR_materials_ior": {"ior": 1.0}, "KHR_materials_sheen": {
                "sheenColorFactor": [0.8, 0.8, 0.8], "sheenRoughnessFactor": r}}))
        stage.recipes[name] = {"kind": "principled", "inputs": {
            "Base Color": color, "Roughness": 1.0, "Specular": 0.0, "Sheen": 0.8, "Sheen Tint": 0.0}}
    stage.spheres(materials, radius=0.7)
    return Comparison("sheen", "sheen (Charlie) of 0.8, roughness 0.3 and 0.7, over Lambert | Principled BSDF",
                      stage.write(folder, "sheen"), stage.recipes, sky(folder), same=False,
                      why="Cycles' sheen is Burley's (1 - cos)^5 without roughness and added to the base; glTF's is "
                      "Charlie's distribution of fibres, and the base is dimmed below it")


def helmet(folder):
    source = SHARED / "scenes/damaged-helmet/DamagedHelmet.glb"
    if not source.exists():
        return None
    path = with_camera(source, folder / "helmet.glb", ((1.7, 0.9, 2.9), (0, 0, 0), 40.0))
    return Comparison("helmet", "DamagedHelmet as glTF has it | as Blender imports it: Principled BSDF", path,
                      {"*": {"kind": "imported"}}, studio(folder), same=False,
                      why="Burley diffuse that is not dimmed by the specular lobe, single-scattering GGX with independent "
                      "masking, 8-bit texels blended before they are decoded")


def png_alpha(rows, alpha):
    """8-bit RGBA PNG."""
    import zlib
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + bytes(c for x, pixel in enumerate(row) for c in (*pixel, alpha(x, y)))
                   for y, row in enumerate(rows))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


SCENES = [cornell, matte_sky, matte_turned_sky, cutout, blend, translucent, point, spot, directional, sun, quad, sphere,
          metal_smooth, metal_single, metal_multi, anisotropic, dielectric, glass_smooth, glass_thin, glass_constant,
          glass_rough, shared_cornell, shared_dragon,
          oren_nayar, metal_rough, metal_multi_rough, glass_rougher, gold_rough, plastic, clearcoat, sheen, helmet]
