#!/usr/bin/env python3
"""Before and after of the hard cases: docs/hard-cases/*.png and the figures in docs/hard-cases.md.

    tests/numerics/naive/pictures.py [--work FOLDER] [--only NAME …] [--out docs]
    tests/numerics/naive/pictures.py --check

Each patch here swaps one technique of the renderer for its textbook form. The script copies the tree, builds
tilefarm-worker as it is and under one patch after the other, renders the same scene with the same seed by both, and
writes "before | after". relMSE is against the renderer as it is with another seed and 8 times the samples.
--check only asks whether every patch still applies.
"""
import argparse
import dataclasses
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(ROOT / "tests/data"), str(ROOT / "tests/support")]
import scenes  # noqa: E402
from exr_image import Exr  # noqa: E402
from gltf_writer import png  # noqa: E402

SIZE = 176  # pixels, of each of the two pictures
TREE = ["CMakeLists.txt", "CMakePresets.json", "server", "shaders", "shared", "worker"]


@dataclasses.dataclass
class Case:
    name: str          # of the picture; begins with the number of the case
    patch: str
    scene: object      # writes the glTF at a path and gives the options to render it with
    samples: int = 64
    bounces: int = 6
    exposure: float = 1.0
    faults: bool = False  # with one NaN in 1e5 samples


CASES = [
    Case("01_watertight", "moeller_trumbore", scenes.cracks, samples=16, bounces=1),
    Case("04_scale_100000", "constant_epsilon", lambda path: scenes.scaled(path, 1e5)),
    Case("04_scale_0.001", "constant_epsilon", lambda path: scenes.scaled(path, 1e-3)),
    Case("05_translation", "float_transforms", lambda path: scenes.moved(path, 1e6)),
    Case("06_thin_gap", "constant_epsilon", scenes.thin_gap, bounces=12),
    Case("07_far_sphere", "quadratic_formula", scenes.far_ball),
    Case("08_small_far_lamp", "cos_theta_max", scenes.small_far_lamp),
    Case("17_grazing_normal_map", "unbent_normals", scenes.steep_bumps),
    Case("23_tiny_roughness", "textbook_d", scenes.tiny_highlight),
    Case("25_critical_angle", "unguarded_fresnel", scenes.gem, samples=48, bounces=12),
    Case("43_nan_samples", "every_sample_counts", scenes.plain, samples=128, faults=True),
    Case("51_sphere_light", "cos_theta_max", scenes.lamp_around),
]


def patches():
    return sorted(HERE.glob("*.patch"))


def hunks(patch):
    """(file, old lines, new lines) of each hunk of a unified diff."""
    found, file = [], None
    for line in patch.read_text().splitlines(keepends=True):
        if line.startswith("--- "):
            continue
        if line.startswith("+++ b/"):
            file = line[6:].strip()
        elif line.startswith("@@"):
            found.append((file, [], []))
        elif found:
            if line[0] in " -":
                found[-1][1].append(line[1:])
            if line[0] in " +":
                found[-1][2].append(line[1:])
    return [(file, "".join(old), "".join(new)) for file, old, new in found]


def apply(patch, texts):
    """Changes `texts`, of files by their paths; gives the first fault, or None. A hunk's lines have to stand in the file
    once, wherever that is. (No `patch`, no git: this works in an export too.)"""
    for file, old, new in hunks(patch):
        if texts[file].count(old) != 1:
            return f"{patch.name}: these lines stand {texts[file].count(old)} times in {file}:\n{old}"
        texts[file] = texts[file].replace(old, new)
    return None


def sources(patch):
    return {file: (ROOT / file).read_text() for file in sorted({hunk[0] for hunk in hunks(patch)})}


def check():
    """What is wrong with the patches and pictures, a line each."""
    faults = [apply(patch, sources(patch)) for patch in patches()]
    named, there = {case.patch for case in CASES}, {patch.stem for patch in patches()}
    faults += [f"{name}: a patch without a case, or a case without a patch" for name in sorted(named ^ there)]
    faults += [f"{case.name}: no picture" for case in CASES if not (ROOT / f"docs/hard-cases/{case.name}.png").exists()]
    return [fault for fault in faults if fault]


class Builds:
    """Workers by patch (None: as it is), built in one copy of the tree."""

    def __init__(self, work):
        self.work, self.tree = work, work / "tree"
        for old in work.glob("worker-*"):
            old.unlink()
        if self.tree.exists():
            shutil.rmtree(self.tree)
        self.tree.mkdir(parents=True)
        for name in TREE:
            source = ROOT / name
            (shutil.copytree if source.is_dir() else shutil.copy)(source, self.tree / name)
        # As if compiled in place, so that ccache knows the files that no patch touches.
        self.environment = {**os.environ, "CCACHE_BASEDIR": str(self.tree), "CCACHE_NOHASHDIR": "1"}
        self.run("cmake", "--preset", "release", "-DTILEFARM_TESTS=OFF", "-DTILEFARM_BENCH=OFF")

    def run(self, *command):
        result = subprocess.run(command, cwd=self.tree, env=self.environment, capture_output=True, text=True)
        if result.returncode != 0:
            sys.exit(f"{' '.join(command)}:\n{result.stdout[-4000:]}{result.stderr[-4000:]}")

    def worker(self, patch):
        built = self.work / f"worker-{patch or 'as-it-is'}"
        if not built.exists():
            texts = sources(HERE / f"{patch}.patch") if patch else {}
            before = dict(texts)
            if patch and (fault := apply(HERE / f"{patch}.patch", texts)):
                sys.exit(fault)
            self.write(texts)
            self.run("cmake", "--build", "--preset", "release", "--target", "tilefarm-worker")
            shutil.copy(self.tree / "build/release/bin/tilefarm-worker", built)
            self.write(before)
        return built

    def write(self, texts):
        for file, text in texts.items():
            (self.tree / file).write_text(text)


def render(worker, case, scene, options, out, seed, samples):
    """The planes of a picture and its report's numerics."""
    command = [worker, "render", scene, "-o", f"{out}.exr", "--report", f"{out}.json", "--width", SIZE, "--height", SIZE,
               "--seed", seed, "--samples", samples, "--max-bounces", case.bounces, "--roulette-start", case.bounces, *options]
    faults = {"TILEFARM_INJECT_FAULTS": "1"} if case.faults and seed == 1 else {}
    done = subprocess.run([str(c) for c in command], env={**os.environ, **faults}, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{case.name}: {done.stderr[-2000:]}")
    exr = Exr(f"{out}.exr")
    pixels = list(zip(*(exr.planes[c] for c in "RGB")))
    return pixels, json.loads(pathlib.Path(f"{out}.json").read_text())["numerics"]


def figures(pixels, numerics, reference):
    """relMSE, with what is not finite taken as black; the share of black pixels and of those that are not finite."""
    difference = square = black = bad = 0
    for pixel, exact in zip(pixels, reference):
        finite = all(math.isfinite(c) for c in pixel)
        bad += not finite
        shown = pixel if finite else (0, 0, 0)
        black += finite and not sum(shown) > 0
        difference += sum((a - b) ** 2 for a, b in zip(shown, exact))
        square += sum(b * b + 1e-4 for b in exact)
    share = 100 / len(pixels)
    return {"relMSE": difference / square, "black": black * share, "notFinite": bad * share,
            "dropped": numerics["droppedSamples"]}


def shown(pixel, exposure):
    if not all(math.isfinite(c) for c in pixel):
        return (255, 0, 255)
    srgb = lambda c: 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055
    return tuple(min(255, max(0, round(255 * srgb(min(max(exposure * c, 0.0), 1.0))))) for c in pixel)


def side_by_side(before, after, exposure):
    gap = [(255, 255, 255)] * 4
    rows = []
    for y in range(SIZE):
        row = slice(y * SIZE, (y + 1) * SIZE)
        rows.append([shown(p, exposure) for p in before[row]] + gap + [shown(p, exposure) for p in after[row]])
    return png(2 * SIZE + 4, SIZE, rows)


def sentence(before, after):
    """What was measured, for the page. Figures that are 0 in both go without saying."""
    pair = lambda key, text: f"; {text} {before[key]:.3g} % and {after[key]:.3g} %" if before[key] + after[key] >= 0.01 else ""
    dropped = f"; samples left out {before['dropped']} and {after['dropped']}" if before["dropped"] + after["dropped"] else ""
    return (f"Before and after: relMSE {before['relMSE']:.2g} and {after['relMSE']:.2g}" + pair("black", "black pixels") +
            pair("notFinite", "pixels that are NaN") + dropped + ".")


def write_figures(page, results):
    """Writes the sentences where the page has `<!-- name -->` at the end of a line."""
    lines = page.read_text().split("\n")
    for i, line in enumerate(lines):
        for name, result in results.items():
            if line.endswith(f"<!-- {name} -->"):
                lines[i] = f"{sentence(**result)} <!-- {name} -->"
    page.write_text("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="whether the patches apply; builds and renders nothing")
    parser.add_argument("--work", type=pathlib.Path, help="where the copy is built, and kept; default: a temporary folder")
    parser.add_argument("--only", nargs="*", help="names of pictures, or how they begin")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs")
    options = parser.parse_args()
    if options.check:
        sys.exit("\n".join(check()) or 0)
    with tempfile.TemporaryDirectory(prefix="tilefarm-hard-cases-") as temporary:
        work = (options.work or pathlib.Path(temporary)).resolve()
        builds, results = Builds(work), {}
        (options.out / "hard-cases").mkdir(parents=True, exist_ok=True)
        for case in CASES:
            if options.only and not any(case.name.startswith(name) for name in options.only):
                continue
            scene = work / f"{case.name}.glb"
            more = case.scene(scene)
            after = builds.worker(None)
            reference, _ = render(after, case, scene, more, work / f"{case.name}-reference", 2, 8 * case.samples)
            pictures = {"before": render(builds.worker(case.patch), case, scene, more, work / f"{case.name}-before", 1, case.samples),
                        "after": render(after, case, scene, more, work / f"{case.name}-after", 1, case.samples)}
            results[case.name] = {key: figures(*value, reference) for key, value in pictures.items()}
            print(case.name, json.dumps(results[case.name]), flush=True)
            (options.out / f"hard-cases/{case.name}.png").write_bytes(
                side_by_side(pictures["before"][0], pictures["after"][0], case.exposure))
        if (options.out / "hard-cases.md").exists():
            write_figures(options.out / "hard-cases.md", results)


if __name__ == "__main__":
    main()
