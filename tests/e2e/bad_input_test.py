"""Bad input gets a message that names the fault and its place; nothing crashes and nothing hangs."""
import json
import unittest

from farm import DATA, SHARED, FarmTest

BAD_SCENES = sorted((SHARED / "bad-inputs").glob("*.gl*")) if SHARED.is_dir() else []
SMALL = dict(width=16, height=16, samples=1)


def tiny(**changes):
    """The JSON of tiny.gltf with members replaced."""
    return {**json.loads((DATA / "tiny.gltf").read_text()), **changes}


class Scenes(FarmTest):
    """Scenes of our own that are broken each in one way, beside those that others collected."""

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())
        return path

    def own_bad_scenes(self):
        nodes = tiny()["nodes"]
        accessors = tiny()["accessors"]
        return [
            (self.write("empty.gltf", b""), "empty.gltf"),
            (self.write("rubbish.glb", b"glTF\2\0\0\0" + b"\xff" * 40), "rubbish.glb"),
            (self.write("cut.gltf", (DATA / "tiny.gltf").read_bytes()[:700]), "cut.gltf"),
            (self.write("mesh.gltf", tiny(nodes=[{**nodes[0], "mesh": 9}, *nodes[1:]])), "/nodes/0/mesh"),
            (self.write("count.gltf", tiny(accessors=[{**accessors[0], "count": 1 << 30}, *accessors[1:]])),
             "/accessors/0"),
            (self.write("required.gltf", tiny(extensionsRequired=["EXT_time_travel"],
                                              extensionsUsed=["EXT_time_travel"])), "EXT_time_travel"),
        ]

    def all_bad_scenes(self):
        return [(path, path.name) for path in BAD_SCENES] + self.own_bad_scenes()


class BadScenesHere(Scenes):
    def test_a_local_render_names_file_and_fault(self):
        for path, place in self.all_bad_scenes():
            with self.subTest(path.name):
                code, _, err = self.run_program("tilefarm-worker", "render", path, "-o", self.folder / "x.exr",
                                                "--cache", self.folder / "cache", "--width", 16, "--height", 16)
                self.assertEqual(code, 1, err)
                self.assertEqual(err.count("\n"), 1, f"one clear line: {err}")
                self.assertIn(path.name, err)
                self.assertIn(place, err)
                self.assertFalse((self.folder / "x.exr").exists())

    def test_missing_files_and_cameras_are_named(self):
        for arguments, named in [
            ((self.folder / "no.glb", "-o", self.folder / "x.exr"), "no.glb"),
            ((DATA / "tiny.gltf", "-o", self.folder / "no" / "x.exr"), "x.exr"),
            ((DATA / "tiny.gltf", "-o", self.folder / "x.exr", "--environment", self.folder / "no.hdr"), "no.hdr"),
            ((DATA / "tiny.gltf", "-o", self.folder / "x.exr", "--camera", "Nobody"), "Nobody"),
            ((DATA / "tiny.gltf", "-o", self.folder / "x.exr", "--device", "99"), "99"),
        ]:
            with self.subTest(named):
                code, _, err = self.run_program("tilefarm-worker", "render", *arguments, "--cache",
                                                self.folder / "cache")
                self.assertEqual(code, 1, err)
                self.assertIn(named, err)


class BadScenesOnTheFarm(Scenes):
    def test_jobs_fail_with_a_message_and_the_farm_goes_on(self):
        self.start_server()
        self.start_workers(3)
        jobs = []
        for path, place in self.all_bad_scenes():
            digest = self.put_blob(path.read_bytes())
            files = {path.name: digest}
            if (SHARED / "bad-inputs" / path.name) == path:
                files["simpleTriangle.bin"] = self.put_blob((path.parent / "simpleTriangle.bin").read_bytes())
            answer = self.call("POST", "/v1/jobs", {"scene": {"files": files, "entry": path.name},
                                                    "image": {"width": 16, "height": 16}, "stop": {"samples": 1}})
            self.assertEqual(answer.status, 201, answer.body)
            jobs.append((path, place, answer.json()["id"]))
        good = self.submit(DATA / "tiny.gltf", **SMALL)
        for path, place, job in jobs:
            with self.subTest(path.name):
                view = self.wait_for_end(job, "failed")
                self.assertIn(path.name, view["faults"][0])
                self.assertIn(place, view["faults"][0])
                self.assertNotIn(str(self.folder), view["faults"][0], "where a worker keeps files is its own affair")
        self.wait_for_end(good)


class BadJobs(FarmTest):
    def faults(self, body, status=400):
        answer = self.call("POST", "/v1/jobs", body, {"Content-Type": "application/json"})
        self.assertEqual(answer.status, status, answer.body)
        self.assertEqual(answer.headers.get_content_type(), "application/problem+json")
        problem = answer.json()
        for member in ("type", "title", "status", "detail", "errors", "retryable"):
            self.assertIn(member, problem)
        return [error["pointer"] for error in problem["errors"]]

    def test_every_fault_is_pointed_at(self):
        self.start_server()
        digest = self.put_blob((DATA / "tiny.gltf").read_bytes())
        good = {"scene": {"files": {"tiny.gltf": digest}, "entry": "tiny.gltf"}}

        def scene(**changes):
            return {"scene": {**good["scene"], **changes}}

        for name, body, pointers in [
            ("nothing", {}, ["/scene"]),
            ("no object", [], [""]),
            ("no files", {"scene": {}}, ["/scene/entry", "/scene/files"]),
            ("no digest", scene(files={"tiny.gltf": "abc"}), ["/scene/files/tiny.gltf"]),
            ("a path that leaves", scene(files={"tiny.gltf": digest, "../a": digest}), ["/scene/files/..~1a"]),
            ("an entry that is not there", scene(entry="other.gltf"), ["/scene/entry"]),
            ("an environment that is not there", scene(environment="sky.hdr"), ["/scene/environment"]),
            ("no width", {**good, "image": {"width": 0}}, ["/image/width"]),
            ("a width in words", {**good, "image": {"width": "640"}}, ["/image/width"]),
            ("half a pixel", {**good, "image": {"height": 1.5}}, ["/image/height"]),
            ("an odd tile", {**good, "image": {"tileSize": 12}}, ["/image/tileSize"]),
            ("no samples", {**good, "stop": {"samples": 0}}, ["/stop/samples"]),
            ("a negative seed", {**good, "settings": {"seed": -1}}, ["/settings/seed"]),
            ("no frames", {**good, "frames": {"count": 0}}, ["/frames/count"]),
            ("a member nobody knows", {**good, "colour": "red"}, ["/colour"]),
            ("one deeper down", {**good, "settings": {"gamma~/": 2}}, ["/settings/gamma~0~1"]),
            ("an unknown way to choose lights", {**good, "settings": {"lightSelection": "best"}},
             ["/settings/lightSelection"]),
            ("a material that is too rough", {**good, "materials": [{"material": "*"}, {"material": "*", "roughness": 2}]},
             ["/materials/1/roughness"]),
            ("a metal nobody measured", {**good, "materials": [{"material": "*", "conductor": "mithril"}]},
             ["/materials/0/conductor"]),
            ("materials without a name", {**good, "materials": [{"roughness": 1}]}, ["/materials/0/material"]),
            ("a point light with a radius", {**good, "lights": [{"kind": "point", "radius": 1}]}, ["/lights/0/radius"]),
            ("a light of no kind", {**good, "lights": [{"intensity": -1}]}, ["/lights/0/intensity", "/lights/0/kind"]),
            ("a dark colour", {**good, "environment": {"kind": "constant", "color": [0, -1, 0]}},
             ["/environment/color/1"]),
            ("a file that is not there", {**good, "environment": {"kind": "file"}}, ["/environment/kind"]),
            ("several at once", {**good, "priority": 101, "camera": 7, "image": {"width": -1, "height": 1e9}},
             ["/camera", "/image/height", "/image/width", "/priority"]),
        ]:
            with self.subTest(name):
                self.assertEqual(sorted(self.faults(body)), pointers)
        with self.subTest("no JSON"):
            self.faults('{"scene": {')
        with self.subTest("a key twice"):
            self.faults('{"scene": {}, "scene": {}}')
        with self.subTest("deep nesting"):
            self.faults("[" * 10000)
        with self.subTest("a blob that was never sent"):
            lost = scene(files={"tiny.gltf": digest, "a/b.bin": "0" * 64})
            self.assertEqual(self.faults(lost, 422), ["/scene/files/a~1b.bin"])
        self.assertEqual(self.get("/v1/jobs")["jobs"], [], "none of them made a job")


class Extensions(Scenes):
    def test_an_unknown_one_that_is_only_used_is_a_warning(self):
        scene = self.write("used.gltf", tiny(extensionsUsed=["EXT_time_travel", "KHR_materials_unlit"]))
        _, report = self.render_here(scene, **SMALL)
        self.assertEqual([w["feature"] for w in report["warnings"]], ["EXT_time_travel"])
        self.start_server()
        self.start_workers(1)
        job = self.submit(scene, **SMALL)
        self.wait_for_end(job)
        report = self.get(f"/v1/jobs/{job}/report")
        self.assertEqual([w["feature"] for w in report["warnings"]], ["EXT_time_travel"])


del Scenes  # has no tests of its own


if __name__ == "__main__":
    unittest.main()
