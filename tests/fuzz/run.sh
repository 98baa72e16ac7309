#!/usr/bin/env bash
# Runs the libFuzzer targets, built with clang under the address and undefined-behaviour sanitizers, side by side.
#
#     tests/fuzz/run.sh [SECONDS [NAME...]]      60 seconds each of all of them where not given
#     tests/fuzz/run.sh --prepare FOLDER         programs and seeds into FOLDER, to be run elsewhere
#
# An input that fails ends its fuzzer and this script with an error; it is left in build/fuzz/found and shown, with the
# command that tries it again.
#
#     TILEFARM_FUZZ_BIN=FOLDER   what --prepare wrote, with the libraries it needs but for libc: nothing is built, and
#                                corpus, logs and found inputs go below FOLDER
#     TILEFARM_FUZZ_JOBS=N       N processes per fuzzer, which share their corpus (libFuzzer's -fork)
#
# For half an hour on a machine with 16 cores and nothing installed:
#     tests/fuzz/run.sh --prepare .fuzz          # here; then take this tree and .fuzz there (tar -czf makes 15 MB of it)
#     TILEFARM_FUZZ_BIN=$PWD/.fuzz TILEFARM_FUZZ_JOBS=4 tests/fuzz/run.sh 1800
set -euo pipefail
cd "$(dirname "$0")/../.."
{  # read to its end before it runs: it may be edited meanwhile

all=(job gltf image upload http)
# No input may make a reader take more, of some 20 kB. The sanitizer's own tables and quarantine are within it.
memory_mb=1024 allocation_mb=512
largest_input=20000

build() {
    cmake --preset fuzz >/dev/null
    cmake --build --preset fuzz --target make_seeds "${@/%/_fuzzer}"
}

# make_seeds, and the small files of the tree; larger ones leave too few runs a second.
gather_seeds() {
    local make_seeds=$1 seeds=$2 folder kind
    rm -rf "$seeds"
    "$make_seeds" "$seeds"
    for folder in tests/data ../shared/bad-inputs; do
        [ -d "$folder" ] || continue
        for kind in gltf:gltf gltf:glb image:exr image:hdr job:json; do
            find "$folder" -type f -name "*.${kind#*:}" -size -20k -exec cp -t "$seeds/${kind%:*}" {} +
        done
    done
}

if [ "${1:-}" = --prepare ]; then
    folder=$(mkdir -p "$2" && cd "$2" && pwd)
    build "${all[@]}"
    gather_seeds build/fuzz/bin/make_seeds "$folder/seeds"
    mkdir -p "$folder/bin" "$folder/lib"
    for name in "${all[@]}"; do
        strip --strip-debug -o "$folder/bin/${name}_fuzzer" "build/fuzz/bin/${name}_fuzzer"
        # What has been found so far is worth more than the seeds alone.
        [ ! -d "build/fuzz/corpus/$name" ] || { mkdir -p "$folder/corpus" && cp -r "build/fuzz/corpus/$name" "$folder/corpus/"; }
    done
    # A newer libc runs what was built with an older one, but only its own loader can load it.
    ldd "$folder"/bin/* | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | sort -u | grep -vE '/lib(c|m|dl|rt|pthread|resolv)\.so' |
        xargs cp -L -t "$folder/lib"
    echo "fuzz: ready: TILEFARM_FUZZ_BIN=$folder tests/fuzz/run.sh SECONDS"
    exit
fi

seconds=${1:-60}
shift || true
names=("$@")
[ ${#names[@]} -gt 0 ] || names=("${all[@]}")
if [ -n "${TILEFARM_FUZZ_BIN:-}" ]; then
    work=$TILEFARM_FUZZ_BIN
    export LD_LIBRARY_PATH=$work/lib
else
    build "${names[@]}"
    work=build/fuzz
    gather_seeds $work/bin/make_seeds $work/seeds
fi
found=$work/found
mkdir -p "$found"

export ASAN_OPTIONS=quarantine_size_mb=32:allocator_may_return_null=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}
export UBSAN_OPTIONS=print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}

start() {
    local name=$1 options=()
    [ ! -f "$work/seeds/$name.dict" ] || options+=("-dict=$work/seeds/$name.dict")
    [ -z "${TILEFARM_FUZZ_JOBS:-}" ] || options+=("-fork=$TILEFARM_FUZZ_JOBS" -ignore_ooms=0 -ignore_timeouts=0)
    mkdir -p "$work/corpus/$name"
    # New inputs stay in the corpus of this folder; the seeds are read only.
    "$work/bin/${name}_fuzzer" "$work/corpus/$name" "$work/seeds/$name" "${options[@]}" -max_len=$largest_input \
        -max_total_time="$seconds" -timeout=25 -rss_limit_mb=$memory_mb -malloc_limit_mb=$allocation_mb \
        -print_final_stats=1 -artifact_prefix="$found/$name-" >"$work/$name.log" 2>&1
}

# How often it ran, and what it reached.
summary() {
    sed -n 's/^#\([0-9]*\)[:\t].*cov: \([0-9]*\) ft: \([0-9]*\).*/\1 runs, \2 edges, \3 features/p' "$1" | tail -n 1
}

show() {
    local name=$1 file
    for file in "$found/$name"-*; do
        [ -f "$file" ] && [ "$file" -nt "$work/$name.started" ] || continue
        echo "fuzz: $name: the input is $file ($(stat -c %s "$file") bytes); try it again with"
        echo "    $work/bin/${name}_fuzzer -rss_limit_mb=$memory_mb -malloc_limit_mb=$allocation_mb $file"
        echo "  or, where that folder is gone: base64 -d >input <<END | gunzip"
        gzip -9c "$file" | base64
        echo "END"
    done
}

declare -A running
for name in "${names[@]}"; do
    touch "$work/$name.started"
    start "$name" &
    running[$name]=$!
done
failed=0
for name in "${names[@]}"; do
    if wait "${running[$name]}"; then
        line=$(summary "$work/$name.log")
        echo "fuzz: $name: ${line:-no runs} in $seconds s, nothing found"
        # A fuzzer that does not run finds nothing either.
        [ "${line%% *}" -gt 100 ] 2>/dev/null || { echo "fuzz: $name: too few runs" >&2; failed=1; }
    else
        echo "fuzz: $name failed:" >&2
        # From the report on; what comes before it is progress.
        sed -n '/runtime error\|ERROR: \|DEADLYSIGNAL/,$p' "$work/$name.log" | head -n 60 | cut -c1-300 >&2
        show "$name" >&2
        failed=1
    fi
done
exit $failed
}
