"""A study survives the deaths of its server and its workers, and gives the same figures again."""
import csv
import io
import json

from farm import DATA, FarmTest, until

KNOBS = ["--knob", "settings.clampIndirect=0.3", "--knob", "settings.maxBounces=1"]
SIZE = dict(width=32, height=32, tile_size=16, samples=16, seeds=2, reference_samples=128, sample_counts=16)


class Study(FarmTest):
    def study(self, study_id):
        return self.get(f"/v1/studies/{study_id}")

    def submit_study(self):
        words = [word for key, value in SIZE.items() for word in ("--" + key.replace("_", "-"), value)]
        return self.cli("study", *KNOBS, *words, DATA / "cornell.gltf").split()[0]

    def wait_for_study(self, study_id):
        until(lambda: self.study(study_id)["state"] != "running", f"the end of study {study_id}")
        view = self.study(study_id)
        self.assertEqual(view["state"], "completed", view["fault"])
        return view

    @staticmethod
    def figures(view):
        """All that does not depend on time."""
        return [[(cell["samples"], cell["mse"], cell["variance"], cell["bias"], cell["metrics"])
                 for cell in variant["cells"]] for variant in view["result"]["variants"]]

    def test_survives_kills_of_both_sides_and_repeats_to_the_bit(self):
        server = self.start_server(lease_seconds=1.5)
        worker = self.start_worker()
        first = self.submit_study()
        for least in (2, 4):
            until(lambda: self.study(first)["progress"]["jobsDone"] >= least, "some of its jobs")
            self.assertEqual(self.study(first)["state"], "running", "it was over too soon for this test")
            server.kill()
            worker.kill()
            server = self.start_server(lease_seconds=1.5)
            worker = self.start_worker()
        view = self.wait_for_study(first)
        self.assertEqual(view["progress"], dict(jobs=7, jobsDone=7, cells=3, cellsMeasured=3))
        made = len(self.get("/v1/jobs?limit=1000")["jobs"])
        self.assertEqual(made, 7)

        again = self.wait_for_study(self.submit_study())
        self.assertEqual(self.figures(again), self.figures(view))
        self.assertEqual(again["referenceJob"], view["referenceJob"])
        self.assertEqual(len(self.get("/v1/jobs?limit=1000")["jobs"]), made + 6)

        # What it says is right: one bounce loses light, and the reports say it in every form.
        bounced = view["result"]["variants"][2]["cells"][0]
        self.assertLess(bounced["bias"]["percent"], -5)
        self.assertTrue(bounced["biased"])
        page, table, whole = (self.folder / f"study.{kind}" for kind in ("html", "csv", "json"))
        shown = self.cli("studies", first, "-o", page, "-o", table, "-o", whole)
        self.assertIn(view["result"]["verdict"], shown)
        self.assertIn("settings.maxBounces = 1", page.read_text())
        self.assertEqual(json.loads(whole.read_text()), self.study(first))
        rows = list(csv.DictReader(io.StringIO(table.read_text())))
        self.assertEqual([row["variant"] for row in rows],
                         ["base", "settings.clampIndirect = 0.3", "settings.maxBounces = 1"])
        self.assertIn(first, self.cli("studies"))

    def test_names_the_knob_that_no_job_has(self):
        self.start_server()
        code, _, err = self.run_program("tilefarm", "--server", self.url, "study", "--knob", "settings.maxbounces=1",
                                        DATA / "cornell.gltf")
        self.assertNotEqual(code, 0)
        self.assertIn("/knobs/0/values/0", err)
        self.assertIn("maxbounces", err)
