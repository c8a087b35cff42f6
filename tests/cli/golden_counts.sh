# Declared, legal and needed variants and classes of every case in tests/golden, found independently of kiln.
. "$(dirname "$0")/common.inc"
python3 "$root/tests/golden/check.py" "$KILN" "$root"/tests/golden/*/expected.json
