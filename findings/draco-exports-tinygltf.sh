#!/usr/bin/env bash
# Debian's libdraco is a mesh compressor, yet it exports a whole second tinygltf and stb_image.
#
# Expected: a program that links libdraco and libtinygltf calls tinygltf's functions in libtinygltf.
# Seen: libdraco 1.5.5 exports 49 functions of tinygltf:: and 56 of stb_image, of the copies that it was
#   built with. The dynamic linker takes the first definition that it meets, so the order of -l on the link line decides
#   whose parser runs; nothing warns. The two copies are different builds of the same classes.
# Matters to: whoever reads Draco-compressed glTF with tinygltf or stb_image from packages. Link libtinygltf first, or
#   rename the namespace when compiling the header.
# Versions: Debian 12, libdraco-dev 1.5.5+dfsg-2, libtinygltf-dev 2.7.0+dfsg-2. Seen 2026-11-30.
set -euo pipefail
export LC_ALL=C
fail() { echo "CHANGED: $*" >&2; exit 1; }
packages=(g++ binutils nlohmann-json3-dev libstb-dev libdraco-dev=1.5.5+dfsg-2 libtinygltf-dev=2.7.0+dfsg-2)
have() { [ "$(dpkg-query -W -f='${Version}' "$1" 2>/dev/null)" = "$2" ]; }
if ! have libdraco-dev 1.5.5+dfsg-2 || ! have libtinygltf-dev 2.7.0+dfsg-2 || ! command -v g++ nm >/dev/null; then
    apt-get -qq update
    apt-get -qq install -y --no-install-recommends "${packages[@]}" >/dev/null
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
draco=$(g++ -print-file-name=libdraco.so)

exported() { nm -DC --defined-only "$1" | grep -cE "$2" || true; }
echo "tinygltf:: symbols that libdraco exports: $(exported "$draco" ' T tinygltf::')"
echo "stbi_ functions that libdraco exports:    $(exported "$draco" ' T stbi_')"
[ "$(exported "$draco" ' T tinygltf::')" -gt 20 ] || fail "libdraco exports no tinygltf"
[ "$(exported "$draco" ' T stbi_')" -gt 20 ] || fail "libdraco exports no stb_image"

# Asks where the function that this program calls really is, and calls it on a minimal valid file.
cat > which.cpp <<'CPP'
#include <dlfcn.h>
#include <draco/core/decoder_buffer.h>
#include <draco/compression/decode.h>
#include <tiny_gltf.h>
#include <cstdio>
#include <cstring>
int main() {
    draco::DecoderBuffer buffer;
    buffer.Init("", 0);
    draco::Decoder::GetEncodedGeometryType(&buffer).ok();  // so that libdraco is needed
    tinygltf::TinyGLTF reader;
    using Function = bool (tinygltf::TinyGLTF::*)(tinygltf::Model*, std::string*, std::string*, const char*,
                                                  const unsigned int, const std::string&, unsigned int);
    Function function = &tinygltf::TinyGLTF::LoadASCIIFromString;
    void* address;
    std::memcpy(&address, &function, sizeof address);
    Dl_info info;
    if (!dladdr(address, &info)) return 1;
    const char* name = std::strrchr(info.dli_fname, '/');
    std::printf("%s\n", name ? name + 1 : info.dli_fname);
}
CPP
build() { g++ -std=c++17 -O1 -fPIE -w which.cpp -o "$1" "${@:2}" -Wl,--no-as-needed -ldl; }
build draco-first -ldraco -ltinygltf
build tinygltf-first -ltinygltf -ldraco
first=$(./draco-first) second=$(./tinygltf-first)
echo "linked -ldraco -ltinygltf: TinyGLTF::LoadASCIIFromString is in $first"
echo "linked -ltinygltf -ldraco: TinyGLTF::LoadASCIIFromString is in $second"
case "$first" in libdraco*) ;; *) fail "with -ldraco first the call goes to $first" ;; esac
case "$second" in libtinygltf*) ;; *) fail "with -ltinygltf first the call goes to $second" ;; esac

# Output seen:
#   tinygltf:: symbols that libdraco exports: 49
#   stbi_ functions that libdraco exports:    56
#   linked -ldraco -ltinygltf: TinyGLTF::LoadASCIIFromString is in libdraco.so.7
#   linked -ltinygltf -ldraco: TinyGLTF::LoadASCIIFromString is in libtinygltf.so.2d
