# Whatever a hurt cache does, the table is the one that is built without it; only time and counters change.
. "$(dirname "$0")/common.inc"
cp -r "$root/uber" "$root/manifests" .
kiln build manifests/sky_light.yaml -o alone.kiln --cache none >/dev/null
kiln build manifests/sky_light.yaml -o filled.kiln --cache c --json >calm.json
kiln build manifests/sky_light.yaml -o warm.kiln --cache c --json >warm.json
cmp alone.kiln warm.kiln
expect_json warm.json 'd["work"]["compiled"]' 0

hurt=0
for seed in 1 2 3 4 5 6 7 8; do
  for spec in loss=0.3 error=0.3 flip=0.5 delay=2 loss=0.2,error=0.2,flip=0.3,delay=1; do
    kiln build manifests/sky_light.yaml -o hurt.kiln --cache c --json --chaos "seed=$seed,$spec" >hurt.json 2>err
    cmp alone.kiln hurt.kiln
    cmp alone.kiln.proof hurt.kiln.proof
    grep -q 'chaos: lost' err || fail 'no word of what was done'
    # The control: over all runs, something was lost, failed, flipped and compiled again.
    if [ "$(json hurt.json 'd["work"]["compiled"]')" != 0 ]; then hurt=$((hurt + 1)); fi
    cat err >>all
  done
done
[ "$hurt" -gt 0 ] || fail 'no chaos cost any work'
for what in lost failed flipped delayed; do
  grep -qE "$what [1-9]" all || { cat all; fail "nothing was ever $what"; }
done
expect_code 2 kiln build manifests/sky_light.yaml -o x.kiln --chaos loss=2
expect_err "chances P from 0 to 1"
