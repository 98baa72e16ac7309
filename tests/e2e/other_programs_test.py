"""Every kind of EXR opened by the programs that people look at it with: their pixels are ours, to the bit."""
import array
import os
import shutil
import subprocess
import sys
import unittest

from farm import DATA, ROOT, FarmTest, until

sys.path.insert(0, str(ROOT / "tests/support"))
from exr_image import Exr  # noqa: E402

SCENE = DATA / "cornell.gltf"
SIZE = dict(width=40, height=28, samples=4, tile_size=16)
# So that the settings are longer than any header entry may be.
LONG = dict(material='{"material": "none of this name, however long it is made by this", "ior": 1.5}')
ALL = dict(output_light_paths=(), output_uv=(), output_cryptomatte=())
KINDS = {
    "plain": {},
    "denoised": dict(output_denoise=()),
    "light": dict(output_light_paths=()),
    "uv": dict(output_uv=()),
    "mattes": dict(output_cryptomatte=()),
    "all": dict(**ALL, output_denoise=(), **LONG),
}
LONGEST = 250  # bytes of a header entry
# What Blender calls channels without a layer.
UNNAMED = {"Combined": ["R", "G", "B", "A"], "Alpha": ["A"], "Depth": ["Z"]}
ORDERS = ["RGBA", "RGB", "XYZ", "UVA", "X"]


def layers_of(exr):
    """Channels of every layer in the order in which a program shows them: {"normal": ["normal.X", …], …}."""
    layers = dict(UNNAMED)
    names = {name.rpartition(".")[0] for name in exr.planes} - {""}
    for layer in names:
        mine = {name.rpartition(".")[2] for name in exr.planes if name.rpartition(".")[0] == layer}
        order = next(o for o in ORDERS if set(o) == mine)
        layers[layer] = [f"{layer}.{c}" for c in order]
    return layers


class OtherPrograms(FarmTest):
    def files(self):
        """One of each kind, and one that is not finished."""
        files = [self.render_here(SCENE, f"{kind}.exr", **SIZE, **options)[0] for kind, options in KINDS.items()]
        self.start_server()
        self.start_workers(1)
        job = self.submit(SCENE, **{**SIZE, "samples": 1 << 20}, **ALL)
        until(lambda: self.job(job)["progress"]["fraction"] > 0, "a first pass")
        files.append(self.download(job, "partial.exr"))
        self.cli("cancel", job)
        return files

    def test_all_see_the_same_pixels(self):
        files = self.files()
        for file in files:
            exr = Exr(file)
            with self.subTest(file.stem, what="header"):
                for name, value in exr.attributes.items():
                    self.assertTrue(len(value) <= LONGEST or name == "channels", name)
            for look in self.in_ffmpeg, self.in_oiiotool:
                with self.subTest(file.stem, what=look.__name__):
                    look(file, exr)
        self.in_blender(files)

    def need(self, program):
        """Skips where it is not, but not in CI."""
        if not shutil.which(program) and "TILEFARM_CI" not in os.environ:
            self.skipTest("no " + program)

    def in_ffmpeg(self, file, exr):
        self.need("ffmpeg")
        raw = subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-f", "rawvideo", "-pix_fmt", "gbrapf32le", "-"],
                             stdout=subprocess.PIPE, check=True).stdout
        floats, size = array.array("f", raw), exr.width * exr.height
        self.assertEqual(len(floats), 4 * size)
        for i, channel in enumerate("GBRA"):
            self.assertEqual(floats[i * size:(i + 1) * size], exr.planes[channel], channel)
        self.assertGreater(max(exr.planes["R"]), 0)

    def in_oiiotool(self, file, exr):
        self.need("oiiotool")
        copy = file.with_suffix(".copy.exr")
        subprocess.run(["oiiotool", file, "--compression", "none", "-o", copy], check=True)
        self.assertEqual(Exr(copy).planes, exr.planes)

    def in_blender(self, files):
        self.need("blender")
        out = self.folder / "blender"
        log = subprocess.run(["blender", "-b", "--factory-startup", "-P", ROOT / "tests/support/blender_passes.py", "--", out,
                              *files], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=True, text=True).stdout
        for file in files:
            exr = Exr(file)
            with self.subTest(file.stem, what="in_blender"):
                seen = {path.name[:-len("0001.exr")]: path for path in (out / file.stem).iterdir()}
                layers = layers_of(exr)
                self.assertEqual(set(seen), set(layers), log)
                for layer, names in layers.items():
                    planes = Exr(seen[layer]).planes
                    for shown, name in zip("RGBA", names):
                        self.assertEqual(planes[shown], exr.planes[name], name)


if __name__ == "__main__":
    unittest.main()
