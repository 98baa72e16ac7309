#!/usr/bin/env python3
"""Looks through shaders for arithmetic that drivers may compute otherwise than it stands there.

    tests/lint/shader_lint.py [FILE.comp ...]      default: every kernel and stage below shaders/

Prints `file:line: rule: what` with a line on why for each rule found, and ends with status 1 if there is any. The rules
and how a finding is excused stand in shader_rules.py.
"""
import os
import re
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from shader_rules import RULES, findings  # noqa: E402
from shader_tree import STAGES, read_shader  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]


@lru_cache(maxsize=None)
def lines_of(file):
    return Path(file).read_text().splitlines()


def excused(rule, file, line):
    """By a comment that gives a reason, on that line or the one above."""
    comment = re.compile(rf"//.*\blint {rule}: \S+")
    return any(comment.search(text) for text in lines_of(file)[max(0, line - 2):line])


def lint(paths, include):
    lines_of.cache_clear()
    found = set()
    for path in paths:
        for rule, (file, line), what in findings(read_shader(path, include)):
            if not file or not excused(rule, file, line):
                found.add((os.path.relpath(file), line, rule, what))
    return sorted(found)


def write_tables(folder):
    """The headers of constants and records that shaders include, as the build makes them."""
    subprocess.run([sys.executable, "-B", ROOT / "shaders" / "tables" / "generate.py", "gpu", folder], check=True)


def main(arguments):
    shaders = ROOT / "shaders"
    paths = arguments or sorted(p for p in shaders.rglob("*") if p.suffix in STAGES)
    with tempfile.TemporaryDirectory() as tables:
        write_tables(tables)
        found = lint(paths, [shaders, tables])
    for file, line, rule, what in found:
        print(f"{file}:{line}: {rule}: {what}")
    for rule in sorted({finding[2] for finding in found}):
        print(f"{rule}: {RULES[rule][1]}")
    print(f"{len(paths)} shaders, {len(found)} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
