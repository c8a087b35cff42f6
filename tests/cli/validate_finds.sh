# A division by zero in one corner is a mismatch that names its variants.
. "$(dirname "$0")/common.inc"
small_project
sed -i 's/c \*= 2.0;/c \/= dot(c, c) - dot(c, c);/' p/paint.frag
kiln build p/m.yaml -o a.kiln >/dev/null
expect_code 4 kiln validate a.kiln
expect_out "exactly when bright"
expect_code 4 kiln validate a.kiln --json
expect_json "$t/out" '[f["where"] for f in d["failed"]]' "['in 2 of 5 variants of paint: exactly when bright']"
expect_json "$t/out" 'd["passed"]' 3
