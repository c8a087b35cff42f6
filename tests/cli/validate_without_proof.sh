# Without a proof nothing is compared, and that is a number and a warning, never a pass. A foreign proof is refused.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln >/dev/null
sed -i 's/c \*= 2.0/c *= 4.0/' p/paint.frag
kiln build p/m.yaml -o b.kiln >/dev/null
mv a.kiln.proof kept
expect_code 0 kiln validate a.kiln --json
expect_err "no proof"
expect_json "$t/out" 'd["not_compared"]' 5
mv b.kiln.proof a.kiln.proof
expect_code 1 kiln validate a.kiln
mv kept a.kiln.proof
expect_code 0 kiln validate a.kiln --sample 2 --json
expect_json "$t/out" 'd["modules"]' 5
expect_code 0 kiln validate a.kiln --shader paint --json
expect_json "$t/out" 'd["not_compared"]' 0
expect_code 1 kiln validate a.kiln --shader pian
expect_err "did you mean 'paint'"
KILN_ICD=/nowhere.json expect_code 3 kiln validate a.kiln --cache none
