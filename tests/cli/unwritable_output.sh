# A table that cannot be published is the environment's fault, and leaves nothing.
. "$(dirname "$0")/common.inc"
small_project
expect_code 3 kiln build p/m.yaml -o p/m.yaml/x.kiln
mkdir taken.kiln
expect_code 3 kiln build p/m.yaml -o taken.kiln
ln -s /dev/full full.kiln
expect_code 3 kiln build p/m.yaml -o full.kiln
[ -z "$(find . -name '*.tmp.*')" ] || fail "a temporary file was left"
