#!/usr/bin/env bash
# Installs what is missing, builds kiln, compiles manifests/surface.yaml into a table, runs every variant of it on lavapipe and
# renders some of them. Results go to demo-out/.
set -euo pipefail
cd "$(dirname "$0")/.."
started=$SECONDS
say() { printf '\n== %s (%d s)\n' "$1" $((SECONDS - started)); }

say "packages"
tools/setup.sh
export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1  # checkouts share what they compile
started=$SECONDS

say "building kiln"
mkdir -p demo-out
cmake --preset release -DKILN_TESTS=OFF >demo-out/configure.log
cmake --build --preset release
kiln=build/release/bin/kiln
out=demo-out

say "what the axes cost"
"$kiln" count manifests/surface.yaml --classes

say "from a manifest to a table"
"$kiln" build manifests/surface.yaml -o "$out/surface.kiln" --parse-back --header "$out/surface_key.h" --report-json "$out/build.json"
"$kiln" build manifests/surface.yaml -o "$out/surface.kiln" --report-json "$out/build.json"

say "why one variant is what it is"
"$kiln" explain manifests/surface.yaml light=spot pass=forward material=pbr_mr lightmap=none two_sided=false shadow=hard
"$kiln" explain manifests/surface.yaml light=spot pass=depth

say "every variant on lavapipe"
"$kiln" validate "$out/surface.kiln" --report "$out"

say "a picture of some"
"$kiln" sheet "$out/surface.kiln" -o "$out/surface.png"

say "done"
echo "table    $out/surface.kiln"
echo "verdicts $out/validate.txt"
echo "picture  $out/surface.png"
