#!/usr/bin/env bash
# demo.sh KILN KILN_CACHED: one server, two machines' worth of jobs. Main writes and branches read; two jobs at once; a pull
# request that poisons all it can reach changes nothing. Each step says what it found, and the script fails where it is not so.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../../.." && pwd)
export KILN; KILN=$(realpath "$1")
cached=$(realpath "$2")
work=$(mktemp -d)
server=
finish() { if [ -n "$server" ]; then kill "$server" 2>/dev/null && wait "$server" || true; fi; rm -rf "$work"; }
trap finish EXIT
unset http_proxy https_proxy all_proxy HTTP_PROXY HTTPS_PROXY ALL_PROXY
export NO_COLOR=1 KILN_CACHE_DRAIN=60
cd "$work"

fail() { echo "FAILED: $*" >&2; tail -5 server.log >&2 || true; exit 1; }
of() { python3 -c "import json,sys; d=json.load(open(sys.argv[1])); print($2)" "$1.json"; }
expect() { local got; got=$(of "$1" "$2"); [ "$got" = "$3" ] || fail "$1: $2 is $got, not $3"; }
secret() { openssl rand -hex 24; }
# job MACHINE TOKEN SCRIPT CHECKOUT TABLE: a job on a machine that has nothing but a checkout and its secrets.
job() { XDG_CACHE_HOME="$work/$1/cache" TOKEN_FILE="$work/$2.token" "$here/$3.sh" "$4/manifests/sky_light.yaml" "$5" >"$5.log" 2>&1 || { cat "$5.log" >&2; fail "$3 on $1"; }; }
# Fresh machines: their folders are gone.
fresh() { rm -rf "$@"; }

# --- the server ---
umask 077
for who in main-ci branch-ci pr-ci pr-9; do secret >"$who.token"; done
cat >tokens <<TOKENS
main-ci $(cat main-ci.token) main:read,cas-write,ac-write
branch-ci $(cat branch-ci.token) main:read
pr-ci $(cat pr-ci.token) main:read pr/*:read,cas-write,ac-write
pr-9 $(cat pr-9.token) main:read pr/9:read,cas-write,ac-write until=2099-12-31
TOKENS
openssl genpkey -algorithm ed25519 -out sign.key 2>/dev/null
openssl pkey -in sign.key -pubout -out sign.pub
export SIGN_KEY=$work/sign.key SIGN_PUB=$work/sign.pub
"$cached" --config="$here/kiln-cached.yaml" --log=requests >port 2>server.log &
server=$!
for _ in $(seq 200); do [ -s port ] && break; sleep 0.05; done
CACHE=$(awk '{print $2; exit}' port)
case $CACHE in http*) ;; *) CACHE=http://$CACHE ;; esac
export CACHE

# --- three states of the project, and what their tables are without any cache ---
for state in one two three; do
  mkdir "$state"
  cp -r "$root/uber" "$root/manifests" "$state/"
done
sed -i 's/water += sky;/water += sky * 0.5;/' two/uber/sky_light.frag
! cmp -s one/uber/sky_light.frag two/uber/sky_light.frag || fail 'both states are one'
# State three differs in a remark: the whole build has to be found piece by piece.
echo '// a remark' >>three/uber/sky_light.frag
for state in one two three; do "$KILN" build $state/manifests/sky_light.yaml -o $state.alone --cache none >/dev/null; done
same() { cmp "$1.alone" "$2" && cmp "$1.alone.proof" "$2.proof" || fail "$2 is not the table of state $1"; }

echo "1. main builds state one and writes it"
job a main-ci main one main1
same one main1
expect main1 'd["work"]["compiled"] > 0 and d["remote"]["not_sent"] == 0 and d["remote"]["sent"] > 40' True

echo "2. a branch on another machine compiles nothing, and every record it used was signed by main"
job b branch-ci branch one branch1
same one branch1
expect branch1 '[d["work"]["compiled"], d["work"]["translated"], d["remote"]["misses"], d["remote"]["untrusted"], d["remote"]["sent"]]' '[0, 0, 0, 0, 0]'

echo "3. a pull request of state two finds in main what it did not change, and keeps the rest to itself"
export PR=7
job c pr-ci pull_request two pr1
same two pr1
expect pr1 'd["remote"]["hits"] > 0 and d["work"]["compiled"] > 0 and d["remote"]["not_sent"] == 0' True
fresh c
job c pr-ci pull_request two pr2
same two pr2
expect pr2 '[d["work"]["compiled"], d["remote"]["sent"]]' '[0, 0]'

fresh c
PR=9 job c pr-9 pull_request two pr9
same two pr9
expect pr9 'd["remote"]["sent"] > 0 and d["remote"]["not_sent"] == 0' True
fresh c
PR=10 job c pr-9 pull_request two pr10
same two pr10
expect pr10 'd["remote"]["sent"]' 0

echo "4. the pull request turns bad and writes other texts under the keys that main will ask"
python3 "$here/poison.py" "$CACHE" pr-ci.token server.log | tee poison
grep -qE '^main: 0 of [1-9][0-9]* writes' poison || fail 'a pull request wrote main'
grep -q '^blobs: 0 of [1-9]' poison || fail 'a blob took other bytes'
fresh c
PR=8 job c pr-ci pull_request two control
if cmp -s two.alone control; then fail 'the control: this poison harms nobody who takes it'; fi
fresh c
PR=8 KILN_CACHE_TRUST=$SIGN_PUB job c pr-ci pull_request two cured
same two cured
fresh c
PR=7 job c pr-ci pull_request two pr3
same two pr3

echo "5. main and a branch are as before, and main merges state two without a word from the pull request"
fresh a b
job a main-ci main one main2
same one main2
expect main2 '[d["work"]["compiled"], d["remote"]["sent"], d["remote"]["corrupt"]]' '[0, 0, 0]'
fresh a
job a main-ci main two main3
same two main3
expect main3 'd["work"]["compiled"] > 0 and d["remote"]["kept_first"] == 0' True
job b branch-ci branch two branch2
same two branch2
fresh a
job a main-ci main three main4
same three main4
expect main4 'd["work"]["compiled"]' 0
expect branch2 '[d["work"]["compiled"], d["remote"]["untrusted"]]' '[0, 0]'

echo "6. both machines build both states at once, main writing"
fresh a b
job a main-ci main one both1 & p1=$!
job b main-ci main two both2 & p2=$!
wait $p1; wait $p2
same one both1
same two both2

echo "7. the server is killed while a branch builds, and the table is the same"
fresh b
job b branch-ci branch one torn & p1=$!
sleep 0.05
kill -9 "$server"; wait "$server" 2>/dev/null || true
server=
wait $p1
same one torn
! grep -qFf main-ci.token server.log || fail 'a token is in the log'
echo "all as it should be"
