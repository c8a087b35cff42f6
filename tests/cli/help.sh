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
