# renderer.yaml: a whole renderer builds, without a hole in any language; what its scenes and its full-screen passes need runs on
# lavapipe. (Running all of its pipelines takes minutes: kiln validate.)
. "$(dirname "$0")/common.inc"
renderer=$root/manifests/renderer.yaml
kiln build "$renderer" -o all.kiln --report-json build.json >/dev/null
expect_json build.json 'd["counts"]["legal"]' 2614
expect_json build.json 'd["counts"]["pipelines"]' 1589
kiln dump all.kiln --json >dump.json
expect_json dump.json 'd["holes"]' '{}'

# What a scene does not need is left out: of 1,589 pipelines these remain.
declare -A pipelines=([corridor]=39 [valley]=22 [handheld]=22)
for scene in corridor valley handheld; do
  kiln build "$renderer" --scene "$root/manifests/scenes/renderer_$scene.yaml" -o $scene.kiln --parse-back --report-json build.json \
    >/dev/null 2>err
  expect_json build.json 'd["counts"]["pipelines"]' ${pipelines[$scene]}
  kiln validate $scene.kiln --json >v.json
  expect_json v.json 'd["passed"]' ${pipelines[$scene]}
  expect_json v.json 'len(d["failed"])+len(d["unsupported"])+len(d["undrawn"])+d["not_compared"]+d["nonfinite"]' 0
done

# Every way to light a g-buffer, every sky and every tone curve.
for shader in deferred background post; do
  kiln validate all.kiln --shader $shader --json >v.json
  expect_json v.json 'd["passed"] == d["pipelines"] and d["nonfinite"] == 0 and not d["failed"] and not d["undrawn"]' True
done
