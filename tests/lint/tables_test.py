"""What shaders/tables/generate.py makes of the tables, and what it refuses."""
import importlib.util
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "shaders" / "tables"


def generator():
    """A fresh one: tests change its tables."""
    sys.path.insert(0, str(TABLES))
    for name in ("features", "lights", "light_text", "materials", "material_text", "records"):
        sys.modules.pop(name, None)
    spec = importlib.util.spec_from_file_location("generate", TABLES / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.path.remove(str(TABLES))
    return module


class Tables(unittest.TestCase):
    def setUp(self):
        self.generate = generator()

    def record(self, *members):
        records = self.generate.records
        return records.Record("R", "R_TEXELS", "", [records.Member(*m) for m in members], "rTexels", "r")

    def test_places_members_one_after_the_other(self):
        record = self.record(("vec3", "a"), ("float", "b"), ("vec2", "c"), ("uint", "d"), ("uint", "e"))
        places = [(m.name, texel, first) for m, texel, first in self.generate.placed(record)]
        self.assertEqual(places, [("a", 0, 0), ("b", 0, 3), ("c", 1, 0), ("d", 1, 2), ("e", 1, 3)])

    def test_refuses_members_across_texels_and_half_filled_ones(self):
        for members in ([("float", "a"), ("float", "b"), ("vec3", "c")], [("vec3", "a")]):
            with self.assertRaisesRegex(SystemExit, "records.py: R"):
                list(self.generate.placed(self.record(*members)))

    def test_readers_take_the_component_that_the_host_wrote(self):
        text = self.generate.member_readers(self.record(("vec3", "a"), ("uint", "b"), ("float", "c"), ("vec3", "d")))
        self.assertIn("vec3 rA(uint index) { return uintBitsToFloat(LOAD(rTexels, index * R_TEXELS + 0u).xyz); }", text)
        self.assertIn("uint rB(uint index) { return LOAD(rTexels, index * R_TEXELS + 0u).w; }", text)
        self.assertIn("float rC(uint index) { return uintBitsToFloat(LOAD(rTexels, index * R_TEXELS + 1u).x); }", text)
        self.assertIn("vec3 rD(uint index) { return uintBitsToFloat(LOAD(rTexels, index * R_TEXELS + 1u).yzw); }", text)

    def test_refuses_features_that_are_there_twice_or_not_at_all(self):
        features = self.generate.features.FEATURES
        features.append(features[0])
        with self.assertRaisesRegex(SystemExit, "twice"):
            self.generate.check()
        features.pop()
        records = self.generate.records
        records.RECORDS.append(records.Record("R", "R_TEXELS", "", [records.Member("float", "a", "", "NONE", "0")]))
        with self.assertRaisesRegex(SystemExit, "R.a: there is no feature NONE"):
            self.generate.check()

    def test_refuses_more_features_than_a_mask_holds(self):
        features = self.generate.features
        features.FEATURES.append(features.Feature("MORE", "more", "job", "path", ""))
        features.FEATURES.append(features.Feature("AND_MORE", "and more", "job", "path", ""))
        features.FEATURES.append(features.Feature("TOO_MANY", "too many", "job", "path", ""))
        with self.assertRaisesRegex(SystemExit, "64"):
            self.generate.feature_constants()

    def test_every_feature_has_a_meaning_and_known_words(self):
        for feature in self.generate.features.FEATURES:
            self.assertTrue(feature.meaning, feature.id)
            self.assertIn(feature.asked_by, {"materials", "lights", "geometry", "camera", "job"}, feature.id)
            self.assertIn(feature.shown_by, {"camera", "surface", "lighting", "tracing", "path", "estimator"}, feature.id)

    def test_the_documents_have_the_table_of_effects(self):
        text = (ROOT / "docs" / "effects.md").read_text()
        self.assertIn(self.generate.effects_table(), text,
                      "write it again: shaders/tables/generate.py effects")

    def test_no_shader_reads_these_records_by_texel_number(self):
        raw = re.compile(r"LOAD(_FLOATS)?\((material|texture|light)Texels\b")
        for path in (p for p in (ROOT / "shaders").rglob("*") if p.suffix in (".glsl", ".comp", ".vert", ".frag")):
            self.assertIsNone(raw.search(path.read_text()), path)

    def test_a_row_of_a_material_reaches_host_job_and_shaders(self):
        materials = self.generate.materials
        materials.PARAMETERS.append(materials.Parameter("glow", "float", 0, "a share", (0, 2), feature="OREN_NAYAR",
                                                        needed="hasDiffuse(m)", point="base"))
        materials.TEXELS = materials.TEXELS.replace("unused", "glow")
        text = {name: make() for name, make in self.generate.material_text.FILES.items()}
        self.assertIn("std::optional<float> glow;  // a share", text["job_material.h"])
        self.assertIn('v.number({"glow", "a share"}, m.glow, NumberRange{0, 2});', text["job_material_fields.h"])
        self.assertIn("float glow{0};  // a share", text["scene_material.h"])
        self.assertIn("set(m.glow, o.glow);", text["scene_material_override.h"])
        self.assertIn("if (m.glow > 0 && hasDiffuse(m)) features |= gpu::bit(gpu::FEATURE_OREN_NAYAR);", text["gpu_material_host.h"])
        self.assertIn("record.glow = m.glow;", text["gpu_material_host.h"])
        self.assertIn("m.glow = materialGlow(index);", text["gpu_material_point.glsl"])
        self.generate.check()

    def test_a_row_of_a_light_reaches_host_and_shaders(self):
        lights, text = self.generate.lights, self.generate.light_text
        lights.LIGHTS.insert(2, lights.Light(("DISK",), "SHAPES", "disk.glsl", "sampleDiskLight(light, pmf, bits, s, l)",
                                             "pmf * diskLightPdf(light, from)", "centreOfDiskLight(light, s, l)", "addDiskShape"))
        self.assertIn("GPU_CONSTANT LIGHT_DISK = 2;", text.constants())
        case = "if (has(FEATURE_SHAPES) && light.type == LIGHT_DISK) "
        self.assertIn('#include "lights/disk.glsl"', text.glsl())
        for what in ("return sampleDiskLight(light, pmf, bits, s, l);", "return pmf * diskLightPdf(light, from);",
                     "found = centreOfDiskLight(light, s, l); else"):
            self.assertIn(case + what, text.glsl())
        self.assertIn("{addDiskShape, addQuadShape, addSphereShape}", text.packers())
        self.generate.check()
        lights.LIGHTS.append(lights.LIGHTS[0])
        with self.assertRaisesRegex(SystemExit, "lights.py: a kind is there twice"):
            self.generate.check()

    def test_refuses_parameters_that_are_there_twice_or_nowhere(self):
        materials = self.generate.materials
        materials.PARAMETERS.append(materials.PARAMETERS[0])
        with self.assertRaisesRegex(SystemExit, "twice"):
            self.generate.check()
        materials.PARAMETERS[-1] = materials.Parameter("glow", "float", 0, "", feature="SHEEN", point="base")
        with self.assertRaisesRegex(SystemExit, "glow is not in TEXELS"):
            self.generate.check()

    def test_writes_files_only_when_their_text_changes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "a")
            self.generate.write(folder, "a", "text")
            os.utime(path, (1, 1))
            self.generate.write(folder, "a", "text")
            self.assertEqual(path.stat().st_mtime, 1)
            self.generate.write(folder, "a", "other")
            self.assertEqual(path.read_text(), "other")

    def test_writes_all_files(self):
        with tempfile.TemporaryDirectory() as folder:
            argv, sys.argv = sys.argv, ["generate.py", "gpu", folder]
            try:
                self.generate.main()
            finally:
                sys.argv = argv
            self.assertEqual({p.name for p in Path(folder).iterdir()},
                             set(self.generate.FILES))


if __name__ == "__main__":
    unittest.main()
