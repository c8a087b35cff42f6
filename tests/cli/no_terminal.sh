# Neither colour nor progress where standard error is no terminal.
. "$(dirname "$0")/common.inc"
unset NO_COLOR
small_project
kiln build p/m.yaml -o a.kiln >out 2>err
kiln validate a.kiln >>out 2>>err
sed -i 's/values: bool/values: boool/' p/m.yaml
! kiln count p/m.yaml >>out 2>>err
! grep -q $'\x1b' out err || fail "escape sequences in a file"
! grep -q $'\r' out err || fail "progress in a file"
