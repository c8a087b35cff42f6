# kiln report measures one family, and says the same in JSON, CSV and HTML; what is asked wrongly is refused before the device opens.
. "$(dirname "$0")/common.inc"
expect_code 0 kiln report --quick --family 4 -o page --budget maxabs=0.3 --json
cmp "$t/out" page/report.json
expect_json page/report.json '"llvmpipe" in d["device"]' True
expect_json page/report.json '"nopt" in d["settings"]' False
expect_json page/report.json '[f["name"] for f in d["families"]]' "['fresnel']"
expect_json page/report.json 'd["families"][0]["primary"]' maxabs
expect_json page/report.json 'sorted({e["verdict"] for e in d["families"][0]["expectations"]} - {"confirmed", "falsified", "undecided"})' '[]'
expect_json page/report.json 'min(m["repeats"] for s in d["families"][0]["scenes"] for m in s["members"]) >= 30' True
expect_json page/report.json 'min(m["dispatch_ms"] for s in d["families"][0]["scenes"] for m in s["members"]) >= 2' True
expect_json page/report.json 'sum(m["nonfinite"] for s in d["families"][0]["scenes"] for m in s["members"])' 0
# Fresnel's equations against themselves in double precision: rounding alone.
expect_json page/report.json '[m["maxabs"] < 2e-6 for m in d["families"][0]["together"]["members"] if m["member"] == "exact_conductor"]' '[True]'
expect_json page/report.json 'any("relmse" in m["front"] for m in d["families"][0]["together"]["members"])' True
expect_json page/report.json '[b["family"] for b in d["budget"]]' "['fresnel']"
python3 - <<'PY'
import csv, json
report = json.load(open("page/report.json"))["families"][0]
rows = list(csv.DictReader(open("page/report.csv")))
members = report["together"]["members"]
assert len(rows) == len(members) * (len(report["scenes"]) + 1), len(rows)
for member in members:
    row = next(r for r in rows if r["scene"] == "all" and r["member"] == member["member"])
    for key in ("relmse", "maxrel", "ns", "jit_ms", "spirv_bytes", "operations"):
        assert abs(float(row[key]) - member[key]) <= 1e-5 * abs(member[key]), (key, row[key], member[key])
PY
grep -q '<svg' page/report.html && grep -q 'data:image/png' page/report.html
! grep -qE 'https?:|src="/' page/report.html || fail "the page asks for something outside itself"

expect_code 0 kiln report --quick --family fresnel --budget maxabs=1e-30
expect_out "4 fresnel: none"
expect_code 2 kiln report --family frensel
expect_err "no family 'frensel'"
expect_code 2 kiln report --family 4 --budget error=1
expect_err "metrics are relmse"
expect_code 1 kiln report --quick --family 4 --library "$t"
expect_err "math.glsl"
