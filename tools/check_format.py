#!/usr/bin/env python3
"""Checks that all C++ sources are formatted by clang-format 14. Names those that are not."""
import shutil
import subprocess
import sys
from pathlib import Path

FOLDERS = ("src", "apps", "bench", "tests", "examples")


def main():
    tool = shutil.which("clang-format-14") or shutil.which("clang-format")
    if tool is None:
        print("SKIPPED: clang-format 14 is not installed")
        return 0
    version = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout
    if " 14." not in version:
        print(f"SKIPPED: clang-format 14 is not installed, only {version.strip()}")
        return 0
    sources = sorted(str(path) for folder in FOLDERS for path in Path(folder).rglob("*")
                     if path.suffix in (".h", ".cpp"))
    if not sources:
        sys.exit("check_format: found no sources")
    result = subprocess.run([tool, "--dry-run", "--Werror", *sources], capture_output=True, text=True)
    if result.returncode != 0:
        wrong = sorted({line.split(":")[0] for line in result.stderr.split("\n") if ": error:" in line})
        print("not as clang-format writes them; run: clang-format-14 -i " + " ".join(wrong))
    return result.returncode


if __name__ == "__main__":
    sys.exit(main())
