# kiln report's lightmaps, in real BC textures: their sizes, their order, and how far the encoding may be off.
. "$(dirname "$0")/common.inc"
expect_code 0 kiln report --quick --family 9 -o page --json
python3 - <<'PY'
import json
family = json.load(open("page/report.json"))["families"][0]
assert (family["number"], family["name"]) == (9, "lightmap"), family["name"]
scenes = {s["scene"]: {m["member"]: m for m in s["members"]} for s in family["scenes"]}
texels = 32 * 32
for member, size in (("flat_rgba8", 4), ("sh_rgba16f", 32), ("sh_hq", 4), ("sh_lq", 2.5)):
    assert scenes["floor"][member]["bytes"] == size * texels, (member, scenes["floor"][member]["bytes"])
for scene, members in scenes.items():
    for name, m in members.items():
        assert m["nonfinite"] == 0, (scene, name)
        assert m["relmse"] >= 0.0 and m["rmse"] < 10.0, (scene, name, m["rmse"])
# E over m0 / 4 of the same bands unencoded: half floats, 8 bits, BC7, BC1.
encoding = scenes["encoding"]
assert encoding["sh_rgba16f"]["maxabs"] < 5e-3
for member, bound in (("sh_ratio8", 0.0136), ("sh_bc7_alone", 0.0136), ("sh_bc1_alone", 0.112)):
    assert 1e-4 < encoding[member]["rmse"] <= bound, (member, encoding[member]["rmse"])
for order in ("sh_rgba16f", "sh_hq", "sh_lq", "flat_rgba8"),:
    for better, worse in zip(order, order[1:]):
        assert encoding[better]["relmse"] < encoding[worse]["relmse"], (better, worse)
# A sun at n.l = 1/4 over all normals: two bands, clamped, are 1/8 off, one colour 0.3227.
assert abs(scenes["sunlit"]["sh_rgba16f"]["rmse"] - 0.125) < 1e-3, scenes["sunlit"]["sh_rgba16f"]["rmse"]
assert abs(scenes["sunlit"]["flat_rgba16f"]["rmse"] - 0.32275) < 2e-3, scenes["sunlit"]["flat_rgba16f"]["rmse"]
# A filtered ratio loses what two texels of unlike brightness hold.
assert scenes["contrast"]["sh_ratio16f"]["relmse"] > 1e3 * scenes["contrast"]["sh_rgba16f"]["relmse"]
verdicts = [e["verdict"] for e in family["expectations"]]
assert verdicts.count("confirmed") > 20, verdicts
PY
