# No output replaces a file that the build reads, or another output; devices may be named often.
. "$(dirname "$0")/common.inc"
small_project
cp -r p kept
ln -s p/paint.frag link.frag
expect_code 2 kiln build p/m.yaml -o p/m.yaml
expect_err "--output would overwrite p/m.yaml"
expect_code 2 kiln build p/m.yaml -o p/lib/../paint.frag
expect_err "would overwrite p/paint.frag"
expect_code 2 kiln build p/m.yaml -o a.kiln --header "$real/p/lib/tint.glsl"
expect_err "--header would overwrite p/lib/tint.glsl"
expect_code 2 kiln build p/m.yaml -o a.kiln --depfile link.frag
expect_err "--depfile would overwrite p/paint.frag"
diff -r p kept
expect_code 2 kiln build p/m.yaml -o a.kiln --header a.kiln
expect_err "--output and --header name one file, a.kiln"
expect_code 2 kiln build p/m.yaml -o a.kiln --report-json ./a.kiln.proof
expect_err "the proof and --report-json name one file"
expect_code 2 kiln build p/m.yaml -o ""
expect_err "--output: the name of a file is missing"
expect_code 2 kiln build "" -o a.kiln
expect_code 2 kiln count p/m.yaml --scene=
[ ! -e a.kiln ] || fail "a table was written"
kiln build p/m.yaml -o a.kiln --header /dev/null --depfile /dev/null
kiln build p/m.yaml -o a.kiln  # over its own old self
