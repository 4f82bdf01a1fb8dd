#!/usr/bin/env python3
"""Surfaces, decks and fields as people have them: wound the other way, corners apart by rounding, faces twice, decks in several
files, units of other countries; and what stays refused, with what to do about it."""
import random
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from campaigns import vtu_arrays
from strangers_readers import cube_surfaces

base.CASES.clear()
case = base.case

MM = ("--unit", "mm")


def cube(folder):
    """The lines of a cube of 80 mm as OFF: header, corners, faces."""
    folder.mkdir(parents=True, exist_ok=True)
    cube_surfaces(folder)
    rows = (folder / "cube.off").read_text().strip().split("\n")
    return rows[:2], rows[2:10], rows[10:]


def write_off(path, corners, faces):
    path.write_text("\n".join(["OFF", f"{len(corners)} {len(faces)} 0", *corners, *faces]) + "\n")
    return path


def turned(face):
    count, a, b, c = face.split()
    return f"{count} {a} {c} {b}"


def mesh(programs, surface):
    """Fills a surface. @return what is said, and the mesh's bytes"""
    said = programs.succeeds("mesh", surface, "-o", surface.with_suffix(".msh"), *MM).stderr
    return said, surface.with_suffix(".msh").read_bytes()


@case("faces wound the other way are turned, and their volume is said, and a clean surface is not touched")
def _(programs, folder):
    _, corners, faces = cube(folder)
    said, clean = mesh(programs, folder / "cube.off")
    assert "repaired" not in said, said
    for name, inverted in (("half", [turned(f) if k % 2 else f for k, f in enumerate(faces)]), ("all", [turned(f) for f in faces])):
        said, found = mesh(programs, write_off(folder / f"{name}.off", corners, inverted))
        assert f"{name}.off: repaired: " in said and "of 12 faces turned, which now enclose a volume of 512000" in said, said
        # The reader numbers vertices in the order in which faces first name them. In "all" the first face is turned, so that
        # the vertices have other numbers, and the mesher places other nodes.
        assert name == "all" or found == clean, f"{name}: another mesh"


@case("corners that differ by rounding and faces that are there twice are mended, and their figures said")
def _(programs, folder):
    _, corners, faces = cube(folder)
    dice = random.Random(59)
    points = [[float(x) for x in row.split()] for row in corners]
    shaken = []
    for face in faces:
        for corner in face.split()[1:]:
            shaken.append(" ".join(repr(x + dice.uniform(-1e-3, 1e-3)) for x in points[int(corner)]))
    own = [f"3 {3 * k} {3 * k + 1} {3 * k + 2}" for k in range(len(faces))]
    said, _ = mesh(programs, write_off(folder / "shaken.off", shaken, own))
    assert "shaken.off: repaired: 28 vertices joined with others at most 0.00" in said, said
    said, twice = mesh(programs, write_off(folder / "twice.off", corners, [*faces, faces[3]]))
    assert "twice.off: repaired: 1 duplicate face left out" in said, said
    assert twice == (mesh(programs, folder / "cube.off"))[1]


@case("what is no mechanical fault of a surface is refused and names wrap")
def _(programs, folder):
    _, corners, faces = cube(folder)

    def second(offset):
        moved = [" ".join(str(float(x) + d) for x, d in zip(row.split(), offset)) for row in corners]
        return [*corners, *moved], [*faces, *("3 " + " ".join(str(int(v) + 8) for v in f.split()[1:]) for f in faces)]
    for name, offset, says in (("wall", (0, 0, 80), "edges of more than two triangles"),
                               ("edge", (80, 80, 0), "edge of more than two triangles"),
                               ("overlap", (40, 40, 40), "overlap")):
        off = write_off(folder / f"{name}.off", *second(offset))
        programs.refuses("mesh", off, "-o", folder / "x.msh", *MM, says=[f"{name}.off", says, "'wrap' in a body's description"])
    off = write_off(folder / "hole.off", corners, faces[1:])
    programs.refuses("mesh", off, "-o", folder / "x.msh", *MM, says=["3 open edges", "'wrap' in a body's description"])
    # Far from the origin, four digits would not tell two corners apart.
    far = [" ".join(str(float(x) + 4e6) for x in row.split()) for row in corners]
    programs.refuses("mesh", write_off(folder / "far.off", far, faces[1:]), "-o", folder / "x.msh", *MM,
                     says=["the first at (4.00004e+06, 4.00004e+06, 4e+06)"])


@case("an STL that is cut short or padded is refused by its counts")
def _(programs, folder):
    cube(folder)
    stl = b"solid part1".ljust(80) + (folder / "cube.stl").read_bytes()[80:]

    def refuses(content, *says):
        (folder / "part.stl").write_bytes(content)
        programs.refuses("mesh", folder / "part.stl", "-o", folder / "x.msh", *MM, says=["part.stl", *says])
    refuses(stl[:300], "12 triangles are announced, there is room for 4")
    refuses(stl[:70], "in its 70 bytes: it is cut short")
    refuses(stl + bytes(100), "12 triangles are announced, which end at byte 684, but 100 more bytes follow")
    refuses(b"solid part1\n", "has no facets")
    (folder / "solid.stl").write_bytes(stl)
    (folder / "LOUD.STL").write_text((folder / "text.stl").read_text().upper())
    (folder / "lines.obj").write_text((folder / "cube.obj").read_text().replace("f 1 3 4", "f 1 \\\n 3 4"))
    for name in ("solid.stl", "LOUD.STL", "lines.obj"):
        assert "80 x 80 x 80 mm" in mesh(programs, folder / name)[0], name


@case("a deck in several files is read, and an inverted mesh is turned and said")
def _(programs, folder):
    bar = base.write_bar(folder)
    deck = (folder / "bar.inp").read_text()
    programs.succeeds("solve", bar, "-o", folder / "whole.vtu")
    whole = (folder / "whole.vtu").read_bytes()
    at = deck.index("*ELEMENT")
    (folder / "parts").mkdir(exist_ok=True)
    (folder / "parts/nodes.inp").write_text(deck[:at])
    (folder / "bar.inp").write_text("*INCLUDE, INPUT=parts/nodes.inp\n" + deck[at:])
    programs.succeeds("solve", bar, "-o", folder / "parted.vtu")
    assert (folder / "parted.vtu").read_bytes() == whole
    (folder / "bar.inp").write_text("*INCLUDE, INPUT=lost.inp\n" + deck[at:])
    programs.refuses("solve", bar, "-o", folder / "x.vtu", says=["bar.inp: line 1: includes 'lost.inp': no such file"])
    (folder / "bar.inp").write_text("*INCLUDE, INPUT=bar.inp\n" + deck[at:])
    programs.refuses("solve", bar, "-o", folder / "x.vtu", says=["would include itself"])
    (folder / "bar.inp").write_text("*PART, NAME=Bar\n*END PART\n*PART, NAME=Tool\n" + deck)
    programs.refuses("solve", bar, "-o", folder / "x.vtu", says=["line 3: a second *PART, 'Tool', beside 'Bar'", "save the deck flat"])
    rows = deck.split("\n")
    first = next(k for k, row in enumerate(rows) if row.startswith("*ELEMENT")) + 1
    for k in range(first, len(rows)):
        if rows[k].startswith("*"):
            break
        number, a, b, c, d = rows[k].split(",")
        rows[k] = ",".join((number, a, b, d, c))
    (folder / "bar.inp").write_text("\n".join(rows))
    said = programs.succeeds("solve", bar, "-o", folder / "turned.vtu").stderr
    assert re.search(r"bar\.inp: repaired: (\d+) of \1 tetrahedra turned", said), said
    # Nodes are numbered in the order in which elements name them, so the sums are compared; their order is rounding.
    (_, one), (_, other) = (vtu_arrays(folder / f"{name}.vtu")["displacement"] for name in ("whole", "turned"))
    assert abs(sum(map(abs, one)) - sum(map(abs, other))) < 1e-6 * sum(map(abs, one)) != 0


@case("units as people write them are read, and an unknown one is answered with those that are known")
def _(programs, folder):
    bar = base.write_bar(folder)
    text = bar.read_text()
    young = re.search(r'young = "(.*?)"', text)
    assert young, text

    def with_young(value):
        bar.write_text(text.replace(young[0], f'young = "{value}"') + '[gravity]\ndensity = "1.05e-9 t/mm^3"\n'
                       'acceleration = ["0 mm/s^2", "0 mm/s2", "-9810 mm/s^2"]\n')
    results = []
    for value in ("0.5 MPa", "0.5 N/mm^2", "0.5 N/mm²", "5 bar"):
        with_young(value)
        programs.succeeds("solve", bar, "-o", folder / "x.vtu")
        results.append((folder / "x.vtu").read_bytes())
    assert all(result == results[0] for result in results)
    for value, says in (("0.5 mPa", "MPa, GPa"), ("0.5 kgf", "psi, ksi"), ("0,5 MPa", "decimal comma")):
        with_young(value)
        programs.refuses("solve", bar, "-o", folder / "x.vtu", says=["bar.toml:", "'young' in [material]", says])


if __name__ == "__main__":
    sys.exit(base.main())
