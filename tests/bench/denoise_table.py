#!/usr/bin/env python3
"""Measures the denoiser on whole scenes and prints the table of docs/denoiser.md: error raw and denoised at several
sample counts, the bias, and what becomes of the picture's light.

    tests/bench/denoise_table.py [--build build/release] [--work FOLDER] [--only demo,cornell] [--seeds 8] [--reference 1024]

Pictures that FOLDER already has are not rendered again (some CPU minutes for all of them). Errors are relMSE,
mean (x - ref)² / (ref² + 0.01²) over R, G and B, less what the reference's own variance adds to it. The bias comes from
n independent pictures of 16 samples, denoised: B of their mean and M, the mean of theirs, give bias² = (n B - M) / (n - 1)
without the noise that is left in their mean, and bias² / M is its share of the error. Scenes of ../shared that are
not there are left out.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared"
sys.path[:0] = [str(ROOT / "tests/support")]
from exr_image import Exr

SCENES = {
    "demo": (ROOT / "tests/data/demo/demo.glb", 320, 180, ROOT / "tests/data/demo/sky.hdr"),
    "cornell": (SHARED / "scenes/cornell-box/CornellBox.glb", 256, 256, None),
    "bathroom": (SHARED / "scenes/bathroom/LAZIENKA.gltf", 320, 180, None),
    "helmet": (SHARED / "scenes/damaged-helmet/DamagedHelmet.glb", 256, 256,
               SHARED / "environments/brown_photostudio_02_1k.hdr"),
}
REFERENCE_SEED = 777
FEW = 16


class Scene:
    def __init__(self, name, options):
        self.name, self.options = name, options
        self.reference = Exr(self.render(options.reference, REFERENCE_SEED))

    def render(self, samples, seed):
        path = self.options.work / f"{self.name}-{samples}-{seed}.exr"
        if not path.exists():
            scene, width, height, environment = SCENES[self.name]
            words = [self.options.build / "bin/tilefarm-worker", "render", scene, "-o", path, "--width", width,
                     "--height", height, "--samples", samples, "--seed", seed]
            run(*words, *(["--environment", environment] if environment else []))
        return path

    def denoised(self, samples, seed):
        """The raw picture and the denoised one, each as planes by channel."""
        path = self.options.work / f"{self.name}-{samples}-{seed}-denoised.exr"
        run(self.options.build / "bin/tilefarm", "denoise", self.render(samples, seed), path)
        planes = Exr(path).planes
        return {c: planes[c] for c in "RGB"}, {c: planes["denoised." + c] for c in "RGB"}

    def error(self, picture):
        total = 0
        for c in "RGB":
            variances = self.reference.planes["variance." + c]
            total += sum(((x - r) ** 2 - v) / (r * r + 1e-4)
                         for x, r, v in zip(picture[c], self.reference.planes[c], variances))
        return total / (3 * self.reference.width * self.reference.height)


def run(*words):
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def light(picture):
    return sum(sum(picture[c]) for c in "RGB")


def mean(numbers):
    numbers = list(numbers)
    return sum(numbers) / len(numbers)


def row(scene, seeds):
    pairs = [scene.denoised(FEW, seed) for seed in range(1, seeds + 1)]
    raw, left = mean(scene.error(a) for a, _ in pairs), mean(scene.error(b) for _, b in pairs)
    together = {c: [mean(values) for values in zip(*(b[c] for _, b in pairs))] for c in "RGB"}
    bias = max(0, (seeds * scene.error(together) - left) / (seeds - 1))
    cells = [scene.name, f"{raw:.4f}", f"{left:.4f}", f"{raw / left:.1f}×"]
    for samples in (64, 256):
        a, b = (scene.error(picture) for picture in scene.denoised(samples, 1))
        cells.append(f"{a:.4f} → {b:.4f}")
    cells += [f"{bias:.4f} ({100 * bias / left:.0f} %)",
              f"{100 * (mean(light(b) for _, b in pairs) / mean(light(a) for a, _ in pairs) - 1):+.2f} %"]
    return cells, raw / left


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--work", type=pathlib.Path, help="keep the pictures here")
    parser.add_argument("--only", help="names of scenes, by commas")
    parser.add_argument("--seeds", type=int, default=8, help="pictures of 16 samples, at least 2")
    parser.add_argument("--reference", type=int, default=1024, help="samples of the reference")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        options.work = options.work or pathlib.Path(scratch)
        options.work.mkdir(parents=True, exist_ok=True)
        print("| scene | raw, 16 samples | denoised | lower by | 64 samples | 256 samples | bias² (share of the error) |"
              " light |")
        print("|---|---|---|---|---|---|---|---|")
        enough = 0
        for name in options.only.split(",") if options.only else SCENES:
            if not SCENES[name][0].exists():
                print(f"{name}: {SCENES[name][0]} is not there", file=sys.stderr)
                continue
            cells, ratio = row(Scene(name, options), options.seeds)
            enough += ratio >= 3
            print("| " + " | ".join(cells) + " |", flush=True)
        print(f"{enough} scenes with an error lower by at least 3 times", file=sys.stderr)


if __name__ == "__main__":
    main()
