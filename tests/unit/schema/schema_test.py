#!/usr/bin/env python3
"""Checks the JSON Schemas: every manifest and scene we ship passes, every bad example fails.

Usage: schema_test.py ROOT [KILN_CHECK]
YAML is read as kiln reads it: only true and false are booleans, integers are decimal or 0x, null and ~ are empty.
With KILN_CHECK (a program that exits 1 for a manifest that kiln refuses) the good examples are held against it as well.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema
import yaml


class Loader(yaml.SafeLoader):
    yaml_implicit_resolvers = {}


Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|false)$"), list("tf"))
Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"^-?(?:0|[1-9][0-9]*|0x[0-9a-fA-F]+)$"), list("-0123456789"))
Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^-?[0-9]+\.[0-9]+$"), list("-0123456789"))
Loader.add_implicit_resolver("tag:yaml.org,2002:null", re.compile(r"^(?:~|null|Null|NULL|)$"), ["~", "n", "N", ""])

SHADERS = "shaders: [{name: s, stages: {fragment: f}}]\n"
GOOD_MANIFESTS = [
    "kiln: 1\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: [yes, no, on, off]}, b: {macro: B, values: [-1, 0x10]}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: {x: 0, y: -4}}, b: {macro: B, values: bool}, c: {macro: C, values: defined}}\n" + SHADERS,
    "kiln: 1\ntargets: []\ninclude: []\nrules: []\noptions: {vulkan: 1.2, spirv: \"1.5\", debug: true}\n" + SHADERS,
    "kiln: 1\nrules: [{forbid: 1 == 2}, {require: \"1\", because: why}]\n" + SHADERS,
    "kiln: 1\nshaders: [{name: s, stages: {compute: c}, axes: [], rules: [], defines: {N: 4, M: \"\", B: true}, options: {optimise: none}}]\n",
    "kiln: 1\nshaders: [{name: s, stages: {vertex: v, tess_control: c, tess_evaluation: e}}]\n",
]
BAD_MANIFESTS = [
    "kiln: 2\n" + SHADERS,
    "kiln: 1\n",
    "kiln: 1\nshaders: []\n",
    "kiln: 1\ntarget: [spirv]\n" + SHADERS,
    "kiln: 1\ntargets: [glsl45]\n" + SHADERS,
    "kiln: 1\ntargets: [spirv, spirv]\n" + SHADERS,
    "kiln: 1\ninclude: uber\n" + SHADERS,
    "kiln: 1\noptions: {vulkan: 1.4}\n" + SHADERS,
    "kiln: 1\noptions: {debug: yes}\n" + SHADERS,
    "kiln: 1\naxes: {in: {macro: A, values: bool}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: GL_A, values: bool}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A__B, values: bool}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: boolean}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: []}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: [true, false]}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: [x, null]}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: [x, 1]}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: [x, x]}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: [2147483648]}}\n" + SHADERS,
    "kiln: 1\naxes: {a: {macro: A, values: {ggx: D_GGX}}}\n" + SHADERS,
    "kiln: 1\nrules: [{forbid: a, require: b}]\n" + SHADERS,
    "kiln: 1\nrules: [{because: a}]\n" + SHADERS,
    "kiln: 1\nrules: [{forbid: [a]}]\n" + SHADERS,
    "kiln: 1\nshaders: [{name: s}]\n",
    "kiln: 1\nshaders: [{stages: {vertex: v}}]\n",
    "kiln: 1\nshaders: [{name: a b, stages: {vertex: v}}]\n",
    "kiln: 1\nshaders: [{name: s, stages: {pixel: v}}]\n",
    "kiln: 1\nshaders: [{name: s, stages: {}}]\n",
    "kiln: 1\nshaders: [{name: s, stages: {task: t}}]\n",
    "kiln: 1\nshaders: [{name: s, stages: {vertex: v}, defines: {N: }}]\n",
    "kiln: 1\nshaders: [{name: s, stages: {vertex: v}, defines: {defined: 1}}]\n",
]
GOOD_SCENES = [
    "kiln_scene: 1\nobjects: []\n",
    "kiln_scene: 1\nname: x\nall: {a: b, c: {in: [d, 1, true]}}\nobjects: [{shader: s, a: false, b: 4}]\n",
]
BAD_SCENES = [
    "kiln_scene: 1\n",
    "kiln: 1\nobjects: []\n",
    "kiln_scene: 1\nobjects: [{a: b}]\n",
    "kiln_scene: 1\nobjects: [s]\n",
    "kiln_scene: 1\nobjects: [{shader: s, a: [b]}]\n",
    "kiln_scene: 1\nobjects: [{shader: s, a: {in: []}}]\n",
    "kiln_scene: 1\nobjects: [{shader: s, a: {on: [b]}}]\n",
    "kiln_scene: 1\nobjects: [{shader: s, a: ~}]\n",
    "kiln_scene: 1\nall: [a]\nobjects: []\n",
]


def main():
    root = pathlib.Path(sys.argv[1])
    checker = sys.argv[2] if len(sys.argv) > 2 else None
    failures = 0
    checked = 0

    def fail(why):
        nonlocal failures
        failures += 1
        print("FAILED:", why)

    def refused(text):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            return subprocess.run([checker, file.name], capture_output=True).returncode != 0

    def accepts(validator, text):
        return next(validator.iter_errors(yaml.load(text, Loader)), None)

    schemas = {}
    for kind in ("manifest", "scene"):
        schema = json.loads((root / "manifests" / f"{kind}.schema.json").read_text())
        jsonschema.Draft7Validator.check_schema(schema)
        schemas[kind] = jsonschema.Draft7Validator(schema)

    shipped = sorted((root / "manifests").rglob("*.yaml"))
    if not shipped:
        fail("no manifests found")
    for path in shipped:
        text = path.read_text(encoding="utf-8")
        kind = "scene" if re.search(r"^kiln_scene:", text, re.M) else "manifest"
        error = accepts(schemas[kind], text)
        checked += 1
        if error is not None:
            fail(f"{path}: {error.message}")
        if checker and subprocess.run([checker, str(path)], capture_output=True).returncode != 0:
            fail(f"the compiler refuses {path}")

    for kind, good, bad in (("manifest", GOOD_MANIFESTS, BAD_MANIFESTS), ("scene", GOOD_SCENES, BAD_SCENES)):
        for text in good:
            error = accepts(schemas[kind], text)
            checked += 1
            if error is not None:
                fail(f"refused: {text}{error.message}")
            if checker and refused(text):
                fail(f"the compiler refuses: {text}")
        for text in bad:
            checked += 1
            if accepts(schemas[kind], text) is None:
                fail(f"accepted: {text}")
            if checker and not refused(text):
                fail(f"the compiler accepts: {text}")
    print(checked, "documents")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
