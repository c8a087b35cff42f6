# The depfile lists every file read, once, with its target.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln --depfile a.d >/dev/null
grep -q '^a.kiln:' a.d
for file in p/m.yaml p/paint.frag p/lib/tint.glsl; do
  [ "$(grep -cE "^ *$file( |$|\\\\)" a.d)" = 1 ] || { cat a.d; fail "$file is not listed once"; }
done
kiln build p/m.yaml -o a.kiln --depfile b.d >/dev/null
cmp a.d b.d
