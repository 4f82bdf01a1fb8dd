#!/usr/bin/env python3
"""check_instructions.py compile_commands.json: checks that no file is compiled for a specific processor.

One package serves every x86-64: instruction sets are chosen when a program runs (Highway's targets, functions with
a target attribute), so that no command may request one from the compiler. Otherwise an older processor would abort the
program at its first such instruction."""
import json
import re
import shlex
import sys

# -march=..., -mtune=... (harmless by itself, but usually combined with the former), -mavx2, -msse4.1, -mfma, -mbmi2, -maes ...
OF_A_PROCESSOR = re.compile(r"-m(arch|cpu|tune)=|-m(avx|sse|ssse|fma|bmi|f16c|aes|pclmul|popcnt|lzcnt|movbe|amx)|-x[A-Z]")


def main():
    commands = json.load(open(sys.argv[1]))
    if len(commands) < 100:
        sys.exit(f"check_instructions: {sys.argv[1]} has {len(commands)} commands only; is it the right file?")
    wrong = {}
    for entry in commands:
        words = entry.get("arguments") or shlex.split(entry["command"])
        for word in words:
            if OF_A_PROCESSOR.match(word):
                wrong.setdefault(word, []).append(entry["file"])
    for word, files in sorted(wrong.items()):
        print(f"{word} is asked of the compiler for {len(files)} files, such as {files[0]}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
