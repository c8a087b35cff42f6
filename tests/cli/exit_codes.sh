# 1 input, 2 usage, 3 environment; every message names what to mend.
. "$(dirname "$0")/common.inc"
small_project
expect_code 2 kiln
expect_code 2 kiln biuld p/m.yaml
expect_err "did you mean 'build'"
expect_code 2 kiln build p/m.yaml
expect_code 2 kiln build p/m.yaml -o x.kiln --targt spirv
expect_err "did you mean '--target'"
expect_code 2 kiln count p/m.yaml p/m.yaml
expect_code 1 kiln count missing.yaml
expect_err missing.yaml
expect_code 1 kiln build p/m.yaml -o x.kiln --target spriv
expect_err "did you mean 'spirv'"
sed -i 's/tint == none/tnit == none/' p/m.yaml
expect_code 1 kiln count p/m.yaml
expect_err "p/m.yaml:9:13"
expect_err "did you mean 'tint'"
[ ! -e x.kiln ]
