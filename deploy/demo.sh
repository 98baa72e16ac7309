#!/usr/bin/env bash
# Renders a scene on a farm on this machine, from nothing: installs packages, builds, starts a server and two
# workers on the loopback interface, submits the job, downloads the pictures, stops what it started.
#
#     deploy/demo.sh [SCENE [ENVIRONMENT]]      .gltf or .glb; .hdr or .exr
#
# By environment variable, with the defaults for the demo scene:
#     TILEFARM_DEMO_WIDTH=960  TILEFARM_DEMO_HEIGHT=540   pixels
#     TILEFARM_DEMO_SAMPLES=64                            per pixel
#     TILEFARM_DEMO_BOUNCES=8                             surface scatterings of a path
#     TILEFARM_DEMO_EXPOSURE=0                            stops, of the PNG only
#     TILEFARM_DEMO_TONE=pbrNeutral                       linear, aces or pbrNeutral, of the PNG only
#     TILEFARM_DEMO_WORKERS=2
#     TILEFARM_DEMO_OUT=build/demo                        folder for the pictures and the report
#     TILEFARM_DEMO_SETUP=1                               0 skips deploy/setup.sh
set -euo pipefail
case "${1:-}" in -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit ;; esac
[ $# -le 2 ] || { echo "usage: deploy/demo.sh [SCENE [ENVIRONMENT]]" >&2; exit 2; }

# shellcheck source=deploy/farm.sh
source "$(dirname "${BASH_SOURCE[0]}")/farm.sh"

absolute() { [ -r "$1" ] && [ -f "$1" ] || farm_fail "no such file: $1"; realpath "$1"; }
scene=$farm_root/tests/data/demo/demo.glb environment=$farm_root/tests/data/demo/sky.hdr
if [ $# -ge 1 ]; then scene=$(absolute "$1") environment=; fi
if [ $# -ge 2 ]; then environment=$(absolute "$2"); fi
width=${TILEFARM_DEMO_WIDTH:-960} height=${TILEFARM_DEMO_HEIGHT:-540}
samples=${TILEFARM_DEMO_SAMPLES:-64} bounces=${TILEFARM_DEMO_BOUNCES:-8}
exposure=${TILEFARM_DEMO_EXPOSURE:-0} tone=${TILEFARM_DEMO_TONE:-pbrNeutral}
workers=${TILEFARM_DEMO_WORKERS:-2}
out=$(realpath -m "${TILEFARM_DEMO_OUT:-$farm_root/build/demo}")
name=$(basename "${scene%.*}")

build() {
    if [ "${TILEFARM_DEMO_SETUP:-1}" != 0 ]; then "$farm_root/deploy/setup.sh"; fi
    command -v cmake >/dev/null || farm_fail "no cmake: run deploy/setup.sh first"
    farm_say "building (the first time takes some minutes)"
    mkdir -p "$out"
    if ! (cd "$farm_root" && cmake --preset release && cmake --build --preset release \
        --target tilefarm tilefarm-server tilefarm-worker) >"$out/build.log" 2>&1; then
        tail -n 40 "$out/build.log" >&2
        farm_fail "the build failed; all of its output is in $out/build.log"
    fi
}

# Draws one line over itself on a terminal, a line for every tenth elsewhere.
progress_bar() {
    local percent=$1 note=$2 full
    full=$((percent * 40 / 100))
    if [ -t 2 ]; then
        printf '\r[%s%s] %3d %%  %s   ' "$(printf '%*s' "$full" '' | tr ' ' '#')" "$(printf '%*s' $((40 - full)) '' | tr ' ' '.')" \
            "$percent" "$note" >&2
        [ "$percent" -lt 100 ] || printf '\n' >&2
    elif [ $((percent / 10)) -ne "${progress_shown:--1}" ]; then
        progress_shown=$((percent / 10))
        farm_say "$percent %  $note"
    fi
}

wait_for_job() {
    local state percent merged error seconds
    while :; do
        read -r state percent merged error seconds < <(farm_get "/v1/jobs/$job" \
            '"{state} {0:.0f} {samplesMerged} {1:.4f} {deviceSeconds:.1f}".format(100 * answer["progress"]["fraction"], answer["relativeError"] or 0, **{k: answer[k] for k in ("state", "samplesMerged", "deviceSeconds")})')
        progress_bar "$percent" "$merged of $samples samples, relative error $error, $seconds device seconds"
        case $state in
            completed) return ;;
            failed | canceled) farm_get "/v1/jobs/$job" '"\n".join(answer["faults"])' >&2; farm_fail "the job is $state" ;;
        esac
        farm_check_workers "$work"
        sleep 0.5
    done
}

build
work=$(mktemp -d "${TMPDIR:-/tmp}/tilefarm-demo.XXXXXX")
farm_cleanup() { farm_stop; rm -rf "$work"; }
farm_start "$work" "$workers"
farm_say "server at $farm_url, $workers workers, data in $work"

submit=("$farm_bin/tilefarm" --server "$farm_url" submit "$scene" --name "$name" --width "$width" --height "$height"
    --samples "$samples" --max-bounces "$bounces")
if [ -n "$environment" ]; then submit+=(--environment "$environment"); fi
job=$("${submit[@]}" | tail -n 1)
farm_say "job $job: $name, $width x $height, $samples samples per pixel"
wait_for_job

"$farm_bin/tilefarm" --server "$farm_url" download "$job" -o "$out/$name.exr"
curl -fsS -o "$out/$name.png" "$farm_url/v1/jobs/$job/frames/0/image.png?exposure=$exposure&tone=$tone"
curl -fsS -o "$out/$name.job.json" "$farm_url/v1/jobs/$job"
python3 "$farm_root/deploy/summary.py" "$out/$name.job.json"
printf '\nEXR     %s\nPNG     %s\nreport  %s\n' "$out/$name.exr" "$out/$name.png" "$out/$name.job.json"
