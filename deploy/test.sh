#!/usr/bin/env bash
# Sets up, builds and tests.
#
#     deploy/test.sh                        all tests but the label `full`, then each fuzzer for a minute
#     deploy/test.sh PRESET [CTEST OPTION…] release, asan or tsan, without the fuzzers
#
# asan runs all that it can in reasonable time, tsan what has threads (CMakePresets.json says which; CONTRIBUTING.md
# why). TILEFARM_FUZZ_SECONDS sets the fuzzers' time, 0 leaves them out.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release fuzz_seconds=0
case "${1:-}" in
    release | asan | tsan) preset=$1; shift ;;
    "") fuzz_seconds=${TILEFARM_FUZZ_SECONDS:-60} ;;
esac

deploy/setup.sh
cmake --preset "$preset"
cmake --build --preset "$preset"
run=()
# Its runtime maps its shadow where the kernel may have put something else.
[ "$preset" != tsan ] || run=(setarch --addr-no-randomize)
# The full statistical suites are asked for by their label: ctest --preset release -L full.
[ $# -gt 0 ] || set -- -LE full
"${run[@]}" ctest --preset "$preset" "$@"
[ "$fuzz_seconds" = 0 ] || tests/fuzz/run.sh "$fuzz_seconds"
