# What tests/golden says of renderer.yaml and its scenes is what listing its variants and preprocessing their texts says, without kiln.
. "$(dirname "$0")/common.inc"
python3 "$root/tests/golden/shipped.py" --check
