#!/usr/bin/env bash
# The price list: what each accuracy knob costs in time, buys in error and biases, measured by studies of the
# project's own scenes on a farm on this machine. Let nothing else run meanwhile.
#
#     deploy/price-list.sh [FOLDER]        default: build/price-list; a page, CSV and table for each scene
#
# By environment variable:
#     TILEFARM_PRICE_SCENES="cornell demo"    also mirrors, materials, layers
#     TILEFARM_PRICE_WIDTH=160                pixels
#     TILEFARM_PRICE_SAMPLES=64               per pixel; the reference has 32 times as many
#     TILEFARM_PRICE_SEEDS=5
#     TILEFARM_PRICE_WORKERS=1
set -euo pipefail
case "${1:-}" in -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit ;; esac

# shellcheck source=deploy/farm.sh
source "$(dirname "${BASH_SOURCE[0]}")/farm.sh"

out=$(realpath -m "${1:-$farm_root/build/price-list}")
width=${TILEFARM_PRICE_WIDTH:-160} samples=${TILEFARM_PRICE_SAMPLES:-64} seeds=${TILEFARM_PRICE_SEEDS:-5}
knobs=(
    "settings.maxBounces=1,2,4,16" "settings.clampDirect=10" "settings.clampIndirect=1,10"
    "settings.regularisation=0.3" "settings.roulette=none,constant" "settings.rouletteStart=1"
    "settings.shadowDepth=1" "settings.directionSampling=cosine,uniform" "settings.directLight=lights,bsdf"
    "settings.lightSelection=uniform,all,tree" "settings.fresnel=schlick" "settings.energyCompensation=false"
    "settings.sampler=stratified,sobol" "settings.filter=tent,gaussian" "settings.jitter=false"
    "settings.integrator=whitted,raster,ambient-occlusion" "output.denoise=true" "image.tileSize=32"
)
words=(--width "$width" --samples "$samples" --sample-counts "$samples" --seeds "$seeds"
    --reference-samples $((32 * samples)))
for knob in "${knobs[@]}"; do words+=(--knob "$knob"); done

scene_of() {
    case $1 in
        cornell) echo "$farm_root/tests/data/cornell.gltf" ;;
        demo) echo "$farm_root/tests/data/demo/demo.glb" --environment "$farm_root/tests/data/demo/sky.hdr" ;;
        mirrors | materials | layers) echo "$farm_root/tests/data/$1.glb" ;;
        *) farm_fail "there is no scene '$1' in the price list" ;;
    esac
}

work=$(mktemp -d "${TMPDIR:-/tmp}/tilefarm-price.XXXXXX")
farm_cleanup() { farm_stop; rm -rf "$work"; }
farm_start "$work" "${TILEFARM_PRICE_WORKERS:-1}"
mkdir -p "$out"
for name in ${TILEFARM_PRICE_SCENES:-cornell demo}; do
    read -ra scene <<<"$(scene_of "$name")"
    farm_say "$name: $width pixels wide, $samples samples, $seeds seeds"
    "$farm_bin/tilefarm" --server "$farm_url" study "${scene[0]}" "${scene[@]:1}" "${words[@]}" --name "$name" \
        -o "$out/$name.html" -o "$out/$name.csv" >"$out/$name.txt"
    python3 "$farm_root/deploy/price_table.py" "$out/$name.csv" >"$out/$name.md"
    farm_say "$out/$name.html, .csv, .txt and .md"
done
