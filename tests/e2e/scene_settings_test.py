"""What a job says of materials, lights, environment and sampling changes its picture, on the farm as in a local render."""
import json
import pathlib

from farm import DATA, FarmTest

SCENE = DATA / "cornell.gltf"
SMALL = dict(width=48, height=48, samples=8, seed=3)
SETTINGS = {
    "a material": dict(material=['{"material": "*", "baseColor": [0.9, 0.4, 0.1], "roughness": 0.3}']),
    "a light": dict(light=['{"kind": "point", "position": [0, 1, 0], "intensity": 2}']),
    "an environment": dict(environment_kind="constant", environment_color=("0.5", "0.6", "0.7")),
    "a knob": dict(max_bounces=1),
}


class SceneSettings(FarmTest):
    def test_each_changes_the_picture(self):
        plain, _ = self.render_here(SCENE, "plain.exr", **SMALL)
        for name, options in SETTINGS.items():
            with self.subTest(name):
                other, report = self.render_here(SCENE, name.replace(" ", "-") + ".exr", **SMALL, **options)
                self.assert_other_bits(other, plain)
                self.assertEqual(report["warnings"], [])

    def test_the_farm_renders_what_a_local_render_does(self):
        together = {key: value for options in SETTINGS.values() for key, value in options.items()}
        # The second file of materials: lists may come from files too.
        overrides = self.folder / "materials.json"
        overrides.write_text(json.dumps([{"material": "*", "metallic": 0, "ior": 1.8}, {"material": "Nobody"}]))
        together["material"] = together["material"] + [overrides]
        here, local = self.render_here(SCENE, **SMALL, **together)
        self.start_server()
        self.start_workers(2)
        job = self.submit(SCENE, **SMALL, **together, tile_size=16)
        self.wait_for_end(job)
        self.assert_same_bits(self.download(job), here)
        with self.subTest("an override that matches nothing is a warning in both reports"):
            for warnings in (local["warnings"], self.get(f"/v1/jobs/{job}/report")["warnings"]):
                self.assertEqual([w["feature"] for w in warnings], ["material override"])
                self.assertIn("Nobody", warnings[0]["instead"])
        with self.subTest("another job of the same scene without them is another picture"):
            bare = self.submit(SCENE, **SMALL, tile_size=16)
            self.wait_for_end(bare)
            plain, _ = self.render_here(SCENE, "plain.exr", **SMALL)
            self.assert_same_bits(self.download(bare, "bare.exr"), plain)

    def test_every_integrator_renders_on_the_farm_what_it_does_here(self):
        self.start_server()
        self.start_workers(1)
        pictures = set()
        for integrator in ("raster", "whitted", "ambient-occlusion", "normal"):
            with self.subTest(integrator):
                settings = dict(width=48, height=48, samples=3, integrator=integrator)
                here, _ = self.render_here(SCENE, integrator + ".exr", **settings)
                job = self.submit(SCENE, **settings, tile_size=16)
                self.wait_for_end(job)
                farm = self.download(job, integrator + "-farm.exr")
                self.assert_same_bits(farm, here)
                pictures.add(pathlib.Path(here).read_bytes())
        self.assertEqual(len(pictures), 4)

    def test_bad_ones_are_refused_before_anything_is_sent(self):
        self.start_server()
        for words, named in [
            (("--material", '{"material": "*", "roughness": 2}'), "/roughness"),
            (("--material", '{"material": "*", "conductor": "mithril"}'), "/conductor"),
            (("--light", '{"kind": "lamp"}'), "/kind"),
            (("--light", '{"kind": "point", "radius": 1}'), "/lights/0/radius"),
            (("--sky-turbidity", "3"), "/environment/sky"),
            (("--integrator", "raster", "--view-kind", "panorama"), "/settings/integrator"),
        ]:
            for program, arguments in (("tilefarm", ("--server", self.url, "submit", SCENE)),
                                       ("tilefarm-worker", ("render", SCENE, "-o", self.folder / "x.exr"))):
                with self.subTest(program + " " + words[1]):
                    code, _, err = self.run_program(program, *arguments, *words)
                    self.assertNotEqual(code, 0)
                    self.assertIn(named, err)
        self.assertEqual(self.get("/v1/jobs")["jobs"], [])


class Variants(FarmTest):
    def test_a_job_chooses_one_by_name(self):
        scene = json.loads((DATA / "cornell.gltf").read_text())
        scene["extensionsUsed"] = scene.get("extensionsUsed", []) + ["KHR_materials_variants"]
        scene.setdefault("extensions", {})["KHR_materials_variants"] = {"variants": [{"name": "odd"}]}
        scene["meshes"][0]["primitives"][0]["extensions"] = {
            "KHR_materials_variants": {"mappings": [{"material": len(scene["materials"]) - 1, "variants": [0]}]}}
        path = self.folder / "variants.gltf"
        path.write_text(json.dumps(scene))
        for buffer in scene["buffers"]:
            if "uri" in buffer and not buffer["uri"].startswith("data:"):
                (self.folder / buffer["uri"]).write_bytes((DATA / buffer["uri"]).read_bytes())
        usual, _ = self.render_here(path, "usual.exr", **SMALL)
        odd, _ = self.render_here(path, "odd.exr", **SMALL, variant="odd")
        self.assert_other_bits(odd, usual)
        self.start_server()
        self.start_workers(1)
        job = self.submit(path, **SMALL, variant="odd")
        self.wait_for_end(job)
        self.assert_same_bits(self.download(job), odd)
        lost = self.submit(path, **SMALL, variant="even")
        self.assertIn("there are odd", self.wait_for_end(lost, "failed")["faults"][0])
