#!/usr/bin/env python3
"""collect_tests.py TARGET [BUILD:LABEL_REGEX ...]: one list of tests from several builds.

Writes TARGET/CTestTestfile.cmake, so that a single `ctest --test-dir TARGET` runs the unit tests of
the dev build, the thread tests of the release build and the long ones of the release build, and
ends in one summary. A test keeps its command, label, time limit and rule for being skipped; its
name gets the build in front.

The cases of one test file run in one process: what they share (an OpenGL context, a planned film,
a baked body) is made once, and 1,100 starts of a sanitized program are saved. A file whose cases
look for data, programs or displays that may be missing (PALPABLE_SKIP) keeps a process for each,
so that the summary names what was skipped; a missing OpenGL context skips all of a file alike.
"""
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEPT = {"LABELS", "TIMEOUT", "SKIP_REGULAR_EXPRESSION", "SKIP_RETURN_CODE", "WORKING_DIRECTORY",
        "RESOURCE_LOCK", "RUN_SERIAL", "ENVIRONMENT", "PASS_REGULAR_EXPRESSION", "DEPENDS"}
TIMEOUT_OF_A_FILE = 1200  # s
# The selection that catch_discover_tests made for each label (cmake/PalpableModule.cmake).
CASES_OF_LABEL = {"unit": "~[long]~[threads]", "long": "[long]", "threads": "[threads]~[long]"}


def quoted(text):
    level = "="
    while f"]{level}]" in text:
        level += "="
    return f"[{level}[{text}]{level}]"


def tests_of(build, labels):
    listing = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1", "-L", labels],
                             check=True, capture_output=True, text=True).stdout
    return json.loads(listing)["tests"]


def files_of_cases():
    """{sentence of a test case: stem of its file} for files whose cases run in one process."""
    found = {}
    case = re.compile(r'TEST_CASE\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)')
    for folder in ("src", "apps", "bench", "tests"):
        for path in (ROOT / folder).rglob("*_test.cpp"):
            text = path.read_text()
            skips = [line for line in text.splitlines() if "PALPABLE_SKIP(" in line]
            if any(".problem().message" not in line for line in skips):
                continue
            for words in case.findall(text):
                literals = re.findall(r'"((?:[^"\\]|\\.)*)"', words)
                found["".join(literals).replace('\\"', '"').replace("\\\\", "\\")] = path.stem
    return found


def by_file(tests, files):
    """The same tests, with the cases of one file combined into one test."""
    groups, rest = {}, []
    for test in tests:
        labels = next((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])
        kind = labels[0].split(".")[0] if labels else ""
        stem = files.get(test["name"].split("/", 1)[1]) if kind in CASES_OF_LABEL else None
        if stem is None or "command" not in test:
            rest.append(test)
            continue
        groups.setdefault((test["command"][0], stem, kind), []).append(test)
    for (program, stem, kind), cases in groups.items():
        first = cases[0]
        module = first["name"].split("/", 1)[0]
        count = f"{len(cases)} case{'s' if len(cases) > 1 else ''}"
        first["name"] = f"{module}/{stem}: {count}"
        first["command"] = [program, "-#", f"[#{stem}]{CASES_OF_LABEL[kind]}"]
        for prop in first["properties"]:
            if prop["name"] == "TIMEOUT":
                prop["value"] = TIMEOUT_OF_A_FILE
        rest.append(first)
    return rest


def main():
    target = Path(sys.argv[1])
    lines = []
    files = files_of_cases()
    for selection in sys.argv[2:]:
        build, labels = selection.split(":", 1)
        preset = Path(build).name
        for test in by_file(tests_of(build, labels), files):
            if "command" not in test:
                sys.exit(f"collect_tests: '{test['name']}' of {build} has no program; build it first")
            name = quoted(f"{preset}: {test['name']}")
            lines.append(f"add_test({name} {' '.join(quoted(word) for word in test['command'])})")
            for prop in test.get("properties", []):
                if prop["name"] not in KEPT:
                    continue
                value = prop["value"]
                if prop["name"] == "DEPENDS":
                    value = [f"{preset}: {v}" for v in value]
                if isinstance(value, bool):
                    value = "TRUE" if value else "FALSE"
                if isinstance(value, list):
                    value = ";".join(map(str, value))
                lines.append(f"set_tests_properties({name} PROPERTIES {prop['name']} {quoted(str(value))})")
    if not lines:
        sys.exit("collect_tests: no test matches")
    target.mkdir(parents=True, exist_ok=True)
    (target / "CTestTestfile.cmake").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
