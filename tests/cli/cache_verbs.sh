# kiln cache verify finds a flipped bit and keeps it as evidence; gc and the bound keep a cache small; sizes are checked.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln --cache c >/dev/null

expect_code 0 kiln cache verify --cache c --json
expect_json out '[len(d["damaged"]), len(d["unreadable"]), d["checked"]["entries"] > 10]' '[0, 0, True]'
python3 - c <<'PY'
import pathlib, sys
files = sorted(p for p in pathlib.Path(sys.argv[1], "blob").rglob("*") if p.is_file())
data = bytearray(files[0].read_bytes())
data[len(data) // 2] ^= 4
files[0].write_bytes(data)
open("bad", "wb").write(data)
open("path", "w").write(str(files[0]))
PY
expect_code 4 kiln cache verify --cache c
expect_out "$(cat path)"
expect_out "have the SHA-256"
expect_out "1 damaged"
[ ! -e "$(cat path)" ] || fail 'a damaged entry kept its name'
cmp bad c/quarantine/blob-*
expect_code 0 kiln cache verify --cache c
expect_code 0 kiln cache stats --cache c --json
expect_json out '[d["quarantine"]["entries"], d["temporary"]["entries"], d["limit"]]' '[1, 0, 5368709120]'
kiln build p/m.yaml -o b.kiln --cache c >/dev/null
cmp a.kiln b.kiln

expect_code 0 kiln cache gc --cache c --max-size 20k --json
expect_json out '[d["after"]["charged"] <= 20480, d["after"]["entries"] > 0, d["before"]["entries"] == d["after"]["entries"] + d["evicted"]["entries"]]' '[True, True, True]'
kiln build p/m.yaml -o b.kiln --cache c >/dev/null
cmp a.kiln b.kiln

# A bound that is far too small for the build costs time alone.
for size in 1 5k 40k; do
  kiln build p/m.yaml -o b.kiln --cache "small$size" --cache-size "$size" >/dev/null 2>err
  cmp a.kiln b.kiln
  limit=$(KILN_CACHE_SIZE=$size "$KILN" cache stats --cache "small$size" --json | python3 -c 'import json,sys; d=json.load(sys.stdin); print(d["charged"] <= d["limit"])')
  [ "$limit" = True ] || fail "over the bound of $size"
done
KILN_CACHE_SIZE=40k "$KILN" cache gc --cache c >/dev/null
expect_code 0 kiln cache stats --cache c --json
expect_json out 'd["charged"] <= 36864' True

expect_code 2 kiln cache gc --cache c --max-size 5X
expect_err "takes a size such as"
expect_code 2 env KILN_CACHE_SIZE=lots "$KILN" build p/m.yaml -o b.kiln
expect_err "KILN_CACHE_SIZE takes a size"
expect_code 2 env KILN_CACHE_SYNC=often "$KILN" build p/m.yaml -o b.kiln
expect_code 2 kiln cache stats --cache c --max-size 5G
expect_code 2 kiln cache empty --cache c
expect_err "say stats, verify, gc or clear"
for sync in none file folder; do
  KILN_CACHE_SYNC=$sync "$KILN" build p/m.yaml -o b.kiln --cache "sync$sync" >/dev/null
  cmp a.kiln b.kiln
done
