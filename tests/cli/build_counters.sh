# Work follows change: nothing changed, a comment, one function, one option.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln --report-json a.json >/dev/null
expect_json a.json 'd["counts"]["legal"]' 5
expect_json a.json 'd["work"]["compiled"]' 5
kiln build p/m.yaml -o b.kiln --report-json b.json >/dev/null
expect_json b.json 'd["work"]["compiled"]+d["work"]["preprocessed"]+d["work"]["optimised"]+d["work"]["translated"]' 0
cmp a.kiln b.kiln
cmp a.kiln.proof b.kiln.proof
expect_json b.json 'd["counts"]==json.load(open("a.json"))["counts"]' True
sed -i '1i // a comment' p/lib/tint.glsl
kiln build p/m.yaml -o c.kiln --report-json c.json >/dev/null
expect_json c.json 'd["work"]["compiled"]' 0
expect_json c.json 'd["work"]["preprocessed"]>0' True
cmp a.kiln c.kiln
sed -i 's/vec3(1.0, 0.2, 0.2)/vec3(1.0, 0.3, 0.2)/' p/lib/tint.glsl
kiln build p/m.yaml -o d.kiln --report-json d.json >/dev/null
expect_json d.json 'd["work"]["compiled"]' 2
! cmp -s a.kiln d.kiln
