#!/usr/bin/env python3
"""The tests of one file by pytest; exit code 77, and the reason, where something that all of them need is missing.

    /usr/bin/python3 tests/python/run.py test_views.py --library build/release/lib/libpalpable.so --programs build/release/bin
"""
import argparse
import importlib.util
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def sanitizer():
    """The environment in which a Python without sanitizer loads a library with one."""
    runtime = subprocess.run(["clang", "-print-file-name=libclang_rt.asan-x86_64.so"], capture_output=True, text=True, check=True)
    # Python itself frees little at its end; tests of growth look for leaks.
    return {"LD_PRELOAD": runtime.stdout.strip(), "ASAN_OPTIONS": "detect_leaks=0:abort_on_error=1"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--library", help="libpalpable.so; default: $PALPABLE_LIBRARY, else the system's")
    parser.add_argument("--programs", help="folder of palpable and palpable-bake; default: PATH")
    parser.add_argument("--work", help="folder for bodies that tests share")
    parser.add_argument("--sanitized", help="libpalpable.so built with AddressSanitizer by clang, to be used instead of --library")
    words, more = parser.parse_known_args()
    for module in ("numpy", "pytest"):
        if importlib.util.find_spec(module) is None:
            print(f"SKIPPED: the Debian package python3-{module} is not installed")
            return 77
    environment = os.environ | {"PYTHONPATH": str(HERE.parent.parent / "python"), "PYTHONDONTWRITEBYTECODE": "1"}
    if words.library:
        environment["PALPABLE_LIBRARY"] = str(Path(words.library).resolve())
    if words.sanitized:
        if not Path(words.sanitized).exists():
            print(f"SKIPPED: {words.sanitized} is not built (./check builds it)")
            return 77
        environment |= {"PALPABLE_LIBRARY": str(Path(words.sanitized).resolve()), **sanitizer()}
    if words.programs:
        environment["PATH"] = str(Path(words.programs).resolve()) + os.pathsep + environment.get("PATH", "")
    if words.work:
        environment["PALPABLE_WORK"] = words.work
    pytest = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(HERE / words.file), *more]
    return subprocess.run(pytest, env=environment).returncode


if __name__ == "__main__":
    sys.exit(main())
