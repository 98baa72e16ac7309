"""The repository's own style rules over every tracked file; then every rule against a text that breaks it."""
import collections
import json
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import rebuild_counts
import rules
import sources

# Commits before this one are as they are.
FIRST_CHECKED_COMMIT = "09f1597"
# What was too long when the rule came, and how long each may be at most: these numbers only ever shrink.
EXCEPTIONS = json.loads((pathlib.Path(__file__).parent / "exceptions.json").read_text())


def texts_of(paths):
    return {path: (sources.ROOT / path).read_text() for path in paths
            if path.suffix in rules.TEXT or path.name == "CMakeLists.txt"}


class Repository(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        if not (sources.ROOT / ".git").exists() or not shutil.which("git"):
            raise unittest.SkipTest("not a git checkout")
        cls.paths = sources.tracked()
        cls.texts = texts_of(cls.paths)
        cls.code = [path for path in cls.paths if path.suffix in sources.CPP | sources.GLSL]
        cls.product = {path: text for path, text in cls.texts.items()
                       if path.parts[0] in sources.PRODUCT and path.suffix in sources.CPP}

    def none(self, violations):
        violations = list(violations)
        self.assertEqual([], violations, "\n" + "\n".join(violations))

    def test_white_space(self):
        self.none(line for path, text in self.texts.items() for line in rules.white_space(path, text))

    def test_files_hold_one_concept(self):
        files = EXCEPTIONS["files"]
        self.none(line for path in self.code
                  for line in rules.length(path, self.texts[path], files.get(str(path), rules.MOST_LINES)))
        self.none(rules.outlived(files, [(str(path), self.texts[path].count("\n")) for path in self.code],
                                 rules.MOST_LINES))

    def test_functions_are_short(self):
        if not shutil.which("ctags"):
            self.skipTest("needs universal-ctags")
        found, functions = list(rules.functions(sources.ROOT, self.code)), EXCEPTIONS["functions"]
        self.none(rules.function_length(found, functions))
        self.none(rules.outlived(functions, [(f"{path} {name}", lines) for path, _, name, lines in found],
                                 rules.MOST_FUNCTION_LINES))

    def test_includes_are_linked(self):
        found, public = sources.libraries(), rules.used_outside(self.texts)
        self.none(line for path, text in self.product.items() for line in rules.include(path, text, found, public))

    def test_sides_stay_apart(self):
        self.none(line for path, text in self.product.items() for line in rules.sides(path, text))

    def test_declarations_are_used(self):
        words = collections.Counter()
        for path in [*self.code, *(path for path in self.texts if path.name == "CMakeLists.txt")]:
            words.update(re.findall(r"\w+", self.texts[path]))
        self.none(rules.unused_declarations([item for item in self.product.items() if item[0].suffix == ".h"], words))

    def test_commit_subjects(self):
        log = subprocess.run(["git", "-C", sources.ROOT, "log", "--no-merges", "--format=%h %s",
                              f"{FIRST_CHECKED_COMMIT}..HEAD"], capture_output=True, text=True)
        if log.returncode != 0:
            self.skipTest("the history does not reach back")
        self.none(line for commit in log.stdout.splitlines() for line in rules.subject(*commit.split(" ", 1)))


class Rules(unittest.TestCase):
    """Each rule finds what it is there for, and lets pass what is right."""

    def one(self, violations, words):
        violations = list(violations)
        self.assertEqual(1, len(violations), violations)
        self.assertIn(words, violations[0])

    def test_white_space(self):
        path = pathlib.PurePosixPath("a.cpp")
        self.one(rules.white_space(path, "int a; \n"), "a.cpp:1")
        self.one(rules.white_space(path, "int a;\n\tint b;\n"), "a.cpp:2: a tab")
        self.one(rules.white_space(path, "int a;"), "no newline")
        self.assertEqual([], list(rules.white_space(path, "int a;\n")))

    def test_length(self):
        path, long = pathlib.PurePosixPath("a.cpp"), "int a;\n" * (rules.MOST_LINES + 1)
        self.one(rules.length(path, long), "401 lines")
        self.assertEqual([], list(rules.length(path, "// Long because it is a table.\n" + long)))
        self.assertEqual([], list(rules.length(path, "int a;\n" * rules.MOST_LINES)))
        self.assertEqual([], list(rules.length(path, long, 401)))

    def test_function_length(self):
        if not shutil.which("ctags"):
            self.skipTest("needs universal-ctags")
        with tempfile.TemporaryDirectory() as folder:
            body = "    f();\n" * (rules.MOST_FUNCTION_LINES - 1)
            for name in ("a.cpp", "b.glsl"):
                (pathlib.Path(folder) / name).write_text(f"void shorter() {{\n    f();\n}}\nvoid longer() {{\n{body}}}\n")
            functions = list(rules.functions(folder, ["a.cpp", "b.glsl"]))
        self.assertEqual(["a.cpp:4: longer has 61 lines, more than 60", "b.glsl:4: longer has 61 lines, more than 60"],
                         list(rules.function_length(functions, {})))
        self.one(rules.function_length(functions, {"a.cpp longer": 61}), "b.glsl:4")
        self.one(rules.function_length(functions, {"a.cpp longer": 60, "b.glsl longer": 99}), "a.cpp:4")

    def test_outlived(self):
        found = [("a.cpp f", 61), ("a.cpp f", 3), ("a.cpp g", 60)]
        self.assertEqual([], list(rules.outlived({"a.cpp f": 70}, found, 60)))
        self.one(rules.outlived({"a.cpp f": 70, "a.cpp g": 70}, found, 60), "a.cpp g needs no exception")
        self.one(rules.outlived({"gone.cpp f": 70}, found, 60), "gone.cpp f")

    def test_include(self):
        folder = pathlib.PurePosixPath
        found = {library.name: library for library in [
            *sources.libraries_in(folder("shared/a"), "tilefarm_library(a SOURCES a.cpp)"),
            *sources.libraries_in(folder("shared/b"), "tilefarm_library(b SOURCES b.cpp LINKS a)"),
            *sources.libraries_in(folder("shared/c"), "tilefarm_library(c SOURCES c.cpp PRIVATE_LINKS b)")]}
        text = '#include "shared/a/a.h"\n'
        self.assertEqual([], list(rules.include(folder("shared/b/b.h"), text, found, {"shared/b/b.h"})))
        self.assertEqual([], list(rules.include(folder("shared/c/c.cpp"), text, found, {"shared/c/c.h"})))
        self.assertEqual([], list(rules.include(folder("shared/c/private.h"), text, found, {"shared/c/c.h"})))
        self.one(rules.include(folder("shared/c/c.h"), text, found, {"shared/c/c.h"}), "c does not link a")
        self.one(rules.include(folder("shared/a/a.cpp"), '\n#include "shared/b/b.h"\n', found, set()), "shared/a/a.cpp:2")

    def test_include_within_a_folder_of_several_libraries(self):
        folder = pathlib.PurePosixPath
        found = {library.name: library for library in sources.libraries_in(folder("worker/a"), """
            tilefarm_library(agent SOURCES agent.cpp)
            tilefarm_library(http SOURCES http.cpp LINKS agent)
            add_executable(a-worker main.cpp)
            target_link_libraries(a-worker PRIVATE agent fmt::fmt)""")}
        agent, http = '#include "worker/a/agent.h"\n', '#include "worker/a/http.h"\n'
        self.assertEqual([], list(rules.include(folder("worker/a/http.cpp"), agent + http, found, set())))
        self.one(rules.include(folder("worker/a/agent.cpp"), agent + http, found, set()), "agent does not link http")
        self.one(rules.include(folder("worker/a/main.cpp"), agent + http, found, set()), "a-worker does not link http")
        self.assertEqual([], list(rules.include(folder("worker/a/agent.cpp"), '#include "worker/a/plain.h"\n', found, set())))

    def test_rebuild_counts(self):
        texts = {"shared/a.h": '#include "shared/b.h"\n', "shared/b.h": '#include "shared/a.h"\n#include "made.h"\n',
                 "shared/a.cpp": '#include "shared/a.h"\n', "shared/c.cpp": "#include <vector>\n",
                 "tests/b_test.cpp": '#include "shared/b.h"\n'}
        self.assertEqual(["shared/a.cpp", "tests/b_test.cpp"], rebuild_counts.rebuilt(texts, "shared/b.h"))
        self.assertEqual([("shared/b.h", 1, 1), ("all units", 2, 1)], list(rebuild_counts.rows(texts, ["shared/b.h"])))

    def test_sides(self):
        path = pathlib.PurePosixPath
        self.one(rules.sides(path("shared/a/a.h"), '#include "worker/x.h"\n'), "shared must not include")
        self.one(rules.sides(path("server/a.h"), '#include "worker/x.h"\n'), "server must not include")
        self.one(rules.sides(path("worker/agent/a.h"), "#include <vulkan/vulkan.h>\n"), "worker/vk")
        self.assertEqual([], list(rules.sides(path("worker/vk/a.h"), "#include <vulkan/vulkan.h>\n")))

    def test_subject(self):
        self.one(rules.subject("abc", "x" * 73), "73 characters")
        self.assertEqual([], list(rules.subject("abc", "x" * 72)))

    def test_unused_declarations(self):
        header = pathlib.PurePosixPath("a.h"), "/// f.\nint unusedOne(int a);\nint usedOne();\n        int x = call(x);\n"
        self.one(rules.unused_declarations([header], {"unusedOne": 2, "usedOne": 3}), "a.h:2: unusedOne")


if __name__ == "__main__":
    unittest.main()
