# The same bytes for any thread count, cache state and working folder.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln -j 1 --cache none >/dev/null
kiln build p/m.yaml -o b.kiln -j 2 --cache none >/dev/null
kiln build p/m.yaml -o c.kiln >/dev/null
kiln build p/m.yaml -o d.kiln >/dev/null
mkdir -p other/deep
cp -r p other/deep/p
(cd other/deep && kiln build p/m.yaml -o "$t/e.kiln" --cache none >/dev/null)
(cd p && kiln build m.yaml -o "$t/f.kiln" >/dev/null)
(cd / && kiln build "$t/p/m.yaml" -o "$t/g.kiln" >/dev/null)
for x in b c d e f g; do
  cmp a.kiln $x.kiln
  cmp a.kiln.proof $x.kiln.proof
done
