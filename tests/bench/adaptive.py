#!/usr/bin/env python3
"""Compares jobs that stop at an error with jobs of as many samples everywhere, and prints a table of docs/accuracy.md.

    tests/bench/adaptive.py [--bin build/release/bin] [--work FOLDER] [--only demo,cornell] [--size 320x180]
                            [--tile 32] [--samples 16,64,256,1024] [--like 256] [--seeds 3] [--reference 16384]

For each scene the error target is what a uniform render of --like samples reports. Given are, as means over the seeds:
the true error over the target; device seconds over those in which a uniform render comes to the same *true* error
(interpolated between the renders of --samples, on logarithmic scales); samples over those likewise; and the difference of
the mean luminance from the uniform renders' of the same seeds in per mille of it, with its z by the spread over the
seeds. Pictures that FOLDER already has are not rendered again. Needs numpy.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy

from error_estimate import LUMINANCE, REFERENCE_SEED, ROOT, SCENES, Exr, file_of

USUAL = ["demo", "cornell", "own-cornell", "bathroom", "dragon", "materials", "mirrors", "flower"]


class Comparison:
    def __init__(self, options):
        self.options = options

    def render(self, name, label, seed, *words):
        path = self.options.work / f"{name}-{label}-{seed}.exr"
        report = path.with_suffix(".json")
        if not path.exists():
            scene, environment = SCENES[name]
            width, height = self.options.size
            words = [self.options.bin / "tilefarm-worker", "--cache", self.options.work / "cache", "render",
                     file_of(scene), "-o", path, "--report", report, "--width", width, "--height", height, "--seed", seed,
                     *(["--environment", environment] if environment else []), *words]
            done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
            if done.returncode:
                sys.exit(f"{name}: {done.stderr.strip()}")
        return luminance(Exr(path)), json.loads(report.read_text())

    def uniform(self, name, samples, seed):
        return self.render(name, f"uniform{samples}", seed, "--samples", samples)

    def row(self, name):
        options = self.options
        seeds = range(1, options.seeds + 1)
        reference, _ = self.uniform(name, options.reference, REFERENCE_SEED)
        curve = []
        for samples in options.samples:
            runs = [self.uniform(name, samples, seed) for seed in seeds]
            error = root_mean_square([true_error(picture, reference) for picture, _ in runs])
            curve.append((error, statistics.mean(report["deviceSeconds"] for _, report in runs), samples))
        target = root_mean_square([self.uniform(name, options.like, seed)[1]["relativeError"] for seed in seeds])
        runs = [self.render(name, f"error{target:.6f}-{options.tile}", seed, "--relative-error", target, "--tile-size",
                            options.tile) for seed in seeds]
        error = root_mean_square([true_error(picture, reference) for picture, _ in runs])
        seconds = statistics.mean(report["deviceSeconds"] for _, report in runs)
        samples = statistics.mean(report["samples"] for _, report in runs) / math.prod(options.size)
        means = [picture.mean() / self.uniform(name, options.like, seed)[0].mean() - 1
                 for seed, (picture, _) in zip(seeds, runs)]
        spread = statistics.stdev(means) / math.sqrt(len(means)) if len(means) > 1 else math.nan
        in_time, in_samples = at(error, [(e, t) for e, t, _ in curve]), at(error, [(e, n) for e, _, n in curve])
        print(f"| {name} | {target:.4f} | {error / target:.2f} | {seconds / in_time:.2f} | {samples / in_samples:.2f} | "
              f"{samples:.0f} | {1000 * statistics.mean(means):.2f} | {statistics.mean(means) / spread:.1f} |", flush=True)
        return seconds / in_time, samples / in_samples


def luminance(exr):
    return sum(weight * numpy.asarray(exr.planes[channel], dtype=float) for channel, weight in LUMINANCE.items())


def true_error(picture, reference):
    return math.sqrt(((picture - reference) ** 2 / (reference ** 2 + 1e-4)).mean())


def root_mean_square(values):
    return math.sqrt(statistics.mean(v * v for v in values))


def at(error, points):
    """What falls with the error: the line through the two points around it, on logarithmic scales."""
    points = sorted((math.log(e), math.log(cost)) for e, cost in points)
    x = math.log(error)
    i = min(max(sum(e < x for e, _ in points), 1), len(points) - 1)
    (x0, y0), (x1, y1) = points[i - 1], points[i]
    return math.exp(y0 + (y1 - y0) * (x - x0) / (x1 - x0))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--work", type=pathlib.Path)
    parser.add_argument("--only", type=lambda text: text.split(","), default=USUAL)
    parser.add_argument("--size", type=lambda text: [int(n) for n in text.split("x")], default=[320, 180])
    parser.add_argument("--tile", type=int, default=32)
    parser.add_argument("--samples", type=lambda text: [int(n) for n in text.split(",")], default=[16, 64, 256, 1024])
    parser.add_argument("--like", type=int, default=256)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--reference", type=int, default=16384)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        options.work = options.work or pathlib.Path(scratch)
        options.work.mkdir(parents=True, exist_ok=True)
        print("| scene | target | true / target | seconds of uniform's | samples of uniform's | samples | mean, ‰ | its z |\n"
              "|---|---|---|---|---|---|---|---|")
        rows = [Comparison(options).row(name) for name in options.only
                if file_of(SCENES[name][0]) and (SCENES[name][1] is None or SCENES[name][1].exists())]
        print("geometric means:", *(f"{statistics.geometric_mean(column):.2f}" for column in zip(*rows)))


if __name__ == "__main__":
    main()
