#!/usr/bin/env python3
"""What one lease, a scrape of the metrics and a page of jobs cost over HTTP as a farm grows. Medians, in
milliseconds. The server's folder lies in memory, so that the disk is not what is measured.

    tests/bench/queue_cost.py [--server build/release/bin/tilefarm-server] [--calls 60]
"""
import argparse
import hashlib
import http.client
import json
import pathlib
import re
import statistics
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = b"{}"
DIGEST = hashlib.sha256(SCENE).hexdigest()


class Server:
    def __init__(self, program, folder):
        self.process = subprocess.Popen([program, "--data", folder, "--listen", "127.0.0.1:0", "--disk-floor-mib", "0"],
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        port = re.search(r":(\d+)\s*$", self.process.stdout.readline()).group(1)
        self.connection = http.client.HTTPConnection("127.0.0.1", int(port), timeout=120)
        self.version = json.loads(self.call("GET", "/healthz")[1])["version"]
        self.call("PUT", f"/v1/blobs/{DIGEST}", SCENE)

    def call(self, method, path, body=None):
        if isinstance(body, dict):
            body = json.dumps(body)
        self.connection.request(method, path, body, {"Content-Type": "application/json"})
        answer = self.connection.getresponse()
        return answer.status, answer.read()

    def submit(self, size=64, priority=50, tile=64, samples=1):
        status, text = self.call("POST", "/v1/jobs", {
            "scene": {"files": {"a.gltf": DIGEST}, "entry": "a.gltf"}, "stop": {"samples": samples}, "priority": priority,
            "image": {"width": size, "height": size, "tileSize": tile}})
        assert status == 201, text

    def lease(self, worker="w"):
        return self.call("POST", "/v1/leases", {"worker": worker, "host": worker, "device": "d", "driver": "d",
                                                "version": self.version, "wantSeconds": 1})

    def give_back(self, lease):
        self.call("POST", f"/v1/leases/{lease['id']}/return", {"epoch": lease["epoch"]})

    def stop(self):
        self.process.terminate()
        self.process.wait()


def median_ms(calls, work):
    times = []
    for _ in range(calls):
        begin = time.perf_counter()
        after = work()
        times.append(1000 * (time.perf_counter() - begin))
        if after:
            after()
    return statistics.median(times)


def lease_cost(server, calls):
    def once():
        status, text = server.lease()
        assert status == 201, (status, text)
        return lambda: server.give_back(json.loads(text))
    return median_ms(calls, once)


def measured(server, calls):
    page = lambda: server.call("GET", "/v1/jobs") and None
    scrape = lambda: server.call("GET", "/metrics") and None
    return f"lease {lease_cost(server, calls):8.3f}   metrics {median_ms(5, scrape):8.3f}   jobs {median_ms(5, page):8.3f}"


def farm_of(program, fill, calls, name):
    with tempfile.TemporaryDirectory(dir="/dev/shm") as folder:
        server = Server(program, folder)
        try:
            fill(server)
            print(f"{name:46} {measured(server, calls)}", flush=True)
        finally:
            server.stop()


def waiting(jobs):
    return lambda server: [server.submit() for _ in range(jobs)]


def on_loan(jobs):
    def fill(server):
        for i in range(jobs):
            server.submit()
            assert server.lease(f"w{i}")[0] == 201
        server.submit(priority=10, size=128)
    return fill


def tiles(side):
    return lambda server: server.submit(size=64 * side, samples=8) or server.lease("first")


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--server", default=ROOT / "build/release/bin/tilefarm-server")
    options.add_argument("--calls", type=int, default=60)
    options.add_argument("--only", default="")
    given = options.parse_args()
    farms = {f"{n:,} queued jobs": waiting(n) for n in (100, 1000, 10000)}
    farms |= {f"{n:,} running jobs wholly on loan": on_loan(n) for n in (10, 1000)}
    farms |= {f"a frame of {side * side:,} queued passes": tiles(side) for side in (32, 128, 512)}
    for name, fill in farms.items():
        if given.only in name:
            farm_of(given.server, fill, given.calls, name)


if __name__ == "__main__":
    main()
