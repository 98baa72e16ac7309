# shellcheck shell=bash
# A small farm on this machine, for scripts to source: starts processes, and stops those and no others.
#
#     source deploy/farm.sh          # sets farm_root, farm_bin; installs the exit trap
#     farm_start FOLDER WORKERS      # server and workers with their data and logs below FOLDER; sets farm_url
#     farm_stop                      # also happens on exit, Ctrl-C and TERM
#
# The caller has set -euo pipefail.

farm_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
farm_bin=${TILEFARM_BIN:-$farm_root/build/release/bin}
farm_pids=() # every process started here that may still run, the server first
farm_groups=() # leaders of process groups started here
farm_url=

farm_say() { printf '%s: %s\n' "$(basename "$0" .sh)" "$*" >&2; }
farm_fail() { farm_say "$*"; exit 1; }

# Runs a program in the background with its output in a log. Where the system can, it also ends when this
# shell is killed in a way that no trap sees.
farm_spawn() {
    local log=$1
    shift
    if command -v setpriv >/dev/null; then set -- setpriv --pdeathsig TERM "$@"; fi
    "$@" >"$log" 2>&1 </dev/null &
    farm_pids+=("$!")
}

farm_running() { kill -0 "$1" 2>/dev/null; }

# Workers first, so that they hand their work back; TERM, then KILL after ten seconds.
farm_stop() {
    local index pid tries
    for pid in "${farm_groups[@]}"; do kill -TERM -- "-$pid" 2>/dev/null || true; done
    farm_groups=()
    for ((index = ${#farm_pids[@]} - 1; index >= 0; index--)); do kill -TERM "${farm_pids[index]}" 2>/dev/null || true; done
    for pid in "${farm_pids[@]}"; do
        for ((tries = 0; tries < 100; tries++)); do
            farm_running "$pid" || break
            sleep 0.1
        done
        kill -KILL "$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    done
    farm_pids=()
}

# EXIT alone would do for errors; the signals are turned into an exit so that EXIT runs for them too.
farm_cleanup() { farm_stop; }
trap 'farm_cleanup' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

farm_free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }
farm_up() { curl -fsS -o /dev/null --max-time 2 "$farm_url/healthz" 2>/dev/null; }

# Another process may take the port between the asking and the binding: then the next one is tried.
farm_start_server() {
    local folder=$1 attempt tries port
    for attempt in 1 2 3 4 5; do
        port=$(farm_free_port)
        farm_url=http://127.0.0.1:$port
        farm_spawn "$folder/server.log" "$farm_bin/tilefarm-server" --data "$folder/data" --listen "127.0.0.1:$port"
        for ((tries = 0; tries < 150; tries++)); do
            if farm_up; then return; fi
            farm_running "${farm_pids[-1]}" || break
            sleep 0.1
        done
        kill -KILL "${farm_pids[-1]}" 2>/dev/null || true
        unset 'farm_pids[-1]'
        grep -qi 'in use\|bind' "$folder/server.log" || break
    done
    tail -n 20 "$folder/server.log" >&2
    farm_fail "the server did not start (attempt $attempt); its last words are above"
}

# Software devices of several workers share the cores, or they would fight for them.
farm_start_workers() {
    local folder=$1 count=$2 number threads
    threads=$(($(nproc) / count))
    for ((number = 1; number <= count; number++)); do
        LP_NUM_THREADS=$((threads > 0 ? threads : 1)) farm_spawn "$folder/worker-$number.log" \
            "$farm_bin/tilefarm-worker" --server "$farm_url" --cache "$folder/cache-$number"
    done
}

farm_start() {
    local folder=$1 count=$2
    mkdir -p "$folder/data"
    farm_start_server "$folder"
    farm_start_workers "$folder" "$count"
}

# farm_get PATH EXPRESSION: a value out of a JSON answer, `answer` in the expression being the parsed body.
farm_get() { curl -fsS --max-time 30 "$farm_url$1" | python3 -c "import json, sys; answer = json.load(sys.stdin); print($2)"; }

# farm_check_workers FOLDER WORKERS: ends the script with their last words if all of them are gone.
farm_check_workers() {
    local pid folder=$1 count=$2
    for pid in "${farm_pids[@]:1:count}"; do
        if farm_running "$pid"; then return; fi
    done
    tail -n 10 "$folder"/worker-*.log >&2
    farm_fail "no worker is left; their last words are above"
}

# Peak resident memory of a process in MiB.
farm_peak_mib() { awk '/^VmHWM:/ { printf "%.0f", $2 / 1024 }' "/proc/$1/status"; }
