# Closed standard streams neither end up in a file nor hide a failure; a reader that leaves early ends kiln quietly.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o want.kiln >/dev/null
code=0
"$KILN" build p/m.yaml -o got.kiln --cache none <&- >&- 2>&- || code=$?
[ "$code" = 3 ] || fail "closed streams: exit code $code, not 3"
cmp want.kiln got.kiln
cmp want.kiln.proof got.kiln.proof
code=0
"$KILN" count p/m.yaml >&- 2>err || code=$?
[ "$code" = 3 ] || fail "closed output: exit code $code, not 3"
expect_err "cannot write to standard output"
code=0
"$KILN" count p/m.yaml >/dev/full 2>err || code=$?
[ "$code" = 3 ] || fail "full output: exit code $code, not 3"
# A named pipe whose reader has gone before kiln writes.
mkfifo pipe
(exec 3<pipe) &
exec 4>pipe
wait
code=0
"$KILN" count p/m.yaml >&4 2>err || code=$?
[ "$code" = 141 ] || fail "broken pipe: exit code $code, not 141"
[ ! -s err ] || { cat err; fail "a broken pipe is no error"; }
# No home, no cache folder: a build all the same.
env -u HOME -u XDG_CACHE_HOME "$KILN" build p/m.yaml -o nohome.kiln >/dev/null
cmp want.kiln nohome.kiln
