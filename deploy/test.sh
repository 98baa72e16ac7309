#!/usr/bin/env bash
# Sets up, builds and tests.
#
#     deploy/test.sh                        all tests but the label `full`, then each fuzzer for a minute
#     deploy/test.sh PRESET [CTEST OPTION…] release, asan or tsan, without the fuzzers
#
# asan runs all that it can in reasonable time, tsan what has threads (testPresets in CMakePresets.json; why:
# CONTRIBUTING.md, Sanitizers and fuzzing). TILEFARM_FUZZ_SECONDS sets the fuzzers' time, 0 leaves them out.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release fuzz_seconds=0
case "${1:-}" in
    release | asan | tsan) preset=$1; shift ;;
    "") fuzz_seconds=${TILEFARM_FUZZ_SECONDS:-60} ;;
esac

deploy/setup.sh
cmake --preset "$preset"
run=()
# The thread sanitizer maps its shadow where a kernel that randomizes many bits may have put something else; also
# while building, where the tests are asked for their names.
if [ "$preset" = tsan ] && setarch --addr-no-randomize true 2>/dev/null; then run=(setarch --addr-no-randomize); fi
"${run[@]}" cmake --build --preset "$preset"
# The full statistical suites are asked for by their label: ctest --preset release -L full.
[ $# -gt 0 ] || set -- -LE full
"${run[@]}" ctest --preset "$preset" --parallel "$(nproc)" "$@"
[ "$fuzz_seconds" = 0 ] || tests/fuzz/run.sh "$fuzz_seconds"
