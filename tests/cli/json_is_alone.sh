# With --json standard output is one JSON document even when there are warnings.
. "$(dirname "$0")/common.inc"
small_project
sed -i 's/  bright: {macro: BRIGHT, values: bool}/&\n  idle: {macro: IDLE, values: bool}/' p/m.yaml
expect_code 0 kiln count p/m.yaml --classes --json
python3 -m json.tool "$t/out" >/dev/null
expect_err "no stage reads the macro IDLE"
expect_code 0 kiln build p/m.yaml -o a.kiln --json
python3 -m json.tool "$t/out" >/dev/null
expect_json "$t/out" 'd["counts"]["legal"]' 10
expect_json "$t/out" 'd["counts"]["modules"]' 5
