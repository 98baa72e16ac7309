"""A user with nothing but curl gets from a scene to a picture by the words of the README."""
import re
import shutil
import subprocess

from farm import DEADLINE, ROOT, FarmTest, environment


def curl_example():
    readme = ROOT / "README.md"
    blocks = re.findall(r"```(?:bash|sh)\n(.*?)```", readme.read_text(), re.S) if readme.exists() else []
    return "\n".join(block for block in blocks if "curl" in block and "/v1/jobs" in block)


class Curl(FarmTest):
    def test_the_example_of_the_readme(self):
        script = curl_example()
        if not script or not shutil.which("curl"):
            self.skipTest("needs curl and the README's example")
        self.start_server()
        self.start_workers(1)
        script, changed = re.subn(r"server=http://\S+", f"server={self.url}", script)
        self.assertGreaterEqual(changed, 1, "the example says where the server is")
        (self.folder / "tests").symlink_to(ROOT / "tests")
        done = subprocess.run(["bash", "-euc", script], cwd=self.folder, env=environment(), text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=DEADLINE, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        pictures = list(self.folder.glob("*.exr"))
        self.assertTrue(pictures, "the example downloads an EXR")
        self.cli("compare", pictures[0], pictures[0])
        for png in self.folder.glob("*.png"):
            self.assertEqual(png.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
