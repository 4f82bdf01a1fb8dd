#!/usr/bin/env python3
"""write_verification.py [PROGRAM]: docs/verification.md from what the verification tests measure.

Runs PROGRAM (default build/release/bin/verification_tests), collects its lines that begin with
VERIFICATION and writes them as tables between the texts below. Stops without writing when a test
fails or a table has no rows (CalculiX not installed, for instance).
"""
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs/verification.md"

HEAD = """\
# Verification

How far the equilibrium solver (`solid`) is from what is known without it. All figures are printed by
the tests of `tests/verification`, which `./check` runs and which hold them to the bars named here;
`tools/write_verification.py` writes this page from their output. Patch tests, derivative tests,
objectivity and balance of forces are unit tests of `src/palpable/solid`.
"""

# table of the tests' output -> heading and text of its section
SECTIONS = {
    "calculix": ("CalculiX on the same mesh and loads", """\
Both programs solve the same tetrahedra (C3D4: 4 nodes, C3D10: 10) under the same dead loads to a residual of 1e-8,
at every level of a path from rest. Differences are the largest over nodes (displacement) or
integration points (Cauchy stress), relative to the largest value of that level; the worst level is shown. Bars: 1e-6 and
1e-5. What is left is the rounding of CalculiX' printed output, seven digits.

Two things had to be known to get there (`src/palpable/bake/calculix.h`): ccx 2.20 takes any residual
below 1e-6 in the deck's own unit of force for zero, and a `D1` below 1e-10 in the deck's own unit for
missing. Decks are written in units that keep clear of both.
"""),
    "uniaxial": ("A cube in uniaxial strain", """\
A unit cube stretched to 1.5 with its sides held; axial force in N. St. Venant-Kirchhoff with E = 1000 Pa,
nu = 0.3; the Abaqus form with C10 = 200 Pa, D1 = 0.001 / Pa. Ours is the sum of the nodal forces,
CalculiX' its printed stress.
"""),
    "manufactured": ("Manufactured solutions", """\
A smooth displacement with strains of tens of percent is chosen on a pyramid without its top; body
force, traction on five faces and prescribed displacement of the base follow from it. Errors are
relative. Theory: order 2 for u and 1 for grad u with 4-node elements, 3 and 2 with 10-node ones.

The sides rise by 45 degrees on purpose. On a cube, where the held face meets free ones at 90 degrees,
the order of u was 1.4 to 1.7: the dual problem has a singular edge there.
"""),
    "elastica": ("The elastica", """\
A cantilever of 1 x 0.1 x 0.05 m (nu = 0, St. Venant-Kirchhoff) with a dead load at its tip, against the
inextensible elastica without shear. Columns of nodes: error of the tip's deflection w with 3, 4 and 6
cells over the height. **Linear tetrahedra are far too stiff in bending** (7 % with 6 cells over the
height); what they converge to is right: extrapolated with a parabola in h^2, w is held to 0.5 % and the
shortening u to 1 %. Shear (0.15 %) and stretching (0.2 % at the largest load) belong to the solid and
not to the elastica.
"""),
    "elastica-quadratic": ("The elastica with 10-node tetrahedra", """\
The same beam with one (369 nodes) and with two elements over the height. **With a sixteenth of the
nodes of the finest linear mesh, they are right to what the elastica leaves out**: they tend to the same
limit as the linear meshes extrapolated above.
"""),
    "cook": ("Cook's membrane", """\
Tapered panel (48 mm; 44 and 16 mm high) in plane strain, sheared by 1 N per mm of thickness; rise of the
middle of its right edge. mu = 422.5 kPa, nu = 0.3. The reference states neither its point nor the
volumetric part of its law; those shown reproduce it. One layer of elements, held in z at every node.
CalculiX' 20-node bricks (C3D20, 32 x 32, NEO HOOKE; run once by hand) give 14.727 mm at that point.
"""),
    "cook-quadratic": ("Cook's membrane with 10-node tetrahedra", """\
The same panel under the Abaqus form.
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


def main():
    if len(sys.argv) > 2 or sys.argv[1:] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    program = Path(sys.argv[1]) if len(sys.argv) == 2 else ROOT / "build/release/bin/verification_tests"
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
    parts = [HEAD]
    for name, (heading, text) in SECTIONS.items():
        parts.append(f"## {heading}\n\n{text}\n{markdown(tables[name])}")
    OUTPUT.write_text("\n".join(parts))
    print(f"{OUTPUT.relative_to(ROOT)}: {sum(map(len, tables.values()))} rows in {len(tables)} tables")


if __name__ == "__main__":
    main()
