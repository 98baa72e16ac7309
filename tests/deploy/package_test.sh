#!/usr/bin/env bash
# Tests that `install` and the Debian package hold programs that run, their documents, and nothing of the build.
#
#     package_test.sh BUILD
set -euo pipefail
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "package: $*" >&2; exit 1; }

check_tree() {  # FOLDER with bin and share
    local program
    for program in tilefarm tilefarm-server tilefarm-worker; do
        [[ $("$1/bin/$program" --version) == *[0-9].[0-9]* ]] || fail "$program of $1 does not say its version"
    done
    [ -s "$1/share/doc/tilefarm/README.md" ] || fail "no README in $1"
    [ -s "$1/share/doc/tilefarm/docs/operations.md" ] || fail "no documents in $1"
    [ "$(ls "$1/bin" | wc -l)" = 3 ] || fail "more than the three programs: $(ls "$1/bin")"
    [ ! -e "$1/lib" ] && [ ! -e "$1/include" ] || fail "libraries of the build are in $1"
}

cmake --install "$build" --prefix "$work/installed" >/dev/null
check_tree "$work/installed"

(cd "$work" && cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work/packages" >"$work/log" 2>&1) ||
    { cat "$work/log" >&2; fail "cpack failed"; }
package=$(ls "$work"/packages/tilefarm_*.deb)
dpkg-deb --extract "$package" "$work/unpacked"
check_tree "$work/unpacked/usr"
[ "$(ls "$work/unpacked")" = usr ] || fail "files outside /usr: $(ls "$work/unpacked")"
depends=$(dpkg-deb --field "$package" Depends)
for library in libembree3 libopenexr libsqlite3-0 libvulkan1; do
    [[ $depends == *$library* ]] || fail "Depends lacks $library: $depends"
done
[ "$(dpkg-deb --field "$package" Package)" = tilefarm ] || fail "not named tilefarm"
echo "package: $(basename "$package"), $(stat -c %s "$package") bytes, Depends: $depends"
