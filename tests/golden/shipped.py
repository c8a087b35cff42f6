#!/usr/bin/env python3
"""Writes renderer/expected.json, renderer_*/expected.json and library/expected.json: what `kiln count` must say of
manifests/renderer.yaml, of its scenes and of manifests/library.yaml: declared, legal and needed variants by listing (oracle.py),
classes by preprocessing every listed variant (preprocess.py), some of them by glslc as well. Needs PyYAML. With --check it writes
nothing and tells what differs from the files (exit code 4).
"""
import hashlib
import json
import pathlib
import random
import sys
import tempfile

import yaml

import oracle
from preprocess import Preprocessor

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
STAGES = {"vertex": "vert", "fragment": "frag", "compute": "comp"}


ASK_GLSLC = 8  # of each shader's stages' texts

with_glslc = 0


def texts_of(files, preprocessor, file, stage, axes, variants, fixed):
    """Of each variant, the text of a stage as a hash."""
    global with_glslc
    read = preprocessor.words(file)
    known, out = {}, []
    for v in variants:
        macros = tuple(fixed) + tuple((a["macro"], v[n]) for n, a in axes.items()
                                      if a["macro"] in read and (a["values"] != "defined" or v[n] != 0))
        if macros not in known:
            known[macros] = hashlib.sha256("\n".join(preprocessor.tokens(file, macros)).encode()).hexdigest()
        out.append(known[macros])
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        for macros in random.Random(7).sample(sorted(known), min(ASK_GLSLC, len(known))):
            with_glslc += 1
            assert preprocessor.tokens(file, macros) == oracle.tokens_of(folder, file, stage, macros), (file, macros)
    return out


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
    """Whether the file says so already; without --check it does afterwards."""
    file = folder / "expected.json"
    text = json.dumps(document, indent=2) + "\n"
    same = file.exists() and file.read_text() == text
    print(folder.name, document["total"], "" if same or "--check" not in sys.argv else "differs from " + file.name)
    if "--check" not in sys.argv:
        folder.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return same


def golden(of, preprocessor, files):
    """Whether the files of a manifest and its scenes say so already."""
    manifest = yaml.safe_load((ROOT / f"manifests/{of}.yaml").read_text())
    scenes = {p.stem: yaml.safe_load(p.read_text()) for p in sorted((ROOT / "manifests/scenes").glob(of + "_*.yaml"))}
    shaders, in_scene = [], {name: [] for name in scenes}
    for shader in manifest["shaders"]:
        axes = {n: manifest["axes"][n] for n in manifest["axes"] if n in shader["axes"]}
        every = rules_of(manifest) + rules_of(shader)
        variants = list(oracle.legal_variants(axes, [r for r in every if applies(r, axes, manifest["axes"])]))

        texts = {s: texts_of(files, preprocessor, f, STAGES[s], axes, variants, shader.get("defines", {}).items())
                 for s, f in shader["stages"].items()}

        def stages(chosen):
            return [{"stage": s, "classes": str(len({texts[s][i] for i in chosen}))} for s in shader["stages"]]

        counts = {"name": shader["name"], "declared": str(oracle.declared(axes)), "legal": str(len(variants))}
        shaders.append(with_stages({**counts, "needed": str(len(variants))}, stages(range(len(variants)))))
        for name, scene in scenes.items():
            needed = needed_by(scene, shader["name"], axes, variants)
            entry = {**counts, "needed": str(len(needed))}
            in_scene[name].append(with_stages(entry, stages(needed) if needed else []))

    def total(entries):
        sums = {k: str(sum(int(s[k]) for s in entries)) for k in ("declared", "legal", "needed")}
        sums["classes"] = str(sum(int(t["classes"]) for s in entries for t in s.get("stages", [])))
        return sums

    same = write(HERE / of, {"manifest": f"../../../manifests/{of}.yaml", "shaders": shaders, "total": total(shaders)})
    for name, entries in in_scene.items():
        same &= write(HERE / name, {"manifest": f"../../../manifests/{of}.yaml", "scenes": [f"../../../manifests/scenes/{name}.yaml"],
                                    "shaders": entries, "total": total(entries)})
    return same


def main():
    files = {str(p.relative_to(ROOT / "uber")): p.read_text() for pattern in ("*.glsl", "*.vert", "*.frag", "*.comp", "lib/*.glsl")
             for p in (ROOT / "uber").glob(pattern)}
    preprocessor = Preprocessor(files)
    same = all([golden(of, preprocessor, files) for of in ("renderer", "library")])
    print(f"{with_glslc} texts preprocessed by glslc as well")
    return 4 if "--check" in sys.argv and not same else 0


if __name__ == "__main__":
    sys.exit(main())
