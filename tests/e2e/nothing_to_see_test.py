"""Hard case 48: scenes in which there is nothing to see are no mistakes. The program says so by its exit code, and what
it writes is a picture. (What the pixels hold: HardPath.HardCase48_NothingToSee.)"""
import json
import math
import struct
import sys

from farm import ROOT, FarmTest

sys.path.append(str(ROOT / "tests/support"))
from exr_image import Exr

CAMERA = {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.01}}


def scene(corners=None):
    """A camera 5 m from the origin, and with `corners` a triangle of them; no corner at all makes a mesh of nothing."""
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "cameras": [CAMERA],
            "nodes": [{"name": "Eye", "camera": 0, "translation": [0, 0, 5]}]}
    if corners is None:
        return gltf, b""
    data = b"".join(struct.pack("<3f", *corner) for corner in corners)
    gltf["scenes"][0]["nodes"].append(1)
    gltf["nodes"].append({"mesh": 0})
    gltf["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}}]}]
    lower, upper = ([edge(c[axis] for c in corners) for axis in range(3)] for edge in (min, max))
    gltf["accessors"] = [{"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3",
                          "min": lower, "max": upper}]
    gltf["bufferViews"] = [{"buffer": 0, "byteLength": len(data)}]
    gltf["buffers"] = [{"uri": "corners.bin", "byteLength": len(data)}]
    return gltf, data


SCENES = {
    "an empty scene": scene(),
    "a mesh of no area": scene([(0, 0, 0)] * 3),
    "no light": scene([(-1, -1, 0), (1, -1, 0), (0, 1, 0)]),
    "a triangle of 1e9": scene([(-1e9, -1e9, 0), (1e9, -1e9, 0), (0, 1e9, 0)]),
}


class HardCase48(FarmTest):
    def render(self, name, *options):
        gltf, data = SCENES[name]
        folder = self.folder / name.replace(" ", "-")
        folder.mkdir(exist_ok=True)
        (folder / "scene.gltf").write_text(json.dumps(gltf))
        (folder / "corners.bin").write_bytes(data)
        picture = folder / "picture.exr"
        code, _, err = self.run_program("tilefarm-worker", "render", folder / "scene.gltf", "-o", picture, "--cache",
                                        self.folder / "cache", "--width", 16, "--height", 16, "--samples", 4, *options)
        self.assertEqual(code, 0, err)
        return Exr(picture)

    def values(self, name, *options):
        picture = self.render(name, *options)
        values = [x for c in "RGB" for x in picture.planes[c]]
        self.assertEqual(len(values), 3 * 16 * 16)
        self.assertTrue(all(math.isfinite(x) and x >= 0 for x in values))
        return values

    def test_exit_code_0_and_a_picture(self):
        for name in SCENES:
            with self.subTest(name):
                self.assertEqual(max(self.values(name, "--environment-kind", "none")), 0, "nothing shines")
        with self.subTest("what nothing else lights is lit by white"):
            self.assertEqual(min(self.values("an empty scene")), 1)
            self.assertGreater(min(self.values("a triangle of 1e9")), 0.1)
