#!/usr/bin/env bash
# fuzz.sh BUILD SECONDS: runs every libFuzzer target of a fuzz build from its seed corpus for so many seconds. New inputs stay
# in the build folder; a crash ends with a non-zero exit and the input's path.
set -euo pipefail
build=${1:?usage: fuzz.sh BUILD SECONDS}
seconds=${2:?usage: fuzz.sh BUILD SECONDS}
root=$(cd "$(dirname "$0")/.." && pwd)
for fuzzer in "$build"/bin/fuzz_*; do
  name=$(basename "$fuzzer")
  name=${name#fuzz_}
  mkdir -p "$build/corpus/$name"
  echo "fuzz: $name for $seconds s"
  "$fuzzer" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -print_final_stats=0 -verbosity=0 \
    -artifact_prefix="$build/corpus/$name-" "$build/corpus/$name" "$root/tests/fuzz/corpus/$name"
done
