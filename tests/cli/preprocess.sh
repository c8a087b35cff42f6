# The class's text; axes that do not matter may be left out, those that do must be given.
. "$(dirname "$0")/common.inc"
small_project
kiln preprocess p/m.yaml tint=red bright=false >a.txt
grep -q '#version 450' a.txt
grep -q 'vec3 ( 1.0 , 0.2 , 0.2 )' a.txt
! grep -qE '^#(if|else|endif|define|include)' a.txt
expect_code 2 kiln preprocess p/m.yaml tint=red
expect_err bright
expect_code 1 kiln preprocess p/m.yaml tint=none bright=true
glslangValidator -S frag a.txt >/dev/null
# Only what still tells classes apart is asked for: the rules fix `bright`, and nothing reads `idle`.
sed -i 's/^rules:/  dim: {macro: DIM, values: bool}\n  idle: {macro: IDLE, values: bool}\nrules:\n  - forbid: tint == blue \&\& !bright/' p/m.yaml
sed -i 's/^#if BRIGHT/#if DIM\n    c *= 0.5;\n#endif\n#if BRIGHT/' p/paint.frag
expect_code 2 kiln preprocess p/m.yaml tint=blue
grep -q "say more of: dim$" err || { cat err; fail "asked for an axis that tells nothing apart"; }
