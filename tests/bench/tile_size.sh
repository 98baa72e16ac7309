#!/usr/bin/env bash
# What the size of tiles costs: device seconds of the Cornell box, 1024 x 1024 pixels, 128 samples, 5 bounces.
#
#     tests/bench/tile_size.sh [OPTION...]      e.g. --device 1; of `tilefarm-worker render`
#
# Sizes are rendered in turn, three rounds of them; the median counts. Ends with status 1 where the default size takes
# more than 1.1 times the least, or where reports count light or rays differently. Runs from what deploy/bundle.sh
# packs too, as bench/tile_size.sh; smaller by SIDE=256 SAMPLES=16 TILE_SIZES="8 32" ROUNDS=1.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
worker=${TILEFARM_BIN:-$here/../../build/release/bin}/tilefarm-worker
scene=$here/../data/cornell.gltf
if [ -x "$here/../tilefarm-worker" ]; then worker=$here/../tilefarm-worker scene=$here/cornell.gltf; fi
default=128
read -ra sizes <<<"${TILE_SIZES:-8 32 $default 512 1024}"
rounds=${ROUNDS:-3} side=${SIDE:-1024} samples=${SAMPLES:-128}
work=$(mktemp -d "${TMPDIR:-/tmp}/tilefarm-tile-size.XXXXXX")
trap 'rm -rf "$work"' EXIT

# value NAME FILE: the first number of that name in a report.
value() { sed -n "s/^ *\"$1\": \([-0-9.e+]*\),*$/\1/p" "$2" | tail -n 1; }

for ((round = 1; round <= rounds; round++)); do
    for size in "${sizes[@]}"; do
        report=$work/$size.json
        "$worker" render "$scene" --width "$side" --height "$side" --samples "$samples" --max-bounces 5 "$@" --tile-size "$size" \
            --report "$report" -o "$work/image.exr" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
        sed -n 's/^  "deviceSeconds": \([-0-9.e+]*\),*$/\1/p' "$report" >>"$work/$size.seconds"
        echo "$(value rays "$report") $(value truncatedPaths "$report") $(value truncatedThroughput "$report")" >>"$work/counts"
    done
done
sed -n 's/^  "device": /device: /p; s/^  "driver": /driver: /p' "$report"
for size in "${sizes[@]}"; do
    echo "$size $(sort -g "$work/$size.seconds" | sed -n "$(((rounds + 1) / 2))p")"
done | awk -v default="$default" '
    { size[NR] = $1; seconds[NR] = $2; if (NR == 1 || $2 < least) least = $2 }
    END {
        print "tile size  device s  of the least"
        for (i = 1; i <= NR; i++) {
            printf "%9d  %8.4f  %12.3f\n", size[i], seconds[i], seconds[i] / least
            if (size[i] == default && seconds[i] > 1.1 * least) slow = 1
        }
        exit slow
    }' || { echo "the default of $default is slow" >&2; exit 1; }
[ "$(sort -u "$work/counts" | wc -l)" = 1 ] || { echo "reports differ:" >&2; sort "$work/counts" | uniq -c >&2; exit 1; }
