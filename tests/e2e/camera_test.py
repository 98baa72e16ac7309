"""Pictures of another shape than the camera's view, clipping planes and single-sided faces: on the farm as here."""
import base64
import json
import struct
import sys
import unittest

from farm import ROOT, SHARED, FarmTest, option_words, software_device

sys.path.insert(0, str(ROOT / "tests" / "support"))
from exr_image import Exr  # noqa: E402

CASES = SHARED / "cases"


def card(camera, placed=((0, 0, 0),), turned=False, double_sided=True):
    """A glTF of cards 4 m wide and 2 m high that face +z, seen from z = 3."""
    corners = struct.pack("<12f", -2, -1, 0, 2, -1, 0, 2, 1, 0, -2, 1, 0)
    data = corners + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    nodes = [{"mesh": 0, "translation": at, "name": f"card {i}"} for i, at in enumerate(placed)]
    if turned:
        for node in nodes:
            node["rotation"] = [0, 1, 0, 0]
    nodes.append({"camera": 0, "translation": [0, 0, 3]})
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
        "cameras": [camera], "materials": [{"doubleSided": double_sided}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-2, -1, 0],
                       "max": [2, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}


WIDE = {"type": "perspective", "perspective": {"yfov": 0.6435011087932844, "znear": 0.01, "aspectRatio": 2}}
FLAT = {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 2, "znear": 0.5, "zfar": 10}}
NEAR = {"type": "perspective", "perspective": {"yfov": 0.64, "znear": 2}}


class CameraTest(FarmTest):
    def scene(self, gltf, name="scene.gltf"):
        path = self.folder / name
        path.write_text(json.dumps(gltf))
        return path

    def case(self, name):
        path = CASES / name / "a.gltf"
        if not path.exists():
            self.skipTest("no ../shared/cases")
        return path

    def rows(self, exr):
        """Mean alpha of every row."""
        picture = Exr(exr)
        alpha, width = picture.planes["A"], picture.width
        return [sum(alpha[y * width:(y + 1) * width]) / width for y in range(picture.height)]

    def expect_whole_card(self, scene):
        square = dict(width=32, height=32, samples=4)
        whole, report = self.render_here(scene, "whole.exr", **square)
        self.assertEqual(report["warnings"], [w for w in report["warnings"] if w["feature"] == "lights"])
        # A view of 4 by 4 m: the card fills the middle half of the rows from edge to edge.
        self.assertEqual([round(a, 6) for a in self.rows(whole)], [0.0] * 8 + [1.0] * 16 + [0.0] * 8)
        for fit, rows in (("horizontal", 16), ("vertical", 32), ("fill", 32)):
            exr, _ = self.render_here(scene, fit + ".exr", **square, camera_fit=fit)
            self.assertEqual(round(sum(self.rows(exr))), rows, fit)

    def expect_back_culled(self, scene):
        small = dict(width=16, height=16, samples=2)
        for culling, alpha in (("camera", 0), ("all", 0), ("none", 1)):
            exr, report = self.render_here(scene, culling + ".exr", **small, culling=culling)
            self.assertEqual(Exr(exr).planes["A"][8 * 16 + 8], alpha, culling)
            warned = "doubleSided" in [w["feature"] for w in report["warnings"]]
            self.assertEqual(warned, culling != "none")
        exr, _ = self.render_here(scene, **small)
        self.assertEqual(max(Exr(exr).planes["A"]), 0, "the default is the camera's")

    def expect_near_plane(self, scene, node):
        small = dict(width=16, height=16, samples=2)
        seen, report = self.render_here(scene, "seen.exr", **small)
        self.assertAlmostEqual(Exr(seen).planes["Z"][8 * 16 + 8], 1, delta=0.1)
        self.assertIn(node, next(w["instead"] for w in report["warnings"] if w["feature"] == "znear"))
        clipped, report = self.render_here(scene, "clipped.exr", **small, camera_clip=())
        self.assertAlmostEqual(Exr(clipped).planes["Z"][8 * 16 + 8], 3, delta=0.2)
        self.assertNotIn("znear", [w["feature"] for w in report["warnings"]])


class Shapes(CameraTest):
    def test_shared_case(self):
        self.expect_whole_card(self.case("cam-aspect-mismatch"))

    def test_a_square_picture_shows_all_of_a_wide_view(self):
        self.expect_whole_card(self.scene(card(WIDE)))

    def test_a_size_that_is_not_given_has_the_aspect_of_the_camera(self):
        wide, _ = self.render_here(self.scene(card(WIDE), "wide.gltf"), "wide.exr", samples=1)
        self.assertEqual((Exr(wide).width, Exr(wide).height), (640, 320))
        scene = self.scene(card(FLAT), "flat.gltf")
        here, _ = self.render_here(scene, "flat.exr", samples=1)
        self.assertEqual((Exr(here).width, Exr(here).height), (320, 640))
        self.start_server()
        self.start_workers(1)
        answer = self.call("POST", "/v1/jobs", {
            "scene": {"files": {"s.gltf": self.put_blob(scene.read_bytes())}, "entry": "s.gltf"}, "stop": {"samples": 1}})
        self.assertEqual(answer.status, 201, answer.body)
        for job in (self.submit(scene, samples=1), answer.json()["id"]):
            self.wait_for_end(job)
            self.assert_same_bits(self.download(job, f"{job}.exr"), here)

    def test_one_side_gives_the_other(self):
        here, _ = self.render_here(self.scene(card(WIDE)), samples=1, height=16)
        self.assertEqual(Exr(here).width, 32)


class Clipping(CameraTest):
    def test_shared_case(self):
        self.expect_near_plane(self.case("cam-znear"), "wall in front")

    def test_what_lies_before_znear_is_named_and_clipped_if_asked_for(self):
        self.expect_near_plane(self.scene(card(NEAR, ((0, 0, 0), (0, 0, 2)))), "card 1")


class Culling(CameraTest):
    def test_shared_case(self):
        self.expect_back_culled(self.case("single-sided-culling"))

    def test_the_camera_does_not_see_backs(self):
        self.expect_back_culled(self.scene(card(NEAR, turned=True, double_sided=False)))


class Frames(CameraTest):
    def test_a_list_of_frames_is_rendered_here_and_on_the_farm(self):
        scene = self.scene(card(WIDE))
        settings = dict(width=16, height=16, samples=1, turntable=10)
        self.start_server()
        self.start_workers(1)
        job = self.submit(scene, **settings, frames="9,1-5x2")
        self.wait_for_end(job)
        self.assertEqual([f["frame"] for f in self.get(f"/v1/jobs/{job}/frames")["frames"]], [1, 3, 5, 9])
        self.cli("download", job, "--frames", "all", "-o", self.folder / "far.##.exr")
        words = option_words(dict(settings, frames="9,1-5x2", device=software_device(), cache=self.folder / "cache"))
        code, out, err = self.run_program("tilefarm-worker", "render", scene, "-o", self.folder / "near.##.exr", *words)
        self.assertEqual(code, 0, out + err)
        for frame in (1, 3, 5, 9):
            self.assert_same_bits(self.folder / f"far.{frame:02}.exr", self.folder / f"near.{frame:02}.exr")
        self.assertFalse((self.folder / "far.02.exr").exists())


if __name__ == "__main__":
    unittest.main()
