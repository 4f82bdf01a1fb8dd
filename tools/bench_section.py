"""Converts a benchmark's JSON to a section of docs/results.md: shared by reduce_results.py, beam_results.py and live_results.py."""
import argparse
import json
from pathlib import Path

from write_results import SECTIONS


def write_section(doc, name, section_of):
    """The command line `BENCH.json [--note TEXT]`: writes docs/results/NAME from section_of(figures).

    The benchmark's own figures stay in the file; the first line of `doc` is the help.
    """
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("bench", type=Path)
    parser.add_argument("--note")
    options = parser.parse_args()
    figures = json.loads(options.bench.read_text())
    section = {**section_of(figures), "figures": figures}
    if options.note:
        section["note"] = options.note
    (SECTIONS / name).write_text(json.dumps(section, indent=1, ensure_ascii=False) + "\n")
