"""Scenes that are broken where no picture shows it, or invalid by the letter alone, are rendered with warnings that name
the place, on the farm as here; --strict refuses them. (Each fault by itself: tests/unit/worker/scene/tolerance_test.cpp.)"""
import base64
import json
import sys

from farm import DATA, ROOT, SHARED, FarmTest

sys.path.append(str(ROOT / "tests/support"))
from exr_image import Exr

SMALL = dict(width=16, height=16, samples=1)
CASES = SHARED / "cases"


def tiny():
    return json.loads((DATA / "tiny.gltf").read_text())


def picture_of(gltf):
    """The bytes of its image, which stand in its buffer."""
    view = gltf["bufferViews"][gltf["images"][0]["bufferView"]]
    start = view.get("byteOffset", 0)
    return base64.b64decode(gltf["buffers"][0]["uri"].split(",")[1])[start:start + view["byteLength"]]


class Paths(FarmTest):
    """Where an image lies and how its path is written changes neither picture, and the server never sees a '..'."""

    def scene(self, entry, uri, image):
        gltf = tiny()
        path, picture = (self.folder / "scenes" / name for name in (entry, image))
        for file in path, picture:
            file.parent.mkdir(parents=True, exist_ok=True)
        picture.write_bytes(picture_of(gltf))
        gltf["images"] = [{"uri": uri}]
        path.write_text(json.dumps(gltf))
        return path

    def test_the_farm_renders_what_a_local_render_does(self):
        right, _ = self.render_here(DATA / "tiny.gltf", "right.exr", **SMALL)
        self.start_server()
        self.start_workers(1)
        for entry, uri, image in [
            ("above/models/scene.gltf", "../textures/tex.png", "above/textures/tex.png"),
            ("far/a/b/scene.gltf", "./c/../../../tex.png", "far/tex.png"),
            ("dots/scene.gltf", "sub/../tex.png", "dots/tex.png"),
            ("slashes/scene.gltf", "sub//tex.png", "slashes/sub/tex.png"),
        ]:
            with self.subTest(uri):
                path = self.scene(entry, uri, image)
                here, report = self.render_here(path, **SMALL)
                self.assertEqual(report["warnings"], [])
                self.assert_same_bits(here, right)
                job = self.submit(path, **SMALL)
                files = self.wait_for_end(job)["spec"]["scene"]["files"]
                self.assertEqual(len(files), 2)
                self.assertFalse([name for name in files if ".." in name or "//" in name])
                self.assert_same_bits(self.download(job), right)

    def test_the_shared_case(self):
        path = CASES / "uri-parent/models/s.gltf"
        if not path.exists():
            self.skipTest("no shared data")
        here, _ = self.render_here(path, **SMALL)
        self.start_server()
        self.start_workers(1)
        job = self.submit(path, **SMALL)
        self.wait_for_end(job)
        self.assert_same_bits(self.download(job), here)


class Faults(FarmTest):
    """One scene with a fault of each kind."""

    PLACES = ["animations/0 (Broken)", "animations/0/samplers/0", "bufferViews/1/byteStride", "images/1", "nodes/0/extras/note"]

    def scene(self, *, missing=True):
        gltf = tiny()
        gltf["bufferViews"][1]["byteStride"] = 0
        gltf["nodes"][0]["extras"] = {"note": "MARK"}
        if missing:
            gltf["images"].append({"uri": "gone.png"})
        gltf["animations"] = [{"name": "Broken", "samplers": [{"input": 99, "output": 99}],
                               "channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}]}]
        path = self.folder / "scene.gltf"
        path.write_text(json.dumps(gltf).replace('"MARK"', '1, "note": 2'))
        return path

    def test_are_warnings_in_both_reports_and_no_other_picture(self):
        right, _ = self.render_here(DATA / "tiny.gltf", "right.exr", **SMALL)
        path = self.scene()
        here, local = self.render_here(path, **SMALL, animation="none")
        self.assert_same_bits(here, right)
        self.assertEqual(sorted(w["where"] for w in local["warnings"]), self.PLACES)
        self.start_server()
        self.start_workers(1)
        code, out, err = self.run_program("tilefarm", "--server", self.url, "submit", path, "--animation", "none", "--width",
                                          16, "--height", 16, "--samples", 1)
        self.assertEqual(code, 0, err)
        self.assertIn("/images/1/uri", err)
        job = out.split()[0]
        self.wait_for_end(job)
        self.assert_same_bits(self.download(job), right)
        farm = self.get(f"/v1/jobs/{job}/report")["warnings"]
        self.assertEqual(sorted(w["where"] for w in farm), self.PLACES)

    def test_strict_refuses_each(self):
        path = self.scene()
        options = ["--strict", "--animation", "none", "--width", 16, "--height", 16]
        code, _, err = self.run_program("tilefarm-worker", "render", path, "-o", self.folder / "x.exr", *options)
        self.assertEqual(code, 1, err)
        self.assertIn('"note" stands twice', err)
        self.start_server()
        code, _, err = self.run_program("tilefarm", "--server", self.url, "submit", path, *options)
        self.assertEqual(code, 2, err)
        self.assertIn("stands twice", err)
        self.assertEqual(self.get("/v1/jobs")["jobs"], [])
        self.start_workers(1)
        path.write_text(self.scene(missing=False).read_text().replace('1, "note": 2', "1"))
        job = self.cli("submit", path, *options).split()[0]
        view = self.wait_for_end(job, "failed")
        self.assertIn("scene.gltf: /bufferViews/1/byteStride", view["faults"][0])


class Light(FarmTest):
    """What only looks bright, or is black, leaves the white light on."""

    def centre(self, path):
        exr, report = self.render_here(path, width=16, height=16, samples=64, seed=2)
        self.assertEqual([w["feature"] for w in report["warnings"]], ["lights"])
        picture = Exr(exr)
        pixels = [y * 16 + x for y in range(6, 10) for x in range(6, 10)]
        return [sum(picture.planes[c][i] for i in pixels) / len(pixels) for c in "RGB"]

    def test_a_matte_floor_beside_it_is_as_bright_as_its_albedo(self):
        others = {
            "an unlit card": {"extensions": {"KHR_materials_unlit": {}}},
            "a black emissive map": {"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 1}},
            "an emitter that is cut out": {"emissiveFactor": [1, 1, 1], "alphaMode": "MASK",
                                           "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0]}},
        }
        black = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNgYGAAAAAEAAH2FzhVAAAAAElFTkSuQmCC")
        (self.folder / "black.png").write_bytes(black)
        for name, material in others.items():
            with self.subTest(name):
                gltf = tiny()
                gltf["images"].append({"uri": "black.png"})
                gltf["textures"].append({"source": len(gltf["images"]) - 1})
                gltf["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1]},
                                      "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}, material]
                gltf["materials"][0]["pbrMetallicRoughness"].update(metallicFactor=0)
                card = json.loads(json.dumps(gltf["meshes"][0]))
                card["primitives"][0]["material"] = 1
                gltf["meshes"].append(card)
                gltf["nodes"].append({"mesh": 1, "scale": [0.05, 0.05, 0.05], "translation": [0.9, 0.9, 0.5]})
                gltf["scenes"][0]["nodes"].append(len(gltf["nodes"]) - 1)
                path = self.folder / "scene.gltf"
                path.write_text(json.dumps(gltf))
                for value in self.centre(path):
                    # The card hides less than a hundredth of the sky; 16 pixels of 64 samples.
                    self.assertAlmostEqual(value, 0.5, delta=0.01)

    def test_the_shared_case(self):
        path = CASES / "mat-unlit-does-not-darken-others/a.gltf"
        if not path.exists():
            self.skipTest("no shared data")
        for value in self.centre(path):
            self.assertGreater(value, 0.49, "the diffuse part of its albedo of 0.5, and some gloss")
            self.assertLess(value, 0.6)
