"""Whether the lists of files in docs/extending.md are true, as far as that is cheap: the files exist and are no more than promised."""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs" / "extending.md").read_text()
FOLDERS = ("docs", "server", "shaders", "shared", "tests", "worker")
# At most so many product files, in the first table of the section.
MOST = {"A lobe": 4, "A light": 4, "A knob": 3, "An image metric": 2}


def sections():
    return {part.split("\n", 1)[0]: part for part in TEXT.split("\n## ")[1:]}


def first_table(section):
    """The files of its rows."""
    table = section.split("|---|---|\n", 1)[1].split("\n\n", 1)[0]
    return [name for row in table.splitlines() for name in re.findall(r"`([^`]+)`", row.split("|")[1])]


class Extending(unittest.TestCase):
    def test_names_files_that_exist(self):
        for name in re.findall(r"`([^`\s]+)`", TEXT):
            if name.split("/")[0] in FOLDERS and "/" in name and "<" not in name:
                found = list(ROOT.glob(name)) if "*" in name else [ROOT / name]
                self.assertTrue(found and all(path.exists() for path in found), name)

    def test_new_files_are_in_folders_that_exist(self):
        for name in re.findall(r"`([^`\s]+<[^`\s]+)`", TEXT):
            if "/" in name.split("<")[0]:
                self.assertTrue((ROOT / name.split("<")[0]).parent.is_dir(), name)

    def test_keeps_to_the_number_of_files_promised(self):
        for title, most in MOST.items():
            files = first_table(sections()[title])
            self.assertTrue(1 <= len(files) <= most, (title, files))


if __name__ == "__main__":
    unittest.main()
