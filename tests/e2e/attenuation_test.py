"""Khronos' AttenuationTest: five columns of glass, the same transmittance five times over in each.

The rows get it from a tint (a flat sheet), from the size of the mesh, from one mesh that holds all sizes with a thickness
texture, from the scale of the node, and from the attenuation distance. Thickness itself says nothing to a path tracer,
which measures the way through the solid. Cubes are looked through squarely, before a backdrop that shines on its own, so
that what is seen has a closed form:

    sheet    tint * (1 - F)                     the glTF sheet is one interface (KHR_materials_transmission)
    solid    (1 - F)^2 t / (1 - F^2 t^2)        two interfaces and all reflections between them

with t = attenuationColor^(thickness / attenuationDistance) and F = ((ior - 1) / (ior + 1))^2. With an index of 1 all five
rows must look alike.
"""
import json
import math
import shutil
import sys
import unittest

from farm import ROOT, SHARED, FarmTest

sys.path.append(str(ROOT / "tests/support"))
from exr_image import Exr

SCENE = SHARED / "scenes/khronos-16_volume"
COLOR = (0.1, 0.5, 0.9)
COLUMNS = {0.25: -3.5, 0.5: -2.0, 1.0: 0.0, 1.5: 2.5, 2.0: 6.0}  # metres of glass -> x
ROWS = {"sample colour": 6.0, "thickness factor": 3.0, "thickness texture": 0.0, "node scale": -3.0,
        "attenuation distance": -6.0}
WIDTH, HEIGHT, PIXEL = 3, 282, 0.05  # a column's picture in pixels, and the metres of one: the least cube has 5
TOLERANCE = 0.01


def prepared(folder, ior):
    """A copy seen squarely by an orthographic camera, with a backdrop of radiance 1 and nothing else that shines."""
    shutil.copytree(SCENE, folder, dirs_exist_ok=True, copy_function=shutil.copyfile)
    path = folder / "16_volume.gltf"
    path.chmod(0o644)
    scene = json.loads(path.read_text())
    for material in scene["materials"]:
        if material["name"] == "FlatBackdrop":
            material["pbrMetallicRoughness"] = {"baseColorFactor": [1, 1, 1, 1]}
            material["extensions"] = {"KHR_materials_unlit": {}}
        elif "extensions" in material:
            material["extensions"]["KHR_materials_ior"] = {"ior": ior}
    scene["extensionsUsed"] += ["KHR_materials_unlit", "KHR_materials_ior"]
    labels = next(i for i, node in enumerate(scene["nodes"]) if node["name"] == "Labels")
    scene["scenes"][0]["nodes"].remove(labels)
    half = [WIDTH * PIXEL / 2, HEIGHT * PIXEL / 2]
    scene["cameras"] = [{"type": "orthographic",
                         "orthographic": {"xmag": half[0], "ymag": half[1], "znear": 0.01, "zfar": 100}}]
    for depth, x in COLUMNS.items():
        scene["scenes"][0]["nodes"].append(len(scene["nodes"]))
        scene["nodes"].append({"name": f"Column {depth}", "camera": 0, "translation": [x, 0, 10]})
    path.write_text(json.dumps(scene))
    return path


def patch(picture, y):
    """Mean colour of 3 x 3 pixels in the middle of a cube, and its standard error."""
    row = round(HEIGHT / 2 - y / PIXEL)
    box = (0, row - 1, WIDTH, row + 2)
    return [(picture.mean(c, *box), math.sqrt(picture.mean(f"variance.{c}", *box) / 9)) for c in "RGB"]


@unittest.skipUnless(SCENE.exists(), "no shared data")
class Columns(FarmTest):
    def measured(self, ior):
        scene, found = prepared(self.folder / "scene", ior), {}
        for depth in COLUMNS:
            # (An unlit backdrop is no light, so that the glass would mirror the default one.)
            exr, _ = self.render_here(scene, width=WIDTH, height=HEIGHT, samples=2048, max_bounces=16,
                                      camera=f"Column {depth}", environment_kind="none")
            picture = Exr(exr)
            found.update({(row, depth): patch(picture, y) for row, y in ROWS.items()})
        return found

    def assert_shows(self, measured, row, depth, expected):
        for channel, (mean, error), wanted in zip("RGB", measured[row, depth], expected):
            where = f"{row}, {depth} m, {channel}"
            self.assertLess(4 * error, TOLERANCE * wanted, f"{where}: too noisy to tell")
            self.assertAlmostEqual(mean / wanted, 1, delta=TOLERANCE, msg=f"{where}: {mean} ± {error}, not {wanted}")

    def test_all_rows_are_alike_where_surfaces_reflect_nothing(self):
        measured = self.measured(1.0)
        for row in ROWS:
            for depth in COLUMNS:
                self.assert_shows(measured, row, depth, [c**depth for c in COLOR])

    def test_solids_are_alike_and_as_two_interfaces_have_it(self):
        measured = self.measured(1.5)
        reflected = 0.04
        for depth in COLUMNS:
            through = [c**depth for c in COLOR]
            self.assert_shows(measured, "sample colour", depth, [t * (1 - reflected) for t in through])
            for row in list(ROWS)[1:]:
                self.assert_shows(measured, row, depth,
                                  [(1 - reflected)**2 * t / (1 - (reflected * t)**2) for t in through])
