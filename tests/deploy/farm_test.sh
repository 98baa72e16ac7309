#!/usr/bin/env bash
# Tests deploy/farm.sh against programs that only pretend: what it starts comes up, ends with it however it ends,
# and nothing else does.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
bystander=
cleanup() { kill "$bystander" 2>/dev/null || true; rm -rf "$work"; }
trap cleanup EXIT

mkdir "$work/bin"
cat >"$work/bin/tilefarm-server" <<'PYTHON'
#!/usr/bin/env python3
import http.server, os, sys
if os.environ.get("FAKE_FAILS"):
    sys.exit("no luck today")
class Answer(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        self.send_response(200)
        self.end_headers()
        self.wfile.write(b'{"workers": [1, 2, 3]}')
host, port = sys.argv[sys.argv.index("--listen") + 1].split(":")
http.server.HTTPServer((host, int(port)), Answer).serve_forever()
PYTHON
printf '#!/bin/sh\nexec sleep 1000\n' >"$work/bin/tilefarm-worker"
chmod +x "$work"/bin/*
export TILEFARM_BIN=$work/bin

cat >"$work/script.sh" <<SCRIPT
set -euo pipefail
source "$here/../../deploy/farm.sh"
farm_start "\$1" 2
printf '%s\n' "\${farm_pids[@]}" >"\$1/pids"
farm_get /v1/workers 'len(answer["workers"])' >"\$1/answer"
case \$2 in
    return) ;;
    fail) false ;;
    stay) while :; do sleep 0.1; done ;;
esac
SCRIPT

failures=0
expect() { # WHAT CONDITION…
    if "${@:2}"; then echo "ok: $1"; else echo "FAILED: $1"; failures=$((failures + 1)); fi
}
all_gone() { while read -r pid; do ! kill -0 "$pid" 2>/dev/null || return 1; done <"$1/pids"; }
wait_for() { for _ in $(seq 200); do [ ! -s "$1" ] || return 0; sleep 0.05; done; return 1; }
status() { "$@" && code=0 || code=$?; }

sleep 1000 &
bystander=$!

status bash "$work/script.sh" "$work/a" return
expect "a script that ends well reports so" [ "$code" = 0 ]
expect "server and two workers were started" [ "$(wc -l <"$work/a/pids")" = 3 ]
expect "values come out of answers" [ "$(cat "$work/a/answer")" = 3 ]
expect "all are gone after a good end" all_gone "$work/a"

status bash "$work/script.sh" "$work/b" fail
expect "an error keeps its status" [ "$code" = 1 ]
expect "all are gone after an error" all_gone "$work/b"

for signal in TERM HUP; do
    bash "$work/script.sh" "$work/$signal" stay &
    script=$!
    wait_for "$work/$signal/answer"
    kill -"$signal" "$script"
    status wait "$script"
    expect "$signal ends the script with 143" [ "$code" = 143 ]
    expect "all are gone after $signal" all_gone "$work/$signal"
done

status env FAKE_FAILS=1 bash "$work/script.sh" "$work/c" return 2>"$work/words"
expect "a server that does not come up is an error" [ "$code" = 1 ]
expect "its words are shown" grep -q "no luck today" "$work/words"

expect "a process of somebody else lives on" kill -0 "$bystander"
exit "$((failures > 0))"
