#!/usr/bin/env bash
# Builds the libFuzzer targets with clang under the address and undefined-behaviour sanitizers and runs them side by side.
# An input that fails is left in build/fuzz/found.  `tests/fuzz/run.sh [SECONDS [NAME...]]`: 60 seconds each of all of
# job, gltf and image where not given.
set -euo pipefail
cd "$(dirname "$0")/../.."

seconds=${1:-60}
shift || true
names=("$@")
[ ${#names[@]} -gt 0 ] || names=(job gltf image)
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target make_seeds "${names[@]/%/_fuzzer}"
work=build/fuzz
seeds=$work/seeds
rm -rf "$seeds"
mkdir -p "$work/found"
$work/bin/make_seeds "$seeds"
for folder in tests/data ../shared/bad-inputs; do
    [ -d "$folder" ] || continue
    # Larger files than this leave too few runs a second.
    for kind in gltf:gltf gltf:glb image:exr image:hdr job:json; do
        find "$folder" -type f -name "*.${kind#*:}" -size -20k -exec cp -t "$seeds/${kind%:*}" {} +
    done
done

declare -A options=([job]="-dict=$seeds/job.dict")
declare -A running
for name in "${names[@]}"; do
    mkdir -p "$work/corpus/$name"
    # Found inputs stay in the corpus of this build folder; the seeds are read only.
    # shellcheck disable=SC2086  # the options are words
    $work/bin/${name}_fuzzer "$work/corpus/$name" "$seeds/$name" ${options[$name]:-} -max_len=20000 \
        -max_total_time="$seconds" -timeout=25 -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix="$work/found/$name-" >"$work/$name.log" 2>&1 &
    running[$name]=$!
done
failed=0
for name in "${names[@]}"; do
    if wait "${running[$name]}"; then
        runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/$name.log")
        echo "fuzz: $name: ${runs:-0} runs in $seconds s, nothing found"
        # A fuzzer that does not run finds nothing either.
        [ "${runs:-0}" -gt 100 ] || { echo "fuzz: $name: too few runs" >&2; failed=1; }
    else
        echo "fuzz: $name failed:" >&2
        tail -n 60 "$work/$name.log" >&2
        failed=1
    fi
done
exit $failed
