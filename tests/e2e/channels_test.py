"""Channels that a job asks for beside its picture: the same bits on the farm as here, light that adds up, and mattes as
the Cryptomatte 1.2 specification has them, decoded here by what the file alone says."""
import json
import pathlib
import struct
import sys

from farm import DATA, FarmTest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from exr_image import Exr  # noqa: E402

PATHS = ["emission", "diffuse_direct", "diffuse_indirect", "specular_direct", "specular_indirect",
         "transmission_direct", "transmission_indirect", "volume_direct", "volume_indirect"]
WORDS = 0xFFFFFFFF


def murmur3(text):
    """MurmurHash3_x86_32 with seed 0, after Appleby's description."""
    def rotated(x, by):
        return (x << by | x >> (32 - by)) & WORDS

    def scrambled(block):
        return rotated(int.from_bytes(block, "little") * 0xCC9E2D51 & WORDS, 15) * 0x1B873593 & WORDS

    data = text.encode()
    h, blocks = 0, len(data) // 4 * 4
    for i in range(0, blocks, 4):
        h = (rotated(h ^ scrambled(data[i:i + 4]), 13) * 5 + 0xE6546B64) & WORDS
    h ^= scrambled(data[blocks:]) ^ len(data)
    h = (h ^ h >> 16) * 0x85EBCA6B & WORDS
    h = (h ^ h >> 13) * 0xC2B2AE35 & WORDS
    return h ^ h >> 16


class Mattes:
    """One layer of a file, found as readers of Cryptomatte find it: by its header entries."""

    def __init__(self, exr, name):
        key = next(k for k, v in exr.attributes.items() if k.startswith("cryptomatte/") and k.endswith("/name")
                   and v == name.encode())
        prefix = key[:-len("name")]
        assert prefix == f"cryptomatte/{murmur3(name):08x}"[:len("cryptomatte/") + 7] + "/", prefix
        assert exr.attributes[prefix + "hash"] == b"MurmurHash3_32"
        assert exr.attributes[prefix + "conversion"] == b"uint32_to_float32"
        beside = exr.attributes.get(prefix + "manif_file")
        self.manifest = json.loads((exr.path.parent / beside.decode()).read_bytes() if beside else exr.attributes[prefix + "manifest"])
        self.ranks = [(exr.planes[f"{name}{level:02}.{i}"], exr.planes[f"{name}{level:02}.{c}"])
                      for level in range(3) for i, c in ("RG", "BA")]

    def coverage(self, name):
        """A plane of how much of each pixel the name covers."""
        wanted = struct.unpack("<f", struct.pack("<I", int(self.manifest[name], 16)))[0]
        return [sum(c[i] for ids, c in self.ranks if ids[i] == wanted) for i in range(len(self.ranks[0][0]))]


class Cornell(FarmTest):
    def test_farm_and_local_render_agree_and_say_what_is_seen(self):
        options = dict(width=96, height=72, seed=3, samples=40)
        here, _ = self.render_here(DATA / "cornell.gltf", **options, tile_size=16, output_light_paths=(),
                                   output_uv=(), output_cryptomatte=())
        plain, _ = self.render_here(DATA / "cornell.gltf", "plain.exr", **options)
        self.start_server()
        self.start_workers(2)
        job = self.submit(DATA / "cornell.gltf", **options, tile_size=32, output_light_paths=(), output_uv=(),
                          output_cryptomatte=())
        self.wait_for_end(job)
        farm = self.download(job)
        self.assert_same_bits(farm, here)

        a, b = Exr(farm), Exr(here)
        header = {k: v for k, v in b.attributes.items() if k.startswith("cryptomatte/")}
        self.assertEqual(header, {k: v for k, v in a.attributes.items() if k.startswith("cryptomatte/")})
        self.assertEqual(len(header), 8)
        without = Exr(plain)
        for name, plane in without.planes.items():
            self.assertEqual(plane, a.planes[name], f"{name} changed")
        self.assertFalse(any(k.startswith("cryptomatte/") for k in without.attributes))

        self.light_adds_up(a)
        self.mattes_say_what_is_seen(a)

    def light_adds_up(self, exr):
        for c in "RGB":
            for i, whole in enumerate(exr.planes[c]):
                total = sum(exr.planes[f"{path}.{c}"][i] for path in PATHS)
                self.assertAlmostEqual(total, whole, delta=1e-5 * whole)
        for path in PATHS[5:]:  # nothing lets light through
            self.assertEqual(max(exr.planes[path + ".R"]), 0, path)
        self.assertGreater(exr.mean("diffuse_direct.R"), 0)
        self.assertGreater(exr.mean("diffuse_indirect.R"), 0)

    def mattes_say_what_is_seen(self, exr):
        objects, materials = Mattes(exr, "CryptoObject"), Mattes(exr, "CryptoMaterial")
        for mattes in objects, materials:
            for name, digits in mattes.manifest.items():
                self.assertIn(murmur3(name) ^ int(digits, 16), (0, 1 << 23), name)
            for ids, _ in mattes.ranks:
                self.assertLessEqual({struct.pack("<f", i).hex() for i in ids if i},
                                     {int(d, 16).to_bytes(4, "little").hex() for d in mattes.manifest.values()})
            for i, alpha in enumerate(exr.planes["A"]):
                shares = [c[i] for _, c in mattes.ranks]
                self.assertEqual(shares, sorted(shares, reverse=True))
                self.assertAlmostEqual(sum(shares), alpha, delta=1e-6)
        self.assertTrue({"Floor", "Lamp", "Tall block", "Camera"} <= objects.manifest.keys())
        # Nothing but the lamp emits, and all of it alike.
        lamp, emission = objects.coverage("Lamp"), exr.planes["emission.R"]
        radiance = max(e / c for e, c in zip(emission, lamp) if c > 0)
        self.assertGreater(max(lamp), 0)
        for e, c in zip(emission, lamp):
            self.assertAlmostEqual(e, c * radiance, delta=1e-5 * radiance)
        # Walls of two colours are two objects and two materials.
        for wall, paint in ("Left wall", "Red"), ("Right wall", "Green"):
            self.assertEqual(objects.coverage(wall), materials.coverage(paint))
            self.assertGreater(sum(objects.coverage(wall)), 100)
