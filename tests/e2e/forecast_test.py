"""What a job would take, before it is submitted and while it is rendered."""
import json

from farm import DATA, FarmTest, option_words

CORNELL = dict(width=96, height=72, tile_size=16)


class Forecast(FarmTest):
    def test_a_pilot_tells_what_the_job_then_takes(self):
        self.start_server()
        self.start_workers(1)
        words = option_words({**CORNELL, "error": 0.1})
        table = self.cli("submit", DATA / "cornell.gltf", "--dry-run", *words).splitlines()
        self.assertEqual(table[0].split(), ["RELATIVE", "ERROR", "SAMPLES", "DEVICE", "TIME", "TIME"])
        self.assertEqual([row.split("%")[0].strip() for row in table[1:]], ["10", "5", "2", "1", "0.5"])
        jobs = self.get("/v1/jobs")["jobs"]
        self.assertEqual([job["spec"]["name"] for job in jobs], ["forecast of cornell"], "the pilot alone")

        expected = self.get(f"/v1/jobs/{jobs[0]['id']}/forecast?relativeError=0.1")["targets"][0]["forecast"]
        job = self.submit(DATA / "cornell.gltf", **CORNELL, error=0.1)
        self.wait_for_end(job)
        frame = self.get(f"/v1/jobs/{job}/report")["frames"][0]
        samples = sum(line["samples"] for line in self.get(f"/v1/jobs/{job}/report")["workers"]) / (96 * 72)
        # Seconds depend on what else this machine does, samples do not. From 16 samples the error is known to about a
        # fifth, and the samples go with its square.
        self.assertLess(abs(samples / expected["samples"] - 1), 0.5)
        self.assertAlmostEqual(frame["forecast"]["outcome"], frame["deviceSeconds"])
        self.assertLess(frame["forecast"]["madeAtDeviceSeconds"], frame["deviceSeconds"])

        view = json.loads(self.cli("forecast", job, "--json"))
        self.assertEqual([row["relativeError"] for row in view["targets"]], [0.05, 0.02, 0.01, 0.005])
        self.assertEqual(view["basis"]["samples"], self.get(f"/v1/jobs/{job}")["samplesMerged"])
