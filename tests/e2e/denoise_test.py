"""The denoised picture beside the raw one: on the farm, in a local render and by `tilefarm denoise`."""
import sys

from farm import DATA, ROOT, FarmTest

sys.path.insert(0, str(ROOT / "tests/support"))
from exr_image import Exr

SCENE = DATA / "cornell.gltf"
SMALL = dict(width=72, height=56, samples=4, seed=5)


class Denoised(FarmTest):
    def test_the_farm_adds_what_a_local_render_does_and_changes_nothing_else(self):
        raw, _ = self.render_here(SCENE, "raw.exr", **SMALL)
        here, _ = self.render_here(SCENE, "here.exr", **SMALL, output_denoise=())
        self.start_server()
        self.start_workers(1)
        job = self.submit(SCENE, **SMALL, output_denoise=(), tile_size=16)
        self.wait_for_end(job)
        there = self.download(job, "there.exr")
        self.assert_same_bits(there, here)
        planes, plain = Exr(there).planes, Exr(raw).planes
        self.assertEqual(sorted(set(planes) - set(plain)), ["denoised.B", "denoised.G", "denoised.R"])
        for name, plane in plain.items():
            self.assertEqual(planes[name], plane, name)
        self.assertNotEqual(planes["denoised.G"], planes["G"])

        with self.subTest("by hand"):
            self.cli("denoise", raw, self.folder / "by-hand.exr")
            self.assert_same_bits(self.folder / "by-hand.exr", here)
        with self.subTest("pictures show the raw one unless asked"):
            self.cli("download", job, "-o", self.folder / "a.png")
            self.cli("download", job, "-o", self.folder / "b.png", "--denoised")
            self.cli("png", here, "-o", self.folder / "c.png", "--channel", "denoised")
            a, b, c = ((self.folder / name).read_bytes() for name in ("a.png", "b.png", "c.png"))
            self.assertNotEqual(a, b)
            self.assertEqual(b, c)
        with self.subTest("a job that did not ask has none"):
            other = self.submit(SCENE, **SMALL)
            self.wait_for_end(other)
            self.assert_same_bits(self.download(other, "other.exr"), raw)
            code, _, err = self.run_program("tilefarm", "--server", self.url, "download", other, "-o",
                                            self.folder / "d.png", "--denoised")
            self.assertNotEqual(code, 0)
            self.assertIn("output.denoise", err)
