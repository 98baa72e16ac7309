"""A job that kills its workers is set aside, and others go on. The test is the OOM killer, and the supervisor that
starts a worker again at once."""
import time

from farm import BIN, DATA, DEADLINE, FarmTest, SHARED, software_device

HEAVY = dict(width=1024, height=1024, tile_size=1024, samples=4)  # a pass takes long enough to be killed in it
LIGHT = dict(width=32, height=32, tile_size=16, samples=4)


class Poison(FarmTest):
    def supervise(self, name, doomed, done):
        """Keeps a worker running until done(); kills it, SIGKILL, while its log says that it prepared `doomed`.
        How often."""
        kills = 0
        end = time.monotonic() + DEADLINE
        while not done():
            worker = self.start(f"{name}{kills}", BIN / "tilefarm-worker", "--server", self.url, "--cache",
                                self.folder / f"cache-{name}", "--name", name, "--want-seconds", 1, "--device",
                                software_device())
            while not done() and f"job {doomed}:" not in worker.log():
                self.assertTrue(worker.running(), worker.log())
                self.assertLess(time.monotonic(), end, "waited in vain")
                time.sleep(0.02)
            if done():
                self.assertEqual(worker.stop(), 0, worker.log())
                break
            worker.kill()
            kills += 1
            self.assertLess(kills, 20, "killed again and again")
        return kills

    def ended(self, sound):
        return self.job(sound)["state"] == "completed"

    def check(self, scene):
        self.start_server(lease_seconds=30)  # far longer than the test has: deaths show without waiting for it
        poison = self.submit(scene, priority=90, **HEAVY)
        sound = self.submit(DATA / "cornell.gltf", priority=10, **LIGHT)
        kills = self.supervise("w", poison, lambda: self.ended(sound))
        self.assertEqual(kills, 3)
        view = self.job(poison)
        self.assertEqual(view["state"], "paused")
        self.assertIn("3 workers were killed, crashed or vanished", view["setAside"])
        self.assertIn(view["setAside"], view["faults"])
        self.assertIn("error: set aside", self.cli("job", poison))
        code, _, err = self.run_program("tilefarm", "--server", self.url, "wait", poison)
        self.assertEqual(code, 1)
        self.assertIn("the job is set aside", err)
        return poison

    def test_is_set_aside_while_others_go_on(self):
        poison = self.check(DATA / "cornell.gltf")
        self.cli("resume", poison)  # a person has looked: it is tried again
        view = self.job(poison)
        self.assertEqual((view["state"], view["setAside"], view["faults"]), ("running", None, []))

    def test_of_the_shared_case(self):
        case = SHARED / "cases" / "farm-poison-job" / "big.glb"
        if not case.exists():
            self.skipTest("needs the shared cases")
        self.check(case)
