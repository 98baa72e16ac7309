#!/usr/bin/env bash
# Packs the programs with the shared libraries they need into one folder that runs on another x86-64
# Linux of the same or a newer C library, without installing anything there but a Vulkan driver.
#
#   deploy/bundle.sh [OUT]      OUT defaults to build/bundle
#   OUT/tilefarm-worker --server http://farm:8080
#   OUT/bench/tile_size.sh --device 0      measures what the size of tiles costs there
#
# Where the driver is not found by itself, name its manifest: VK_DRIVER_FILES=/…/nvidia_icd.json.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-build/bundle}
bin=build/release/bin
programs=(tilefarm-worker tilefarm-server tilefarm)
[ $# -le 1 ] || programs=("${@:2}")

for program in "${programs[@]}"; do
    [ -x "$bin/$program" ] || { echo "bundle: $bin/$program is not built (cmake --build --preset release)" >&2; exit 1; }
done
rm -rf "$out"
mkdir -p "$out/lib"
for program in "${programs[@]}"; do
    # The C library and its loader belong to the machine.
    ldd "$bin/$program" | awk '$3 ~ /^\// { print $3 }' |
        grep -vE '/(libc|libm|libdl|librt|libpthread|libresolv)\.so' | xargs -r cp -Lu -t "$out/lib"
    cp "$bin/$program" "$out/lib/$program.bin"
    strip "$out/lib/$program.bin"
    cat > "$out/$program" <<'WRAPPER'
#!/bin/sh
here=$(cd "$(dirname "$0")" && pwd)
LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" exec "$here/lib/$(basename "$0").bin" "$@"
WRAPPER
    chmod +x "$out/$program"
done
mkdir "$out/bench"
cp tests/bench/tile_size.sh tests/data/cornell.gltf "$out/bench"
echo "bundle: $out ($(du -sh "$out" | cut -f1))"
