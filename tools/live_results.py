#!/usr/bin/env python3
"""live_results.py BENCH.json [--note TEXT]: docs/results/live.json from what `palpable bench live --json` printed.

To be run where the bench ran, right after it: machine, day and commit are taken from there. The bench's own
figures stay in the file; tools/write_results.py makes a section of docs/results.md of it.
"""
import argparse
import json
from pathlib import Path

from run_benchmark import origin

OUTPUT = Path(__file__).resolve().parent.parent / "docs/results/live.json"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bench", type=Path)
    parser.add_argument("--note")
    options = parser.parse_args()
    figures = json.loads(options.bench.read_text())
    source = figures["source"] if "/" not in figures["source"] else "/".join(Path(figures["source"]).parts[-2:])
    section = {
        "title": "The live loop, stage by stage", "order": 28,
        "text": f"{figures['frames']} frames of `{source}`, the body {figures['body']} ({figures['vertices']} vertices), drawn by "
                f"{figures['renderer'].split(' (')[0]}: **{figures['wall_ms_per_frame']:.3g} ms of wall time a frame**. A frame is "
                "seen on one thread while the one before is followed, answered and drawn on another, so the stages add up to more.",
        "command": ["palpable bench live BODY --source FRAMES --json > bench.json", "tools/live_results.py bench.json",
                    "tools/write_results.py"],
        **origin(),
        "columns": ["stage", "median (ms)", "99 of 100 (ms)", "frames"],
        "rows": [[name, stage["p50_ms"], stage["p99_ms"], stage["count"]] for name, stage in figures["stages"].items()],
        "figures": figures}
    if options.note:
        section["note"] = options.note
    OUTPUT.write_text(json.dumps(section, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
