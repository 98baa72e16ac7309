#!/usr/bin/env python3
"""docs/channels.png out of a frame with every channel that a job may ask for:

    tilefarm-worker render tests/data/demo/demo.glb --environment tests/data/demo/sky.hdr -o demo.exr --width 320 \\
        --height 180 --samples 256 --output-light-paths --output-uv --output-cryptomatte
    python3 tests/bench/channels_picture.py demo.exr docs/channels.png

Three to a row: the picture, emission, diffuse direct; diffuse indirect, specular direct, specular indirect;
transmission direct and indirect, texture coordinates; mattes of objects and of materials, and the sum of the ways of
light. Python's standard library alone."""
import pathlib
import struct
import sys
import zlib

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "support"), str(TESTS / "data")]
from exr_image import Exr  # noqa: E402
from gltf_writer import png  # noqa: E402

PATHS = ["emission", "diffuse_direct", "diffuse_indirect", "specular_direct", "specular_indirect",
         "transmission_direct", "transmission_indirect"]  # and of fog, which the demo scene has none of
GAP = 4


def shown(radiance):
    x = min(max(radiance, 0.0), 1.0)
    return round(255 * (12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055))


def colour(exr, prefix=""):
    planes = [exr.planes[prefix + c] for c in "RGB"]
    return [tuple(shown(v) for v in pixel) for pixel in zip(*planes)]


def sums(exr):
    planes = [[sum(values) for values in zip(*(exr.planes[f"{p}.{c}"] for p in PATHS))] for c in "RGB"]
    return [tuple(shown(v) for v in pixel) for pixel in zip(*planes)]


def uv(exr):
    alpha = exr.planes["A"]
    return [tuple(shown(v / a % 1 if a > 0 else 0) for v in (u, w)) + (0,)
            for u, w, a in zip(exr.planes["uv.U"], exr.planes["uv.V"], alpha)]


def mattes(exr, layer):
    """Each id in a colour of its bits, mixed by coverage."""
    ranks = [(exr.planes[f"{layer}{level:02}.{i}"], exr.planes[f"{layer}{level:02}.{c}"])
             for level in range(3) for i, c in ("RG", "BA")]
    pixels = []
    for at in range(exr.width * exr.height):
        mixed = [0.0, 0.0, 0.0]
        for ids, coverage in ranks:
            if coverage[at] > 0:
                bits = zlib.crc32(struct.pack("<f", ids[at]))
                for c in range(3):
                    mixed[c] += coverage[at] * (0.05 + 0.95 * (bits >> 8 * c & 255) / 255) ** 2
        pixels.append(tuple(shown(v) for v in mixed))
    return pixels


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: channels_picture.py FRAME.exr PICTURE.png")
    frame = Exr(sys.argv[1])
    tiles = [colour(frame)] + [colour(frame, p + ".") for p in PATHS] + \
        [uv(frame), mattes(frame, "CryptoObject"), mattes(frame, "CryptoMaterial"), sums(frame)]
    w, h, white = frame.width, frame.height, (255, 255, 255)
    width = 3 * w + 2 * GAP
    rows = []
    for first in range(0, len(tiles), 3):
        if first:
            rows += [[white] * width] * GAP
        for y in range(h):
            parts = [[tuple(p) for p in tile[y * w:(y + 1) * w]] for tile in tiles[first:first + 3]]
            rows.append(parts[0] + [white] * GAP + parts[1] + [white] * GAP + parts[2])
    pathlib.Path(sys.argv[2]).write_bytes(png(width, len(rows), rows))


if __name__ == "__main__":
    main()
