#!/usr/bin/env python3
"""check.py KILN CASE...: runs `kiln count --classes --json` on each case's manifest and compares with its expected.json.

A case is a folder with manifest.yaml and expected.json, or an expected.json elsewhere that names its "manifest" and "scenes"
relative to itself. What expected.json does not name is not compared. Prints one line a difference; exit code 4 if any.
"""
import json
import pathlib
import subprocess
import sys


def differences(expected, got, where=""):
    if isinstance(expected, dict):
        for key, value in expected.items():
            if key not in got:
                yield f"{where}.{key} is missing"
            else:
                yield from differences(value, got[key], f"{where}.{key}")
    elif isinstance(expected, list):
        if len(expected) != len(got):
            yield f"{where} has {len(got)} entries, not {len(expected)}"
        for i, (e, g) in enumerate(zip(expected, got)):
            yield from differences(e, g, f"{where}[{i}]")
    elif expected != got:
        yield f"{where} is {got}, not {expected}"


def main(kiln, cases):
    wrong = 0
    for case in cases:
        file = pathlib.Path(case)
        if file.is_dir():
            file = file / "expected.json"
        expected = json.loads(file.read_text())
        manifest = file.parent / expected.pop("manifest", "manifest.yaml")
        command = [kiln, "count", str(manifest), "--classes", "--json"]
        for scene in expected.pop("scenes", []):
            command += ["--scene", str(file.parent / scene)]
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode != 0:
            found = [f"exit code {run.returncode}: {run.stderr.strip()[:500]}"]
        else:
            found = list(differences(expected, json.loads(run.stdout)))
        for line in found:
            print(f"{file}: {line}")
        wrong += len(found)
    print(f"{len(cases)} cases, {wrong} differences")
    return 4 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
