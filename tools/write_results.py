#!/usr/bin/env python3
"""write_results.py [--check]: docs/results.md from the files docs/results/*.json, one section each.

A section is a JSON object:

    "title"     heading
    "order"     number; sections are sorted by it, then by file name (default 100)
    "text"      Markdown below the heading: what was measured, and what to make of it
    "note"      Markdown below the text, written by hand: what the tool that writes the file cannot know
    "entries", "real"   of tools/run_benchmark.py: by name {"frames", "commit", "date", "machine", ...}, one
                        row each; they have an origin of their own, so that of the section is not shown
    "command"   line or list of lines that measure it again
    "commit", "date", "machine"   of the measurement
    "tables"    list of {"heading" (optional), "text" (optional), "columns": [...], "rows": [[...], ...]};
                for one table "columns" and "rows" may stand in the object itself

Cells are strings (as they are), whole numbers, other numbers (three significant digits) or null (-).
Further keys are for whoever reads the JSON. --check compares and writes nothing.
"""
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SECTIONS = ROOT / "docs/results"
OUTPUT = ROOT / "docs/results.md"

HEAD = """\
# Results

Measured, not promised: figures that are bad stand here too. This page is written by
`tools/write_results.py` from `docs/results/*.json`; what the scores mean is in
[benchmark.md](benchmark.md).
"""


def cell(value):
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return f"{float(f'{value:.3g}'):g}"
    return str(value).replace("|", "\\|").replace("\n", " ")


def table(columns, rows, where):
    for row in rows:
        if len(row) != len(columns):
            sys.exit(f"write_results: {where}: {len(row)} cells under {len(columns)} columns: {row}")
    lines = ["| " + " | ".join(map(str, columns)) + " |", "|" + "---|" * len(columns)]
    return "\n".join(lines + ["| " + " | ".join(map(cell, row)) + " |" for row in rows]) + "\n"


def section(path):
    try:
        content = json.loads(path.read_text())
    except json.JSONDecodeError as error:
        sys.exit(f"write_results: {path}: {error}")
    if "title" not in content:
        sys.exit(f"write_results: {path}: has no title")
    parts = [f"## {content['title']}\n"]
    if content.get("text"):
        parts.append(content["text"].rstrip() + "\n")
    if content.get("note"):
        parts.append(content["note"].rstrip() + "\n")
    tables = list(content.get("tables", []))
    if "rows" in content:
        tables.insert(0, {"columns": content["columns"], "rows": content["rows"]})
    for one in tables:
        if one.get("heading"):
            parts.append(f"### {one['heading']}\n")
        if one.get("text"):
            parts.append(one["text"].rstrip() + "\n")
        parts.append(table(one["columns"], one["rows"], path.name))
    measured = [[name, *(entry.get(field) for field in ("frames", "commit", "date", "machine"))]
                for key in ("entries", "real")
                for name, entry in content.get(key, {}).items()]
    if measured:
        parts.append("### Measured at\n")
        parts.append(table(["sequence or recording", "frames", "commit", "date", "machine"], measured, path.name))
    commands = content.get("command", [])
    commands = [commands] if isinstance(commands, str) else commands
    origin = "" if measured else ", ".join(
        content[key] if key != "commit" else f"commit {content[key]}"
        for key in ("date", "commit", "machine") if content.get(key))
    if origin:
        parts.append(f"Measured: {origin}.\n")
    if commands:
        parts.append("\n".join("    " + line for line in commands) + "\n")
    return (content.get("order", 100), path.name), "\n".join(parts)


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    sections = sorted(section(path) for path in SECTIONS.glob("*.json"))
    page = "\n".join([HEAD, *(text for _, text in sections)])
    if sys.argv[1:] == ["--check"]:
        if not OUTPUT.is_file() or OUTPUT.read_text() != page:
            sys.exit(f"{OUTPUT.relative_to(ROOT)} is not what its JSON files say; run tools/write_results.py")
        return
    OUTPUT.write_text(page)
    print(f"{OUTPUT.relative_to(ROOT)}: {len(sections)} sections")


if __name__ == "__main__":
    main()
