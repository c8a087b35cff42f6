#!/usr/bin/env python3
"""Writes renderer/expected.json and renderer_*/expected.json: what `kiln count` must say of manifests/renderer.yaml and of its
scenes: declared, legal and needed variants by listing (oracle.py). With --classes every text is preprocessed by glslc as well,
which takes half an hour. Needs PyYAML, which the tests themselves do not.
"""
import json
import pathlib
import sys

import yaml

import oracle

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
STAGES = {"vertex": "vert", "fragment": "frag", "compute": "comp"}


seen = {}
preprocess = oracle.tokens_of


def remembered(folder, file, stage, macros):
    """Scenes ask for texts that the whole manifest has asked for; the files are the same in every folder."""
    key = (file, stage, tuple(macros))
    if key not in seen:
        seen[key] = preprocess(folder, file, stage, macros)
    return seen[key]


oracle.tokens_of = remembered


def rules_of(block):
    return [(kind, r[kind]) for r in block.get("rules", []) for kind in ("forbid", "require") if kind in r]


def applies(rule, axes, every_axis):
    return all(t in axes for t in oracle.TOKEN.findall(rule[1]) if t in every_axis)


def number_of(axis, name):
    return oracle.numbers(axis)[str(name).lower() if isinstance(name, bool) else str(name)]


def needed_by(scene, shader, axes, variants):
    """Indices of the variants that some object of the scene may draw."""
    out = set()
    for drawn in scene["objects"]:
        if drawn["shader"] != shader:
            continue
        facts = {k: v for k, v in {**scene.get("all", {}), **drawn}.items() if k in axes}
        allowed = {k: {number_of(axes[k], n) for n in (v["in"] if isinstance(v, dict) else [v])} for k, v in facts.items()}
        out |= {i for i, v in enumerate(variants) if all(v[k] in n for k, n in allowed.items())}
    return out


def with_stages(entry, stages):
    return {**entry, "stages": stages} if stages else entry


def write(folder, document):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "expected.json").write_text(json.dumps(document, indent=2) + "\n")
    print(folder.name, document["total"])


def main():
    manifest = yaml.safe_load((ROOT / "manifests/renderer.yaml").read_text())
    scenes = {p.stem: yaml.safe_load(p.read_text()) for p in sorted((ROOT / "manifests/scenes").glob("renderer_*.yaml"))}
    files = {str(p.relative_to(ROOT / "uber")): p.read_text() for pattern in ("*.glsl", "*.vert", "*.frag", "*.comp", "lib/*.glsl")
             for p in (ROOT / "uber").glob(pattern)}
    shaders, in_scene = [], {name: [] for name in scenes}
    for shader in manifest["shaders"]:
        axes = {n: manifest["axes"][n] for n in manifest["axes"] if n in shader["axes"]}
        every = rules_of(manifest) + rules_of(shader)
        variants = list(oracle.legal_variants(axes, [r for r in every if applies(r, axes, manifest["axes"])]))

        def stages(chosen):
            if "--classes" not in sys.argv:
                return []
            return [{"stage": s, "classes": str(oracle.classes(files, f, STAGES[s], axes, chosen, shader.get("defines", {}).items()))}
                    for s, f in shader["stages"].items()]

        counts = {"name": shader["name"], "declared": str(oracle.declared(axes)), "legal": str(len(variants))}
        shaders.append(with_stages({**counts, "needed": str(len(variants))}, stages(variants)))
        for name, scene in scenes.items():
            needed = needed_by(scene, shader["name"], axes, variants)
            chosen = [variants[i] for i in sorted(needed)]
            entry = {**counts, "needed": str(len(needed))}
            in_scene[name].append(with_stages(entry, stages(chosen) if chosen else []))

    def total(entries):
        sums = {k: str(sum(int(s[k]) for s in entries)) for k in ("declared", "legal", "needed")}
        if "--classes" in sys.argv:
            sums["classes"] = str(sum(int(t["classes"]) for s in entries for t in s.get("stages", [])))
        return sums

    write(HERE / "renderer", {"manifest": "../../../manifests/renderer.yaml", "shaders": shaders, "total": total(shaders)})
    for name, entries in in_scene.items():
        write(HERE / name, {"manifest": "../../../manifests/renderer.yaml", "scenes": [f"../../../manifests/scenes/{name}.yaml"],
                            "shaders": entries, "total": total(entries)})


if __name__ == "__main__":
    main()
