"""Killing a worker or the server costs time and nothing else."""
import signal

from farm import DATA, FarmTest, until

SIZE = dict(width=128, height=128, tile_size=32)


class KillTest(FarmTest):
    def setUp(self):
        super().setUp()
        self.settings = {**SIZE, "samples": self.samples_for(1.5, **SIZE)}


class WorkerKilled(KillTest):
    def test_in_the_middle_of_a_lease(self):
        self.start_server(lease_seconds=1.5)
        (victim,) = self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **self.settings)
        self.wait_for_progress(job)
        victim.kill()
        self.start_worker()
        self.wait_for_end(job)
        lost = [e for e in self.events(job) if e["type"] == "lease" and e["data"]["state"] == "expired"]
        self.assertTrue(lost, "the worker held no lease when it was killed: the test shows nothing")
        here, _ = self.render_here(DATA / "cornell.gltf", **self.settings)
        self.assert_same_bits(self.download(job), here)


class ServerKilled(KillTest):
    def test_in_the_middle_of_a_job(self):
        server = self.start_server(lease_seconds=2)
        workers = self.start_workers(2)
        job = self.submit(DATA / "cornell.gltf", **self.settings)
        for least in (0.05, 0.3):
            self.wait_for_progress(job, least)
            server.kill()
            server = self.start_server(lease_seconds=2)
        self.wait_for_end(job)
        for worker in workers:
            self.assertTrue(worker.running(), worker.log())
        here, _ = self.render_here(DATA / "cornell.gltf", **self.settings)
        self.assert_same_bits(self.download(job), here)


class WorkerTold(KillTest):
    def test_to_stop_hands_back_what_it_holds(self):
        self.start_server(lease_seconds=60)
        (worker,) = self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **self.settings)
        self.wait_for_progress(job)
        self.assertEqual(worker.stop(), 0, worker.log())
        self.start_worker()
        self.wait_for_end(job)  # in vain if a lease of 60 s had to run out first
        self.assertFalse([e for e in self.events(job) if e["type"] == "lease"], "no lease ran out")
        here, _ = self.render_here(DATA / "cornell.gltf", **self.settings)
        self.assert_same_bits(self.download(job), here)

    def test_twice_stops_at_once(self):
        self.start_server()
        (worker,) = self.start_workers(1, want_seconds=10)
        job = self.submit(DATA / "cornell.gltf", width=512, height=512, samples=65536, tile_size=512)
        until(lambda: self.job(job)["state"] == "running", "the job to begin")
        worker.process.send_signal(signal.SIGINT)
        until(lambda: "repeat the signal" in worker.log(), "the first signal to arrive")
        worker.process.send_signal(signal.SIGINT)
        self.assertIn(worker.wait(), (0, 128 + signal.SIGINT))

    def test_keeps_what_the_server_is_not_there_to_take(self):
        server = self.start_server(lease_seconds=60)
        (worker,) = self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **self.settings)
        self.wait_for_progress(job)
        server.kill()
        until(lambda: "cannot reach" in worker.log(), "the worker to notice")
        self.assertEqual(worker.stop(), 0, worker.log())
        kept = list(self.folder.glob("cache*/results/*/*.result"))
        self.start_server(lease_seconds=60)
        again = self.start("again", *worker.process.args)
        self.wait_for_end(job)
        self.assertFalse(list(self.folder.glob("cache*/results/*/*.result")))
        if kept:
            self.assertIn("of an earlier run", again.log())
        here, _ = self.render_here(DATA / "cornell.gltf", **self.settings)
        self.assert_same_bits(self.download(job), here)
