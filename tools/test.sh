#!/usr/bin/env bash
# Installs what is missing, builds kiln and passes its tests. --full adds the long suites: the sanitizer builds, fuzzing from
# the seed corpora, clang-format and clang-tidy.
set -euo pipefail
cd "$(dirname "$0")/.."

full=no
for argument in "$@"; do
  case "$argument" in
    --full) full=yes ;;
    --help) echo "usage: tools/test.sh [--full]"; exit 0 ;;
    *) echo "test.sh: unknown argument '$argument'" >&2; exit 2 ;;
  esac
done

tools/setup.sh
export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1  # checkouts share what they compile
python3 tools/layers.py

# build PRESET [TARGET]
build() {
  cmake --preset "$1" >"build-$1.log" 2>&1 || { cat "build-$1.log"; exit 1; }
  rm -f "build-$1.log"
  cmake --build --preset "$1" ${2:+--target "$2"}
}

if [ "$full" = yes ]; then
  export KILN_PEERS_BAZEL=yes
  export KILN_KILL_ROUNDS=200  # of processes killed in the middle of their work with a store
  git ls-files '*.cpp' '*.h' '*.hpp' | xargs clang-format --dry-run --Werror
  build tsan unit_tests
  ctest --preset tsan -L 'unit' -LE device -j "$(nproc)"
  build fuzz
  tools/fuzz.sh build/fuzz 60
fi

# The sanitizer build runs the unit tests and the fuzz corpora; device tests run without it, since the driver's JIT is not
# instrumented.
build asan unit_tests
[ "$full" = yes ] || export KILN_ROUNDS=200  # of random shaders against glslang's preprocessor; all of them run in the dev build
ctest --preset asan -L 'unit|fuzz' -j "$(nproc)"
unset KILN_ROUNDS

build dev
if [ "$full" = yes ]; then
  # What this build compiles, without what it generates.
  python3 -c 'import json; print(*sorted({unit["file"] for unit in json.load(open("build/dev/compile_commands.json"))}), sep="\n")' |
    grep -E "^$PWD/(compiler|cache|tools)/" | xargs -P "$(nproc)" -n 4 clang-tidy -p build/dev --quiet
fi
long=()
[ "$full" = no ] || long=(-C full)
ctest --preset dev "${long[@]}" -j "$(nproc)"
