"""A farm of real processes for tests: a server, workers and the command line, all on the loopback interface.

Nothing outlives its test: processes are killed in clean-up, and by the kernel if the test itself is killed. Waits poll
for a fact until a deadline; none is a guess at how long something takes.
"""
import ctypes
import functools
import hashlib
import http.client
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "tests" / "data"
SHARED = ROOT.parent / "shared"
BIN = pathlib.Path(os.environ.get("TILEFARM_BIN", ROOT / "build" / "release" / "bin"))
DEADLINE = 100  # seconds; far beyond what anything takes, also under a sanitizer

_libc = ctypes.CDLL(None)


def _die_with_parent():
    _libc.prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def environment():
    """Compiled kernels are kept from test to test: compiling is most of a small job's time."""
    kernels = pathlib.Path(os.environ.get("TILEFARM_E2E_CACHE", tempfile.gettempdir())) / "kernels"
    kernels.mkdir(parents=True, exist_ok=True)
    return {**os.environ, "MESA_SHADER_CACHE_DIR": str(kernels)}


def until(fact, what, deadline=DEADLINE):
    """The first value of fact() that is true."""
    end = time.monotonic() + deadline
    while time.monotonic() < end:
        value = fact()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"waited {deadline} s in vain for {what}")


@functools.lru_cache(None)
def software_device():
    """The same device on every machine: bits are promised on one device only, and a GPU is over too soon."""
    out = subprocess.run([BIN / "tilefarm-worker", "devices", "--json"], stdout=subprocess.PIPE, check=True).stdout
    devices = [d for d in json.loads(out)["devices"] if d["usable"]]
    return next(d["index"] for d in sorted(devices, key=lambda d: not d["cpu"]))


class Program:
    """A process with its output in files."""

    def __init__(self, folder, name, *arguments):
        self.name = name
        self.out, self.err = folder / f"{name}.out", folder / f"{name}.err"
        with open(self.out, "ab") as out, open(self.err, "ab") as err:
            self.process = subprocess.Popen([str(a) for a in arguments], stdout=out, stderr=err, env=environment(),
                                            preexec_fn=_die_with_parent)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def stop(self):
        """SIGTERM; gives the exit code."""
        self.process.terminate()
        return self.process.wait(DEADLINE)

    def wait(self):
        return self.process.wait(DEADLINE)

    def running(self):
        return self.process.poll() is None

    def log(self):
        return self.out.read_text(errors="replace") + self.err.read_text(errors="replace")


class Answer:
    def __init__(self, response):
        self.status, self.headers, self.body = response.status, response.headers, response.read()

    def json(self):
        return json.loads(self.body)


def option_words(options):
    """width=8, tile_size=16 as --width 8 --tile-size 16; a tuple gives an option several values, a list repeats it."""
    words = []
    for key, values in options.items():
        for value in values if isinstance(values, list) else [values]:
            words += ["--" + key.replace("_", "-"), *(value if isinstance(value, tuple) else (value,))]
    return words


class FarmTest(unittest.TestCase):
    """A test case with an empty folder and, once asked for, a farm."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="tilefarm-e2e-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.programs = []
        self.addCleanup(self.end)
        self.url = None

    def end(self):
        failed = any(error for _, error in getattr(self._outcome, "errors", [])) if self._outcome else False
        result = getattr(self._outcome, "result", None)
        failed = failed or (result and (result.failures or result.errors))
        for program in self.programs:
            program.kill()
            if failed:
                print(f"---- {program.name}\n{program.log()[-4000:]}")

    # ---- programs

    def start(self, name, *arguments):
        program = Program(self.folder, name, *arguments)
        self.programs.append(program)
        return program

    def start_server(self, *options, lease_seconds=30):
        """A server on a free port, or on the one it had before; the data folder stays the same."""
        listen = urllib.parse.urlsplit(self.url).netloc if self.url else "127.0.0.1:0"
        server = self.start(f"server{len(self.programs)}", BIN / "tilefarm-server", "--data", self.folder / "data",
                            "--listen", listen, "--lease-seconds", lease_seconds, *options)

        def listening():
            self.assertTrue(server.running(), server.log())
            return re.search(r"listening on (http://\S+)", server.out.read_text())

        self.url = until(listening, "the server").group(1)
        return server

    def start_worker(self, *options, want_seconds=1):
        number = len(self.programs)
        return self.start(f"worker{number}", BIN / "tilefarm-worker", "--server", self.url, "--cache",
                          self.folder / f"cache{number}", "--name", f"w{number}", "--want-seconds", want_seconds,
                          "--device", software_device(), *options)

    def start_workers(self, count, **options):
        """Workers that have asked for work: they share what comes from the first pass on."""
        workers = [self.start_worker(**options) for _ in range(count)]
        until(lambda: len(self.get("/v1/workers")["workers"]) >= count, "the workers to ask for work")
        return workers

    def samples_for(self, seconds, width=128, height=128, tile_size=32):
        """Samples per pixel that take this machine about so long: a test of something in the middle of a job needs
        one that lasts, on two cores and on sixty-four. Never a power of two, so the last pass is cut."""
        settings = dict(width=width, height=height, tile_size=tile_size)
        self.render_here(DATA / "cornell.gltf", "warm.exr", samples=1, **settings)
        _, report = self.render_here(DATA / "cornell.gltf", "pace.exr", samples=24, **settings)
        pace = report["samples"] / report["seconds"]
        return max(64, int(pace * seconds / (width * height))) | 1

    def run_program(self, program, *arguments, **changed):
        """Runs one to its end, with `changed` environment variables; exit code, standard output, standard error."""
        done = subprocess.run([str(BIN / program), *(str(a) for a in arguments)], env={**environment(), **changed}, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=DEADLINE,
                              preexec_fn=_die_with_parent, check=False)
        return done.returncode, done.stdout, done.stderr

    def cli(self, command, *arguments):
        """Runs the command line, which must succeed; gives its output."""
        options = [] if self.url is None else ["--server", self.url]
        code, out, err = self.run_program("tilefarm", *options, command, *arguments)
        self.assertEqual(code, 0, f"tilefarm {command}: {out}{err}")
        return out

    # ---- REST

    def call(self, method, path, body=None, headers=None):
        where = urllib.parse.urlsplit(self.url)
        connection = http.client.HTTPConnection(where.hostname, where.port, timeout=DEADLINE)
        try:
            if body is not None and not isinstance(body, (bytes, str)):
                body = json.dumps(body)
            connection.request(method, path, body, headers or {})
            return Answer(connection.getresponse())
        finally:
            connection.close()

    def get(self, path, headers=None):
        answer = self.call("GET", path, headers=headers)
        self.assertEqual(answer.status, 200, f"GET {path}: {answer.body[:500]}")
        return answer.json()

    def put_blob(self, data):
        digest = hashlib.sha256(data).hexdigest()
        self.assertIn(self.call("PUT", f"/v1/blobs/{digest}", data).status, (200, 201))
        return digest

    # ---- jobs

    def submit(self, scene, **options):
        """submit(scene, width=8, tile_size=16) and so on; the job's id."""
        words = option_words(options)
        return self.cli("submit", scene, *words).split()[0]

    def job(self, job_id):
        return self.get(f"/v1/jobs/{job_id}")

    def wait_for_progress(self, job_id, least=0.05, most=0.9):
        """Returns in the middle of a job; fails if there was none."""

        def in_the_middle():
            view = self.job(job_id)
            self.assertLessEqual(view["progress"]["fraction"], most, "the job was over too soon for this test")
            return view["progress"]["fraction"] >= least

        until(in_the_middle, f"{least:.0%} of job {job_id}")

    def wait_for_end(self, job_id, state="completed"):
        def ended():
            view = self.job(job_id)
            return view if view["state"] in ("completed", "failed", "canceled") else None

        view = until(ended, f"the end of job {job_id}")
        self.assertEqual(view["state"], state, view["faults"])
        return view

    def download(self, job_id, name="farm.exr"):
        path = self.folder / name
        self.cli("download", job_id, "-o", path)
        return path

    def events(self, job_id):
        return self.get(f"/v1/jobs/{job_id}/events?after=0", {"Accept": "application/json"})["events"]

    # ---- pictures

    def render_here(self, scene, name="local.exr", **options):
        """tilefarm-worker render, which must succeed; gives the EXR and the report."""
        exr, report = self.folder / name, self.folder / (name + ".json")
        words = option_words(options)
        code, out, err = self.run_program("tilefarm-worker", "render", scene, "-o", exr, "--report", report, "--cache",
                                          self.folder / "cache", "--device", software_device(), *words)
        self.assertEqual(code, 0, out + err)
        return exr, json.loads(report.read_text())

    def assert_same_bits(self, a, b):
        code, out, err = self.run_program("tilefarm", "compare", "--identical", a, b)
        self.assertEqual(code, 0, f"{a.name} and {b.name} differ:\n{out}{err}")

    def assert_other_bits(self, a, b):
        self.assertEqual(self.run_program("tilefarm", "compare", "--identical", a, b)[0], 1)
