#!/usr/bin/env python3
"""Writes the table of errors and costs seen on the device into uber/README.md, from two runs of the function tests.

usage: tools/function_table.py build/dev/bin/test_functions
       tools/function_table.py OUTPUT...      what `test_functions` and `test_functions --costs` printed, kept in files

The table stands between the two marks below and has a row for every file of uber/lib: with figures where functions of it are
tested one by one, else with the tests that run it.
"""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
README, LIBRARY = ROOT / "uber" / "README.md", ROOT / "uber" / "lib"
BEGIN, END = "<!-- functions: tools/function_table.py -->", "<!-- /functions -->"
REFERENCES = {"hair_published.glsl": "hair_textbook.h", "math.glsl": "numbers.h"}  # not called as the file is
TEST_FOLDERS = ["functions", "bakes", "images", "stability"]


def definitions():
    """The file that defines each function of the library."""
    found = {}
    for path in sorted(LIBRARY.glob("*.glsl")):
        for name in re.findall(r"^\w+(?:\[\d+\])? (\w+)\(", path.read_text(encoding="utf-8"), re.MULTILINE):
            found[name] = path.name
    return found


class File:
    """What all functions of one file showed."""

    def __init__(self):
        self.functions = self.samples = 0
        self.worst = (-1.0, 0.0, "")  # relative, ulp, name
        self.rounding = self.implementation = self.share = 0.0
        self.names, self.costs = set(), {}  # ns by name, the least that was seen

    def add(self, name, relative, ulp, share, keys):
        self.functions += 1
        self.names.add(name)
        self.samples += int(keys["samples"])
        self.share = max(self.share, share)
        self.rounding = max(self.rounding, float(keys["rounding_ulp"]))
        self.implementation = max(self.implementation, float(keys["implementation_ulp"]))
        self.worst = max(self.worst, (relative, ulp, name), key=lambda w: w[0])


def read(output, files, defined):
    for line in output.splitlines():
        kind, *words = line.split() or [""]
        if kind not in ("KILN_FUNCTION", "KILN_COST"):
            continue
        keys = dict(word.split("=", 1) for word in words if "=" in word)
        name, *numbers = [word for word in words if "=" not in word]
        numbers = [float(n) for n in numbers]
        # A call may be a block of statements or stand under another name; then its file is the one under test.
        file = files.setdefault(defined.get(name, keys["file"]), File())
        if kind == "KILN_FUNCTION":
            file.add(name, numbers[1], numbers[2], numbers[3], keys)
        else:
            file.costs[name] = min(numbers[0], file.costs.get(name, numbers[0]))


def tests_of(file):
    """The test sources that name the file, or else a shader or file that includes it; function tests first."""
    includes = re.compile(rf'#include "(?:lib/)?{re.escape(file)}"')
    users = [p.name for p in sorted(LIBRARY.glob("*.glsl")) + sorted(LIBRARY.parent.glob("*.*"))
             if p.suffix != ".png" and includes.search(p.read_text(encoding="utf-8"))]
    return naming(file) or list(dict.fromkeys(test for user in users for test in naming(user)))


def naming(file):
    found = []
    for folder in TEST_FOLDERS:
        for path in sorted((ROOT / "tests" / folder).glob("*.cpp")):
            if path.stem != "harness_test" and re.search(rf'["/]{re.escape(file)}"', path.read_text(encoding="utf-8")):
                found.append(f"{folder}/{path.stem}")
    return found


def reference_of(file):
    stem = file.removesuffix(".glsl")
    return next((h for h in (REFERENCES.get(file, ""), f"{stem}.h", f"{stem.removeprefix('lecture_')}.h")
                 if (ROOT / "uber" / "reference" / h).is_file()), None)


def ns(cost):
    name, value = cost
    return f"{value:.2g} {name}" if value < 100 else f"{value:.0f} {name}"


def row(file, f):
    reference, tests = reference_of(file), tests_of(file)
    cells = [f"`{file}`", f"`{reference}`" if reference else "", ", ".join(f"`{t}`" for t in tests[:2])]
    if f is None:
        return cells + [""] * 8
    relative, ulp, name = f.worst
    cells += [str(f.functions), "exact" if relative == 0 else f"{relative:.1e} {name}", f"{ulp:,.3g}", f"{f.rounding:,.3g}",
              f"{f.implementation:,.3g}", f"{f.share:.2f}"]
    if not f.costs or not f.names <= f.costs.keys():  # part of them would mislead
        return cells + ["", ""]
    return cells + [ns(pick(f.costs.items(), key=lambda c: c[1])) for pick in (min, max)]


def table(files):
    rows = [["file", "reference", "tests", "functions", "worst relative error", "ulp", "rounding", "device", "share",
             "cheapest, ns", "dearest, ns"],
            ["---", "---", "---", "---:", "---", "---:", "---:", "---:", "---:", "---", "---"]]
    for file in sorted({p.name for p in LIBRARY.glob("*.glsl")} | set(files)):
        rows.append(row(file, files.get(file)))
    return "\n".join("| " + " | ".join(cells) + " |" for cells in rows)


def output_of(command):
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        sys.exit(run.stdout + run.stderr)
    return run.stdout


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    files, defined = {}, definitions()
    for given in sys.argv[1:]:
        if os.access(given, os.X_OK):
            read(output_of([given, "--costs"]), files, defined)
            read(output_of([given, "--gtest_filter=Functions.*"]), files, defined)
        else:
            read(pathlib.Path(given).read_text(encoding="utf-8"), files, defined)
    text = README.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    README.write_text(head + BEGIN + "\n" + table(files) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    print(f"{sum(f.functions for f in files.values())} functions, {sum(f.samples for f in files.values()):,} samples, "
          f"{sum(len(f.costs) for f in files.values())} costs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
