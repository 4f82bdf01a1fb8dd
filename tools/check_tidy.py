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
MOST_CHANGED_LINES = 10_000  # of a file that git does not know yet: read first
SKIPPED_OPTIONS = {"-fpch-preprocess", "-Winvalid-pch", "-fno-sanitize-recover=all"}


def git(*words):
    result = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    return result.stdout.split("\n") if result.returncode == 0 else []


def changed_files():
    """{file: lines changed}, or None if there is no history to compare with."""
    base = (git("merge-base", "HEAD", "@{upstream}") or [""])[0]
    head = (git("rev-parse", "HEAD") or [""])[0]
    if not base or base == head:
        base = (git("rev-parse", "--verify", "--quiet", "HEAD~1") or [""])[0]
    if not base:
        return None
    changed = {}
    for line in git("diff", "--numstat", "--no-renames", base):
        added, removed, name = (line.split("\t") + ["", "", ""])[:3]
        if name and added.isdigit():
            changed[name] = int(added) + int(removed)
    for name in git("ls-files", "--others", "--exclude-standard"):
        changed[name] = MOST_CHANGED_LINES
    return changed


def sources_of(changed, known):
    """{compiled file: lines changed}: a header counts for its source, or else for its test."""
    lines = {}
    for name, count in changed.items():
        stem = name.rsplit(".", 1)[0]
        for source in (name, f"{stem}.cpp", f"{stem}_test.cpp"):
            if source in known:
                lines[source] = lines.get(source, 0) + count
                break
    return lines


def compiled_files(path):
    """The files that an entry of the database compiles: the file itself, or those of a module that is compiled as one."""
    if "/Unity/" not in str(path):
        return [path]
    return [Path(name) for name in re.findall(r'^#include "(.+)"', path.read_text(), re.MULTILINE)]


def commands():
    """{file from the root: (folder, words of its compilation without sanitizers and precompiled headers)}"""
    found = {}
    for entry in json.loads(DATABASE.read_text()):
        words = shlex.split(entry["command"])
        while not re.search(r"(g\+\+|c\+\+|clang\+\+)[\d.-]*$", words[0]):
            words = words[1:]  # env, ccache
        kept, skip = [], False
        for at, word in enumerate(words):
            if skip:
                skip = False
            elif word == "-Xclang" or (word == "-include" and "cmake_pch" in words[at + 1]):
                skip = True
            elif word not in SKIPPED_OPTIONS and not word.startswith(("-fsanitize", "-fno-sanitize", "--param=")):
                kept.append(word)
        for path in compiled_files(Path(entry["file"])):
            if ROOT in path.parents and ROOT / "build" not in path.parents:
                to_file = [str(path) if word == entry["file"] else word for word in kept]
                found[str(path.relative_to(ROOT))] = (entry["directory"], to_file)
    return found


def complaints(tool, file, folder, words):
    # To clang, and not to GCC, -Wconversion includes signs; Eigen's and the standard's indices differ.
    arguments = [tool, "--quiet", str(ROOT / file), "--", *words[1:], "-Wno-unknown-warning-option",
                 "-Wno-sign-conversion"]
    result = subprocess.run(arguments, cwd=folder, capture_output=True, text=True)
    if result.returncode == 0:
        return ""
    return result.stdout or result.stderr or f"{file}: clang-tidy ended with {result.returncode}\n"


def main():
    tool = shutil.which("clang-tidy-14")
    if tool is None:
        print("SKIPPED: clang-tidy-14 is not installed")
        return 0
    if not DATABASE.exists():
        sys.exit("check_tidy: build/dev is not configured: cmake --preset dev")
    known = commands()
    if "--all" in sys.argv[1:]:
        files = sorted(known)
    else:
        changed = changed_files()
        if changed is None:
            print("SKIPPED: git knows no commit to compare with")
            return 0
        lines = sources_of(changed, known)
        files = sorted(lines, key=lambda name: (-lines[name], name))
        if len(files) > MOST_CHANGED:
            print(f"{len(files)} files changed; the {MOST_CHANGED} that changed most are read, "
                  "./check --long reads all")
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
