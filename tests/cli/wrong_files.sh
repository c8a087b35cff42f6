# A wrong file in the place of a table, a proof or a verb is named, with exit code 1 or 2.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln >/dev/null
sed -i 's/0\.5/0.25/' p/paint.frag
kiln build p/m.yaml -o b.kiln >/dev/null
for verb in dump explain validate "diff a.kiln"; do
  expect_code 1 kiln $verb p
  expect_err "p: "
  expect_err "is a folder"
done
expect_code 1 kiln validate a.kiln --proof b.kiln.proof
expect_err "b.kiln.proof: this proof belongs to another table"
expect_code 1 kiln validate a.kiln --proof nowhere
expect_err "nowhere: no such file"
expect_code 1 kiln validate a.kiln --proof p
expect_err "is a folder"
expect_code 1 kiln build p/m.yaml -o c.kiln --target metal
expect_err "msl21"
expect_code 2 kiln help cuont
expect_err "did you mean 'count'?"
expect_code 0 kiln help count
expect_out "kiln count MANIFEST"
# A selection of which the rules leave only a part says so.
kiln explain p/m.yaml bright=true >out
expect_out "paint bright=true: needed in part (3 combinations, 2 legal, 2 needed)"
kiln explain a.kiln bright=true >out
expect_out "paint bright=true: needed in part, 2 variants"
