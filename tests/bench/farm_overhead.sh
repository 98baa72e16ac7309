#!/usr/bin/env bash
# What the farm costs: the same job through a server and one worker, beside `tilefarm-worker render`.
#
#     tests/bench/farm_overhead.sh [SCENE [ENVIRONMENT]]       default: the demo scene
#
# FARM_SECONDS=60 about how long a render takes, FARM_REPEATS=2, FARM_WIDTH=960, FARM_HEIGHT=540, FARM_JSON=file
#
# Both times are wall clock. Local: the whole process, from start to written EXR. Farm: from the start of `tilefarm
# submit`, which hashes and uploads, to the downloaded EXR, with a worker that waits for work. The cache is empty in
# both, so each fetches the scene and compiles the kernel. The two alternate. Target: at most 1.05. The pixels of both EXRs must be equal to the bit.
set -euo pipefail
# shellcheck source=deploy/farm.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../deploy/farm.sh"

scene=${1:-$farm_root/tests/data/demo/demo.glb}
environment=${2:-}
if [ $# -eq 0 ]; then environment=$farm_root/tests/data/demo/sky.hdr; fi
width=${FARM_WIDTH:-960} height=${FARM_HEIGHT:-540} repeats=${FARM_REPEATS:-2} wanted=${FARM_SECONDS:-60}
work=$(mktemp -d "${TMPDIR:-/tmp}/tilefarm-overhead.XXXXXX")
farm_cleanup() { farm_stop; rm -rf "$work"; }

options=(--width "$width" --height "$height")
if [ -n "$environment" ]; then options+=(--environment "$environment"); fi
now() { date +%s.%N; }
calculate() { python3 -c "import statistics; print($1)"; }

local_render() { # SAMPLES OUT: prints seconds
    local start
    start=$(now)
    "$farm_bin/tilefarm-worker" --cache "$work/cache-$RANDOM$RANDOM" render "$scene" -o "$2" "${options[@]}" --samples "$1" >"$work/local.log" 2>&1 ||
        { cat "$work/local.log" >&2; farm_fail "the local render failed"; }
    calculate "f'{$(now) - $start:.3f}'"
}

farm_render() { # SAMPLES OUT FOLDER: sets farm_seconds
    local start
    farm_start "$3" 1
    while [ "$(farm_get /v1/workers 'len(answer["workers"])')" = 0 ]; do farm_check_workers "$3" 1; sleep 0.1; done
    start=$(now)
    "$farm_bin/tilefarm" --server "$farm_url" submit "$scene" "${options[@]}" --samples "$1" --wait -o "$2" >"$work/farm.log" 2>&1 ||
        { cat "$work/farm.log" >&2; farm_fail "the job failed"; }
    farm_seconds=$(calculate "f'{$(now) - $start:.3f}'")
    farm_stop
}

# From the difference of two short renders, so that what happens once counts once.
short=$(local_render 4 "$work/a.exr") longer=$(local_render 20 "$work/a.exr")
samples=$(calculate "max(16, round(($wanted - $short) / max(($longer - $short) / 16, 1e-4)) // 16 * 16)")
farm_say "$width x $height, $samples samples per pixel"

locals=() farms=()
for ((repeat = 1; repeat <= repeats; repeat++)); do
    locals+=("$(local_render "$samples" "$work/local.exr")")
    farm_render "$samples" "$work/farm.exr" "$work/farm-$repeat"
    farms+=("$farm_seconds")
    farm_say "local ${locals[-1]} s, farm ${farms[-1]} s"
done
list() { local IFS=,; echo "[$*]"; }
ratio=$(calculate "f'{statistics.median($(list "${farms[@]}")) / statistics.median($(list "${locals[@]}")):.3f}'")
echo "farm / local = $ratio (medians of $repeats; target at most 1.05)"
"$farm_bin/tilefarm" compare --identical "$work/local.exr" "$work/farm.exr"
if [ -n "${FARM_JSON:-}" ]; then
    printf '{"samples": %s, "localSeconds": %s, "farmSeconds": %s, "ratio": %s}\n' "$samples" "$(list "${locals[@]}")" \
        "$(list "${farms[@]}")" "$ratio" >"$FARM_JSON"
fi
