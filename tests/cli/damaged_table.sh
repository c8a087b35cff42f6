# Every verb that opens a table refuses a damaged one with exit code 1.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln >/dev/null
head -c 100 a.kiln >short.kiln
: >empty.kiln
echo "hello, this is not a table at all" >other.kiln
python3 - <<'PY'
data = bytearray(open("a.kiln", "rb").read())
data[len(data) // 2] ^= 4
open("flipped.kiln", "wb").write(data)
PY
for x in short empty other flipped; do
  expect_code 1 kiln dump $x.kiln
  expect_err "$x.kiln"
  expect_code 1 kiln diff a.kiln $x.kiln
  expect_code 1 kiln validate $x.kiln
done
