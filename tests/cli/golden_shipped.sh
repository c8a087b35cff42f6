# What tests/golden says of renderer.yaml, its scenes and library.yaml is what listing its variants and preprocessing their texts says, without kiln.
. "$(dirname "$0")/common.inc"
python3 "$root/tests/golden/shipped.py" --check
