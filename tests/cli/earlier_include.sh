# A file that appears earlier on the search path is seen, although nothing that was read has changed.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln >/dev/null
sed 's/0.2/0.9/g' p/lib/tint.glsl >p/tint.glsl
kiln build p/m.yaml -o b.kiln --report-json b.json >/dev/null
expect_json b.json 'd["work"]["preprocessed"]>0' True
! cmp -s a.kiln b.kiln || fail "the nearer file was not used"
rm p/tint.glsl
kiln build p/m.yaml -o c.kiln >/dev/null
cmp a.kiln c.kiln
