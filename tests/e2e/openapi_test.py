"""The description of the API is valid OpenAPI 3.1, by a validator from npm that package-lock.json pins, names the query
parameters that the server reads, and describes every answer that real programs get."""
import copy
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

from farm import DATA, FarmTest, ROOT, until
from recorder import Recorder

try:
    from jsonschema import Draft202012Validator
except ImportError:
    Draft202012Validator = None

HERE = pathlib.Path(__file__).resolve().parent / "openapi"
CACHE = pathlib.Path(os.environ.get("TILEFARM_E2E_CACHE", tempfile.gettempdir())) / "openapi"
IN_CI = "TILEFARM_CI" in os.environ


class Description(FarmTest):
    def validator(self):
        """Installed once for each build folder. Skips where there is no npm, but not in CI, and where its registry is not
        reached: that says nothing about us."""
        program = CACHE / "node_modules" / ".bin" / "validate-api"
        if not program.exists():
            if not shutil.which("npm") and not IN_CI:
                self.skipTest("needs npm")
            CACHE.mkdir(parents=True, exist_ok=True)
            for name in ("package.json", "package-lock.json"):
                shutil.copy(HERE / name, CACHE)
            done = subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"], cwd=CACHE, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            if re.search(r"ENOTFOUND|EAI_AGAIN|ECONN|ETIMEDOUT|ENETUNREACH|E403|E404|E5\d\d", done.stdout):
                self.skipTest("npm's registry gives nothing: " + done.stdout[-300:])
            self.assertEqual(done.returncode, 0, done.stdout)
        return program

    def validate(self, document):
        file = self.folder / "openapi.json"
        file.write_text(json.dumps(document))
        done = subprocess.run([self.validator(), file], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              check=False)
        return json.loads(done.stdout)

    def test_is_valid(self):
        self.start_server()
        document = self.get("/v1/openapi.json")
        self.assertEqual(self.validate(document), {"valid": True})
        # The validator looks at what it is given: members of an operation in each other's places.
        shifted = copy.deepcopy(document)
        operation = shifted["paths"]["/v1/jobs/{job}/frames/{frame}/image.exr"]["get"]
        operation["requestBody"] = operation["description"]
        self.assertFalse(self.validate(shifted)["valid"])
        shifted = copy.deepcopy(document)
        shifted["paths"]["/v1/jobs"]["get"]["tags"] = [None]
        self.assertFalse(self.validate(shifted)["valid"])

    def test_is_listed_in_the_documents(self):
        self.start_server()
        table = (ROOT / "docs" / "api.md").read_text()
        for path, operations in self.get("/v1/openapi.json")["paths"].items():
            for method, operation in operations.items():
                self.assertIn(f"| `{method.upper()} {path}` | {operation['summary']} |", table)

    def test_names_the_query_parameters_that_are_read(self):
        read = set()
        for source in (ROOT / "server" / "api").glob("*.cpp"):
            read |= set(re.findall(r'\bqueried(?:Integer|Number|Flag)?\("(\w+)"', source.read_text()))
        self.start_server()
        described = {parameter["name"]
                     for operations in self.get("/v1/openapi.json")["paths"].values()
                     for operation in operations.values()
                     for parameter in operation.get("parameters", []) if parameter["in"] == "query"}
        self.assertIn("cursor", read)
        self.assertEqual(described, read)


def strict(schema):
    """The same, where an object has no members but those that are named."""
    if isinstance(schema, list):
        return [strict(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    changed = {key: strict(value) for key, value in schema.items()}
    if isinstance(schema.get("properties"), dict) and schema.get("type") == "object":
        changed.setdefault("additionalProperties", False)
    return changed


class Answers(FarmTest):
    def setUp(self):
        super().setUp()
        if Draft202012Validator is None and not IN_CI:
            self.skipTest("needs python3-jsonschema")

    def described(self, exchange):
        """The operation of an exchange; its path is the one with the most words that are not parameters."""
        found = [path for path in self.document["paths"]
                 if re.fullmatch(re.sub(r"{\w+}", "[^/]+", path), exchange.path)]
        self.assertTrue(found, exchange.path)
        return self.document["paths"][min(found, key=lambda path: path.count("{"))][exchange.method.lower()]

    def check(self, exchange):
        operation = self.described(exchange)
        place = f"{operation['operationId']}: {exchange.status} {exchange.type}: {exchange.body[:300]}"
        self.assertIn(str(exchange.status), operation["responses"], place)
        content = operation["responses"][str(exchange.status)].get("content", {})
        if not exchange.body:
            return operation["operationId"]
        media = exchange.type.split(";")[0]
        self.assertIn(media, content, place)
        if media.endswith("json"):
            schema = {**content[media]["schema"], "components": self.document["components"]}  # what it refers to
            faults = Draft202012Validator(schema).iter_errors(json.loads(exchange.body))
            self.assertEqual([f"{list(fault.absolute_path)}: {fault.message[:300]}" for fault in faults], [], place)
        return operation["operationId"]

    def render(self):
        """A job from the command line to its pictures."""
        self.start_worker()
        job = self.submit(DATA / "cornell.gltf", width=16, height=16, samples=4, tile_size=8, frames="0-1",
                          output_cryptomatte=(), output_cryptomatte_manifest="sidecar")
        self.wait_for_end(job)
        self.download(job)
        self.cli("job", job)
        for path in ("", "/report", "/forecast", "/forecast?relativeError=none", "/frames", "/frames/0", "/frames/1", "/frames/7", "/frames/0/image.exr",
                     "/frames/0/image.png", "/frames/0/image.png?exposure=99", "/frames/0/image.png?denoised=1",
                     "/frames/0/preview.png?width=8", "/mattes/none.json", "/events?after=0"):
            self.call("GET", f"/v1/jobs/{job}{path}", headers={"Accept": "application/json"})
        for path in ("/v1/jobs?limit=1", "/v1/jobs?limit=0", "/v1/jobs?state=completed", "/v1/workers", "/v1/jobs/none",
                     "/v1/events?after=0", "/v1/openapi.json", "/healthz", "/metrics", "/"):
            self.call("GET", path, headers={"Accept": "application/json"})
        return self.job(job)["spec"]

    def compare(self, spec):
        """A study from its start to its reports."""
        job = {**spec, "frames": {"first": 0}, "output": {}}
        study = {"job": job, "knobs": [{"path": "settings.maxBounces", "values": [1]}], "seeds": 2, "samples": [2],
                 "reference": {"samples": 4}}
        self.call("POST", "/v1/studies", {**study, "seeds": 1})
        made = self.call("POST", "/v1/studies", study)
        path = f"/v1/studies/{made.json()['id']}"
        until(lambda: self.call("GET", path).json()["state"] == "completed", "the end of the study")
        for end in ("/report.csv", "/report.html"):
            self.call("GET", path + end)
        self.call("POST", path + "/cancel")
        self.call("GET", "/v1/studies?limit=1")
        self.call("GET", "/v1/studies/none")
        other = self.call("POST", "/v1/studies", {**study, "samples": [3]}).json()["id"]
        self.call("POST", f"/v1/studies/{other}/cancel")

    def move(self, spec):
        """What jobs are asked to do, and cannot do."""
        self.call("POST", "/v1/jobs?validate=only", spec)
        self.call("POST", "/v1/jobs", {})
        self.call("POST", "/v1/forecasts", {})
        pilot = self.call("POST", "/v1/forecasts", {"job": spec}).json()["pilot"]
        self.call("GET", f"/v1/jobs/{pilot}/forecast")
        self.call("POST", f"/v1/jobs/{pilot}/cancel")
        job = self.call("POST", "/v1/jobs", spec).json()["id"]
        for verb in ("pause", "resume", "cancel", "cancel", "resume"):
            self.call("POST", f"/v1/jobs/{job}/{verb}")
        self.call("POST", "/v1/jobs/none/cancel")

    def work(self, spec):
        """A worker that finishes nothing."""
        hello = {"worker": "w", "host": "h", "version": self.get("/healthz")["version"]}
        self.call("POST", "/v1/leases", {**hello, "version": "0"})
        self.call("POST", "/v1/leases", {})
        self.call("POST", "/v1/leases", hello)  # nothing to do
        job = self.call("POST", "/v1/jobs", {**spec, "name": "for a worker by hand"}).json()["id"]
        report = {"warnings": [], "features": {"used": [], "leftOut": []}}
        for end in ({"return": {}}, {"failure": {"message": "device lost"}}):
            lease = self.call("POST", "/v1/leases", hello).json()
            path, epoch = f"/v1/leases/{lease['id']}", {"epoch": lease["epoch"]}
            self.call("POST", path + "/renew", epoch)
            self.call("POST", path + "/report", {**epoch, "report": report})
            self.call("PUT", f"{path}/result?epoch={lease['epoch']}", b"no picture", {"Content-Type": "image/x-exr"})
            for verb, body in end.items():
                self.call("POST", f"{path}/{verb}", {**epoch, **body})
                self.call("POST", f"{path}/{verb}", {**epoch, **body})  # not held any more
        self.call("POST", "/v1/leases/none/renew", {"epoch": 1})
        self.call("POST", f"/v1/jobs/{job}/cancel")

    def blobs(self):
        path = "/v1/blobs/" + self.put_blob(b"bytes")
        for range_of in ("bytes=1-2", "bytes=9-"):
            self.call("GET", path, headers={"Range": range_of})
        self.call("GET", "/v1/blobs/" + 64 * "0")
        self.call("PUT", "/v1/blobs/" + 64 * "0", b"others")
        self.call("POST", "/v1/blobs/missing", {"sha256": [64 * "0"]})
        self.call("POST", "/v1/blobs/missing", {"sha256": [3]})

    def test_are_as_described(self):
        self.start_server()
        recorder = Recorder(self.url)
        self.addCleanup(recorder.close)
        self.document = strict(self.get("/v1/openapi.json"))
        self.url = recorder.url
        spec = self.render()
        self.compare(spec)
        self.programs[-1].stop()
        self.move(spec)
        self.work(spec)
        self.blobs()
        called = set()
        for exchange in list(recorder.exchanges):
            with self.subTest(f"{exchange.method} {exchange.path}: {exchange.status}"):
                called.add(self.check(exchange))
        named = {operation["operationId"] for operations in self.document["paths"].values()
                 for operation in operations.values()}
        self.assertEqual(named - called, set())
