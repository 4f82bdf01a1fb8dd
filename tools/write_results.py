#!/usr/bin/env python3
"""write_results.py [--check]: docs/results.md and docs/lab/results.md from docs/results/*.json, one section for each file.

A section is a JSON object:

    "title"     heading
    "order"     number; sections are sorted by it, then by file name (default 100)
    "text"      Markdown below the heading: what was measured, and what to make of it
    "note"      Markdown below the text, written by hand: what the tool that writes the file cannot know
    "page"      "lab": the section belongs to docs/lab/results.md
    "lab_text"  Markdown for docs/lab/results.md: earlier runs, details
    "entries", "real"   of tools/run_benchmark.py; tools/chain_tables.py makes the tables
    "command"   line or list of lines that measure it again
    "commit", "date", "machine"   of the measurement
    "tables"    list of {"heading", "text", "folded", "lab": each may be missing, "columns": [...], "rows": [[...], ...]};
                for one table "columns" and "rows" may stand in the object itself. A folded table is shown when
                a reader clicks its text; one with "lab": true belongs to docs/lab/results.md

Cells are strings (as they are), whole numbers, other numbers (three significant digits), true and false, or null (-).
Further keys are for whoever reads the JSON. What the benches of the bake half print is arranged here: ARRANGED.
--check compares and writes nothing.
"""
import json
import re
import sys
import textwrap
from pathlib import Path

import chain_tables
from check_documents import slug

ROOT = Path(__file__).resolve().parent.parent
SECTIONS = ROOT / "docs/results"

HEAD = """\
# Results

Measured figures, good and bad. The films are synthetic and have a known truth, unless a recording is named. **No live
camera has been tried.** `-` means that there is no such figure. [benchmark.md](benchmark.md) defines the scores;
[lab/results.md](lab/results.md) has older runs and details.

"""
FOOT = """\
`tools/write_results.py` writes this page from `docs/results/*.json`.
"""
LAB_HEAD = """\
# Lab notes: results

Older runs and details behind [results.md](../results.md). `tools/write_results.py` writes this page, too.
"""


def cell(value):
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "**no**"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return f"{float(f'{value:.3g}'):g}"
    return str(value).replace("|", "\\|").replace("\n", " ")


def grid(columns, rows, where):
    for row in rows:
        if len(row) != len(columns):
            sys.exit(f"write_results: {where}: {len(row)} cells under {len(columns)} columns: {row}")
    lines = ["| " + " | ".join(map(str, columns)) + " |", "|" + "---|" * len(columns)]
    return "\n".join(lines + ["| " + " | ".join(map(cell, row)) + " |" for row in rows]) + "\n"


def wrapped(text):
    """Markdown with its paragraphs in lines of 120; tables stay."""
    return "\n\n".join(part if part.startswith("|") else textwrap.fill(part, 120, break_long_words=False, break_on_hyphens=False)
                       for part in text.strip().split("\n\n")) + "\n"


def table(one, where):
    parts = [f"### {one['heading']}\n"] if one.get("heading") else []
    if one.get("text"):
        parts.append(wrapped(one["text"]))
    if one.get("columns"):
        text = grid(one["columns"], one["rows"], where)
        folded = one.get("folded")
        parts.append(f"<details><summary>{folded}</summary>\n\n{text}\n</details>\n" if folded else text)
    return parts


def split_paper(content):
    """The examples of the paper: its headline rows; long ones are folded."""
    long = re.compile(r"modes|film written|Algorithm 1")
    rows = content.pop("rows")
    head = [["shown with a live camera and hands", "yes", "no: synthetic films, recorded hands", ""]]
    content["tables"] = [
        {"columns": content["columns"], "rows": head + [row for row in rows if not long.search(row[0])]},
        {"folded": "Modes, errors, films written to disk, Algorithm 1", "columns": content["columns"], "rows": [row for row in rows if long.search(row[0])]}]
    content["text"] = ("The paper prints the figures of the second column; `palpable reproduce` measures those of the third. Some rows compare "
                       "unlike things. The paper's 30 frames/s are its camera's rate; ours are pictures from memory, with one touch at a site. "
                       "Its 34 minutes are Abaqus's on another machine, and it does not print the material's constants; "
                       "[CalculiX on the same mesh](#an-equilibrium-path-against-calculix) is a better comparison. The bodies of this table are "
                       "pressed at their sites: a body that can be touched anywhere takes longer to bake ([touch.md](touch.md)).")


def split_track(content):
    """Figures of bench track: those with a target; all are folded."""
    longer = {"the same without the mask": None, "frames lost, of all": "kitchen: frames lost, of all", "frames lost": "street: frames lost",
              "frames lost, of every sixth": "kitchen: frames lost, of every sixth", "ours by OpenCV's": "kitchen, 400 frames: ATE by that of OpenCV's odometry",
              "every 2nd, 3rd and 4th pair: frames lost": "street, every 2nd, 3rd and 4th pair: frames lost"}
    rows = content.pop("rows")
    content["tables"] = [
        {"columns": ["figure", "target", "measured", "met"],
         "rows": [[longer.get(what, what), f"at most {target}", value, value <= float(target)] for what, value, target in rows if target != "-"]},
        {"folded": "All figures", "columns": ["figure", "measured", "target"], "rows": rows}]
    content["text"] = ("`bench track`, seed 1. The kitchen is of 7-Scenes, the street of KITTI (60 m). Parameters were tuned on these recordings: take "
                       "the results as training errors. Other programs ran, so times are CPU times. OpenCV's RGB-D odometry finds "
                       "hardly any motion on the street and is no baseline there. [tracking.md](tracking.md) and [map.md](map.md) describe the methods.")


def split_solid(content):
    """Our solver beside CalculiX: one row for each kind of element; each path is folded, details are in the lab."""
    rows = [["bunny, 4-node tetrahedra, median of 3 sites", content["nodes"], content["levels"], content["path_cpu_s"], content["ccx_cpu_s"],
             content["ratio_to_ccx"], content["max_rel_difference_u"]]]
    for one in content["verified"]:
        element = "" if "node" in one["body"] else ", 4-node tetrahedra"
        rows.append([one["body"] + element, one["nodes"], one["levels"], one["cpu_s"], one["ccx_cpu_s"], one["ratio_to_ccx"], one["max_rel_difference_u"]])
    each, *details = content["tables"]
    content["lab_text"] = content.pop("text") + "\n\n" + content.pop("note", "")
    content["tables"] = [{"columns": ["body", "nodes", "levels", "Palpable, CPU s", "CalculiX, CPU s", "ratio", "largest difference of u, relative"], "rows": rows},
                         {"folded": "Each site", **each}, *({**one, "lab": True} for one in details)]
    ratios = [row[5] for row in rows]
    content["text"] = (f"Equilibrium paths on the same mesh, law and loads: CalculiX takes {min(ratios):.0f} to {max(ratios):.0f} times as long. Both "
                       f"programs have one thread and stop at a residual of {content['residual']:g}. CalculiX is Debian 12's 2.20, which solves with SPOOLES, "
                       "in one increment for each level. Our time includes set-up and factor; the search for the load is in neither. Measured "
                       "once, on an idle machine.")


def arrange_chain(content, fresh):
    entries, real = content["entries"], content.get("real", {})
    content["tables"] = list(chain_tables.held_out_tables(entries) if fresh else chain_tables.tables(entries, real))
    if fresh:
        sequences = dict.fromkeys(map(chain_tables.sequence_of, entries))
        content["text"] = (f"Films of `palpable synth` with seeds that were not used for tuning, played by `palpable live` and scored by "
                           f"`palpable score`. Sequences: {', '.join(f'`{name}`' for name in sequences)}.")


ARRANGED = {
    "chain.json": lambda content: arrange_chain(content, False),
    "chain-fresh.json": lambda content: arrange_chain(content, True),
    "paper.json": split_paper, "track.json": split_track, "solid.json": split_solid,
}
ORDER = {"chain-fresh.json": 10, "chain.json": 20, "live.json": 28, "paper.json": 29, "reference.json": 90}


def read(path):
    try:
        content = json.loads(path.read_text())
    except json.JSONDecodeError as error:
        sys.exit(f"write_results: {path}: {error}")
    if "title" not in content:
        sys.exit(f"write_results: {path}: has no title")
    ARRANGED.get(path.name, lambda content: None)(content)
    content["name"] = path.name
    if "rows" in content:
        content.setdefault("tables", []).insert(0, {"columns": content["columns"], "rows": content["rows"]})
    return ORDER.get(path.name, content.get("order", 100)), path.name, content


def section(content, lab):
    """The section's part of one of the two pages, or ""."""
    whole = content.get("page") == "lab"
    tables = [part for one in content.get("tables", []) if (whole or bool(one.get("lab"))) == lab for part in table(one, content["name"])]
    texts = [content.get(key) for key in (("text", "note") if whole == lab else ())]
    if lab:
        texts = [*(texts if whole else []), content.get("lab_text")]
    parts = [wrapped(text) for text in texts if text] + tables
    if not parts or (whole and not lab):
        return ""
    commands = content.get("command", [])
    commands = [commands] if isinstance(commands, str) else commands
    origin = "" if content.get("entries") else ", ".join(
        content[key] if key != "commit" else f"commit {content[key]}" for key in ("date", "commit", "machine") if content.get(key))
    if origin and (whole or not lab):
        parts.append(f"Measured: {origin}.\n")
    if commands and (whole or not lab):
        parts.append("\n".join("    " + line for line in commands) + "\n")
    return "\n".join([f"## {content['title']}\n", *parts])


def pages():
    sections = [content for _, _, content in sorted((read(path) for path in SECTIONS.glob("*.json")), key=lambda one: one[:2])]
    texts = {content["title"]: text for content in sections if (text := section(content, False))}
    contents = " ·\n".join(f"[{title}](#{slug(title)})" for title in texts) + "\n"
    return {ROOT / "docs/results.md": "\n".join([HEAD + contents, *texts.values(), FOOT]),
            ROOT / "docs/lab/results.md": "\n".join([LAB_HEAD, *filter(None, (section(content, True) for content in sections))])}


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    for page, text in pages().items():
        if sys.argv[1:] == ["--check"]:
            if not page.is_file() or page.read_text() != text:
                sys.exit(f"{page.relative_to(ROOT)} is not what its JSON files say; run tools/write_results.py")
            continue
        page.parent.mkdir(exist_ok=True)
        page.write_text(text)
        print(f"{page.relative_to(ROOT)}: {len(text.split())} words")


if __name__ == "__main__":
    main()
