#!/usr/bin/env python3
"""Compares the relative error that a render reports with its true one, and prints the tables of docs/accuracy.md.

    tests/bench/error_estimate.py [--bin build/release/bin] [--work FOLDER] [--only demo,cornell] [--samples 16,64,256]
                                  [--seeds 3] [--reference 16384] [-- OPTION...]

For each scene and number of samples: the true error, sqrt(mean (L - Lref)² / (Lref² + 0.01²)) of luminance against a
picture of another seed with --reference samples; the reported error over it, both as root mean squares over the seeds;
and in how many of the renders the reported interval holds the true error. OPTIONs go to `tilefarm-worker render`
of all pictures but the reference: `-- --sampler sobol`. Pictures that FOLDER already has are not rendered again.
Scenes of ../shared that are not there are left out.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared"
sys.path[:0] = [str(ROOT / "tests/support")]
from exr_image import Exr

WIDTH, HEIGHT = 160, 90
REFERENCE_SEED = 99
LUMINANCE = {"R": 0.2126, "G": 0.7152, "B": 0.0722}
STUDIO, GARDEN = (SHARED / "environments" / f"{name}_1k.hdr" for name in ("brown_photostudio_02", "chinese_garden"))
# The constants of shared/film/pixel_error.cpp were chosen on these …
SCENES = {
    "demo": (ROOT / "tests/data/demo/demo.glb", ROOT / "tests/data/demo/sky.hdr"),
    "cornell": (SHARED / "scenes/cornell-box/CornellBox.glb", None),
    "own-cornell": (ROOT / "tests/data/cornell.gltf", None),
    "bathroom": (SHARED / "scenes/bathroom/LAZIENKA.gltf", None),
    "dragon": (SHARED / "scenes/chinese-dragon/chinesedragon.gltf", None),
    "helmet": (SHARED / "scenes/damaged-helmet/DamagedHelmet.glb", GARDEN),
    "materials": (ROOT / "tests/data/materials.glb", None),
    "volume": (SHARED / "scenes/khronos-16_volume/16_volume.gltf", STUDIO),
    "mirrors": (ROOT / "tests/data/mirrors.glb", None),
    # … and not on these.
    "helmet-studio": (SHARED / "scenes/damaged-helmet/DamagedHelmet.glb", STUDIO),
    "dragon-garden": (SHARED / "scenes/chinese-dragon/chinesedragon.gltf", GARDEN),
    "layers": (ROOT / "tests/data/layers.glb", None),
    "fog": (ROOT / "tests/data/fog.gltf", None),
    "flower": (ROOT / "tests/data/flower.glb", STUDIO),
    "bunny": (SHARED / "scenes/stanford-bunny", STUDIO),
    "alpha-mask": (SHARED / "scenes/khronos-01_alpha_mask", STUDIO),
    "transmission": (SHARED / "scenes/khronos-15_transmission", GARDEN),
    "ior": (SHARED / "scenes/khronos-17_ior", STUDIO),
    "sheen": (SHARED / "scenes/khronos-19_sheen", GARDEN),
    "specular": (SHARED / "scenes/khronos-20_specular", STUDIO),
    "anisotropy": (SHARED / "scenes/khronos-25_anisotropy", GARDEN),
}


def file_of(scene):
    """A folder of ../shared stands for the one scene in it."""
    found = sorted(scene.glob("*.gl[tb]*")) if scene.is_dir() else [scene]
    return found[0] if found and found[0].exists() else None


class Study:
    def __init__(self, options):
        self.options = options

    def render(self, name, samples, seed, extra):
        path = self.options.work / f"{name}-{samples}-{seed}.exr"
        report = path.with_suffix(".json")
        if not path.exists():
            scene, environment = SCENES[name]
            words = [self.options.bin / "tilefarm-worker", "--cache", self.options.work / "cache", "render",
                     file_of(scene), "-o", path, "--report", report, "--width", WIDTH, "--height", HEIGHT, "--samples",
                     samples, "--seed", seed, *(["--environment", environment] if environment else []), *extra]
            done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
            if done.returncode:
                sys.exit(f"{name}: {done.stderr.strip()}")
        return luminance(Exr(path)), json.loads(report.read_text())

    def row(self, name):
        reference, _ = self.render(name, self.options.reference, REFERENCE_SEED, [])
        errors, ratios, held = [], [], []
        for samples in self.options.samples:
            runs = [self.render(name, samples, seed, self.options.extra) for seed in range(1, self.options.seeds + 1)]
            true = [true_error(picture, reference) for picture, _ in runs]
            reported = [report["relativeError"] for _, report in runs]
            intervals = [report["relativeErrorInterval"] for _, report in runs]
            errors.append(root_mean_square(true))
            ratios.append(root_mean_square(reported) / errors[-1])
            held.append(sum(low <= t <= high for t, (low, high) in zip(true, intervals)))
        return "| " + " | ".join([name, listed(errors, ".3f"), listed(ratios, ".2f"), listed(held, "d")]) + " |"


def luminance(exr):
    planes = [exr.planes[c] for c in LUMINANCE]
    return [sum(w * v for w, v in zip(LUMINANCE.values(), pixel)) for pixel in zip(*planes)]


def true_error(picture, reference):
    return math.sqrt(sum((l - r) ** 2 / (r * r + 1e-4) for l, r in zip(picture, reference)) / len(reference))


def root_mean_square(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def listed(values, form):
    return ", ".join(format(v, form) for v in values)


def main():
    own, extra = sys.argv[1:], []
    if "--" in own:
        own, extra = own[:own.index("--")], own[own.index("--") + 1:]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--work", type=pathlib.Path)
    parser.add_argument("--only", type=lambda text: text.split(","), default=list(SCENES))
    parser.add_argument("--samples", type=lambda text: [int(n) for n in text.split(",")], default=[16, 64, 256])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--reference", type=int, default=16384)
    options = parser.parse_args(own)
    options.extra = extra
    with tempfile.TemporaryDirectory() as scratch:
        options.work = options.work or pathlib.Path(scratch)
        options.work.mkdir(parents=True, exist_ok=True)
        samples = listed(options.samples, "d")
        print(f"| scene | true error at {samples} | reported / true | interval holds, of {options.seeds} |\n|---|---|---|---|")
        for name in options.only:
            if file_of(SCENES[name][0]) and (SCENES[name][1] is None or SCENES[name][1].exists()):
                print(Study(options).row(name), flush=True)


if __name__ == "__main__":
    main()
