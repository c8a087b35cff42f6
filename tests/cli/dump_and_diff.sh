# What a table holds, a variant's texts, and what an edit changed, counted exactly.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln >/dev/null
kiln dump a.kiln --json >d.json
expect_json d.json 'd["shaders"][0]["needed"]' 5
kiln dump a.kiln tint=red bright=true --target glsl450 --stage fragment >a.frag
glslangValidator -S frag a.frag >/dev/null
kiln dump a.kiln tint=red bright=true --target spirv >a.spvasm
grep -q OpEntryPoint a.spvasm
expect_code 1 kiln dump a.kiln tint=red --target glsl450
expect_code 1 kiln dump a.kiln tint=rde
expect_err "did you mean 'red'"
expect_code 1 kiln dump a.kiln tint=none bright=true --target glsl450
kiln diff a.kiln a.kiln --json >same.json
expect_json same.json 'd["same"]' True
sed -i 's/0.2, 0.2, 1.0/0.2, 0.3, 1.0/' p/lib/tint.glsl
sed -i 's/  - forbid: tint == none \&\& bright/  - forbid: tint == none/' p/m.yaml
kiln build p/m.yaml -o b.kiln >/dev/null 2>&1
kiln diff a.kiln b.kiln --json >diff.json
expect_json diff.json '[d["shaders"][0][k] for k in ("added","lost","changed")]' "['0', '1', '2']"
expect_json diff.json 'd["shaders"][0]["lost_when"].split(": ")[1]' "exactly when tint == none"
