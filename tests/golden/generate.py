#!/usr/bin/env python3
"""Writes the count cases beside it: <case>/manifest.yaml, its shaders, and expected.json.

Small spaces are listed and preprocessed variant by variant (oracle.py). Spaces too large for that have a closed form, which
is first checked against the list on a small member of the same family; their classes come from the axes that the shader reads.
Arguments: the functions of the cases to write; default all.
"""
import json
import pathlib
import sys

import oracle

HERE = pathlib.Path(__file__).resolve().parent


def yaml_values(axis):
    values = axis["values"]
    if isinstance(values, str):
        return values
    if isinstance(values, dict):
        return "{" + ", ".join(f"{k}: {v}" for k, v in values.items()) + "}"
    return "[" + ", ".join(map(str, values)) + "]"


def manifest(case):
    lines = ["kiln: 1", f"name: {case['name']}"]
    if "include" in case:
        lines.append(f"include: [{', '.join(case['include'])}]")
    lines.append("axes:")
    lines += [f"  {n}: {{macro: {a['macro']}, values: {yaml_values(a)}}}" for n, a in case["axes"].items()]

    def rules(items, indent):
        return [f'{indent}rules:'] + [f'{indent}  - {kind}: "{text}"' for kind, text in items] if items else []

    lines += rules(case.get("rules", []), "")
    lines.append("shaders:")
    for shader in case["shaders"]:
        lines.append(f"  - name: {shader['name']}")
        lines.append(f"    stages: {{{', '.join(f'{s}: {f}' for s, f in shader['stages'].items())}}}")
        if "axes" in shader:
            lines.append(f"    axes: [{', '.join(shader['axes'])}]")
        lines += rules(shader.get("rules", []), "    ")
        if "defines" in shader:
            lines.append(f"    defines: {{{', '.join(f'{k}: {v}' for k, v in shader['defines'].items())}}}")
    return "\n".join(lines) + "\n"


def count_by_listing(case):
    """Every shader of the case, listed and preprocessed."""
    shaders = []
    for shader in case["shaders"]:
        axes = {n: case["axes"][n] for n in case["axes"] if n in shader.get("axes", case["axes"])}
        every = case.get("rules", []) + shader.get("rules", [])
        rules = [r for r in every if all(t in axes for t in case["axes"] if t in oracle.TOKEN.findall(r[1]))]
        variants = list(oracle.legal_variants(axes, rules))
        stages = {s: oracle.classes(case["files"], f, {"vertex": "vert", "fragment": "frag", "compute": "comp"}[s], axes, variants,
                                    shader.get("defines", {}).items()) for s, f in shader["stages"].items()}
        shaders.append({"name": shader["name"], "declared": oracle.declared(axes), "legal": len(variants), "stages": stages})
    return shaders


def write(case, shaders):
    folder = HERE / case["name"]
    folder.mkdir(exist_ok=True)
    (folder / "manifest.yaml").write_text(manifest(case))
    for name, text in case["files"].items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    total = {
        "declared": str(sum(s["declared"] for s in shaders)),
        "legal": str(sum(s["legal"] for s in shaders)),
        "classes": str(sum(sum(s["stages"].values()) for s in shaders)),
    }
    document = {
        "shaders": [
            {"name": s["name"], "declared": str(s["declared"]), "legal": str(s["legal"]),
             "stages": [{"stage": k, "classes": str(v)} for k, v in s["stages"].items()]} for s in shaders
        ],
        "total": total,
    }
    (folder / "expected.json").write_text(json.dumps(document, indent=2) + "\n")
    print(f"{case['name']}: {total}")


def flags(names):
    return {n: {"macro": n.upper(), "values": "bool"} for n in names}


def fragment(body, head=""):
    return f"#version 450\n{head}layout(location = 0) out vec4 color;\nvoid main() {{\n    color = vec4(0.0);\n{body}}}\n"


def read_flags(names):
    return "".join(f"#if {n.upper()}\n    color.x += {i}.5;\n#endif\n" for i, n in enumerate(names))


def one_shader(name, axes, rules, files, **extra):
    return {"name": name, "axes": axes, "rules": rules, "files": files,
            "shaders": [{"name": name, "stages": {"fragment": "main.frag"}}], **extra}


# ---- families with a closed form: build(n) and the expected legal count and fragment classes for n ----

def chain(n):
    names = [f"f{i}" for i in range(n)]
    rules = [("require", f"{a} -> {b}") for a, b in zip(names, names[1:])]
    read = [names[0], names[n // 2], names[-1]]
    return one_shader("chain_of_implications", flags(names), rules, {"main.frag": fragment(read_flags(read))})


def no_neighbours(n):
    names = [f"f{i}" for i in range(n)]
    rules = [("forbid", f"{a} && {b}") for a, b in zip(names, names[1:])]
    return one_shader("no_two_neighbours", flags(names), rules, {"main.frag": fragment(read_flags(names[:2] + names[-2:]))})


def fibonacci(n):
    a, b = 0, 1
    for _ in range(n):
        a, b = b, a + b
    return a


def paired(n):
    names = [f"a{i}" for i in range(n)] + [f"b{i}" for i in range(n)]
    rules = [("require", f"a{i} == b{i}") for i in range(n)]
    return one_shader("paired_axes", flags(names), rules, {"main.frag": fragment(read_flags(["a0", f"b{n - 1}", "b0"]))})


def derived(n):
    names = [f"f{i}" for i in range(n)]
    header = "".join(f"#if F{i} && F{(i + 1) % n}\n#define DERIVED{i} 1\n#else\n#define DERIVED{i} 0\n#endif\n" for i in range(n))
    body = "#if DERIVED0\n    color.x = 1.0;\n#endif\n#if DERIVED2\n    color.y = 1.0;\n#endif\n"
    return one_shader("derived_flags", flags(names), [],
                      {"main.frag": fragment(body, '#include "common.glsl"\n'), "common.glsl": header})


def three_ids(n):
    axes = {a: {"macro": a.upper(), "values": list(range(max(0, 8 - n), max(8, n)))} for a in ("material_id", "light_id", "decal_id")}
    body = "".join(f"#if {a.upper()} == 7\n    color.{c} = 1.0;\n#endif\n" for a, c in zip(axes, "xyz"))
    return one_shader("wide_axes_asked_once", axes, [], {"main.frag": fragment(body)})


def at_most_one(n):
    names = [f"f{i}" for i in range(n)]
    rules = [("forbid", f"{names[i]} && {names[j]}") for i in range(n) for j in range(i)]
    return one_shader("at_most_one", flags(names), rules, {"main.frag": fragment(read_flags(names[:4]))})


def independent(n):
    names = [f"f{i}" for i in range(n)]
    return one_shader("two_hundred_flags", flags(names), [], {"main.frag": fragment(read_flags(names[:3]))})


def engine(n):
    """2^n * 3^4 * 5; n = 26 makes 27,179,089,920."""
    axes = {"quality": {"macro": "QUALITY", "values": ["low", "medium", "high", "epic", "cinematic"]}}
    axes |= {f"mode{i}": {"macro": f"MODE{i}", "values": ["off", "fast", "full"]} for i in range(4)}
    axes |= flags([f"f{i}" for i in range(n)])
    body = "    color.x = float(QUALITY);\n#if MODE1 == 2\n    color.y = 1.0;\n#endif\n" + read_flags(["f0"])
    return one_shader("engine_switches", axes, [], {"main.frag": fragment(body)})


FAMILIES = [
    # build, full size, small size, legal(n), classes(n)
    (chain, 60, 8, lambda n: n + 1, lambda n: 4),  # three flags of a chain: 000 001 011 111
    (no_neighbours, 60, 8, lambda n: fibonacci(n + 2), lambda n: 9),  # each end pair: 00 01 10
    (paired, 32, 4, lambda n: 2**n, lambda n: 4),  # a0 and b0 are equal
    (derived, 40, 6, lambda n: 2**n, lambda n: 4),
    (three_ids, 64, 3, lambda n: n**3, lambda n: 8),
    (at_most_one, 40, 5, lambda n: n + 1, lambda n: 5),
    (independent, 200, 4, lambda n: 2**n, lambda n: 8),
    (engine, 26, 1, lambda n: 2**n * 81 * 5, lambda n: 5 * 2 * 2),
]


# ---- cases that are small enough to list ----

def operators():
    axes = {
        "light": {"macro": "LIGHT_TYPE", "values": ["none", "directional", "point", "spot"]},
        "cascades": {"macro": "CASCADES", "values": [1, 2, 4]},
        "lightmap": {"macro": "LIGHTMAP", "values": {"off": 0, "flat": 1, "sh_lq": 2, "sh_hq": 4}},
        "two_sided": {"macro": "TWO_SIDED", "values": "bool"},
        "skinned": {"macro": "SKINNED", "values": "defined"},
        "bias": {"macro": "BIAS", "values": [-2, -1, 0, 0x10]},
    }
    rules = [
        ("forbid", "light == none && lightmap == off"),
        ("require", "light != directional -> cascades == 1"),
        ("require", "cascades > 1 -> lightmap in {off, sh_hq} -> bias >= -1"),
        ("forbid", "skinned && !(lightmap == off) || not two_sided && bias < -1"),
        ("require", "light in {none, point, spot} || two_sided || bias == 0x10"),
    ]
    body = """#if LIGHT_TYPE != 0 && CASCADES > 1
    color.x = float(CASCADES);
#elif LIGHT_TYPE
    color.x = -1.0;
#endif
#ifdef SKINNED
    color.y = 1.0;
#endif
#if SKINNED + TWO_SIDED == 2
    color.z = 1.0;
#endif
#if (LIGHTMAP & 6) != 0
    color.w = float(LIGHTMAP / 2);
#endif
#if BIAS < 0 || BIAS << 1 == 32
    color.z += 0.5;
#endif
"""
    return one_shader("every_operator", axes, rules, {"main.frag": fragment(body)})


def shaders_and_rules():
    axes = {
        "pass": {"macro": "PASS", "values": ["color", "depth"]},
        "fog": {"macro": "FOG", "values": "bool"},
        "grass": {"macro": "GRASS", "values": "bool"},
        "taps": {"macro": "TAPS", "values": [1, 5, 9]},
    }
    return {
        "name": "several_shaders", "axes": axes,
        "rules": [("forbid", "pass == depth && fog"), ("require", "grass -> taps <= 5")],
        "files": {
            "mesh.vert": "#version 450\nlayout(location = 0) in vec3 p;\nvoid main() {\n    gl_Position = vec4(p, 1.0);\n"
                         "#if GRASS\n    gl_Position.x += 0.1;\n#endif\n}\n",
            "mesh.frag": fragment("#if PASS == 0\n    color.x = 1.0;\n#if FOG\n    color.y = 1.0;\n#endif\n#endif\n"),
            "blur.comp": "#version 450\nlayout(local_size_x = 64) in;\nlayout(std430, binding = 0) buffer B { float b[]; };\n"
                         "void main() {\n    for (int i = 0; i < TAPS * SCALE; ++i) b[i] = 0.0;\n}\n",
        },
        "shaders": [
            {"name": "mesh", "stages": {"vertex": "mesh.vert", "fragment": "mesh.frag"}, "axes": ["pass", "fog", "grass"],
             "rules": [("forbid", "grass && fog")]},
            {"name": "blur", "stages": {"compute": "blur.comp"}, "axes": ["grass", "taps"], "defines": {"SCALE": 2}},
        ],
    }


def joins():
    """Macros whose bodies differ by axis: some are read, some not, one is undefined again."""
    axes = flags(["a", "b", "c", "d"])
    head = """#if A
#define WIDTH 4
#else
#define WIDTH 8
#endif
#if B
#define UNREAD 1
#endif
#if C
#define PICK(x) (x)
#else
#define PICK(x) (x)
#endif
#if D
#define TEMPORARY 1
#endif
#undef TEMPORARY
"""
    body = """    color.x = float(WIDTH);
    color.y = PICK(2.0);
#ifdef TEMPORARY
    color.z = 1.0;
#endif
#if WIDTH == 4 && defined(UNREAD)
    color.w = 1.0;
#endif
"""
    return one_shader("differences_that_join", axes, [], {"main.frag": fragment(body, head)})


def blank_differences():
    """Comments, blanks and line breaks that hang on axes make no class."""
    body = """#if A
    color.x = 1.0; // with a comment
#else
    /* without */ color.x
        =   1.0;
#endif
#if B

#endif
"""
    return one_shader("blank_differences", flags(["a", "b"]), [], {"main.frag": fragment(body)})


def guarded_default():
    axes = {"light": {"macro": "LIGHT_TYPE", "values": [0, 1, 2]}, "tint": {"macro": "TINT", "values": "defined"}}
    head = "#ifndef LIGHT_TYPE\n#define LIGHT_TYPE 0\n#endif\n#ifndef TINT\n#define TINT 3\n#endif\n"
    body = "#if LIGHT_TYPE > 0\n    color.x = 1.0;\n#endif\n    color.y = float(TINT);\n"
    return one_shader("guarded_defaults", axes, [], {"main.frag": fragment(body, head)})


SMALL = [operators, shaders_and_rules, joins, blank_differences, guarded_default]


def main(wanted):
    for build in SMALL:
        if wanted and build.__name__ not in wanted:
            continue
        case = build()
        write(case, count_by_listing(case))
    for build, full, small, legal, class_count in FAMILIES:
        if wanted and build.__name__ not in wanted:
            continue
        listed = count_by_listing(build(small))[0]
        expected = (legal(small), class_count(small))
        if (listed["legal"], listed["stages"]["fragment"]) != expected:
            sys.exit(f"{build.__name__}({small}): listed {listed}, closed form {expected}")
        case = build(full)
        write(case, [{"name": case["name"], "declared": oracle.declared(case["axes"]), "legal": legal(full),
                      "stages": {"fragment": class_count(full)}}])


if __name__ == "__main__":
    main(sys.argv[1:])
