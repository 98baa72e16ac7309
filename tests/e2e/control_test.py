"""Jobs can be paused, resumed and canceled, and their pictures fetched at any time and in parts."""
import hashlib

from farm import DATA, FarmTest, until

LONG = dict(width=128, height=128, samples=65536, tile_size=32)  # never to be finished here
SHORT = dict(width=64, height=48, samples=4, tile_size=16)


class Moves(FarmTest):
    def test_cancel_in_the_middle(self):
        self.start_server(lease_seconds=1.5)
        (worker,) = self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **LONG)
        self.wait_for_progress(job, 0.002)
        self.assertEqual(self.call("POST", f"/v1/jobs/{job}/cancel").json()["state"], "canceled")
        self.assertEqual(self.call("POST", f"/v1/jobs/{job}/resume").status, 409)
        next_job = self.submit(DATA / "cornell.gltf", **SHORT)
        self.wait_for_end(next_job)
        self.assertEqual(self.job(job)["state"], "canceled")
        self.assertTrue(worker.running())
        merged = self.job(job)["progress"]["passesMerged"]
        self.wait_for_end(self.submit(DATA / "cornell.gltf", **SHORT, seed=1))
        self.assertEqual(self.job(job)["progress"]["passesMerged"], merged, "nothing comes in after a cancel")

    def test_pause_and_resume(self):
        settings = dict(width=128, height=128, samples=self.samples_for(1.5), tile_size=32)
        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **settings)
        self.wait_for_progress(job)
        self.assertEqual(self.call("POST", f"/v1/jobs/{job}/pause").json()["state"], "paused")
        # The worker is free for others; what it held of the paused job still comes in.
        self.wait_for_end(self.submit(DATA / "tiny.gltf", **SHORT))
        halted = self.job(job)
        self.assertEqual(halted["state"], "paused")
        self.assertLess(halted["progress"]["fraction"], 1)
        self.wait_for_end(self.submit(DATA / "tiny.gltf", **SHORT, seed=1))
        self.assertEqual(self.job(job)["progress"], halted["progress"])
        self.assertEqual(self.call("POST", f"/v1/jobs/{job}/resume").json()["state"], "running")
        self.wait_for_end(job)
        here, _ = self.render_here(DATA / "cornell.gltf", **settings)
        self.assert_same_bits(self.download(job), here)


class Images(FarmTest):
    def test_a_picture_can_be_fetched_while_it_renders(self):
        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **LONG)
        self.wait_for_progress(job, 0.002)
        partial = self.download(job, "partial.exr")
        self.assertIn(b"partial", partial.read_bytes()[:8192])
        few, _ = self.render_here(DATA / "cornell.gltf", **{**LONG, "samples": 1})
        self.cli("compare", partial, few)  # readable, of the same size, finite
        png = self.call("GET", f"/v1/jobs/{job}/frames/0/image.png")
        self.assertEqual((png.status, png.body[:8]), (200, b"\x89PNG\r\n\x1a\n"))
        preview = self.call("GET", f"/v1/jobs/{job}/frames/0/preview.png?width=32")
        self.assertEqual((preview.status, preview.body[:8]), (200, b"\x89PNG\r\n\x1a\n"))
        self.assertLess(len(preview.body), len(png.body))
        self.assertEqual(self.job(job)["state"], "running")

    def test_ranges_and_etags_of_the_final_picture(self):
        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "cornell.gltf", **SHORT)
        self.wait_for_end(job)
        path = f"/v1/jobs/{job}/frames/0/image.exr"
        whole = self.call("GET", path)
        self.assertEqual(whole.status, 200)
        self.assertEqual(whole.headers["ETag"], '"' + hashlib.sha256(whole.body).hexdigest() + '"')
        head = self.call("HEAD", path)
        self.assertEqual((head.status, head.body), (200, b""))
        self.assertEqual(int(head.headers["Content-Length"]), len(whole.body))
        part = self.call("GET", path, headers={"Range": "bytes=100-299"})
        self.assertEqual(part.status, 206)
        self.assertEqual(part.headers["Content-Range"], f"bytes 100-299/{len(whole.body)}")
        self.assertEqual(part.body, whole.body[100:300])
        tail = self.call("GET", path, headers={"Range": "bytes=-10"})
        self.assertEqual((tail.status, tail.body), (206, whole.body[-10:]))
        self.assertEqual(self.call("GET", path, headers={"Range": f"bytes={len(whole.body)}-"}).status, 416)
        same = self.call("GET", path, headers={"If-None-Match": whole.headers["ETag"]})
        self.assertEqual((same.status, same.body), (304, b""))
        here, _ = self.render_here(DATA / "cornell.gltf", **SHORT)
        self.assert_same_bits(self.download(job), here)

    def test_frames_of_a_job_each_have_a_picture(self):
        self.start_server()
        self.start_workers(1)
        job = self.submit(DATA / "tiny.gltf", **SHORT, frames="3-5")
        self.wait_for_end(job)
        frames = self.get(f"/v1/jobs/{job}/frames")["frames"]
        self.assertEqual([(f["frame"], f["state"]) for f in frames], [(n, "completed") for n in (3, 4, 5)])
        here, _ = self.render_here(DATA / "tiny.gltf", **SHORT, frame=4)
        path = self.folder / "frame.exr"
        self.cli("download", job, "--frame", 4, "-o", path)
        self.assert_same_bits(path, here)


class Access(FarmTest):
    def test_a_worker_without_the_token_stops_and_says_so(self):
        token = self.folder / "token"
        token.write_text("secret\n")
        self.start_server("--token-file", token)
        refused = self.start_worker()
        self.assertEqual(refused.wait(), 1)
        self.assertIn("token", refused.log())
        self.assertEqual(self.call("GET", "/v1/jobs").status, 401)
        worker = self.start_worker("--token-file", token)
        until(lambda: self.get("/v1/workers", {"Authorization": "Bearer secret"})["workers"], "the worker to be let in")
        self.assertEqual(worker.stop(), 0)

    def test_a_worker_of_another_version_is_told_which_is_wanted(self):
        self.start_server()
        answer = self.call("POST", "/v1/leases", {"worker": "old", "version": "0.0.1", "wantSeconds": 1})
        self.assertEqual(answer.status, 426)
        self.assertIn("0.0.1", answer.json()["detail"])

    def test_a_worker_waits_for_a_server_that_is_not_there_yet(self):
        self.start_server().stop()
        worker = self.start_worker()
        until(lambda: "cannot reach" in worker.log(), "the worker to try")
        self.start_server()
        self.wait_for_end(self.submit(DATA / "tiny.gltf", **SHORT))
        self.assertEqual(worker.stop(), 0)

    def test_a_worker_at_the_wrong_address_says_so(self):
        for address, words in (("nonsense", "nonsense"), ("http://127.0.0.1:1/path", "URL")):
            code, _, err = self.run_program("tilefarm-worker", "--server", address, "--cache", self.folder / "c")
            self.assertEqual(code, 1)
            self.assertIn(words, err)

    def test_devices_are_listed_for_people_and_for_programs(self):
        code, out, _ = self.run_program("tilefarm-worker", "devices")
        self.assertEqual((code, "usable" in out), (0, True))
        code, out, _ = self.run_program("tilefarm-worker", "devices", "--json")
        self.assertEqual(code, 0)
        self.assertIn('"driver"', out)
