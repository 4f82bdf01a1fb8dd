#!/usr/bin/env python3
"""Checks that the code and tests named in docs/paper_map.md exist.

Rows look like  | Eq. (7) | `material/neo_hookean.h` `first_piola` | "a body at rest ..." | ... |
Each `path` in backticks must exist (in a folder of src/palpable, or from the root), each `name` in backticks
must stand in the files named in that cell, each "sentence" in the test column must be a TEST_CASE.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def find(path):
    for base in (*(ROOT / "src/palpable").iterdir(), ROOT):
        if (base / path).exists():
            return base / path
    return None


def test_names():
    names = set()
    for folder in ("src", "tests"):
        for source in (ROOT / folder).rglob("*_test.cpp"):
            names |= set(re.findall(r'TEST_CASE\(\s*"((?:[^"\\]|\\.)*)"', source.read_text()))
    return names


def main():
    tests = test_names()
    wrong, rows = [], 0
    for number, line in enumerate((ROOT / "docs/paper_map.md").read_text().splitlines(), 1):
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if len(cells) != 4 or cells[0] in ("paper", "") or set(cells[0]) <= set("-: "):
            continue
        rows += 1
        where = f"docs/paper_map.md:{number}"
        files = []
        for item in re.findall(r"`([^`]+)`", cells[1]):
            if "/" in item:
                path = find(item)
                if path is None:
                    wrong.append(f"{where}: {item} does not exist")
                elif path.is_file():
                    files.append(path)
            else:
                text = "\n".join(path.read_text() for path in files)
                if not re.search(r"\b" + re.escape(item) + r"\b", text):
                    wrong.append(f"{where}: {item} does not stand in the files before it")
        for sentence in re.findall(r'"([^"]+)"', cells[2]):
            if sentence not in tests:
                wrong.append(f'{where}: there is no test "{sentence}"')
    if rows == 0:
        sys.exit("check_paper_map: docs/paper_map.md has no rows")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
