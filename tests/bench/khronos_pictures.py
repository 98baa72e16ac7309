#!/usr/bin/env python3
"""Renders the Khronos test scenes of ../shared/scenes into docs/khronos, where README.md says what each must show.

    tests/bench/khronos_pictures.py [--build build/release] [--only 15,19] [--samples 128] [--out docs/khronos]

The scenes have no cameras of their own that would show all of them: each is copied to a scratch folder and gets one.
They are lit by the studio of ../shared/environments.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared"
sys.path[:0] = [str(ROOT / "tests/bench/radiance"), str(ROOT / "tests/data")]
from scenes import CAMERA, with_camera

# scene -> width, height, eye, target, vertical field of view in degrees, more options of the worker
VIEWS = {
    "01_alpha_mask": (280, 220, (0.9, 2.4, 2.4), (0, 0, 0.1), 36, []),
    "03_skinned_cylinder": (280, 220, (7, 2.5, 6), (0, -0.2, 0.2), 36, []),
    "15_transmission": (600, 160, (4, 1.6, 14), (4, 0, 0), 13, []),
    "16_volume": (500, 460, (-1.2, 0.9, 40), (-1.2, 0.9, 0), 24, ["--environment-kind", "constant"]),
    "17_ior": (600, 170, (6, 4.2, 17), (6, -0.2, 0), 16, []),
    "19_sheen": (600, 130, (6, 1.6, 22), (6, 0, 0), 8.6, []),
    "20_specular": (600, 130, (6, 1.6, 22), (6, 0, 0), 8.6, []),
    "24_gpu_instancing": (420, 260, (60, 42, 105), (20, 0, 25), 40, []),
    "25_anisotropy": (480, 460, (0.4, 4.9, 30), (0.4, 4.9, 0), 23.5, []),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--only", default="", help="parts of names, with commas between")
    parser.add_argument("--samples", type=int, default=128)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs/khronos")
    parser.add_argument("--exr", type=pathlib.Path, help="folder to keep the EXRs in")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="tilefarm-khronos-") as temporary:
        for name, (width, height, eye, target, fov, more) in VIEWS.items():
            if not any(part in name for part in options.only.split(",")):
                continue
            source = SHARED / f"scenes/khronos-{name}/{name}.gltf"
            folder = pathlib.Path(temporary) / name
            folder.mkdir()
            scene = with_camera(source, folder / source.name, (eye, target, fov), width / height)
            exr = (options.exr or pathlib.Path(temporary)) / f"{name}.exr"
            command = [options.build / "bin/tilefarm-worker", "render", scene, "-o", exr, "--png",
                       options.out / f"{name}.png", "--report", exr.with_suffix(".json"), "--width", width, "--height", height,
                       "--samples", options.samples, "--max-bounces", 16, "--camera", CAMERA,
                       "--environment",
                       SHARED / "environments/brown_photostudio_02_1k.hdr", *more]
            print(name, flush=True)
            subprocess.run([str(c) for c in command], check=True, stderr=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
