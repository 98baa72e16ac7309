#!/usr/bin/env bash
# ffmpeg 5.1.9 (Debian 12: 7:5.1.9-0+deb12u1) decodes a valid OpenEXR file to black, or to other wrong pixels, where a
# header entry that it does not know is longer than 255 bytes. It reads 255 of them and takes the rest for the next entry;
# whether it finds its way again depends on those bytes (a string of 300 equal letters passed, one of 1,000 did not).
# OpenEXR sets no such bound; settings and Cryptomatte manifests of renderers are often longer. Exits 0 while this is so.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

command -v ffmpeg >/dev/null && command -v oiiotool >/dev/null ||
    apt-get install -qy --no-install-recommends ffmpeg=7:5.1.9-0+deb12u1 openimageio-tools=2.4.7.1+dfsg-2
ffmpeg -version | head -n 1

# A picture of 0.25, 0.5, 0.75 with a string of so many bytes in its header; what ffmpeg makes of its first pixel.
first_pixel() {
    oiiotool --pattern constant:color=0.25,0.5,0.75 8x4 3 -d float --compression none \
        --attrib note "$(printf 'n%.0s' $(seq "$1"))" -o "$1.exr"
    oiiotool --info -v --stats "$1.exr" | grep -q '0.250000 0.500000 0.750000' || echo 'oiiotool disagrees'
    ffmpeg -v quiet -i "$1.exr" -f rawvideo -pix_fmt gbrpf32le - | od -An -N4 -t f4 | tr -d ' ' || true
}
for size in 200 255 1000 4000; do
    green=$(first_pixel "$size")
    echo "a header entry of $size bytes: green is ${green:-not decoded}, right is 0.5"
    if [ "$size" -le 255 ]; then [ "$green" = 0.5 ]; else [ "$green" != 0.5 ]; fi
done

# Output seen, 2026-11-30:
#   a header entry of 200 bytes: green is 0.5, right is 0.5
#   a header entry of 255 bytes: green is 0.5, right is 0.5
#   a header entry of 1000 bytes: green is 0, right is 0.5
#   a header entry of 4000 bytes: green is 0, right is 0.5
