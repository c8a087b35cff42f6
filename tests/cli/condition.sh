# An error in one corner says exactly which variants it hits; #error suggests the rule it stands for.
. "$(dirname "$0")/common.inc"
small_project
sed -i 's/c \*= 2.0;/c *= glow;/' p/paint.frag
expect_code 1 kiln build p/m.yaml -o a.kiln
expect_err "p/paint.frag:10:10: error: 'glow' : undeclared identifier"
expect_err "in 2 of 5 variants of paint: exactly when bright"
[ ! -e a.kiln ] || fail "a table was written"
sed -i 's/c \*= glow;/\n#error no glow/' p/paint.frag
expect_code 1 kiln count p/m.yaml --classes
expect_err "no glow"
expect_err "exactly when bright"
expect_err "forbid: bright"
