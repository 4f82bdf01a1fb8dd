#!/usr/bin/env python3
"""web_accuracy.py WEB.palpable FULL.palpable: how far a page's smaller tables and the full ones are from finite elements.

WEB.palpable is baked from bodies/bunny-web.toml, FULL.palpable from bodies/bunny-demo.toml. `palpable bench touch` presses
each at random places, which neither bake has seen, and solves the same contact by finite elements on the mesh of the
tables. What is printed is a table in Markdown: error of displacement, force and stress (relative L2 over the skin; of the
force: of its size), median over the scenes. The mesh's own error is in neither: docs/verification.md has that."""
import argparse
import json
import subprocess

DESCRIPTIONS = {"web": "bodies/bunny-web.toml", "full": "bodies/bunny-demo.toml"}
FIGURES = (("displacement", "u_median"), ("force", "force_median"), ("stress", "vm_median"))


def measured(program, description, body, each, seed):
    """The JSON of `palpable bench touch`, with the tables of a body file."""
    words = [program, "bench", "touch", description, "--baked", body, "--each", str(each), "--seed", str(seed), "--json"]
    return json.loads(subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("web", help="body file of bodies/bunny-web.toml")
    parser.add_argument("full", help="body file of bodies/bunny-demo.toml")
    parser.add_argument("--program", default="build/release/bin/palpable")
    parser.add_argument("--each", type=int, default=20, help="scenes of each thing (default: 20)")
    parser.add_argument("--seed", type=int, default=1, help="of the scenes (default: 1)")
    options = parser.parse_args()
    results = {name: measured(options.program, description, getattr(options, name), options.each, options.seed)
               for name, description in DESCRIPTIONS.items()}
    print("| | deep | " + " | ".join(f"{figure}, {name}" for figure, _ in FIGURES for name in results) + " |")
    print("|---" * (2 + len(FIGURES) * len(results)) + "|")
    for thing in ("finger", "palm", "hand"):
        for depth in ("2.5", "5", "10"):
            at = {name: result[thing][f"at_{depth}mm"] for name, result in results.items()}
            figures = [f"{100 * at[name][key]:.1f} %" for _, key in FIGURES for name in results]
            print(f"| {thing} | {depth} mm | {' | '.join(figures)} |")
    for name, result in results.items():
        print(f"\n{name}: {result['nodes']} nodes, {result['vertices']} vertices, tables of {result['table_mb']:.1f} MB, "
              f"{result['finger']['at_5mm']['scenes']} scenes of each thing, seed {result['seed']}", end="")
        print(f"; stopped: {result['truth_stopped']}" if result["truth_stopped"] else "")


if __name__ == "__main__":
    main()
