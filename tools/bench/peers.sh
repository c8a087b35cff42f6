#!/usr/bin/env bash
# Measures kiln against what a user has today, on the same sources and variants in one run, and prints one JSON document of
# CPU seconds, ratios, memory and lookup times. Builds the release preset first. Arguments go to tools/bench/peers.py.
set -euo pipefail
cd "$(dirname "$0")/../.."
tools/setup.sh --bench >&2
export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1  # checkouts share what they compile
cmake --preset release -DKILN_BENCH=ON >/dev/null
cmake --build --preset release >&2
exec python3 tools/bench/peers.py build/release "$@"
