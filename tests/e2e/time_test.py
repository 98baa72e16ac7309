"""Frames over time through the farm: a turntable, a skinned animation, a zip of EXRs, a movie."""
import shutil
import subprocess
import unittest
import zipfile

from farm import DATA, FarmTest

SMALL = dict(width=64, height=48, samples=4, tile_size=32)
FLOWER = DATA / "flower.glb"  # bends by a skin while its bud opens by a morph target


class Turntable(FarmTest):
    def test_frames_of_a_moving_camera_are_those_of_a_local_render(self):
        settings = dict(SMALL, turntable=7.5, shutter=0.5, fps=12)
        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **settings, frames="0-5")
        self.wait_for_end(job)
        archive = self.folder / "frames.zip"
        self.cli("download", job, "--frames", "all", "-o", archive)
        with zipfile.ZipFile(archive) as frames:
            names = frames.namelist()
            self.assertEqual(names, [f"frame.{n:04}.exr" for n in range(6)])
            self.assertIsNone(frames.testzip())
            frames.extractall(self.folder / "frames")
        first, fifth = self.folder / "frames" / names[0], self.folder / "frames" / names[5]
        self.assert_other_bits(first, fifth)
        here, _ = self.render_here(DATA / "cornell.gltf", **settings, frame=5)
        self.assert_same_bits(fifth, here)
        self.cli("download", job, "--frames", "2-3", "-o", self.folder / "a##.png")
        self.assertTrue((self.folder / "a02.png").exists() and (self.folder / "a03.png").exists())

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg")
    def test_a_job_becomes_a_movie(self):
        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "tiny.gltf", width=33, height=16, samples=1, tile_size=16, frames="0-4", turntable=20,
                          fps=10)
        self.wait_for_end(job)
        movie = self.folder / "out.mp4"
        self.cli("movie", job, "-o", movie)
        seen = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries",
                               "stream=nb_read_frames,r_frame_rate,width", "-of", "csv=p=0", movie],
                              stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
        self.assertEqual(seen, "34,10/1,5")
        png = self.folder / "first.png"
        self.cli("download", job, "--frame", 0, "-o", png)
        first, picture = self.grey(movie), self.grey(png)
        self.assertGreater(max(picture), 64)
        self.assertLess(sum(abs(a - b) for a, b in zip(first, picture)) / len(picture), 4, "as its first frame, compressed")

    def grey(self, file):
        """Of a picture or a movie's first frame, without the column that makes its width even."""
        return subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-frames:v", "1", "-vf", "crop=32:16:0:0", "-f",
                               "rawvideo", "-pix_fmt", "gray", "-"], stdout=subprocess.PIPE, check=True).stdout

    def test_without_ffmpeg_a_movie_says_what_is_missing(self):
        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "tiny.gltf", width=16, height=16, samples=1, tile_size=16)
        self.wait_for_end(job)
        code, _, err = self.run_program("tilefarm", "--server", self.url, "movie", job, "-o", self.folder / "out.mp4",
                                        PATH=str(self.folder))
        self.assertNotEqual(code, 0)
        self.assertIn("the package ffmpeg", err)
        self.assertFalse((self.folder / "out.mp4").exists())


class SkinnedAndMorphingAnimation(FarmTest):
    def test_two_workers_agree_on_an_animation_with_motion_blur(self):
        settings = dict(SMALL, shutter=0.5, shutter_steps=4, fps=2)
        self.start_server()
        self.start_workers(2)
        job = self.submit(FLOWER, **settings, frames="0-3")
        self.wait_for_end(job)
        pictures = []
        for frame in (0, 3):
            farm = self.folder / f"farm{frame}.exr"
            self.cli("download", job, "--frame", frame, "-o", farm)
            here, _ = self.render_here(FLOWER, f"here{frame}.exr", **settings, frame=frame)
            self.assert_same_bits(farm, here)
            pictures.append(farm)
        self.assert_other_bits(*pictures)


if __name__ == "__main__":
    unittest.main()
