#!/usr/bin/env python3
"""write_verification.py [PROGRAM | --texts]: docs/verification.md from what was measured.

Runs PROGRAM (default build/release/bin/verification_tests), collects its lines that begin with
VERIFICATION and writes them as tables between the texts below. Stops without writing when a test
fails or a table has no rows (CalculiX not installed, for instance). With --texts no test runs: the
tables of the tests stay as the page has them, and only the texts around them are written again.

What takes longer than a test may is read from docs/results, where a bench's --json output is kept:

    palpable bench elements --json > docs/results/elements.json
    palpable bench solid --verify --json > docs/results/solid.json
"""
import json
import math
import re
import statistics
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs/verification.md"

RESULTS = ROOT / "docs/results"

HEAD = """\
# Verification

This page compares the equilibrium solver (`solid`) with closed forms, manufactured solutions and CalculiX, and measures the error of the mesh.

* The solver gives the numbers of CalculiX on the same mesh, to the seven digits that CalculiX prints.
* It converges with the orders of theory, for all four laws and both elements.
* **The mesh error of the bunny exceeds its model error.** Meshes of 4-node tetrahedra, as the shipped bodies have, are too stiff, thin parts
  such as ears most of all: [4-node and 10-node tetrahedra on the bunny](#4-node-and-10-node-tetrahedra-on-the-bunny). The
  [model error](theory.md#model-error) does not include it. `order = 2` in a [description](body.md) reduces it.

The tests of `tests/verification` print the figures and hold them to the limits named here; `./check` runs them. Where a bench is named, the bench
prints them. `tools/write_verification.py` writes this page. Patch tests, derivative tests, objectivity and balance of forces are unit tests of
`src/palpable/bake/solid`. Contact with rigid obstacles, against Hertz and CalculiX (`palpable bench obstacle`),
Cattaneo and Mindlin, the capstan and CalculiX (`palpable bench friction`):
[the decision's record](decisions/full-order-contact.md).

Errors are relative to the reference. u is displacement; J is the volume ratio of an element.
"""

# table of the tests' output -> heading and text of its section
SECTIONS = {
    "calculix": ("CalculiX on the same mesh and loads", """\
Both programs solve the same tetrahedra (C3D4: 4 nodes, C3D10: 10) under the same dead loads to a residual of 1e-8, at every level of a path
from rest. Differences are the largest over nodes (displacement) or integration points (Cauchy stress), relative to the largest value of that
level; the table shows the worst level. Limits: 1e-6 and 1e-5. The remaining difference is the rounding of CalculiX' printed output.

Decks avoid two thresholds of ccx 2.20 by their choice of units (`src/palpable/bake/calculix/calculix.h`): it takes any residual below 1e-6 in the
deck's unit of force for zero, and a `D1` below 1e-10 in the deck's unit for missing.
"""),
    "uniaxial": ("A cube in uniaxial strain", """\
A unit cube is stretched to 1.5 with its sides held. Columns: the axial force in N. St. Venant-Kirchhoff with E = 1000 Pa, nu = 0.3; the Abaqus form
with C10 = 200 Pa, D1 = 0.001 / Pa. "ours" is the sum of the nodal forces, CalculiX' value its printed stress.
"""),
    "manufactured": ("Manufactured solutions", """\
A smooth displacement with strains of tens of per cent is chosen on a pyramid without its top. Body force, traction on five faces and prescribed
displacement of the base follow from it. Theory: order 2 for u and 1 for grad u with 4-node elements, 3 and 2 with 10-node ones. The table has
the finest of three meshes, and the order from the one before. The sides rise by 45 degrees: where a held face meets free ones at 90 degrees,
the dual problem has a singular edge, and theory promises less.
"""),
    "elastica": ("The elastica", """\
A cantilever of 1 x 0.1 x 0.05 m (nu = 0, St. Venant-Kirchhoff) with a dead load at its tip, against the inextensible elastica without shear. Columns of
nodes: error of the tip's deflection w with 3, 4 and 6 cells over the height. **Linear tetrahedra are far too stiff in bending**: by 7 % with 6
cells over the height. Their limit is right: extrapolated with a parabola in h^2, w is held to 0.5 % and the shortening u to 1 %. Shear (0.15 %)
and stretching (0.2 % at the largest load) belong to the solid and not to the elastica.
"""),
    "elastica-quadratic": ("The elastica with 10-node tetrahedra", """\
The same beam with one (369 nodes) and with two elements over the height. With a sixteenth of the nodes of the finest linear mesh, the error is
that which the elastica leaves out. The limit is that of the linear meshes above.
"""),
    "cook": ("Cook's membrane", """\
A tapered panel (48 mm; 44 and 16 mm high) in plane strain, sheared by 1 N per mm of thickness; rise of the middle of its right edge.
mu = 422.5 kPa, nu = 0.3. The reference names neither its point nor the volumetric part of its law; those shown reproduce it. One layer of
elements, held in z at every node.
"""),
    "cook-quadratic": ("Cook's membrane with 10-node tetrahedra", """\
The same panel under the Abaqus form.
"""),
    "elements-coarse": ("4-node and 10-node tetrahedra on the same nodes", """\
A ball with two ears under patch loads (eq. (7), nu = 0.4), meshed coarsely. Its tetrahedra split in eight make 4-node tetrahedra with exactly the
nodes of the 10-node ones. Errors against 10-node tetrahedra on the split mesh under the same traction field; displacement and von Mises stress
in the relative L2 norm. "At nodes": as recovered (`solid/stress_recovery.h`), against the mean of the reference's own elements there. The test holds
10-node tetrahedra to 0.6 of the errors of 4-node ones in press and displacement, and to 0.7 in von Mises stress in the elements.
"""),
}


def rows_of(text):
    tables = {}
    for line in text.splitlines():
        if line.startswith("VERIFICATION\t"):
            _, table, *cells = line.split("\t")
            tables.setdefault(table, []).append(dict(cell.split("=", 1) for cell in cells))
    return tables


def markdown(rows):
    columns = list(rows[0])
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(row[column] for column in columns) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def wrapped(text):
    """Paragraphs and list items in lines of 120 characters; headings and tables as they are."""
    blocks = []
    for block in text.split("\n\n"):
        items = re.split(r"\n(?=\* )", block)
        keeps = block.lstrip("\n").startswith(("|", "#"))
        blocks.append(block if keeps else "\n".join(
            textwrap.fill(" ".join(item.split()), 120, subsequent_indent="  " if item.startswith("* ") else "",
                          break_long_words=False, break_on_hyphens=False) for item in items))
    return "\n\n".join(blocks)


def percent(value, digits=1):
    return "-" if value is None else f"{100 * value:.{digits}f} %"


def signed_percent(value):
    return "-" if value is None else f"{100 * value:+.1f} %"


def seconds(value):
    return f"{value:.3g} s"


def median_of(rows, mesh, quantity):
    """Median over the rows that have it of the errors' absolute values; the sign is that of their median."""
    values = [row["errors"][mesh][quantity] for row in rows if mesh in row["errors"]]
    values = [value for value in values if value is not None]
    return statistics.median(values) if values else None


def cost_of(mesh):
    """CPU time of one path, set-up included: the median over the sites."""
    return mesh["setup_cpu_s"] + statistics.median(mesh["path_cpu_s"])


def at_cost(cost, coarse, fine):
    """Error at `cost`, linear in logarithms between two (cost, error)."""
    along = math.log(cost / coarse[0]) / math.log(fine[0] / coarse[0])
    size = abs(coarse[1]) * abs(fine[1] / coarse[1]) ** along
    return math.copysign(size, coarse[1])


def elements_section(results):
    """Accuracy of the elements for the paper's bunny: text and tables."""
    nested, direct = results["nested"], results["direct"]
    meshes = {mesh["name"]: mesh for mesh in nested["meshes"]}
    own = {mesh["name"]: mesh for mesh in direct["meshes"]}
    shares = sorted({row["share"] for row in nested["presses"] if row["share"] > 0})
    nu = nested["presses"][0]["poisson"]

    def rows_at(study, share, poisson=nu):
        return [row for row in study["presses"] if row["share"] == share and row["poisson"] == poisson]

    text = [f"""\
Measured on {results["date"]} by `{results["command"]}` ({results["wall_s"] / 60:.0f} minutes).
The body is `{results["description"]}` with an edge of {1e3 * results["edge_m"]:g} mm, {results["law"]}, full press {1e3 * results["full_press_m"]:.0f} mm = 10 % of the height.

A coarse mesh of the body ({meshes["4-node, coarse"]["nodes"]} nodes) is given edge nodes ("10-node") and is split, each tetrahedron into eight
("4-node"). Both have the same {meshes["10-node"]["nodes"]} nodes, fill the same polyhedron and are held at the same faces. The reference is the split mesh with
edge nodes, {meshes["reference"]["nodes"]} nodes. The traction is that of a patch of graph distance 2 on the split mesh's skin, the same field on all meshes.
Loads are those that press the 10-node mesh by the share of the full press.

Columns: error of the press (below zero: too stiff), of displacement and of von Mises stress in the elements (L2 norms over the body), and of von
Mises stress as recovered at nodes (`solid/stress_recovery.h`).
"""]

    table = []
    for share in shares:
        for row in rows_at(nested, share):
            site = nested["sites"][row["site"]]
            entry = {"site": str(row["site"]),
                     "height": f"{100 * site['height']:.0f} %",
                     "press": f"{share:g}",
                     "reference": "-" if row["press_m"] is None else f"{1e3 * row['press_m']:.2f} mm"}
            for mesh in ("4-node", "10-node"):
                errors = row["errors"][mesh]
                entry[f"{mesh}: press"] = signed_percent(errors["press"])
                entry[f"{mesh}: u"] = percent(errors["displacement"])
                entry[f"{mesh}: von Mises"] = percent(errors["element_von_mises"])
            table.append(entry)
    text.append(f"Each site, nu = {nu}; its height in per cent of the body's; the share of the full press:\n")
    text.append(markdown(table))
    for study in (nested, direct):
        for row in study["presses"]:
            if row["why_stopped"]:
                text.append(f"Site {row['site']}, share {row['share']:g}: the reference stops: {row['why_stopped']}\n")

    share = shares[-1]
    costs = {name: cost_of(mesh) for name, mesh in meshes.items() if mesh["path_cpu_s"]}
    quantities = ("press", "displacement", "element_von_mises", "nodal_von_mises")

    def line(label, nodes, cost, errors):
        return {"mesh": label, "nodes": nodes, "CPU of a path": cost, "press": signed_percent(errors[0]),
                "u": percent(errors[1]), "von Mises": percent(errors[2]), "at nodes": percent(errors[3])}

    table = []
    for name in ("4-node, coarse", "4-node", "10-node", "4-node, fine"):
        rows = rows_at(nested, share)
        table.append(line(name, str(meshes[name]["nodes"]), seconds(costs[name]),
                          [median_of(rows, name, q) for q in quantities]))
    cost = costs["10-node"]
    ends = ("4-node", "4-node, fine") if cost >= costs["4-node"] else ("4-node, coarse", "4-node")
    equal = []
    for q in quantities:
        coarse, fine = (median_of(rows_at(nested, share), name, q) for name in ends)
        equal.append(None if coarse is None or fine is None
                     else at_cost(cost, (costs[ends[0]], coarse), (costs[ends[1]], fine)))
    table.append(line("4-node at the cost of 10-node", f"between {meshes[ends[0]]['nodes']} and {meshes[ends[1]]['nodes']}",
                      seconds(cost), equal))
    table.append(line("4-node, the body's own mesh (other reference)", str(own["4-node"]["nodes"]),
                      seconds(cost_of(own["4-node"])),
                      [median_of(rows_at(direct, share), "4-node", q) for q in quantities]))
    text.append(f"""\
Medians over the sites at {share:g} of the full press. CPU of a path: the solver with its factor, and the presses of
{", ".join(f"{s:g}" for s in shares)} of the full one; the median of the sites. The row at the same cost lies between two meshes, on a straight
line in logarithms. The last row is the mesh that the description makes ({own["4-node"]["nodes"]} nodes), against itself with edge nodes
({own["reference"]["nodes"]}).
""")
    text.append(markdown(table))

    table = []
    for poisson in sorted({row["poisson"] for row in nested["presses"]}):
        entry = {"nu": f"{poisson:g}"}
        for label, study, mesh in (("4-node", nested, "4-node"), ("10-node", nested, "10-node"),
                                   ("4-node, the body's own mesh", direct, "4-node")):
            values = sorted(row["errors"][mesh]["press"] for row in rows_at(study, 0, poisson))
            entry[label] = " / ".join(signed_percent(v) for v in
                                      (values[-1], statistics.median(values), values[0]))
        table.append(entry)
    text.append(f"""\
The response to a small load (a hundredth of the full press) of {len(nested["sites"])} sites: error of the press, least / median / greatest.
""")
    text.append(markdown(table))
    return "\n".join(text)


def solid_section(results):
    """The full-size comparison with CalculiX: text and table."""
    rows = [{"body": f"bunny, site {row['site']}", "law": results["law"], "nodes": str(results["nodes"]),
             "tets": f"{results['tets']} C3D4", "levels": str(results["levels"]),
             "press": percent(row["press_fraction"]), "smallest J": f"{row['smallest_volume_ratio']:.2f}",
             "difference of u": f"{row['max_rel_difference_u']:.1e}",
             "difference of stress": f"{row['max_rel_difference_stress']:.1e}"} for row in results["sites"]]
    rows += [{"body": row["body"], "law": row["law"], "nodes": str(row["nodes"]),
              "tets": f"{row['tets']} {row['element']}", "levels": str(row["levels"]), "press": "",
              "smallest J": f"{row['smallest_volume_ratio']:.2f}",
              "difference of u": f"{row['max_rel_difference_u']:.1e}",
              "difference of stress": f"{row['max_rel_difference_stress']:.1e}"}
             for row in results.get("verified", [])]
    return f"""\
The same comparison on meshes of full size, at every level, measured on {results["date"]} by
`{results["command"]}`. With `--verify` it ends with exit code 1 if the limits do not hold. Press: share of the height.

""" + markdown(rows)


# file in docs/results -> heading, and who makes its text
MEASURED = {
    "solid": ("CalculiX on meshes of full size", solid_section),
    "elements": ("4-node and 10-node tetrahedra on the bunny", elements_section),
}


def finest(table, rows):
    """The rows that the page shows: of the manufactured solutions those of the finest meshes, else all."""
    return list({(row["law"], row["element"]): row for row in rows}.values()) if table == "manufactured" else rows


def tables_of_page():
    """The tables of the tests as the page has them."""
    sections = dict(section.split("\n", 1) for section in OUTPUT.read_text().split("\n## ")[1:])
    return {name: "\n".join(line for line in sections[heading].split("\n") if line.startswith("|")) + "\n"
            for name, (heading, _) in SECTIONS.items()}


def tables_of_tests(program):
    if not program.is_file():
        sys.exit(f"write_verification: {program} is not there; build the target verification_tests")
    run = subprocess.run([program.resolve()], cwd=ROOT, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"write_verification: tests fail; nothing written\n{run.stdout[-3000:]}")
    tables = rows_of(run.stdout)
    skipped = [line for line in run.stdout.splitlines() if line.startswith("SKIPPED")]
    wrong = set(SECTIONS) ^ set(tables)
    if wrong:
        sys.exit(f"write_verification: no text or no rows for {sorted(wrong)}; nothing written\n" +
                 "\n".join(skipped))
    return {name: markdown(finest(name, rows)) for name, rows in tables.items()}


def main():
    if len(sys.argv) > 2 or sys.argv[1:] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    if sys.argv[1:] == ["--texts"]:
        tables = tables_of_page()
    else:
        tables = tables_of_tests(Path(sys.argv[1]) if len(sys.argv) == 2 else ROOT / "build/release/bin/verification_tests")
    parts = [HEAD]
    for name, (heading, text) in SECTIONS.items():
        parts.append(f"## {heading}\n\n{text}\n{tables[name]}")
    for name, (heading, section) in MEASURED.items():
        file = RESULTS / f"{name}.json"
        if not file.is_file():
            print(f"write_verification: no {file.relative_to(ROOT)} (see --help), so no section about it", file=sys.stderr)
            continue
        parts.append(f"## {heading}\n\n{section(json.loads(file.read_text()))}")
    OUTPUT.write_text(wrapped("\n".join(parts)).rstrip("\n") + "\n")
    print(f"{OUTPUT.relative_to(ROOT)}: {len(tables)} tables of tests")


if __name__ == "__main__":
    main()
