"""Small inputs of ../shared/cases that once gave a wrong picture or none: each gives the value that its README names, for
whoever renders it by the command line. (What lies behind each is tested where it is done, with more inputs.)"""
import shutil
import sys
import unittest

from farm import ROOT, SHARED, FarmTest

sys.path.append(str(ROOT / "tests/support"))
from exr_image import Exr

CASES = SHARED / "cases"
WHITE = CASES / "_env/w.hdr"


@unittest.skipUnless(CASES.is_dir(), "no ../shared/cases")
class Case(FarmTest):
    def render(self, scene, width=16, height=16, samples=16, **options):
        """Of a file below ../shared/cases: the picture, and the warnings in one text."""
        self.pictures = getattr(self, "pictures", 0) + 1
        picture, report = self.render_here(CASES / scene, f"picture{self.pictures}.exr", width=width, height=height,
                                           samples=samples, **options)
        return Exr(picture), "\n".join(str(w) for w in report["warnings"])

    def assert_mean(self, picture, expected, delta=0.005):
        for channel, value in zip("RGB", expected if isinstance(expected, tuple) else (expected,) * 3):
            self.assertAlmostEqual(picture.mean(channel), value, delta=delta, msg=f"{picture.path}, {channel}")


class Glass(Case):
    def test_light_of_lamps_goes_straight_through_a_thin_pane(self):
        bare = self.render("glass-delta-light/no-pane.gltf", samples=4)[0].mean("G")
        self.assertAlmostEqual(bare, 0.8, delta=0.005)
        # One interface of index 1.5, met squarely: 0.96; what the floor sends up and the pane sends down is added.
        for name in ("pane", "point"):
            lit = self.render(f"glass-delta-light/{name}.gltf")[0].mean("G", 6, 6, 10, 10)
            self.assertGreater(lit, 0.9 * bare, name)
            self.assertLess(lit, 0.99 * bare, name)

    def test_the_order_of_nodes_says_nothing_of_what_lies_under_glass(self):
        block, floor, gap = (self.render(f"glass-on-floor-coincident/{name}.gltf", samples=64, environment=WHITE)[0]
                             for name in ("block-first", "floor-first", "gap"))
        for channel in "RGB":
            self.assertAlmostEqual(block.mean(channel), floor.mean(channel), delta=0.01)
            self.assertAlmostEqual(block.mean(channel), gap.mean(channel), delta=0.02)

    def test_an_open_plane_with_thickness_darkens_nothing_more_than_a_thin_one(self):
        thin, _ = self.render("glass-open-volume/thin.gltf", environment=WHITE)
        volume, said = self.render("glass-open-volume/volume.gltf", environment=WHITE)
        self.assertGreater(volume.mean("G"), 0.95 * thin.mean("G"))
        self.assertIn("thin", said)

    def test_sixteen_panes_keep_their_light(self):
        self.assert_mean(self.render("glass-stack-furnace-16/a.gltf", environment=WHITE, samples=64)[0], 1, 0.01)


class Surfaces(Case):
    def test_a_floor_that_is_there_twice_is_one_floor(self):
        for name in ("floor1", "floor2"):
            picture, _ = self.render(f"coplanar-floor-y0/{name}.gltf")
            self.assert_mean(picture, 0.4)
            self.assertGreater(min(picture.planes["G"]), 0.399, name)

    def test_back_faces_are_not_there_for_the_camera(self):
        picture, _ = self.render("single-sided-culling/a.gltf", environment=WHITE, samples=4)
        self.assertEqual(max(picture.planes["A"]), 0)
        self.assert_mean(picture, 1, 1e-3)

    def test_unlit_things_leave_the_default_light_on(self):
        picture, _ = self.render("mat-unlit-does-not-darken-others/a.gltf")
        self.assertGreater(picture.mean("G", 6, 6, 10, 10), 0.3)

    def test_weights_of_zero_mean_the_first_joint(self):
        skinned, said = self.render("skin-zero-weights-joint1/a.gltf")
        placed, _ = self.render("skin-zero-weights-joint1/b.gltf")
        self.assertIn("weights", said)
        difference = [abs(a - b) for a, b in zip(skinned.planes["G"], placed.planes["G"])]
        self.assertLess(max(difference), 0.02)


class Cameras(Case):
    def test_a_narrow_picture_shows_all_that_the_camera_frames(self):
        options = dict(environment=WHITE, samples=64)
        framed, _ = self.render("cam-aspect-mismatch/a.gltf", 32, 16, **options)
        square, _ = self.render("cam-aspect-mismatch/a.gltf", 32, 32, **options)
        for x in range(0, 32, 8):
            for channel in "RGB":
                self.assertAlmostEqual(square.mean(channel, x, 8, x + 8, 24), framed.mean(channel, x, 0, x + 8, 16),
                                       delta=0.03)

    def test_what_lies_before_the_near_plane_is_named(self):
        _, said = self.render("cam-znear/a.gltf", environment=WHITE, samples=1)
        self.assertIn("znear", said)


class Files(Case):
    def test_faults_of_what_is_not_used_stop_nothing(self):
        for name, options in [("anim-bad-but-not-played", {"animation": "none"}), ("glb-trailing-bytes/s.glb", {}),
                              ("uri-missing-unused/s.gltf", {}), ("uri-parent/models/s.gltf", {})]:
            with self.subTest(name):
                path = f"{name}/a.gltf" if "." not in name else name
                self.assertGreater(self.render(path, samples=1, environment=WHITE, **options)[0].mean("A"), 0)

    def test_the_farm_takes_what_renders_here(self):
        self.start_server()
        self.start_worker()
        scene = (CASES / "uri-parent/models/s.gltf").read_text()
        folder = self.folder / "inner/models"
        (folder / "sub").mkdir(parents=True)
        for file in (CASES / "uri-parent/models").iterdir():
            shutil.copyfile(file, folder / file.name)
        for target in (folder / "tex.png", folder / "sub/tex.png", self.folder / "inner/tex.png"):
            shutil.copyfile(CASES / "uri-parent/textures/tex.png", target)
        local, _ = self.render("uri-parent/models/s.gltf", samples=4)
        jobs = {"outside": self.submit(CASES / "uri-parent/models/s.gltf", width=16, height=16, samples=4)}
        for uri in ("sub/../tex.png", "sub//tex.png", "./sub/./tex.png", "../tex.png"):
            (folder / "s.gltf").write_text(scene.replace("../textures/tex.png", uri))
            jobs[uri] = self.submit(folder / "s.gltf", width=16, height=16, samples=4)
        for uri, job in jobs.items():
            with self.subTest(uri):
                self.wait_for_end(job)
                self.assert_same_bits(local.path, self.download(job, f"{job}.exr"))
