#!/usr/bin/env python3
"""Renders the Khronos test scenes of ../shared/scenes into docs/khronos, where README.md says what each must show.

    tests/bench/khronos_pictures.py [--build build/release] [--only 15,19] [--samples 128] [--out docs/khronos]

The scenes have no cameras of their own that would show all of them: each is copied to a scratch folder and gets one.
They are lit by the studio of ../shared/environments or by white from everywhere.
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

# A part after a hyphen names a variation. scene -> width, height, eye, target, lens, more options of the worker. Lens: the
# vertical field of view in degrees, or the half height in metres of an orthographic camera, by which equal things in a row
# look equal.
CONSTANT = ["--environment-kind", "constant"]
STUDIO = ["--environment", SHARED / "environments/brown_photostudio_02_1k.hdr"]
BLACK = ["--material", '{"material": "*", "baseColor": [0, 0, 0]}']
VIEWS = {
    "01_alpha_mask": (280, 220, (0.9, 2.4, 2.4), (0, 0, 0.1), {"fov": 36}, STUDIO),
    "03_skinned_cylinder": (280, 220, (7, 2.5, 6), (0, -0.2, 0.2), {"fov": 36}, STUDIO),
    "15_transmission": (480, 120, (4, 2, 10), (4, 0, 0), {"half": 1.3}, STUDIO),
    "15_transmission-dielectric": (480, 120, (4, 2, 10), (4, 0, 0), {"half": 1.3},
                                   [*STUDIO, "--material", '{"material": "*", "metallic": 0, "roughness": 0.1}']),
    "16_volume": (320, 294, (-1.2, 0.9, 40), (-1.2, 0.9, 0), {"fov": 24}, CONSTANT),
    "17_ior": (480, 130, (6, 4.2, 10), (6, -0.1, 0), {"half": 1.95}, STUDIO),
    "19_sheen": (560, 100, (6, 2, 10), (6, 0, 0), {"half": 1.3}, STUDIO),
    "19_sheen-black": (560, 100, (6, 2, 10), (6, 0, 0), {"half": 1.3}, [*STUDIO, *BLACK]),
    "20_specular": (560, 100, (6, 2, 10), (6, 0, 0), {"half": 1.3}, STUDIO),
    "20_specular-black": (560, 100, (6, 2, 10), (6, 0, 0), {"half": 1.3}, [*STUDIO, *BLACK, "--exposure", "3"]),
    "24_gpu_instancing": (360, 220, (60, 42, 105), (20, 0, 25), {"fov": 40}, STUDIO),
    "25_anisotropy": (400, 380, (0.5, 5.0, 30), (0.5, 5.0, 0), {"fov": 23.5}, [*STUDIO, "--exposure", "-1.5"]),
    "25_anisotropy-bands": (280, 280, (0, 6.9, 16), (0, 6.9, 0), {"fov": 20},
                            ["--environment-kind", "none", "--light",
                             '{"kind": "point", "position": [1, 8.9, 14], "intensity": 400}']),
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
        for name, (width, height, eye, target, lens, more) in VIEWS.items():
            if not any(part in name for part in options.only.split(",")):
                continue
            test = name.split("-")[0]
            source = SHARED / f"scenes/khronos-{test}/{test}.gltf"
            folder = pathlib.Path(temporary) / name
            folder.mkdir()
            scene = with_camera(source, folder / source.name, (eye, target, lens.get("fov", 40)),
                                aspect=width / height, half_height=lens.get("half"))
            exr = (options.exr or pathlib.Path(temporary)) / f"{name}.exr"
            command = [options.build / "bin/tilefarm-worker", "render", scene, "-o", exr, "--png",
                       options.out / f"{name}.png", "--report", exr.with_suffix(".json"), "--width", width, "--height", height,
                       "--samples", options.samples, "--max-bounces", 16, "--camera", CAMERA, *more]
            print(name, flush=True)
            subprocess.run([str(c) for c in command], check=True, stderr=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
