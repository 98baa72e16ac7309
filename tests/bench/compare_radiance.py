#!/usr/bin/env python3
"""Radiance of `tilefarm-worker render` beside Cycles, Blender's path tracer, scene by scene.

    deploy/setup.sh --bench                       # installs the Debian package `blender`
    cmake --preset release && cmake --build --preset release
    tests/bench/compare_radiance.py [--only matte,glass] [--list] [--json out.json] [--pictures folder]

Both render the same glTF geometry and camera with the same lights and surroundings into linear EXR: box filter, no
clamping, no denoiser, no adaptive sampling, the same number of surfaces that may scatter (Cycles counts them from the
second). Materials of Cycles are built from nodes that have Tilefarm's model (radiance/in_blender.py says how, and
derives the units of its lamps), because Blender's Principled BSDF is another one than glTF's.

The mean radiance of the picture is compared per channel, as the ratio Tilefarm / Cycles with its standard error: from
the variance of every pixel here, from the spread of several renders with seeds of their own in Cycles. The verdict:
    agrees      |ratio - 1| + 2 standard errors <= 1 %
    differs     |ratio - 1| - 2 standard errors >  1 %
    undecided   neither: more samples are needed (--samples multiplies them)
Beside it, the largest deviation of a block of an 8 x 8 grid from equal radiance, in percent of the picture's mean and
in standard errors: a picture that is turned or mirrored may keep its mean.

Scenes whose models differ by design are listed with the reason and are not judged. Exits with 1 unless all agree.
"""
import argparse
import dataclasses
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/support"), str(ROOT / "tests/data"), str(ROOT / "tests/bench/radiance")]
import scenes
from exr_image import Exr
from gltf_writer import png
from textures import to_srgb

TOLERANCE = 0.01
GRID = 8
SEEDS = 8  # renders of Cycles


def run(command, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def render_cycles(comparison, folder, size, samples, threads):
    outputs = [str(folder / f"{comparison.name}_cycles_{i}.exr") for i in range(SEEDS)]
    order = folder / f"{comparison.name}.json"
    order.write_text(json.dumps({**dataclasses.asdict(comparison), "scene": str(comparison.scene), "size": size,
                                 "samples": max(1, samples // SEEDS), "threads": threads, "outputs": outputs}))
    # The system's Python lives inside Blender, which looks for its modules by PATH: another one there leads it astray.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    run(["blender", "--background", "-noaudio", "--factory-startup", "--python-exit-code", "1", "--python",
         ROOT / "tests/bench/radiance/in_blender.py", "--", order], env={**environment, "PATH": "/usr/bin:/bin"})
    return [Exr(path) for path in outputs]


def render_tilefarm(comparison, folder, size, samples, options):
    out = folder / f"{comparison.name}_tilefarm.exr"
    command = [options.build / "bin/tilefarm-worker", "render", comparison.scene, "-o", out, "--width", size, "--height",
               size, "--samples", samples, "--max-bounces", comparison.bounces, "--camera", comparison.camera]
    command += job_options(comparison)
    if options.device is not None:
        command += ["--device", options.device]
    run(command)
    return Exr(out)


def job_options(comparison):
    """What the comparison asks of the job, as options of `tilefarm-worker render`."""
    environment = comparison.environment or {}
    found = ["--environment", environment["file"]] if environment else []
    for key in ("rotation", "intensity"):
        if key in environment:
            found += [f"--environment-{key}", environment[key]]
    for light in comparison.lights:
        found += ["--light", json.dumps(light)]
    for key, value in comparison.settings.items():
        name = "".join("-" + c.lower() if c.isupper() else c for c in key)
        found += [f"--{name}" if value else f"--no-{name}"] if isinstance(value, bool) else [f"--{name}", value]
    return found


# ---- Statistics


def blocks(size):
    edge = [round(size * k / GRID) for k in range(GRID + 1)]
    return [(edge[i], edge[j], edge[i + 1], edge[j + 1]) for j in range(GRID) for i in range(GRID)]


def of_tilefarm(picture, channel, rect):
    """Mean over a rectangle and its standard error: pixels and samples are independent."""
    pixels = (rect[2] - rect[0]) * (rect[3] - rect[1])
    return picture.mean(channel, *rect), math.sqrt(max(0, picture.mean(f"variance.{channel}", *rect)) / pixels)


def of_cycles(pictures, channel, rect):
    means = [picture.mean(channel, *rect) for picture in pictures]
    mean = sum(means) / len(means)
    return mean, math.sqrt(sum((m - mean)**2 for m in means) / (len(means) - 1) / len(means))


def compare(ours, theirs):
    result = {}
    whole = (0, 0, ours.width, ours.height)
    for channel in "RGB":
        (a, ea), (b, eb) = of_tilefarm(ours, channel, whole), of_cycles(theirs, channel, whole)
        if min(a, b) <= 0:
            sys.exit(f"{theirs[0].path}: channel {channel} is black: {a} and {b}")
        ratio = a / b
        error = ratio * math.hypot(ea / a, eb / b)
        worst, worst_z = 0.0, 0.0
        for rect in blocks(ours.width):
            (x, ex), (y, ey) = of_tilefarm(ours, channel, rect), of_cycles(theirs, channel, rect)
            if abs(x - y) > abs(worst):
                worst, worst_z = x - y, (x - y) / max(math.hypot(ex, ey), 1e-12)
        result[channel] = {"tilefarm": a, "tilefarmError": ea, "cycles": b, "cyclesError": eb, "ratio": ratio,
                           "error": error, "worstBlock": worst / b, "worstBlockErrors": worst_z}
    return result


def verdict(channels):
    deviations = [(abs(c["ratio"] - 1), 2 * c["error"]) for c in channels.values()]
    if all(d + e <= TOLERANCE for d, e in deviations):
        return "agrees"
    return "differs" if any(d - e > TOLERANCE for d, e in deviations) else "undecided"


def row(result):
    channels = result["channels"].values()
    block = max(channels, key=lambda c: abs(c["worstBlock"]))
    return (f"{result['scene']:<18}" + "  ".join(f"{c['ratio']:.4f} ± {c['error']:.4f}" for c in channels) +
            f"   {block['worstBlock']:+7.1%} ({block['worstBlockErrors']:+5.1f})   {result['verdict']}")


def side_by_side(path, ours, theirs):
    """Tilefarm on the left, Cycles on the right; sRGB, cut off at white."""
    size = ours.width

    def pixel(pictures, at):
        return tuple(to_srgb(sum(p.planes[c][at] for p in pictures) / len(pictures)) for c in "RGB")

    rows = [[pixel([ours], y * size + x) for x in range(size)] + [(0, 0, 0)] * 2 +
            [pixel(theirs, y * size + x) for x in range(size)] for y in range(size)]
    path.write_bytes(png(2 * size + 2, size, rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--only", default="", help="parts of names, with commas between")
    parser.add_argument("--list", action="store_true", help="names the scenes and models")
    parser.add_argument("--size", type=int, default=128, help="pixels, square")
    parser.add_argument("--samples", type=float, default=1.0, help="times those of each scene")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)), help="of Cycles")
    parser.add_argument("--device", type=int, help="of tilefarm-worker")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for PNGs, Tilefarm left, Cycles right")
    parser.add_argument("--keep", type=pathlib.Path, help="folder to work in that stays")
    options = parser.parse_args()

    wanted = [part for part in options.only.split(",") if part]
    results = []
    if not options.list:
        print(f"{'scene':<18}" + "  ".join(f"{c + ', ratio ± s.e.':<15}" for c in "RGB") + "   worst block (s.e.)   verdict")
    with tempfile.TemporaryDirectory(prefix="tilefarm-radiance-") as temporary:
        folder = options.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for make in scenes.SCENES:
            if wanted and not any(part in make.__name__.replace("_", "-") for part in wanted):
                continue
            comparison = make(folder)
            if comparison is None:
                continue
            if options.list:
                print(f"{comparison.name:<18}{comparison.what}")
                continue
            samples = max(SEEDS, round(comparison.samples * options.samples))
            ours = render_tilefarm(comparison, folder, options.size, samples, options)
            theirs = render_cycles(comparison, folder, options.size, samples, options.threads)
            channels = compare(ours, theirs)
            decided = verdict(channels) if comparison.same else "other model"
            results.append({"scene": comparison.name, "models": comparison.what, "why": comparison.why, "samples": samples,
                            "bounces": comparison.bounces, "verdict": decided, "channels": channels})
            print(row(results[-1]), flush=True)
            if options.json:  # as far as it has come
                options.json.write_text(json.dumps({"size": options.size, "tolerance": TOLERANCE, "results": results},
                                                   indent=2))
            if options.pictures:
                options.pictures.mkdir(parents=True, exist_ok=True)
                side_by_side(options.pictures / f"{comparison.name}.png", ours, theirs)
    sys.exit(any(r["verdict"] not in ("agrees", "other model") for r in results))


if __name__ == "__main__":
    main()
