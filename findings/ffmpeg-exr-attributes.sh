#!/usr/bin/env bash
# A valid OpenEXR file with a long string in its header is decoded to black by ffmpeg, without an error.
#
# Expected: a header entry that a reader does not know is skipped by its size, which stands before it.
# Seen: ffmpeg 5.1.9 reads at most 255 bytes of such an entry and takes the rest for the name of the next one. Up to 509
#   bytes it loses that next entry alone; from 510 on it loses its place. Exit status 0, and every pixel is 0.
# Matters to: whoever writes settings, a history or Cryptomatte manifests into EXRs: no entry above 255 bytes.
# Versions: Debian 12, ffmpeg 7:5.1.9-0+deb12u1, openimageio-tools 2.4.7.1+dfsg-2. Seen 2026-11-30.
set -euo pipefail
export LC_ALL=C
fail() { echo "CHANGED: $*" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

if ! command -v ffmpeg >/dev/null || ! command -v oiiotool >/dev/null; then
    apt-get -qq update
    apt-get -qq install -y --no-install-recommends ffmpeg=7:5.1.9-0+deb12u1 openimageio-tools=2.4.7.1+dfsg-2 >/dev/null
fi
dpkg-query -W ffmpeg openimageio-tools

# A picture of 0.25, 0.5, 0.75 with a string of so many bytes in its header; what ffmpeg makes of its first pixel.
first_pixel() {
    oiiotool --pattern constant:color=0.25,0.5,0.75 8x4 3 -d float --compression none --nosoftwareattrib \
        --attrib note "$(printf 'n%.0s' $(seq "$1"))" -o "$1.exr"
    ffmpeg -nostdin -v error -i "$1.exr" -f rawvideo -pix_fmt gbrpf32le "$1.raw"
    od -An -N4 -t f4 "$1.raw" | tr -d ' '
}
for size in 200 255 600 4000; do
    green=$(first_pixel "$size")
    constant=$(oiiotool --info -v --stats "$size.exr" | sed -n 's/ *Constant Color: //p')
    echo "a header entry of $size bytes: ffmpeg's green is $green, oiiotool reads $constant"
    case $size in 200 | 255) right=0.5 ;; *) right=0 ;; esac
    [ "$green" = "$right" ] || fail "green is $green, not $right"
done
