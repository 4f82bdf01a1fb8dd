#!/usr/bin/env python3
"""collect_tests.py TARGET [BUILD:LABEL_REGEX ...]: one list of tests from several builds.

Writes TARGET/CTestTestfile.cmake, so that a single `ctest --test-dir TARGET` runs the unit tests of
the dev build, the thread tests of the threads build and the long ones of the release build, and
ends in one summary. A test keeps its command, label, time limit and rule for being skipped; its
name gets the build in front.
"""
import json
import subprocess
import sys
from pathlib import Path

KEPT = {"LABELS", "TIMEOUT", "SKIP_REGULAR_EXPRESSION", "SKIP_RETURN_CODE", "WORKING_DIRECTORY",
        "RESOURCE_LOCK", "RUN_SERIAL", "ENVIRONMENT", "PASS_REGULAR_EXPRESSION", "DEPENDS"}


def quoted(text):
    level = "="
    while f"]{level}]" in text:
        level += "="
    return f"[{level}[{text}]{level}]"


def tests_of(build, labels):
    listing = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1", "-L", labels],
                             check=True, capture_output=True, text=True).stdout
    return json.loads(listing)["tests"]


def main():
    target = Path(sys.argv[1])
    lines = []
    for selection in sys.argv[2:]:
        build, labels = selection.split(":", 1)
        preset = Path(build).name
        for test in tests_of(build, labels):
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
