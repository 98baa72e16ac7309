#!/usr/bin/env bash
# Renders a scene on a farm on this machine, from nothing: installs packages, builds, starts a server and two
# workers on the loopback interface, submits the job, downloads the pictures, stops what it started.
#
#     deploy/demo.sh [SCENE [ENVIRONMENT]]      .gltf or .glb; .hdr, .exr, .png or .jpg
#
# By environment variable, with the defaults for the demo scene:
#     TILEFARM_DEMO_WIDTH=960  TILEFARM_DEMO_HEIGHT=540   pixels
#     TILEFARM_DEMO_SAMPLES=128                           per pixel
#     TILEFARM_DEMO_BOUNCES=8                             bounces of a path
#     TILEFARM_DEMO_EXPOSURE=0.15                         stops, of the PNG only; 0 for other scenes
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
samples=${TILEFARM_DEMO_SAMPLES:-128} bounces=${TILEFARM_DEMO_BOUNCES:-8}
exposure=${TILEFARM_DEMO_EXPOSURE:-$([ $# -ge 1 ] && echo 0 || echo 0.15)} tone=${TILEFARM_DEMO_TONE:-pbrNeutral}
workers=${TILEFARM_DEMO_WORKERS:-2}
out=$(realpath -m "${TILEFARM_DEMO_OUT:-$farm_root/build/demo}")
name=$(basename "${scene%.*}")

build() {
    if [ "${TILEFARM_DEMO_SETUP:-1}" != 0 ]; then "$farm_root/deploy/setup.sh" --run; fi
    command -v cmake >/dev/null || farm_fail "no cmake: run deploy/setup.sh first"
    farm_say "building (the first time takes some minutes)"
    mkdir -p "$out"
    # In a session of its own and waited for, so that a signal need not wait until it is done.
    (cd "$farm_root" && exec setsid sh -c 'cmake --preset release &&
        cmake --build --preset release --target tilefarm tilefarm-server tilefarm-worker') >"$out/build.log" 2>&1 </dev/null &
    local builder=$!
    farm_groups+=("$builder")
    if ! wait "$builder"; then
        tail -n 40 "$out/build.log" >&2
        farm_fail "the build failed; all of its output is in $out/build.log"
    fi
    farm_groups=()
}

# The client draws the bar; meanwhile this looks after the workers.
wait_for_job() {
    "$farm_bin/tilefarm" --server "$farm_url" wait "$job" &
    local client=$!
    farm_pids+=("$client")
    while farm_running "$client"; do
        farm_check_workers "$work" "$workers"
        sleep 0.5
    done
    wait "$client" || farm_fail "job $job did not complete"
}

build
work=$(mktemp -d "${TMPDIR:-/tmp}/tilefarm-demo.XXXXXX")
farm_cleanup() { farm_stop; rm -rf "$work"; }
farm_start "$work" "$workers"
farm_say "server at $farm_url, $workers workers, data in $work"

submit=("$farm_bin/tilefarm" --server "$farm_url" submit "$scene" --name "$name" --width "$width" --height "$height"
    --samples "$samples" --max-bounces "$bounces")
if [ -n "$environment" ]; then submit+=(--environment "$environment"); fi
job=$("${submit[@]}") || farm_fail "the job was not taken"
farm_say "job $job: $name, $width x $height, $samples samples per pixel"
wait_for_job

"$farm_bin/tilefarm" --server "$farm_url" download "$job" -o "$out/$name.exr"
"$farm_bin/tilefarm" --server "$farm_url" download "$job" -o "$out/$name.png" --exposure "$exposure" --tone "$tone"
"$farm_bin/tilefarm" --server "$farm_url" job "$job" --json >"$out/$name.job.json"
python3 "$farm_root/deploy/summary.py" "$out/$name.job.json"
printf '\nEXR  %s\nPNG  %s\njob  %s\n' "$out/$name.exr" "$out/$name.png" "$out/$name.job.json"
