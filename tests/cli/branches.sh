# Two states of a project share a cache and answer each other's builds never and their own always: going back costs nothing.
. "$(dirname "$0")/common.inc"
small_project
cp -r p main
cp -r p branch
cat >>branch/paint.frag <<'GLSL'
#if BRIGHT
#include "only_here.glsl"
#endif
GLSL
echo '// nothing' >branch/lib/only_here.glsl
sed -i 's/vec3(0.5)/vec3(0.25)/' branch/paint.frag
for where in main branch; do
  kiln build $where/m.yaml -o "$where.cold" --cache none --depfile "$where.cold.d" >/dev/null
  kiln build $where/m.yaml -o "$where.kiln" --cache c --json >"$where.json"
  expect_json "$where.json" 'd["work"]["compiled"] > 0' True
  cmp "$where.cold" "$where.kiln"
done
for where in main branch main branch; do
  kiln build $where/m.yaml -o again.kiln --cache c --json --depfile again.d >again.json
  cmp "$where.cold" again.kiln
  expect_json again.json 'd["work"]' "{'preprocessed': 0, 'compiled': 0, 'optimised': 0, 'translated': 0, 'cache_hits': 1}"
  diff <(sed 's/^[^:]*://' "$where.cold.d") <(sed 's/^[^:]*://' again.d) || fail 'the depfile of a hit differs'
done
# A file that only one of them reads decides over its builds alone.
echo 'float unused;' >branch/lib/only_here.glsl
kiln build branch/m.yaml -o again.kiln --cache c --json >again.json
expect_json again.json 'd["work"]["preprocessed"] > 0' True
echo 'float unused;' >main/lib/only_here.glsl
kiln build main/m.yaml -o again.kiln --cache c --json >again.json
expect_json again.json 'd["work"]["compiled"]' 0
cmp main.cold again.kiln
