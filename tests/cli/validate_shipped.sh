# Every manifest that is shipped, from text to verdict: parsed back, every pipeline run on lavapipe, nothing left uncompared; a
# second run answers from the cache. Of renderer.yaml, renderer.sh takes what its scenes need: all of it takes minutes.
. "$(dirname "$0")/common.inc"
for manifest in "$root"/manifests/*.yaml; do
  name=$(basename "$manifest" .yaml)
  [ $name != renderer ] || continue
  kiln build "$manifest" -o $name.kiln --parse-back --report-json build.json >/dev/null
  pipelines=$(json build.json 'd["counts"]["pipelines"]')
  kiln validate $name.kiln --json --report out >v.json
  expect_json v.json 'd["passed"]' "$pipelines"
  expect_json v.json 'd["run"]+d["shared"]' "$pipelines"
  expect_json v.json 'len(d["failed"])+len(d["unsupported"])+len(d["undrawn"])+d["not_compared"]+d["nonfinite"]' 0
  expect_json v.json '"llvmpipe" in d["device"]' True
  expect_json v.json 'str(d["variants"])' "$(json build.json 'd["counts"]["needed"]')"
  cmp v.json out/validate.json
  kiln validate $name.kiln --json >again.json
  expect_json again.json '[d["run"],d["cached"]+d["shared"]]' "[0, $pipelines]"
done
