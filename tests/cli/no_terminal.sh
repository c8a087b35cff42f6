# Where standard error is no terminal: no colour, and progress in whole lines.
. "$(dirname "$0")/common.inc"
unset NO_COLOR
small_project
kiln build p/m.yaml -o a.kiln >out 2>err
kiln validate a.kiln >>out 2>>err
sed -i 's/values: bool/values: boool/' p/m.yaml
! kiln count p/m.yaml >>out 2>>err
! grep -q $'\x1b' out err || fail "escape sequences in a file"
! grep -q $'\r' out err || fail "progress in a file"
! grep -q '^kiln: .*[0-9]/[0-9]' err || fail "progress of a short run in a file"

sed -i 's/boool/bool/' p/m.yaml
KILN_PROGRESS=0 kiln build p/m.yaml -o b.kiln --cache none >out 2>err
grep -q '^kiln: .* [0-9]*/[0-9]*' err || fail "no line of progress with KILN_PROGRESS=0"
! grep -q $'\r' err || fail "a rewritten line in a file"
KILN_PROGRESS=99999999999999999999 kiln build p/m.yaml -o b.kiln --cache none >out 2>err
grep -q "not '99999999999999999999'" err || fail "a KILN_PROGRESS that is no number was taken"
! grep -q '[0-9]/[0-9]' err || fail "KILN_PROGRESS ran over"
KILN_PROGRESS=off kiln build p/m.yaml -o b.kiln --cache none >out 2>err
[ ! -s err ] || fail "KILN_PROGRESS=off printed something"
