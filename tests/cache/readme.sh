#!/usr/bin/env bash
# readme.sh KILN KILN_CACHED: follows "A cache server for your CI" of README.md as it stands. Only its ports are the kernel's and its addresses
# loopback's. Then the jobs that the text promises something about: a branch, a pull request, gRPC.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
command -v openssl >/dev/null || { echo "SKIP: no openssl here"; exit 77; }
work=$(mktemp -d)
server=
finish() { if [ -n "$server" ]; then kill "$server" 2>/dev/null && wait "$server" || true; fi; rm -rf "$work"; }
trap finish EXIT
for variable in $(env | sed -n 's/^\(KILN_CACHE[A-Z_]*\)=.*/\1/p'); do unset "$variable"; done
unset http_proxy https_proxy all_proxy no_proxy HTTP_PROXY HTTPS_PROXY ALL_PROXY grpc_proxy
export NO_COLOR=1 XDG_CACHE_HOME=$work/local
mkdir "$work/bin" "$work/there"
printf '#!/bin/sh\nexec "%s" "$@"\n' "$(realpath "$1")" >"$work/bin/kiln"
printf '#!/bin/sh\nexec "%s" "$@"\n' "$(realpath "$2")" >"$work/bin/kiln-cached"
chmod +x "$work/bin"/*
export PATH=$work/bin:$PATH
cd "$work/there"
cp -r "$root/uber" "$root/manifests" .

python3 - "$root/README.md" <<'PY'
import re, socket, sys
text = open(sys.argv[1]).read()
section = text.split("## A cache server for your CI\n", 1)[1].split("\n## ", 1)[0]
code = "".join(line[4:] for line in section.splitlines(True) if line.startswith("    "))
assert code.count(" &\n") == 1, "the text starts no server, or two"
kept = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
for told, taken in zip(("8443", "8980"), kept):
    assert code.count(told) >= 1
    code = code.replace(told, str(taken.getsockname()[1]))
code = code.replace("0.0.0.0", "127.0.0.1").replace(" &\n", " >ports 2>log &\nserver=$!\nfor _ in $(seq 200); do grep -q ^grpc ports && break; sleep 0.05; done\n")
code = code.replace("-o surface.kiln", "-o surface.kiln --json >first.json").replace("surface.yaml", "sky_light.yaml")
open("followed.sh", "w").write(code)
PY
. ./followed.sh 2>errors
grep -q ^grpc ports || { cat log errors; exit 1; }
of() { python3 -c "import json,sys; d=json.load(open('$1')); print($2)"; }
expect() { local got; got=$(of "$1" "$2"); [ "$got" = "$3" ] || { echo "FAILED: $1: $2 is $got, not $3" >&2; cat log >&2; exit 1; }; }
again() { rm -rf "$XDG_CACHE_HOME"; kiln build manifests/sky_light.yaml -o "$1.kiln" --json >"$1.json"; cmp surface.kiln "$1.kiln"; }

expect first.json 'd["work"]["compiled"] > 0 and d["remote"]["sent"] > 40 and d["remote"]["not_sent"] == 0' True
export KILN_CACHE_TOKEN_FILE=branch.token
again branch
expect branch.json '[d["work"]["compiled"], d["remote"]["hits"], d["remote"]["misses"]]' '[0, 3, 0]'
https=$KILN_CACHE
export KILN_CACHE=grpcs://localhost:$(sed -n 's/^grpc .*://p' ports)/main
again grpc
expect grpc.json '[d["work"]["compiled"], d["remote"]["hits"], d["remote"]["misses"]]' '[0, 3, 0]'
# A pull request finds what main has; what it adds main does not see.
export KILN_CACHE=${https%main}pr/7 KILN_CACHE_TOKEN_FILE=pr-7.token
again pr
expect pr.json 'd["work"]["compiled"]' 0
sed -i 's/water += sky;/water += sky * 0.5;/' uber/sky_light.frag
kiln build manifests/sky_light.yaml -o changed.kiln --json >changed.json
expect changed.json 'd["work"]["compiled"] > 0 and d["remote"]["sent"] > 0' True
rm -rf "$XDG_CACHE_HOME"
KILN_CACHE=${https%main}pr/8 kiln build manifests/sky_light.yaml -o eight.kiln --json >eight.json 2>eight.err
expect eight.json '[d["work"]["compiled"] > 0, d["remote"]["hits"], d["remote"]["sent"]]' '[True, 0, 0]'
rm -rf "$XDG_CACHE_HOME"
KILN_CACHE=$https KILN_CACHE_TOKEN_FILE=branch.token kiln build manifests/sky_light.yaml -o other.kiln --json >other.json
expect other.json 'd["work"]["compiled"] > 0' True
echo "the README holds"
