#!/usr/bin/env python3
"""peers.py BUILD [--quick] [--manifest M]...: kiln against per-variant processes (glslc -O, spirv-val, spirv-cross to GLSL, HLSL and
MSL) and against qsb -O, in CPU time of one run; then warm builds, edits, counting, memory and lookups. Prints JSON.

Every peer process gets exactly the macros of a variant that kiln lists for itself, and the include path of the manifest.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
ROUNDS = 3
TARGETS = ["spirv", "glsl450", "hlsl60", "msl21"]


def cpu_of(command, **kwargs):
    """CPU and wall seconds of a command and its children; fails when the command does."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    wall = time.monotonic()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **kwargs)
    wall = time.monotonic() - wall
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout.decode()}{done.stderr.decode()}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, wall, done.stdout.decode()


def best(n, run):
    return min((run() for _ in range(n)), key=lambda r: r[0])


class Kiln:
    def __init__(self, build):
        self.binary = str(build / "bin" / "kiln")

    def build(self, manifest, out, cache, jobs=1, targets=TARGETS, scenes=()):
        report = out + ".json"
        command = [self.binary, "build", str(manifest), "-o", out, "--cache", cache, "-j", str(jobs), "--report-json", report]
        for target in targets:
            command += ["--target", target]
        cpu, wall, _ = cpu_of(command)
        return cpu, wall, json.load(open(report))

    def variants(self, manifest, most):
        text = subprocess.run([self.binary, "count", str(manifest), "--list", str(most)], check=True, stdout=subprocess.PIPE).stdout.decode()
        return [line.split() for line in text.splitlines() if "=" in line]

    def first_of_each_module(self, table, listed, most=2000):
        """(variant, stage) pairs: for every module of the table that up to `most` listed variants reach, the first that does."""
        first = {}
        for words in listed[:: max(1, len(listed) // most)]:
            text = subprocess.run([self.binary, "dump", table, "--json", "--shader", *words], check=True, stdout=subprocess.PIPE).stdout
            for stage in json.loads(text)["stages"]:
                for module in stage["modules"]:
                    first.setdefault(module["module"], (words, stage["stage"]))
        return list(first.values())


def macros(manifest, shader, words):
    """-D arguments of one listed variant: axis names and value names through the manifest."""
    out = []
    for name, body in (shader.get("defines") or {}).items():
        out.append(f"-D{name}={body}")
    for word in words:
        name, value = word.split("=")
        axis = manifest["axes"][name]
        values = axis["values"]
        if values == "bool":
            number = {"false": 0, "true": 1}[value]
        elif values == "defined":
            if value == "true":
                out.append(f"-D{axis['macro']}=1")
            continue
        elif isinstance(values, dict):
            number = values[value]
        elif isinstance(values[0], int):
            number = int(value, 0)
        else:
            number = values.index(value)
        out.append(f"-D{axis['macro']}={number}")
    return out


def stage_runs(path, pairs):
    """(stage, file, include arguments, macros) of (variant, stage) pairs; stage None: every stage of the variant."""
    manifest = yaml.safe_load(path.read_text())
    folder = path.parent
    includes = [f"-I{folder}"] + [f"-I{folder / i}" for i in manifest.get("include", [])]
    runs = []
    for words, only in pairs:
        shader = next(s for s in manifest["shaders"] if s["name"] == words[0])
        for stage, file in shader["stages"].items():
            if only not in (None, stage):
                continue
            found = next(p for p in [folder / file] + [folder / i / file for i in manifest.get("include", [])] if p.exists())
            runs.append((stage, found, includes, macros(manifest, shader, words[1:])))
    return runs


def peers_today(runs, folder):
    """CPU of glslc -O, spirv-val and three spirv-cross processes for each run."""
    total = {"glslc": 0.0, "spirv-val": 0.0, "spirv-cross": 0.0}
    for i, (stage, file, includes, defines) in enumerate(runs):
        spv = f"{folder}/{i}.spv"
        short = {"tess_control": "tesscontrol", "tess_evaluation": "tesseval"}.get(stage, stage)
        total["glslc"] += cpu_of(["glslc", "-O", f"-fshader-stage={short}", "--target-env=vulkan1.1", *includes, *defines, str(file), "-o", spv])[0]
        total["spirv-val"] += cpu_of(["spirv-val", "--target-env", "vulkan1.1", spv])[0]
        for extra in (["--version", "450"], ["--hlsl", "--shader-model", "60"], ["--msl", "--msl-version", "20100"]):
            total["spirv-cross"] += cpu_of(["spirv-cross", spv, *extra])[0]
    return total


def peer_qsb(runs, folder):
    """CPU of qsb -O to the same three text targets. qsb has no include path, so it gets preprocessed text."""
    qsb = shutil.which("qsb") or "/usr/lib/qt6/bin/qsb"
    if not os.path.exists(qsb):
        return None
    endings = {"vertex": "vert", "fragment": "frag", "compute": "comp"}
    total = 0.0
    for i, (stage, file, includes, defines) in enumerate(runs):
        text = subprocess.run(["glslc", "-E", f"-fshader-stage={stage}", "--target-env=vulkan1.1", *includes, *defines, str(file)],
                              check=True, stdout=subprocess.PIPE).stdout.decode()
        text = re.sub(r"^#(line|extension GL_GOOGLE).*$", "", text, flags=re.M)
        source = f"{folder}/q{i}.{endings[stage]}"
        pathlib.Path(source).write_text(text)
        total += cpu_of([qsb, "-O", "--glsl", "450", "--hlsl", "60", "--msl", "21", "-o", source + ".qsb", source])[0]
    return total


def bench_manifest(kiln, path, quick, folder):
    out = {}
    table = f"{folder}/t.kiln"
    report = kiln.build(path, table, "none", 1)[2]
    counts = report["counts"]
    modules = int(counts["modules"])
    listed = kiln.variants(path, 100000)
    # The same population on both sides: one compile of each module for the ratio a module, of each variant's stages for the other.
    modules_runs = stage_runs(path, kiln.first_of_each_module(table, listed))
    runs = stage_runs(path, [(words, None) for words in listed])
    most = 24 if quick else 120
    sample = modules_runs[:: max(1, len(modules_runs) // most)]
    variant_sample = runs[:: max(1, len(runs) // most)]
    # A shared machine is faster in one minute than in the next: each round measures both sides, and a ratio is the median of the rounds'.
    rounds = []
    for _ in range(ROUNDS):
        cold, wall, _ = best(3, lambda: kiln.build(path, table, "none", 1))
        rounds.append({"cold": cold, "wall": wall, "today": peers_today(sample, folder)})
        rounds[-1]["two"] = min(kiln.build(path, table, "none", 2)[1] for _ in range(3))
        rounds[-1]["qsb"] = peer_qsb(sample, folder)
        rounds[-1]["ratio"] = sum(rounds[-1]["today"].values()) / len(sample) * modules / cold
    per_variant_run = sum(peers_today(variant_sample, folder).values()) / len(variant_sample)
    middle = sorted(rounds, key=lambda r: r["ratio"])[ROUNDS // 2]
    cold, cold_wall, today, qsb = middle["cold"], middle["wall"], middle["today"], middle["qsb"]
    per_run = sum(today.values()) / len(sample)
    unique = cold / modules
    out["counts"] = counts
    out["kiln_cold_cpu_s"] = cold
    out["kiln_ms_a_module"] = 1000 * unique
    out["peak_memory_mib"] = report["bytes"]["peak_memory"] / 1048576
    out["ms"] = report["ms"]
    out["today_ms_a_stage_compile"] = 1000 * per_run
    out["today_split_ms"] = {k: 1000 * v / len(sample) for k, v in today.items()}
    out["stage_compiles_measured"] = len(sample)
    out["ratio_a_unique_module"] = middle["ratio"]
    out["ratio_of_each_round"] = [r["ratio"] for r in rounds]
    out["ratio_a_legal_variant"] = per_variant_run * len(runs) / cold
    if qsb is not None:
        out["qsb_ms_a_stage_compile"] = 1000 * qsb / len(sample)
        out["qsb_ratio_a_unique_module"] = qsb / len(sample) / unique
    # glslang builds its symbol tables once, on one thread; the rest is what jobs share.
    tiny = f"{folder}/tiny.yaml"
    pathlib.Path(tiny).write_text("kiln: 1\nname: t\naxes: {a: {macro: A, values: bool}}\nshaders:\n  - {name: t, stages: {fragment: t.frag}}\n")
    pathlib.Path(f"{folder}/t.frag").write_text("#version 450\nlayout(location=0) out vec4 c;\nvoid main() { c = vec4(A); }\n")
    init = min(kiln.build(tiny, f"{folder}/tiny.kiln", "none", 1)[1] for _ in range(3))
    out["one_time_start_s"] = init
    pair = sorted(rounds, key=lambda r: (r["wall"] - init) / max(1e-9, r["two"] - init))[ROUNDS // 2]
    out["one_job_wall_s"], out["two_jobs_wall_s"] = pair["wall"], pair["two"]
    out["two_jobs_speedup_after_start"] = (pair["wall"] - init) / max(1e-9, pair["two"] - init)
    # Warm, and after edits, on a copy of the sources.
    copy = pathlib.Path(folder) / "copy"
    shutil.copytree(ROOT / "manifests", copy / "manifests")
    shutil.copytree(ROOT / "uber", copy / "uber")
    own = copy / path.relative_to(ROOT)
    cache = f"{folder}/cache"
    first, _, _ = kiln.build(own, table, cache, 1)
    warm, _, warm_report = best(5, lambda: kiln.build(own, table, cache, 1))
    out["cold_with_cache_cpu_s"] = first
    out["warm_cpu_s"], out["warm_ratio"], out["warm_work"] = warm, warm / cold, warm_report["work"]
    for source in sorted((copy / "uber").rglob("*.frag")) + sorted((copy / "uber").rglob("*.glsl")):
        text = source.read_text().splitlines(keepends=True)
        text.insert(1 if text[0].startswith("#version") else 0, "// a comment\n")
        source.write_text("".join(text))
    _, _, edited = kiln.build(own, table, cache, 1)
    out["after_comment_edit_work"] = edited["work"]
    return out


def edit_one_material(kiln, folder):
    """Builds surface, edits the Blinn-Phong file, and counts what is compiled again."""
    copy = pathlib.Path(folder) / "edit"
    shutil.copytree(ROOT / "manifests", copy / "manifests")
    shutil.copytree(ROOT / "uber", copy / "uber")
    manifest = copy / "manifests" / "surface.yaml"
    cache = f"{folder}/edit-cache"
    _, _, before = kiln.build(manifest, f"{folder}/e.kiln", cache, 1)
    source = copy / "uber" / "lib" / "blinn_phong.glsl"
    text = source.read_text()
    numbers = [m for m in re.finditer(r"\b8\.0\b", re.sub(r"//[^\n]*", lambda m: " " * len(m.group()), text))]
    source.write_text(text[: numbers[0].start()] + "8.5" + text[numbers[0].end():])
    _, _, after = kiln.build(manifest, f"{folder}/e.kiln", cache, 1)
    return {"classes": before["counts"]["classes"], "compiled_again": after["work"]["compiled"]}


def bench_counts(kiln):
    out = {}
    for case in sorted((ROOT / "tests" / "golden").iterdir()):
        manifest = case / "manifest.yaml"
        expected = case / "expected.json"
        if not expected.exists() or not manifest.exists() or "total" not in json.loads(expected.read_text()):
            continue
        best_wall = min(cpu_of([kiln.binary, "count", str(manifest)])[1] for _ in range(5))
        out[case.name] = {"wall_ms": 1000 * best_wall}
    return out


def bench_google(build, name):
    binary = build / "bin" / name
    if not binary.exists():
        return None
    text = subprocess.run([str(binary), "--benchmark_format=json", "--benchmark_min_time=0.2"], check=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL).stdout.decode()
    return {b["name"]: round(b["cpu_time"], 3) for b in json.loads(text)["benchmarks"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true", help="fewer peer processes")
    parser.add_argument("--manifest", action="append", type=pathlib.Path)
    arguments = parser.parse_args()
    kiln = Kiln(arguments.build.resolve())
    out = {}
    for path in arguments.manifest or [ROOT / "manifests" / "surface.yaml"]:
        with tempfile.TemporaryDirectory() as folder:
            out[path.stem] = bench_manifest(kiln, path.resolve(), arguments.quick, folder)
    with tempfile.TemporaryDirectory() as folder:
        out["edit_of_one_material"] = edit_one_material(kiln, folder)
    out["count_wall_ms"] = bench_counts(kiln)
    out["lookup_ns"] = bench_google(arguments.build.resolve(), "lookup_bench")
    print(json.dumps(out, indent=2))


if __name__ == "__main__":
    main()
