#!/usr/bin/env bash
# Installs what Tilefarm needs to build, run and test on Debian 12 or newer. Safe to run again.
#
# Lavapipe, the Vulkan driver for machines without a GPU, is much faster from Mesa 24.3 on. Where the
# system's own release is older, the driver comes from its backports suite, through the mirror that
# the system already uses; where that is not to be had, the stock driver is kept.
#
# The package names hold on Debian 12 and 13. What differs is found at build time (Embree 3 or 4).
#
#   deploy/setup.sh            packages to build, run and test
#   deploy/setup.sh --run      to build and run alone: without Blender and what else only tests use
#   deploy/setup.sh --bench    also what the comparison benchmarks need
set -euo pipefail
export LC_ALL=C  # apt's answers are read below

readonly mesa_wanted=24.3
readonly backports_list=/etc/apt/sources.list.d/tilefarm-backports.sources

packages=(
    build-essential clang cmake ninja-build ccache git pkg-config ca-certificates curl
    libvulkan-dev vulkan-validationlayers glslang-tools spirv-tools
    libglm-dev libtinygltf-dev libdraco-dev libmeshoptimizer-dev libembree-dev
    libcpp-httplib-dev libssl-dev nlohmann-json3-dev libopenexr-dev
    libsqlite3-dev libsqlitecpp-dev libcli11-dev libspdlog-dev prometheus-cpp-dev libstb-dev
    libjs-chart.js libzip-dev libmurmurhash-dev libjpeg62-turbo-dev libpng-dev ffmpeg
    libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev python3 sqlite3
)
# What tests open our pictures in, check the API's description with (tests/e2e/openapi_test.py) and find functions by
# (tests/tidy).
test_packages=(blender openimageio-tools python3-jsonschema universal-ctags)
command -v npm >/dev/null || test_packages+=(npm)  # where Node.js came from elsewhere, it has npm
bench_packages=(python3-numpy)

say() { printf 'setup: %s\n' "$*" >&2; }
fail() { say "$*"; exit 1; }

command -v apt-get >/dev/null && command -v dpkg-query >/dev/null || fail "needs apt-get: Debian 12 or newer"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
fi
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Quiet unless it fails: what apt-get said then goes to stderr.
apt() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300 \
        "$@" >"$log" 2>&1 </dev/null && return
    local status=$?
    tail -n 25 "$log" >&2
    return "$status"
}

installed() { dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'; }
candidate() { apt-cache policy "$1" | sed -n '/(none)/d; s/^ *Candidate: //p'; }
at_least() { [ -n "$1" ] && dpkg --compare-versions "$1" ge "$2"; }
mesa_installed() { dpkg-query -W -f='${Version}' mesa-vulkan-drivers 2>/dev/null || true; }

# Prints "URI<tab>KEYRING" of the mirror that serves the release itself (not its security suite), from
# either format that apt reads.
system_mirror() {
    local codename=$1 file
    for file in /etc/apt/sources.list.d/*.sources; do
        [ -e "$file" ] && [ "$file" != "$backports_list" ] || continue
        awk -v RS= -v suite="$codename" '
            { uri = suites = key = ""
              n = split($0, lines, "\n")
              for (i = 1; i <= n; i++) {
                  if (lines[i] ~ /^URIs:/)      { sub(/^URIs:[ \t]*/, "", lines[i]); split(lines[i], u, /[ \t]+/); uri = u[1] }
                  if (lines[i] ~ /^Suites:/)    { sub(/^Suites:[ \t]*/, "", lines[i]); suites = " " lines[i] " " }
                  if (lines[i] ~ /^Signed-By:/) { sub(/^Signed-By:[ \t]*/, "", lines[i]); key = lines[i] }
              }
              if (index(suites, " " suite " ")) { print uri "\t" key; exit } }' "$file"
    done
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
        [ -e "$file" ] || continue
        awk -v suite="$codename" '$1 == "deb" {
            key = ""; first = 2
            if ($2 ~ /^\[/) { while ($first !~ /\]$/) first++; first++
                if (match($0, /signed-by=[^] ]+/)) key = substr($0, RSTART + 10, RLENGTH - 10) }
            if ($(first + 1) == suite) { print $first "\t" key; exit } }' "$file"
    done
}

# Adds the backports suite of the running Debian release; false where there is none to reach.
add_backports() {
    local codename mirror uri key
    codename=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")
    [ -n "$codename" ] || return 1
    mirror=$(system_mirror "$codename" | head -n 1)
    uri=${mirror%%$'\t'*} key=${mirror#*$'\t'}
    [ -n "$uri" ] || return 1
    {
        printf 'Types: deb\nURIs: %s\nSuites: %s-backports\nComponents: main\n' "$uri" "$codename"
        [ -z "$key" ] || printf 'Signed-By: %s\n' "$key"
    } | "${as_root[@]}" tee "$backports_list" >/dev/null
    if ! apt update -o Dir::Etc::sourcelist="$backports_list" -o Dir::Etc::sourceparts=- \
        -o APT::Get::List-Cleanup=0 -o APT::Update::Error-Mode=any; then
        "${as_root[@]}" rm -f "$backports_list"
        return 1
    fi
}

install_mesa() {
    if at_least "$(mesa_installed)" "$mesa_wanted" ; then return; fi
    if at_least "$(candidate mesa-vulkan-drivers)" "$mesa_wanted"; then
        apt install --no-install-recommends mesa-vulkan-drivers
        return
    fi
    local suite
    # shellcheck disable=SC1091  # the system's own file
    suite="$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")-backports"
    # libgl1-mesa-dri comes along because older builds of it refuse the newer driver's libraries.
    if add_backports && apt install --no-install-recommends -t "$suite" mesa-vulkan-drivers libgl1-mesa-dri; then
        say "Mesa $(mesa_installed) from $suite"
    else
        say "no Mesa $mesa_wanted to be had; carrying on with the stock driver"
        installed mesa-vulkan-drivers || apt install --no-install-recommends mesa-vulkan-drivers ||
            fail "no Vulkan driver could be installed; apt-get's words are above"
    fi
}

install_packages() {
    local package unknown=()
    for package; do [ -n "$(candidate "$package")" ] || unknown+=("$package"); done
    [ ${#unknown[@]} -eq 0 ] || fail "this system's apt knows no ${unknown[*]}; Tilefarm needs Debian 12 or newer and its main archive"
    say "installing $# packages"
    apt install --no-install-recommends "$@" || fail "installing failed; apt-get's words are above"
}

main() {
    case "${1:-}" in
        "") packages+=("${test_packages[@]}") ;;
        --run) ;;
        --bench) packages+=("${test_packages[@]}" "${bench_packages[@]}") ;;
        *) fail "unknown option '$1' (--run and --bench are known)" ;;
    esac
    local missing=() package
    for package in "${packages[@]}"; do installed "$package" || missing+=("$package"); done
    if [ "$(id -u)" -ne 0 ] && ! sudo -v 2>/dev/null; then
        # Without rights, what is there may be enough.
        installed mesa-vulkan-drivers || missing+=(mesa-vulkan-drivers)
        [ ${#missing[@]} -eq 0 ] || fail "needs root or sudo to install: ${missing[*]}"
        say "ready (Mesa $(mesa_installed); no root or sudo, so nothing was updated)"
        return
    fi
    if [ ${#missing[@]} -gt 0 ] || ! at_least "$(mesa_installed)" "$mesa_wanted"; then
        apt update || say "apt-get update reported errors; trying with the lists there are"
    fi
    [ ${#missing[@]} -eq 0 ] || { install_packages "${missing[@]}"; }
    install_mesa
    say "ready (Mesa $(mesa_installed))"
}
main "$@"
