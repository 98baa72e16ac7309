#!/usr/bin/env bash
# Peak resident memory of server and worker over a job of 3840 x 2160 pixels at 4 samples.
#
#     tests/bench/memory_4k.sh [SCENE [ENVIRONMENT]]      default: the demo scene, some 60,000 triangles
#
# Targets: 2 GiB in the server, 4 GiB in the worker (scene data not counted; the demo's is about 20 MiB).
# Ends with status 1 where one is exceeded. The image is fetched as EXR and as PNG, which counts too.
set -euo pipefail
# shellcheck source=deploy/farm.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../deploy/farm.sh"

scene=${1:-$farm_root/tests/data/demo/demo.glb}
environment=${2:-}
if [ $# -eq 0 ]; then environment=$farm_root/tests/data/demo/sky.hdr; fi
work=$(mktemp -d "${TMPDIR:-/tmp}/tilefarm-memory.XXXXXX")
farm_cleanup() { farm_stop; rm -rf "$work"; }

farm_start "$work" 1
submit=("$farm_bin/tilefarm" --server "$farm_url" submit "$scene" --width 3840 --height 2160 --samples 4 --wait -o "$work/frame.exr")
if [ -n "$environment" ]; then submit+=(--environment "$environment"); fi
"${submit[@]}" >"$work/submit.log" 2>&1 || { cat "$work/submit.log" "$work"/worker-1.log >&2; farm_fail "the job failed"; }
job=$(farm_get /v1/jobs 'answer["jobs"][0]["id"]')
curl -fsS -o "$work/frame.png" "$farm_url/v1/jobs/$job/frames/0/image.png"

server=$(farm_peak_mib "${farm_pids[0]}") worker=$(farm_peak_mib "${farm_pids[1]}")
echo "server $server MiB (at most 2048), worker $worker MiB (at most 4096)"
[ "$server" -le 2048 ] && [ "$worker" -le 4096 ]
