#!/usr/bin/env python3
"""bunny_to_off.py index.js bunny.off: the npm package `bunny` as an OFF file.

The package is one line of JavaScript: exports.positions=[...]; exports.cells=[...]
"""
import json
import re
import sys
from pathlib import Path


def table(text, name):
    return json.loads(re.search(r"exports\." + name + r"\s*=\s*(\[\[.*?\]\])", text, re.S).group(1))


def main():
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    text = source.read_text()
    positions, cells = table(text, "positions"), table(text, "cells")
    lines = ["OFF", f"{len(positions)} {len(cells)} 0"]
    lines += [" ".join(map(repr, p)) for p in positions]
    lines += [f"3 {a} {b} {c}" for a, b, c in cells]
    target.parent.mkdir(parents=True, exist_ok=True)
    aside = target.with_suffix(".part")
    aside.write_text("\n".join(lines) + "\n")
    aside.replace(target)


if __name__ == "__main__":
    main()
