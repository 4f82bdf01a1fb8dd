#!/usr/bin/env python3
"""Comments drawn at random, each with the code that follows: is the text clear to somebody who has never seen the file?

    tools/draw_comments.py --seed 7 --count 60

A comment is a run of comment lines (// or ///) of two words or more in a C++ file of src, apps or bench; tests and
licence lines apart. It is printed with its file and line and the next ten lines of code. The same seed and the same
files give the same draw.
"""
import argparse
import random
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CODE_LINES = 10


def comments_of(path):
    """[(first line, index after the last line)] of the comments on lines of their own."""
    lines = path.read_text(encoding="utf-8").split("\n")
    found, at = [], 0
    while at < len(lines):
        first = at
        while at < len(lines) and re.match(r"\s*//", lines[at]):
            at += 1
        text = " ".join(lines[first:at])
        if at > first and len(re.findall(r"[A-Za-z]{2,}", text)) >= 2 and not re.match(r"\s*// ---", lines[first]):
            found.append((first, at))
        at = max(at, first + 1)
    return lines, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the draw [default 1]")
    parser.add_argument("--count", type=int, default=60, help="how many comments [default 60]")
    parser.add_argument("--under", default="", help="only files whose path begins with this, e.g. src/palpable/live")
    arguments = parser.parse_args()
    names = subprocess.run(["git", "ls-files", "src", "apps", "bench"], cwd=ROOT, capture_output=True, text=True,
                           check=True).stdout.split("\n")
    pool = []
    for name in sorted(names):
        if re.search(r"(?<!_test)\.(h|cpp)$", name) and name.startswith(arguments.under):
            lines, found = comments_of(ROOT / name)
            pool += [(name, lines, first, after) for first, after in found]
    draw = random.Random(arguments.seed).sample(pool, min(arguments.count, len(pool)))
    for number, (name, lines, first, after) in enumerate(draw, 1):
        print(f"--- {number} {name}:{first + 1}")
        print("\n".join(lines[first:after + CODE_LINES]), end="\n\n")
    print(f"{len(draw)} of {len(pool)} comments, seed {arguments.seed}")


if __name__ == "__main__":
    main()
