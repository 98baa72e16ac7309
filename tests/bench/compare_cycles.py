#!/usr/bin/env python3
"""Samples per second of `tilefarm-worker render` beside Cycles, Blender's path tracer, on the same cores.

    deploy/setup.sh --bench                       # installs the Debian package `blender`
    cmake --preset release && cmake --build --preset release
    tests/bench/compare_cycles.py [--build build/release] [--repeats 3] [--threads 2] [--json out.json]

Both render the same two glTF files, the Cornell box of tests/data and the million-triangle room that
`tilefarm_bench --write-terrain` writes, at the same size with the file's own camera, 16 samples per pixel, no
denoiser, no adaptive sampling and no clamping. A path scatters at most five times in both: Cycles counts bounces
after the first surface, so 5 here is its 4. Russian roulette stays as each program has it by default.

What is timed: each program renders 1 sample per pixel and 16, each from nothing, and the rate is 15 samples per
pixel over the difference of the two times. So loading, scene sync, BVH and kernel compilation, which the two
divide differently between process and render, count for neither. Cycles is timed around bpy.ops.render.render,
Tilefarm around the whole process. Runs of the two alternate; medians count.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

MAX_BOUNCES = 5
FEW, MANY = 1, 16


def inside_blender(scene_file, size, threads):
    """Runs in Blender's own Python: prints the seconds of both renders as a line of JSON."""
    import numpy
    numpy.bool = bool  # glTF importer of Blender 3.4 with numpy 1.24 or newer
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=scene_file)
    scene = bpy.context.scene
    scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.use_persistent_data = False
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.blur_glossy = 0
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = MAX_BOUNCES - 1
    cycles.transmission_bounces = MAX_BOUNCES - 1
    if scene.world is None:
        scene.world = bpy.data.worlds.new("black")
        scene.world.use_nodes = True
        scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
    seconds = {}
    for samples in (FEW, MANY):
        cycles.samples = samples
        start = time.perf_counter()
        bpy.ops.render.render()
        seconds[samples] = time.perf_counter() - start
    print("CYCLES " + json.dumps({"few": seconds[FEW], "many": seconds[MANY]}), flush=True)


def cycles_seconds(scene, size, threads):
    command = ["blender", "--background", "-noaudio", "--factory-startup", "--python-exit-code", "1", "--python",
               __file__, "--", "--inside-blender", str(scene), str(size), str(threads)]
    # The system's Python lives inside Blender, which looks for its modules by PATH: another one there leads it astray.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    done = subprocess.run(command, capture_output=True, text=True, env={**environment, "PATH": "/usr/bin:/bin"})
    for line in done.stdout.splitlines():
        if line.startswith("CYCLES "):
            found = json.loads(line[len("CYCLES "):])
            return found["few"], found["many"]
    sys.exit(f"blender failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def tilefarm_seconds(worker, scene, size, folder, device):
    def render(samples):
        command = [worker, "render", scene, "-o", folder / "ours.exr", "--width", str(size), "--height", str(size),
                   "--samples", str(samples), "--max-bounces", str(MAX_BOUNCES)]
        if device is not None:
            command += ["--device", str(device)]
        start = time.perf_counter()
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"tilefarm-worker failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return time.perf_counter() - start
    return render(FEW), render(MANY)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = pathlib.Path(__file__).resolve().parents[2]
    parser.add_argument("--build", type=pathlib.Path, default=root / "build/release")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--size", type=int, default=512, help="pixels, square")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)), help="of Cycles")
    parser.add_argument("--device", type=int, help="of tilefarm-worker")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    bin_folder = options.build / "bin"
    for program in ("tilefarm-worker", "tilefarm_bench"):
        if not (bin_folder / program).exists():
            sys.exit(f"{bin_folder / program} is not there: build it first")

    results = []
    with tempfile.TemporaryDirectory(prefix="tilefarm-cycles-") as name:
        folder = pathlib.Path(name)
        terrain = folder / "terrain.glb"
        subprocess.run([bin_folder / "tilefarm_bench", "--write-terrain", terrain], check=True)
        pixels = options.size**2
        print(f"{options.size} x {options.size}, {MANY} samples per pixel, {options.threads} threads, "
              f"medians of {options.repeats} runs\n")
        print(f"{'scene':<10}{'Cycles ks/s':>14}{'Tilefarm ks/s':>15}{'ratio':>8}   "
              f"whole {MANY}-sample run, s: Cycles render, Tilefarm process")
        for label, scene in (("cornell", root / "tests/data/cornell.gltf"), ("terrain", terrain)):
            ours, theirs = [], []
            for _ in range(options.repeats):
                theirs.append(cycles_seconds(scene, options.size, options.threads))
                ours.append(tilefarm_seconds(bin_folder / "tilefarm-worker", scene, options.size, folder, options.device))
            rate = lambda runs: statistics.median((MANY - FEW) * pixels / (many - few) for few, many in runs)
            whole = lambda runs: statistics.median(many for _, many in runs)
            row = {"scene": label, "cyclesSamplesPerSecond": rate(theirs), "tilefarmSamplesPerSecond": rate(ours),
                   "ratio": rate(ours) / rate(theirs), "cyclesSeconds": whole(theirs), "tilefarmSeconds": whole(ours)}
            results.append(row)
            print(f"{label:<10}{row['cyclesSamplesPerSecond'] / 1e3:>14.0f}{row['tilefarmSamplesPerSecond'] / 1e3:>15.0f}"
                  f"{row['ratio']:>8.2f}   {row['cyclesSeconds']:.2f}, {row['tilefarmSeconds']:.2f}", flush=True)
    if options.json:
        options.json.write_text(json.dumps({"size": options.size, "threads": options.threads, "results": results}, indent=2))


if __name__ == "__main__":
    if "--inside-blender" in sys.argv:
        file, pixels_across, thread_count = sys.argv[sys.argv.index("--inside-blender") + 1:]
        inside_blender(file, int(pixels_across), int(thread_count))
    else:
        main()
