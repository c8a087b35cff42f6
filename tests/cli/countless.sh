# More variants than a double can count: decimal strings stay exact, and validate's number stays a number, not 0.
. "$(dirname "$0")/common.inc"
small_project
sed -i 's/targets: .*/targets: [spirv]/' p/m.yaml
for i in $(seq 1100); do echo "  more$i: {macro: MORE_$i, values: bool}"; done >axes
sed -i '/bright: {/r axes' p/m.yaml
kiln count p/m.yaml --json >count.json
expect_json count.json 'int(d["total"]["legal"]) == 5 << 1100' True
expect_json count.json 'int(d["total"]["declared"]) == 6 << 1100' True
kiln build p/m.yaml -o a.kiln --json >build.json 2>/dev/null
expect_json build.json 'd["counts"]["legal"]' "$(json count.json 'd["total"]["legal"]')"
kiln validate a.kiln --json >validate.json
expect_json validate.json 'd["variants"] > 1e300 and d["variants"] < float("inf")' True
expect_json validate.json 'd["failed"]' '[]'
