#!/usr/bin/env bash
# Sets up, builds and tests. `deploy/test.sh [release|asan|tsan] [ctest options]`.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release
case "${1:-}" in release | asan | tsan) preset=$1; shift ;; esac

deploy/setup.sh
cmake --preset "$preset"
cmake --build --preset "$preset"
# The full statistical suites are asked for by their label: ctest --preset release -L full.
[ $# -gt 0 ] || set -- -LE full
ctest --preset "$preset" "$@"
