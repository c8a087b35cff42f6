# Every verb explains itself with an example, on standard output, with exit code 0.
. "$(dirname "$0")/common.inc"
for verb in count build validate explain preprocess dump diff report cache; do
  expect_code 0 kiln $verb --help
  expect_out "example:"
  expect_out "kiln $verb"
done
expect_code 0 kiln --help
expect_out "exit codes"
expect_code 0 kiln --version
expect_out "glslang"

# Every variable that the sources read is explained, and no other.
expect_code 0 kiln help environment
expect_out "example:"
grep -rhoE '"KILN_[A-Z_]+"' $(ls "$root"/tools/*.cpp | grep -v environment.cpp) "$root"/compiler "$root"/cache/client "$root"/cache/execute --include=*.cpp | tr -d '"' | sort -u >read
grep -oE '^  KILN_[A-Z_]+' out | tr -d ' ' | sort -u >told
diff read told || fail "kiln help environment does not list what is read"
