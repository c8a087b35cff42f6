# kiln build --execute: whatever an engine and its workers do, the table is the one that is built at home.
. "$(dirname "$0")/common.inc"
small_project
mkdir home away
kiln build p/m.yaml -o home/t.kiln --cache none >/dev/null

# Everything is answered by workers, and nothing compiled here.
kiln build p/m.yaml -o away/t.kiln --cache c --execute local:2 --report-json r.json >out
cmp home/t.kiln away/t.kiln
cmp home/t.kiln.proof away/t.kiln.proof
expect_json r.json 'd["work"]["compiled"], d["work"]["translated"]' '0 0'
expect_json r.json 'd["execution"]["answered"] == d["execution"]["questions"] > 0' True
grep -q 'local:2 answered' out || fail 'the summary does not say who worked'

# What the store has is not sent: a new class alone is.
sed -i 's/c \*= 2.0/c *= 3.0/' p/paint.frag
kiln build p/m.yaml -o away/t.kiln --cache c --execute local:2 --report-json r.json >/dev/null
asked=$(json r.json 'd["execution"]["questions"]')
[ "$asked" -gt 0 ] && [ "$asked" -lt 10 ] || fail "$asked questions for two classes"
kiln build p/m.yaml -o home/t.kiln --cache none >/dev/null
cmp home/t.kiln away/t.kiln

# Workers that fail, die, hang, say nothing, or say nonsense cost time and one warning.
worker() { printf '#!/bin/sh\n%s\n' "$1" >worker; chmod +x worker; export KILN_WORKER=$t/worker; }
real_worker=$(dirname "$KILN")/kiln-worker
export REAL=$real_worker
broken() {
  worker "$2"
  kiln build p/m.yaml -o away/t.kiln --cache none --execute local:2 --execute-timeout "${3:-60}" --report-json r.json >out 2>err
  cmp home/t.kiln away/t.kiln || fail "$1: another table"
  expect_json r.json 'd["execution"]["failed_batches"] > 0' True
  [ "$(grep -c 'warning: ' err)" = 1 ] || { cat err; fail "$1: not one warning"; }
}
broken 'exit 1' 'exit 1'
broken 'killed' 'kill -9 $$'
broken 'hangs' 'sleep 600' 1
broken 'no answers' 'exit 0'
broken 'empty answers' ': > answers'
broken 'nonsense' 'head -c 10000 /dev/urandom > answers'
broken 'a link instead of answers' 'ln -s /etc/passwd answers'
broken 'a folder instead of answers' 'mkdir answers'
broken 'cut short' '"$REAL" batch answers; truncate -s -1 answers'
broken 'one bit' '"$REAL" batch answers; printf "\\377" | dd of=answers bs=1 seek=300 conv=notrunc 2>/dev/null'
# Answers to other questions are no answers to these, and answers to some leave the rest to be done here.
worker 'd=$(mktemp -d); cp batch "$d"; "$REAL" batch answers; rm -r "$d"'
kiln build p/m.yaml -o away/t.kiln --cache none --execute local:2 --report-json r.json >/dev/null
expect_json r.json 'd["execution"]["failed_batches"], d["work"]["compiled"]' '0 0'
cp "$t/worker" keep
worker 'test -e '"$t"'/once && exit 1; : > '"$t"'/once; "$REAL" batch answers'
kiln build p/m.yaml -o away/t.kiln --cache none --execute local:1 --report-json r.json >/dev/null 2>&1
cmp home/t.kiln away/t.kiln
expect_json r.json 'd["work"]["compiled"] == 0 and d["work"]["translated"] > 0' True
unset KILN_WORKER

# An error in a shader is shown as without an engine.
cp p/paint.frag keep.frag
sed -i 's/c \*= 3.0/c *= nothing/' p/paint.frag
expect_code 1 kiln build p/m.yaml -o away/t.kiln --cache none --execute local:2
cp err away.err
expect_code 1 kiln build p/m.yaml -o away/t.kiln --cache none
cmp err away.err
cp keep.frag p/paint.frag

# The worker by itself.
worker_says() { local want=$1; shift; expect_code "$want" "$real_worker" "$@"; }
worker_says 2
worker_says 3 nothing answers
: >empty
worker_says 1 empty answers
expect_err 'no batch of work'
worker_says 0 --help

# Usage, and a program that is not there.
expect_code 2 kiln build p/m.yaml -o x.kiln --execute local:0
expect_code 2 kiln build p/m.yaml -o x.kiln --execute slurm:relative
expect_code 2 kiln build p/m.yaml -o x.kiln --execute nonsense
KILN_WORKER=$t/nowhere expect_code 3 kiln build p/m.yaml -o x.kiln --execute local:1
expect_err 'nowhere'

# The plan counts what would be sent, and writes nothing.
expect_code 0 kiln build p/m.yaml --distributed-plan --workers 4 --json
expect_json out '[s["questions"] > 0 and s["bytes"] > 100 for s in d["steps"]]' '[True, True]'
expect_json out 'd["model"][0]["workers"], d["model"][0]["batches"]' '4 2'
expect_code 0 kiln build p/m.yaml --distributed-plan
expect_out '64 workers'
[ ! -e x.kiln ] || fail 'a plan wrote a table'

# Options that would be of no effect, and settings that cannot be right, are told before anything is built.
expect_code 2 kiln build p/m.yaml -o x.kiln --workers 3
expect_code 2 kiln build p/m.yaml -o x.kiln --execute-timeout 3
expect_code 2 kiln build p/m.yaml -o x.kiln --execute grpc://
expect_err "execute 'grpc://'"
expect_code 2 kiln build p/m.yaml -o x.kiln --execute grpc://a,http://b
KILN_EXECUTE_CA=$t/p/m.yaml expect_code 1 kiln build p/m.yaml -o x.kiln --execute grpcs://127.0.0.1:1
expect_err 'holds no certificates'
KILN_EXECUTE_PLATFORM=x expect_code 2 kiln build p/m.yaml -o x.kiln --execute grpc://127.0.0.1:1
[ ! -e x.kiln ] || fail 'a table was written'

# A kiln of other sources: its worker refuses, and its cache entries are not ours.
number=$(kiln --version | sed -n 's/^kiln .*+//p')
[ ${#number} = 16 ] || fail "no digest of the sources in $(kiln --version | head -1)"
other=$(tr 0-9a-f 1-9a-f0 <<<"$number")
sed "s/$number/$other/g" "$real_worker" >other_worker && chmod +x other_worker
KILN_WORKER=$t/other_worker kiln build p/m.yaml -o away/t.kiln --cache none --execute local:2 >out 2>err
cmp home/t.kiln away/t.kiln
grep -q 'answered 0 of' out && grep -q 'another kiln' err || { cat out err; fail 'a worker of another kiln worked'; }
sed "s/$number/$other/g" "$KILN" >other_kiln && chmod +x other_kiln
kiln build p/m.yaml -o away/t.kiln --cache both --report-json r.json >/dev/null
compiled=$(json r.json 'd["work"]["compiled"], d["work"]["translated"]')
echo '// a remark' >>p/paint.frag
kiln build p/m.yaml -o away/t.kiln --cache both --report-json r.json >/dev/null
expect_json r.json 'd["work"]["compiled"], d["work"]["translated"]' '0 0'
./other_kiln build p/m.yaml -o away/t.kiln --cache both --report-json r.json >/dev/null
expect_json r.json 'd["work"]["compiled"], d["work"]["translated"]' "$compiled"
