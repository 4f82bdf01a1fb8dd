#!/usr/bin/env python3
"""What a second hostile tester found: units of imports, twins among elements, obstacles that jump, work that is replaced; one case is one test."""
import ast
import array
import fcntl
import re
import shutil
import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from strangers_loads import bar, quiet, warnings_of

base.CASES.clear()
case = base.case

KINDS = {"<f4": "f", "<f8": "d", "<i4": "i", "<i8": "q"}
SITE = ('sets = "TIP"', 'points = ["10 mm", "0 mm", "30 mm"]')
STAGED = base.BALL.replace('edge = "12 mm"', 'edge = "20 mm"').replace('"none"', '"linear"\nheld_out = 0')


def array_of(path):
    data = path.read_bytes()
    length = struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:10 + length].decode())
    return header, array.array(KINDS[header["descr"]], data[10 + length:])


def write_array(path, header, values):
    text = (repr(header) + "\n").encode()
    path.write_bytes(b"\x93NUMPY\x01\0" + struct.pack("<H", len(text)) + text + values.tobytes())


def scale(path, factor):
    header, values = array_of(path)
    write_array(path, header, array.array(values.typecode, [factor * v for v in values]))


def baked_bar(programs, folder):
    toml = bar(folder, SITE)
    programs.succeeds("bake", "-q", toml, "-o", folder / "bar.palpable")
    return toml


@case("modes in another unit are warned of with the unit, and right ones print their figures without")
def _(programs, folder):
    baked_bar(programs, folder)
    programs.succeeds("export", folder / "bar.palpable", "--to", "numpy", "-o", folder / "modes")

    def imported(name, factor):
        shutil.rmtree(folder / "m", ignore_errors=True)
        shutil.copytree(folder / "modes", folder / "m")
        if name:
            scale(folder / "m" / name, factor)
        return programs.succeeds("import-modes", folder / "m", "-o", folder / "m.palpable")

    right = imported(None, 1)
    assert not warnings_of(right), right.stderr
    assert re.search(r"20 x 20 x 60 mm; at full load: displacement up to [0-9.]+ mm, von Mises stress up to [0-9.]+ kPa, load "
                     r"up to [0-9.]+ N", right.stdout), right.stdout
    for name, factor, says in (("displacement_modes.npy", 1000, "a third of the body's largest extent"), ("vertices.npy", 1000, "not in mm"),
                               ("stress_modes.npy", 1e-6, "MPa"), ("stress_modes.npy", 1e6, "MPa")):
        result = imported(name, factor)
        # Metres that are wrong make the patch too large for its stress, too.
        assert 1 <= len(warnings_of(result)) <= (2 if name == "vertices.npy" else 1) and says in " ".join(result.stderr.split()), (name, factor, result.stderr)


@case("snapshots in a wrong order or unit are refused or warned of, and right ones are not")
def _(programs, folder):
    baked_bar(programs, folder)
    programs.succeeds("export", folder / "bar.snapshots", "--to", "numpy", "-o", folder / "s")
    header, moved = array_of(folder / "s/unit_00000_displacement.npy")
    _, stress = array_of(folder / "s/unit_00000_stress.npy")
    levels, nodes, _ = header["shape"]
    # The export has the nodes in its own order, with their places; an import has them in the order of the deck.
    _, places = array_of(folder / "s/nodes.npy")
    of_deck = sorted(range(nodes), key=lambda n: [round(100 * x) for x in places[3 * n:][:3]][::-1])

    def imports(order=lambda rows: rows, metres=1.0, pascals=1.0, tensor=(0, 1, 2, 3, 4, 5)):
        text = 'body = "bar.toml"\n[[field]]\nname = "displacement"\n[[field]]\nname = "stress"\n'
        for level in range(levels):
            rows = [[metres * v for v in moved[3 * (level * nodes + n):][:3]] for n in of_deck]
            values = [v for row in order(rows) for v in row]
            write_array(folder / f"u{level}.npy", {"descr": "<f8", "fortran_order": False, "shape": (nodes, 3)}, array.array("d", values))
            values = [pascals * stress[6 * (level * nodes + n) + k] for n in of_deck for k in tensor]
            write_array(folder / f"s{level}.npy", {"descr": "<f8", "fortran_order": False, "shape": (nodes, 6)}, array.array("d", values))
            force = 'force = "0.1 N"\n' if level + 1 == levels else ""
            text += (f"[[snapshot]]\nsite = 0\nlevel = {(level + 1) / levels}\n{force}"
                     f'files = {{displacement = "u{level}.npy", stress = "s{level}.npy"}}\n')
        (folder / "m.toml").write_text(text)
        shutil.rmtree(folder / "new.snapshots", ignore_errors=True)
        return ("import-snapshots", folder, "--manifest", folder / "m.toml", "-o", folder / "new.snapshots")

    assert "and the law gives" in quiet(programs, *imports())
    programs.refuses(*imports(order=lambda rows: rows[::-1]), says=["m.toml", "is held by the support and moves by", "order of the mesh"])
    by_component = lambda rows: [list(r) for r in zip(*[iter([row[k] for k in range(3) for row in rows])] * 3)]
    programs.refuses(*imports(order=by_component), says=["is held by the support", "components x y z"])
    programs.refuses(*imports(metres=1000), says=["m.toml", "the range of the model", "'unit'"])
    for pascals in (1e-6, 1e6):
        result = programs.succeeds(*imports(pascals=pascals))
        assert len(warnings_of(result)) == 1 and "unit of stress" in result.stderr, result.stderr
    result = programs.succeeds(*imports(tensor=(0, 3, 5, 1, 4, 2)))
    said = " ".join(result.stderr.split())
    assert len(warnings_of(result)) == 1 and "but the tensors differ" in said and "xx yy zz xy yz zx" in said, said


@case("elements that are there twice under other numbers are refused with both")
def _(programs, folder):
    rows = base.bar_deck().splitlines()
    first = next(i for i, row in enumerate(rows) if row.startswith("*ELEMENT")) + 1
    twins = [re.sub(r"^\d+", lambda m: str(int(m[0]) + 144), row) for row in rows[first:first + 72]]
    toml = base.write_bar(folder, base.BAR, "\n".join(rows[:first + 144] + twins + rows[first + 144:]) + "\n")
    said = programs.refuses("solve", toml, "-o", folder / "x.vtu", says=["bar.inp", "the same corners"])
    one, other = (int(number) for number in re.search(r"tetrahedra (\d+) and (\d+) ", said).groups())
    assert abs(other - one) == 144, said


@case("an obstacle that jumps through a body is refused with the steps it needs, one that passes it by is not")
def _(programs, folder):
    toml = bar(folder)
    solve = ("solve", toml, "-o", folder / "x.vtu", "--obstacle")
    for words in (("sphere 4mm at 0.1,0,0.03 to -0.1,0,0.03", "--steps", "1"), ("sphere 2mm at 0.25,0,0.03 to -0.23,0,0.03",),
                  ("sphere 8mm at 0,0,0.075 to 0,0,-0.2", "--steps", "2")):
        said = programs.refuses(*solve, *words, says=["goes through the body", "--steps "])
        assert int(re.search(r"--steps (\d+)", said)[1]) > 10, said
    for text in ("sphere 4mm at 0.1,0.05,0.03 to -0.1,0.05,0.03", "sphere 8mm at 0.05,0.05,0.061 to 0.05,0.05,0.055"):
        quiet(programs, *solve, text)
    programs.refuses(*solve, "sphere 8 at 0,0,0.07 to 0,0,0.06", says=["inside the obstacle at the start", "metres"])
    programs.refuses(*solve, "plane 0,0,1 at 0,0,0.07 to 0,0,0.055", says=["behind the plane at the start", "reverse it"])


@case("a press by depth says its force and E, and warns where the unit of E must be wrong")
def _(programs, folder):
    def solved(young, *changes, more=""):
        return programs.succeeds("solve", bar(folder, ('young = "60 kPa"', f'young = "{young}"'), *changes, more=more), "-o", folder / "x.vtu")

    for young, depth in (("3 kPa", "3 mm"), ("60 kPa", "3 mm"), ("5 MPa", "3 mm"), ("2 GPa", "1 mm"), ("70 GPa", "0.05 mm"),
                         ("210 GPa", "0.05 mm")):
        result = solved(young, ('depth = "3 mm"', f'depth = "{depth}"'))
        assert not warnings_of(result), result.stderr
        assert re.search(r"full load: up to [0-9.e+]+ N; Young's modulus is [0-9.e+]+ Pa", result.stdout), result.stdout
    for young, says in (("1.5 Pa", "softest gel"), ("210 GPa", "more than any such material bears")):
        result = solved(young, ('depth = "3 mm"', 'depth = "6 mm"'))
        assert len(warnings_of(result)) == 1 and says in result.stderr and "unit" in result.stderr, result.stderr
    for more, says in (('[gravity]\ndensity = "1.1 kg/m^3"\n', "that of air"),
                       ('[gravity]\ndensity = "1100 kg/m^3"\nacceleration = ["0 m/s^2", "0 m/s^2", "0 m/s^2"]\n', "acceleration is 0")):
        result = solved("60 kPa", more=more)
        assert len(warnings_of(result)) == 1 and says in result.stderr, result.stderr
    programs.refuses("solve", bar(folder, more='[gravity]\ndensity = "1100 g/cm^3"\n'), "-o", folder / "x.vtu",
                     says=["'density' in [gravity] is 1.1e+06 kg/m^3", "1 g/cm^3 is 1000 kg/m^3"])
    programs.refuses("solve", bar(folder, more='[[parameter]]\nname = "p"\nof = "body"\nyoung = ["60 kPa", "210000 GPa"]\n'),
                     "-o", folder / "x.vtu", says=["'young' in [[parameter]]", "diamond"])


@case("a body that cannot bear its preload names the load, its value and E, and not the press")
def _(programs, folder):
    for more, says in (('[gravity]\ndensity = "1100 kg/m^3"\nacceleration = ["0 m/s^2", "0 m/s^2", "-9810 m/s^2"]\n', "gravity of 9810 m/s^2"),
                       ('[[pressure]]\npressure = "5 MPa"\nabove = 0.99\n', "a pressure of 5e+06 Pa")):
        for words in (("solve", "-o", folder / "x.vtu"), ("bake", "-o", folder / "x.palpable")):
            said = programs.refuses(words[0], bar(folder, more=more), *words[1:], says=[says, "Young's modulus 6e+04 Pa", "units"])
            assert "press less" not in said, said


@case("a finished body with tables is replaced by one without only with --overwrite")
def _(programs, folder):
    base.write_ball(folder, STAGED)
    programs.succeeds("bake", "ball.toml", "-o", "ball.palpable", cwd=folder)
    before = (folder / "ball.palpable").read_bytes()
    shutil.copytree(folder / "ball.snapshots", folder / "bare.snapshots")
    shutil.rmtree(folder / "bare.snapshots/touch", ignore_errors=True)
    programs.succeeds("export", "ball.palpable", "--to", "numpy", "-o", "modes", cwd=folder)
    bar(folder, SITE)
    lost = (("reduce", "bare.snapshots"), ("import-modes", "modes"), ("bake", "bar.toml"))
    for words in lost:
        programs.refuses(*words, "-o", "ball.palpable", cwd=folder, says=["ball.palpable: ", "'ball'", "tables of touch", "--overwrite"])
        assert (folder / "ball.palpable").read_bytes() == before
    programs.succeeds("reduce", "ball.snapshots", "-o", "ball.palpable", cwd=folder)  # its tables are kept with the snapshots
    programs.succeeds("bake", "ball.toml", "-o", "ball.palpable", cwd=folder)
    for words in lost:
        programs.succeeds(*words, "-o", "ball.palpable", "--overwrite", cwd=folder)


@case("somebody's file of another format is replaced by no command")
def _(programs, folder):
    baked_bar(programs, folder)
    base.write_ball(folder)
    for name in ("mine.palpable", "m.msh", "m.vtu", "m.xdmf"):
        (folder / name).write_text("my notes\n")
    for other, name in (("numpy", "vertices.npy"), ("vtu", "site_000_level_001.vtu")):
        (folder / other).mkdir()
        (folder / other / name).write_text("my notes\n")
    for words in (("bake", "bar.toml", "-o", "mine.palpable"), ("reduce", "bar.snapshots", "-o", "mine.palpable"),
                  ("mesh", "ball.off", "-o", "m.msh"), ("mesh", "ball.off", "-o", "m.vtu"), ("solve", "bar.toml", "-o", "m.vtu"),
                  ("export", "bar.palpable", "--to", "xdmf", "-o", "m.xdmf"), ("export", "bar.palpable", "--to", "numpy", "-o", "numpy"),
                  ("export", "bar.palpable", "--to", "vtu", "-o", "vtu")):
        programs.refuses(*words, cwd=folder, says=["is there already", "somebody's"])
    for path in [folder / name for name in ("mine.palpable", "m.msh", "m.vtu", "m.xdmf")] + list(folder.glob("numpy/*")) + list(folder.glob("vtu/*")):
        assert path.read_text() == "my notes\n", path
    # Their own outputs are replaced as before.
    for _ in range(2):
        programs.succeeds("solve", "bar.toml", "-o", "x.vtu", cwd=folder)
        programs.succeeds("mesh", "ball.off", "-o", "x.inp", cwd=folder)
        programs.succeeds("export", "bar.palpable", "--to", "xdmf", "-o", "x.xdmf", cwd=folder)
        programs.succeeds("export", "bar.palpable", "--to", "numpy", "-o", "np", cwd=folder)
    programs.refuses("export", "bar.palpable", "--to", "numpy", "-o", "bar.snapshots", cwd=folder, says=["bar.snapshots", "campaign"])


@case("two bakes into one body file at once: the second is refused, and no lock is left")
def _(programs, folder):
    base.write_ball(folder)
    bake = ("bake", "ball.toml", "-o", "ball.palpable")
    lock = folder / "ball.palpable.lock"
    with open(lock, "w") as held:  # as the first bake holds it
        fcntl.flock(held, fcntl.LOCK_EX)
        programs.refuses(*bake, "--snapshots", "other.snapshots", cwd=folder, says=["ball.palpable: another run is making it"])
        assert lock.exists() and not (folder / "ball.palpable").exists()
    programs.succeeds(*bake, cwd=folder)  # what a killed bake leaves is taken over
    assert not lock.exists()


@case("a description of another body is refused for --refine before the run")
def _(programs, folder):
    base.write_ball(folder, STAGED)
    programs.succeeds("bake", "ball.toml", "-o", "ball.palpable", cwd=folder)
    base.write_stereo(folder / "clip", frames=3)
    live = ("live", "ball.palpable", "--source", "clip", "--place", "0 0.04 0.42 0 0 0", "--refine")
    for name, what, by in (("stiff", '"60 kPa"', '"60 MPa"'), ("small", '"100 mm"', '"50 mm"'), ("coarse", 'edge = "20 mm"', 'edge = "9 mm"')):
        (folder / f"{name}.toml").write_text(STAGED.replace(what, by))
        programs.refuses(*live, f"{name}.toml", "--out", name, cwd=folder, says=[f"--refine {name}.toml", "describes another", "'ball'"])
    (folder / "same.toml").write_text("# the same\n" + STAGED)
    programs.succeeds(*live, "same.toml", "--out", "same", cwd=folder)
    # A folder's recording is replaced, a note is not.
    (folder / "mine.palprec").write_text("my notes\n")
    programs.refuses("live", "ball.palpable", "--source", "clip", "--place", "0 0.04 0.42 0 0 0", "--record", "mine.palprec", "--overwrite",
                     cwd=folder, says=["mine.palprec", "is no recording", "somebody's"])
    assert (folder / "mine.palprec").read_text() == "my notes\n"


@case("a load whose coordinates are in millimetres says that they are metres")
def _(programs, folder):
    baked_bar(programs, folder)
    programs.refuses("press", folder / "bar.palpable", "--load", "10,0,30=0.01", says=["coordinates are metres"])
    said = programs.refuses("press", folder / "bar.palpable", "--load", "0.02,0,0.03=0.01", says=["off the body's surface"])
    assert "metres" not in said, said


if __name__ == "__main__":
    sys.exit(base.main())
