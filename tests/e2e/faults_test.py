"""What becomes of samples that are NaN: counted, named, and the picture stays whole (hard case 43)."""
import math
import os
import sys

from farm import DATA, ROOT, FarmTest, software_device

sys.path.insert(0, str(ROOT / "tests" / "support"))
from exr_image import Exr  # noqa: E402

SETTINGS = dict(width=128, height=128, samples=64, tile_size=64, max_bounces=2, seed=3)  # 2^20 samples


class Injected(FarmTest):
    def setUp(self):
        super().setUp()
        os.environ["TILEFARM_INJECT_FAULTS"] = "1"
        self.addCleanup(os.environ.pop, "TILEFARM_INJECT_FAULTS", None)

    def check(self, numerics):
        """About ten in a million, each with all that it takes to see it again."""
        self.assertGreater(numerics["droppedSamples"], 2)
        self.assertLess(numerics["droppedSamples"], 30)
        self.assertGreater(numerics["truncatedPaths"], 0)
        self.assertGreater(len(numerics["samples"]), 0)
        for sample in numerics["samples"]:
            self.assertEqual(sample["seed"], 3)
            self.assertLess(max(sample["x"], sample["y"]), 128)
            self.assertLess(sample["sample"], 64)

    def test_worker_server_and_report_tell_of_them(self):
        exr, report = self.render_here(DATA / "cornell.gltf", **SETTINGS)
        self.check(report["numerics"])

        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **SETTINGS)
        self.wait_for_end(job)
        view = self.job(job)
        self.check(view["numerics"])
        self.assertTrue(view["flagged"])
        self.assertEqual(view["numerics"]["droppedSamples"], report["numerics"]["droppedSamples"])
        self.assertEqual(view["numerics"]["truncatedPaths"], report["numerics"]["truncatedPaths"])
        self.assertEqual(view["numerics"]["rejectedPaths"], report["numerics"]["rejectedPaths"])
        self.assertIn("NaN or infinite", " ".join(view["faults"]))
        self.assertIn("bounce limit", " ".join(view["notices"]))
        self.assertEqual(view["notices"], report["notices"])
        told = self.get(f"/v1/jobs/{job}/report")
        self.assertEqual(told["notices"], view["notices"])
        self.check(told["numerics"])
        self.assertTrue(told["flagged"])
        self.assertEqual(told["numerics"]["degenerateTriangles"], 0)
        metrics = self.call("GET", "/metrics").body.decode()
        self.assertIn(f"tilefarm_dropped_samples_total {view['numerics']['droppedSamples']}", metrics)

        # The picture is finite and that of the samples that were kept, here as on the farm.
        picture = self.download(job)
        self.assert_same_bits(picture, exr)
        for name, values in Exr(picture).planes.items():
            self.assertTrue(all(map(math.isfinite, values)), name)

        # And one of them alone.
        sample = view["numerics"]["samples"][0]
        code, out, err = self.run_program(
            "tilefarm-worker", "render", DATA / "cornell.gltf", "--pixel", f"{sample['x']},{sample['y']}", "--sample",
            sample["sample"], "--width", 128, "--height", 128, "--max-bounces", 2, "--seed", sample["seed"],
            "--cache", self.folder / "cache", "--device", software_device())
        self.assertEqual(code, 0, out + err)
        self.assertIn("radiance (nan, nan, nan)", out)
        self.assertIn("throughput (1, 1, 1)", out)
