"""The same job gives the same bits, however it is cut and whoever renders it."""
from farm import DATA, FarmTest

CORNELL = dict(width=120, height=90, seed=7)  # tiles at the edges are cut
DEMO = dict(width=64, height=36, samples=4)


class CornellBox(FarmTest):
    def test_one_worker_three_workers_and_none(self):
        samples = self.samples_for(1, 120, 90)
        cornell = {**CORNELL, "samples": samples}
        here, report = self.render_here(DATA / "cornell.gltf", **cornell, tile_size=128)
        self.assertEqual(report["scene"]["triangles"], 36)
        self.assertEqual(report["samples"], 120 * 90 * samples)
        self.assertGreater(report["rays"], report["samples"])
        self.assertEqual(report["errorCurve"][-1]["samples"], samples)

        with self.subTest("locally with tiles of 16 pixels"):
            small_tiles, _ = self.render_here(DATA / "cornell.gltf", "tiles.exr", **cornell, tile_size=16)
            self.assert_same_bits(small_tiles, here)
        with self.subTest("another seed gives another picture"):
            other, _ = self.render_here(DATA / "cornell.gltf", "other.exr", **{**cornell, "seed": 8})
            self.assert_other_bits(other, here)

        self.start_server()
        self.start_workers(1)
        for tile_size in (16, 128):
            with self.subTest(f"one worker, tiles of {tile_size} pixels"):
                job = self.submit(DATA / "cornell.gltf", **cornell, tile_size=tile_size)
                view = self.wait_for_end(job)
                self.assert_same_bits(self.download(job), here)
                self.assertAlmostEqual(view["relativeError"], report["relativeError"], places=9)
                for ours, theirs in zip(view["relativeErrorInterval"], report["relativeErrorInterval"]):
                    self.assertAlmostEqual(ours, theirs, places=9)
                self.assertEqual([(p["x"], p["y"]) for p in view["errorTail"]["pixels"]],
                                 [(p["x"], p["y"]) for p in report["errorTail"]["pixels"]])

        self.start_workers(2)
        with self.subTest("three workers"):
            job = self.submit(DATA / "cornell.gltf", **cornell, tile_size=16)
            self.wait_for_end(job)
            self.assert_same_bits(self.download(job), here)
            took_part = [w for w in self.get(f"/v1/jobs/{job}/report")["workers"] if w["passes"] > 0]
            self.assertGreater(len(took_part), 1, "the job was too small to tell")


class ErrorTarget(FarmTest):
    def test_one_worker_three_workers_and_none(self):
        target = dict(width=120, height=90, tile_size=16, relative_error=0.35, min_samples=8, samples=512)
        here, report = self.render_here(DATA / "cornell.gltf", **target)
        self.assertEqual(report["stopReason"], "relativeError")
        self.assertRegex(report["stopped"], r"^error target of 0.35 reached at \d+ samples per pixel$")
        self.assertLessEqual(report["relativeError"], 0.35)
        self.assertLess(report["samples"], 512 * 120 * 90)

        self.start_server()
        for workers in (1, 2):
            self.start_workers(workers)
            with self.subTest(f"{len(self.programs) - 1} workers"):
                job = self.submit(DATA / "cornell.gltf", **target)
                view = self.wait_for_end(job)
                self.assert_same_bits(self.download(job), here)
                self.assertEqual(view["stopped"], report["stopped"])
                self.assertEqual(view["samplesMerged"], report["samplesPerPixel"])
                self.assertEqual(view["progress"]["fraction"], 1)
                self.assertAlmostEqual(view["relativeError"], report["relativeError"], places=12)
                self.assertEqual([p["samples"] for p in view["errorCurve"]],
                                 [p["samples"] for p in report["errorCurve"]])


class DemoScene(FarmTest):
    def test_textures_glass_and_environment_too(self):
        demo = DATA / "demo" / "demo.glb"
        sky = DATA / "demo" / "sky.hdr"
        here, _ = self.render_here(demo, **DEMO, environment=sky, tile_size=128)
        self.start_server()
        self.start_workers(2)
        job = self.submit(demo, **DEMO, environment=sky, tile_size=16)
        self.wait_for_end(job)
        self.assert_same_bits(self.download(job), here)
        report = self.get(f"/v1/jobs/{job}/report")
        self.assertIn("environment", report["features"]["used"])
