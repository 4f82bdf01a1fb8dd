#!/usr/bin/env python3
"""live_results.py BENCH.json [--note TEXT]: docs/results/live.json from what `palpable bench live --json` printed.

To be run where the bench ran, right after it: machine, day and commit are taken from there. The bench's own
figures stay in the file; tools/write_results.py makes a section of docs/results.md of it.
"""
from pathlib import Path

from bench_section import write_section
from run_benchmark import origin


def section_of(figures):
    source = figures["source"] if "/" not in figures["source"] else "/".join(Path(figures["source"]).parts[-2:])
    return {
        "title": "The live loop, stage by stage", "order": 28,
        "text": f"{figures['frames']} frames of `{source}`, the body {figures['body']} ({figures['vertices']} vertices), drawn by "
                f"{figures['renderer'].split(' (')[0]}: **{figures['wall_ms_per_frame']:.3g} ms of wall time a frame**. A frame is "
                "seen on one thread while the one before is followed, answered and drawn on another, so the stages add up to more.",
        "command": ["palpable bench live BODY --source FRAMES --json > bench.json", "tools/live_results.py bench.json",
                    "tools/write_results.py"],
        **origin(),
        "columns": ["stage", "median (ms)", "99 of 100 (ms)", "frames"],
        "rows": [[name, stage["p50_ms"], stage["p99_ms"], stage["count"]] for name, stage in figures["stages"].items()]}


if __name__ == "__main__":
    write_section(__doc__, "live.json", section_of)
