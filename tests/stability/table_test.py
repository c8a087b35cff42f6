"""Every test that tests/stability/README.md names is one of ctest's, and no row is missing.

usage: table_test.py README.md BUILD_FOLDER CTEST
"""

import json
import re
import subprocess
import sys


def main() -> int:
    readme, build, ctest = sys.argv[1:4]
    listed = subprocess.run([ctest, "--show-only=json-v1"], cwd=build, capture_output=True, text=True, check=True).stdout
    names = {test["name"] for test in json.loads(listed)["tests"]}
    errors, rows = [], []
    with open(readme, encoding="utf-8") as file:
        for line in file:
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if not line.startswith("|") or len(cells) not in (3, 6) or set(cells[0]) == {"-"} or "tests" in cells:
                continue
            tests = re.findall(r"`([^`]+)`", cells[-1])
            if len(cells) == 6:
                rows.append(int(cells[0]))
                if not any(f"Row{rows[-1]:02}_" in test for test in tests):
                    errors.append(f"row {rows[-1]} has no test of its own")
            if not tests:
                errors.append(f"no test for {cells[0]}")
            for test in tests:
                full = test if test.count(".") > 1 else "stability." + test
                if full not in names:
                    errors.append(f"{cells[0]}: there is no test {full}")
    if rows != list(range(1, 39)):
        errors.append(f"rows are {rows}, not 1 to 38")
    print("\n".join(errors) or f"{len(rows)} rows")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
