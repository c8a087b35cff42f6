# The lecture's snippet, mended: 16 variants, 5 different texts.
. "$(dirname "$0")/common.inc"
kiln count "$root/manifests/sky_light.yaml" --classes --json >c.json
expect_json c.json 'd["total"]["declared"]' 16
expect_json c.json 'd["total"]["legal"]' 16
expect_json c.json 'd["total"]["classes"]' 5
