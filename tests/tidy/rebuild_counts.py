#!/usr/bin/env python3
"""How many translation units a touch of a header compiles again.

    tests/tidy/rebuild_counts.py [HEADER…]

Prints a table for shared/job/job.h, shared/job/appearance.h and the headers named. It follows the includes of the
tracked files, so it needs no build, and counts as a build with -DTILEFARM_UNITY=OFF does. Left out are
tests/fuzz, which another preset builds, and includes of generated headers.
"""
import argparse
import pathlib
import re

import sources

ALWAYS = ["shared/job/job.h", "shared/job/appearance.h"]
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def included(texts):
    """What each file includes directly: {path: paths}, of the repository's files alone."""
    return {path: [name for name in INCLUDE.findall(text) if name in texts] for path, text in texts.items()}


def closure(includes, path):
    """All that a file includes, directly or not, itself left out."""
    seen, waiting = set(), list(includes[path])
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            waiting += includes[name]
    return seen


def rebuilt(texts, header):
    """The translation units among `texts` that include the header."""
    includes = included(texts)
    return [path for path in texts if path.endswith(".cpp") and header in closure(includes, path)]


def compiled(root=sources.ROOT):
    return {str(path): (root / path).read_text() for path in sources.tracked(root)
            if path.suffix in sources.CPP and path.parts[:2] != ("tests", "fuzz")}


def rows(texts, headers):
    """(header, product units, test units) of each header, then of all units."""
    def row(name, units):
        tests = sum(unit.startswith("tests/") for unit in units)
        return name, len(units) - tests, tests
    yield from (row(header, rebuilt(texts, header)) for header in headers)
    yield row("all units", [path for path in texts if path.endswith(".cpp")])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("headers", nargs="*", metavar="HEADER", help="path from the root of the repository")
    texts = compiled()
    headers = list(dict.fromkeys(ALWAYS + [str(pathlib.PurePosixPath(name)) for name in parser.parse_args().headers]))
    for header in headers:
        if header not in texts:
            parser.error(f"{header} is no C++ file of the repository")
    print(f"{'header':40} {'product':>8} {'tests':>6} {'all':>6}")
    for name, product, tests in rows(texts, headers):
        print(f"{name:40} {product:8} {tests:6} {product + tests:6}")


if __name__ == "__main__":
    main()
