# kiln is installed into an empty prefix and used by a project outside: tools/examples/cmake, in a folder with a space, by
# Ninja and by make. The table is built again after a change to what it is made of, and after nothing else.
. "$(dirname "$0")/common.inc"
build=$(cd "$(dirname "$KILN")/.." && pwd)
[ -f "$build/cmake_install.cmake" ] || fail "$KILN is not in a build folder"
cmake --install "$build" --prefix "$t/prefix" >/dev/null
prefix=$t/prefix
"$prefix/bin/kiln" count "$prefix/share/kiln/manifests/sky_light.yaml" >/dev/null

# expect_tables N: builds; N tables were made.
expect_tables() {
  cmake --build built >log 2>&1 || { cat log; fail "build: $1"; }
  local got
  got=$(grep -c 'Building variant table' log || true)
  [ "$got" = "$1" ] || { cat log; fail "$got tables were built, not $1, after: $2"; }
}

for generator in Ninja 'Unix Makefiles'; do
  rm -rf built 'a game'
  cp -r "$root/tools/examples/cmake" 'a game'
  cmake -S 'a game' -B built -G "$generator" -DCMAKE_PREFIX_PATH="$prefix" >log 2>&1 || { cat log; fail configure; }
  expect_tables 1 'a fresh checkout'
  built/game built/paint.kiln stripes >answer
  grep -q '^module [0-9]*, [0-9]* words' answer
  expect_code 1 built/game built/paint.kiln
  grep -q 'striped=false' "$t/out" || { cat "$t/out"; fail 'the miss does not name what was asked'; }

  expect_tables 0 nothing
  sleep 1.1   # make compares time stamps
  touch 'a game/shaders/lib/stripes.glsl'
  expect_tables 1 'an include was touched'
  expect_tables 0 nothing
  touch 'a game/shaders/lib/unrelated.glsl' 'a game/main.cpp'
  expect_tables 0 'unrelated files were touched'
  touch 'a game/shaders/level.yaml'
  expect_tables 1 'the scene was touched'
  touch "$prefix/bin/kiln"
  expect_tables 1 'kiln was replaced'
  rm built/paint.kiln
  expect_tables 1 'the table was removed'

  # A new include is followed from then on.
  echo 'const float stripe_count = 8.0;' >'a game/shaders/lib/count.glsl'
  sed -i '1i #include "count.glsl"' 'a game/shaders/lib/stripes.glsl'
  expect_tables 1 'an include was added'
  sleep 1.1
  echo 'const float stripe_count = 9.0;' >'a game/shaders/lib/count.glsl'
  expect_tables 1 'the new include was changed'

  # A mistake fails the build and keeps the table; the mended file builds again.
  cp built/paint.kiln before.kiln
  cp 'a game/shaders/paint.frag' good.frag
  sed -i 's/vec3 c = /vec3 c = undeclared + /' 'a game/shaders/paint.frag'
  ! cmake --build built >log 2>&1 || fail 'a shader with a mistake built'
  grep -q 'paint.frag:8:.*undeclared' log || { cat log; fail 'the mistake is not named'; }
  cmp built/paint.kiln before.kiln
  sleep 1.1
  cp good.frag 'a game/shaders/paint.frag'
  expect_tables 1 'the mistake was mended'
  expect_tables 0 nothing
done

# A slip in the call is named when the project is configured.
sed -i 's/  OUTPUT paint.kiln/  OUTPT paint.kiln/' 'a game/CMakeLists.txt'
! cmake -S 'a game' -B slip -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >log 2>&1 || fail 'a misspelt argument was accepted'
grep -q 'kiln_add_table: unknown argument' log || { cat log; fail 'the slip is not named'; }
