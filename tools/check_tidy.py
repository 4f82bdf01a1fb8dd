#!/usr/bin/env python3
"""clang-tidy with the short list of .clang-tidy: on the C++ files that changed, or on all (--all).

Changed: what differs from the commit before, or from the branch that this one follows, and what is
not committed. It reads build/dev/compile_commands.json, without the precompiled headers, so that a
file that does not include what it uses is found as well. A large change is read up to a limit, which
is said; --all has none.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DATABASE = ROOT / "build/dev/compile_commands.json"
MOST_CHANGED = 12  # files: about two minutes of two cores
SKIPPED_OPTIONS = {"-fpch-preprocess", "-Winvalid-pch", "-fno-sanitize-recover=all"}


def git(*words):
    result = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    return result.stdout.split("\n") if result.returncode == 0 else []


def changed_files():
    base = (git("merge-base", "HEAD", "@{upstream}") or [""])[0]
    head = (git("rev-parse", "HEAD") or [""])[0]
    if not base or base == head:
        base = (git("rev-parse", "--verify", "--quiet", "HEAD~1") or [""])[0]
    names = set(git("diff", "--name-only", base)) if base else set()
    names |= set(git("ls-files", "--others", "--exclude-standard"))
    return {name for name in names if name.endswith(".cpp")}


def commands():
    """{file from the root: (folder, words of its compilation without what only GCC knows)}"""
    found = {}
    for entry in json.loads(DATABASE.read_text()):
        path = Path(entry["file"])
        if ROOT not in path.parents or ROOT / "build" in path.parents:
            continue
        words = shlex.split(entry["command"])
        while not re.search(r"(g\+\+|c\+\+)[\d.-]*$", words[0]):
            words = words[1:]  # env, ccache
        kept, skip = [], False
        for at, word in enumerate(words):
            if skip:
                skip = False
            elif word == "-include" and "cmake_pch" in words[at + 1]:
                skip = True
            elif word not in SKIPPED_OPTIONS and not word.startswith(("-fsanitize", "-fno-sanitize")):
                kept.append(word)
        found[str(path.relative_to(ROOT))] = (entry["directory"], kept)
    return found


def complaints(tool, file, folder, words):
    arguments = [tool, "--quiet", str(ROOT / file), "--", *words[1:], "-Wno-unknown-warning-option"]
    result = subprocess.run(arguments, cwd=folder, capture_output=True, text=True)
    return result.stdout if result.returncode != 0 else ""


def main():
    tool = shutil.which("clang-tidy-14")
    if tool is None:
        print("SKIPPED: clang-tidy-14 is not installed")
        return 0
    if not DATABASE.exists():
        sys.exit("check_tidy: build/dev is not configured: cmake --preset dev")
    known = commands()
    every = "--all" in sys.argv[1:]
    files = sorted(known if every else changed_files() & set(known))
    if not every and len(files) > MOST_CHANGED:
        print(f"{len(files)} files changed; the first {MOST_CHANGED} are read, ./check --long reads all")
        files = files[:MOST_CHANGED]
    wrong = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for text in pool.map(lambda file: complaints(tool, file, *known[file]), files):
            wrong += bool(text)
            print(text, end="", flush=True)
    print(f"clang-tidy: {len(files)} files, {wrong} with complaints")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
