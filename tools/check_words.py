#!/usr/bin/env python3
"""Phrases that never help a reader, in comments, messages and documents (docs/glossary.md has the terms to use).

One line for each; exit code 1 if there are any. The list is short on purpose: it holds what is always wrong, and is no
replacement for reading.
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PHRASES = {
    r"\bnobody\b": "say what is not done",
    r"\bso many\b": "give the number, or say 'this many' of what",
    r"\bsuch a one\b|\bsuch an one\b": "name the thing",
    r"(?<!/)\bblobs?\b": "contact patch",
    r"\bit is (?:said|told)\b": "say who reports it",
    r"\bneed tell\b|\bis none yet\b": "write a sentence with a subject",
    r"\b(?:bodies|body|pixels?|points?) (?:listen|bear|ask)s?\b": "no personification",
    r"\bexact answers?\b": "full-order solution",
}
# What is not prose of ours, and where a phrase is quoted as an example.
SKIPPED = re.compile(r"^(?:tools/check_words\.py|docs/glossary\.md|docs/results/|CHANGELOG\.md|packaging/|bodies/.*\.off)")
KINDS = re.compile(r"\.(?:h|cpp|c|py|md|toml|cmake|sh|txt)$|^(?:check|demo)$")


def main():
    names = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    wrong = 0
    for name in names:
        if SKIPPED.match(name) or not KINDS.search(name) or not (ROOT / name).is_file():
            continue
        for number, line in enumerate((ROOT / name).read_text(encoding="utf-8").split("\n"), 1):
            for phrase, instead in PHRASES.items():
                found = re.search(phrase, line, re.IGNORECASE)
                if found:
                    print(f"{name}:{number}: '{found[0]}': {instead}")
                    wrong += 1
    if wrong:
        sys.exit(f"check_words: {wrong} phrases that help no reader")


if __name__ == "__main__":
    main()
