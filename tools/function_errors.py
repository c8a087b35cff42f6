#!/usr/bin/env python3
"""Writes the table of errors seen on the device into uber/README.md, from a run of the function tests.

usage: tools/function_errors.py build/dev/bin/test_functions

The table stands between the two marks below and has a row for every file of uber/lib that the tests name.
"""
import pathlib
import subprocess
import sys

README = pathlib.Path(__file__).resolve().parent.parent / "uber" / "README.md"
BEGIN, END = "<!-- errors: tools/function_errors.py -->", "<!-- /errors -->"


class File:
    """What all functions of one file showed."""

    def __init__(self):
        self.functions, self.samples = 0, 0
        self.worst = None  # the function of the largest relative error: (relative, ulp, name)
        self.rounding = self.implementation = self.share = 0.0

    def add(self, name, relative, ulp, share, keys):
        self.functions += 1
        self.samples += int(keys["samples"])
        self.share = max(self.share, share)
        self.rounding = max(self.rounding, float(keys["rounding_ulp"]))
        self.implementation = max(self.implementation, float(keys["implementation_ulp"]))
        if self.worst is None or relative > self.worst[0]:
            self.worst = (relative, ulp, name)


def read(output):
    files = {}
    for line in output.splitlines():
        if not line.startswith("KILN_FUNCTION "):
            continue
        name, _, relative, ulp, share, *rest = line.split()[1:]
        keys = dict(item.split("=", 1) for item in rest)
        files.setdefault(keys["file"], File()).add(name, float(relative), float(ulp), float(share), keys)
    return files


def table(files):
    rows = ["| file | tests | samples | worst relative error | in ulp | rounding | device against float | share of the bound |",
            "| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: |"]
    for file in sorted(files):
        f = files[file]
        relative, ulp, name = f.worst
        where = "exact" if relative == 0 else f"{relative:.1e} {name}"
        rows.append(f"| `lib/{file}` | {f.functions} | {f.samples:,} | {where} | {ulp:,.3g} | {f.rounding:,.3g} | "
                    f"{f.implementation:,.3g} | {f.share:.2f} |")
    return "\n".join(rows)


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    run = subprocess.run([sys.argv[1], "--gtest_filter=Functions.*"], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(run.stdout + run.stderr, file=sys.stderr)
        return 1
    files = read(run.stdout)
    text = README.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    README.write_text(head + BEGIN + "\n" + table(files) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    print(f"{sum(f.functions for f in files.values())} functions of {len(files)} files")
    return 0


if __name__ == "__main__":
    sys.exit(main())
