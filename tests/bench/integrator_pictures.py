#!/usr/bin/env python3
"""Renders the demo scene with three integrators side by side (docs/integrators.png) and prints the table of
docs/integrators.md of what each took.

    tests/bench/integrator_pictures.py [--build build/release] [--samples 1024] [--repeat 3] [--out docs/integrators.png]

Times are medians of the runs, by the reports of `tilefarm-worker render`: the device's seconds, and seconds by the
clock without loading and compiling. How far a picture is from the path traced one, `tilefarm compare` says. ffmpeg
joins the pictures.
"""
import argparse
import json
import pathlib
import re
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEMO = ROOT / "tests/data/demo"


def render(options, integrator, samples, folder):
    """One picture in `folder`, with its report."""
    report = folder / f"{integrator}.json"
    command = [options.build / "bin/tilefarm-worker", "render", DEMO / "demo.glb", "--environment", DEMO / "sky.hdr",
               "-o", folder / f"{integrator}.exr", "--png", folder / f"{integrator}.png", "--report", report,
               "--integrator", integrator, "--samples", samples, "--width", 480, "--height", 360]
    subprocess.run([str(c) for c in command], check=True, stderr=subprocess.DEVNULL)
    return json.loads(report.read_text())


def difference(options, folder, integrator):
    out = subprocess.run([options.build / "bin/tilefarm", "compare", folder / f"{integrator}.exr", folder / "path.exr"],
                         check=True, capture_output=True, text=True).stdout
    return float(re.search(r"relMSE\D*([\d.e+-]+)", out).group(1))


def join(folder, names, out):
    inputs = [word for name in names for word in ("-i", str(folder / f"{name}.png"))]
    subprocess.run(["ffmpeg", "-y", "-loglevel", "error", *inputs, "-filter_complex", f"hstack=inputs={len(names)}",
                    str(out)], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--samples", type=int, default=1024, help="of the path tracer; the others have no noise and get 16")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs/integrators.png")
    options = parser.parse_args()
    samples = {"raster": 16, "whitted": 16, "path": options.samples}
    with tempfile.TemporaryDirectory(prefix="tilefarm-integrators-") as temporary:
        folder = pathlib.Path(temporary)
        reports = {name: [render(options, name, count, folder) for _ in range(options.repeat)]
                   for name, count in samples.items()}
        join(folder, samples, options.out)
        print(f"{reports['path'][0]['device']}, 480 × 360 pixels, medians of {options.repeat} runs:\n")
        print("| integrator | samples per pixel | device seconds | seconds by the clock | device ms per sample | relMSE to path |")
        print("|---|---|---|---|---|---|")
        for name, count in samples.items():
            device = statistics.median(r["deviceSeconds"] for r in reports[name])
            wall = statistics.median(r["seconds"] for r in reports[name])
            apart = "–" if name == "path" else f"{difference(options, folder, name):.3f}"
            print(f"| `{name}` | {count} | {device:.3f} | {wall:.3f} | {1000 * device / count:.2f} | {apart} |")


if __name__ == "__main__":
    main()
