#!/usr/bin/env python3
"""Files as strangers have them: far too large, of another kind, cut short, damaged, pipes and folders, and texts of other editors.
Each reader of the programs is one Input below; every case that goes through INPUTS holds for all of them."""
import fcntl
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from math import cos, sin
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from campaigns import IMPORTED, MANIFEST, vtu_arrays

base.CASES.clear()
case = base.case

GIGABYTE = 1_000_000_000
LONGEST = 60  # s; each command takes less than two on an idle machine, but tests share their cores


# ---- the inputs --------------------------------------------------------------------------------

class Input:
    """A file within the folder of write_inputs(), and a command that reads it."""

    def __init__(self, file, *words, text=False, output=None):
        self.file, self.words, self.text, self.output = file, words, text, output

    def __str__(self):
        return f"{self.file} ({self.words[0]})"


LIVE = ("live", "ball.palpable", "--out", "new", "--frames", "1")
AT = ("--place", "0 0.04 0.42 0 0 0")
IMPORT = ("import-snapshots", ".", "-o", "new.snapshots", "--manifest")
MESHED = ("-o", "new.msh", "--unit", "mm")
INPUTS = [
    Input("ball.palpable", "inspect", "ball.palpable"),
    Input("cube.stl", "mesh", "cube.stl", *MESHED),
    Input("text.stl", "mesh", "text.stl", *MESHED, text=True, output="new.msh"),
    Input("cube.obj", "mesh", "cube.obj", *MESHED, text=True, output="new.msh"),
    Input("cube.off", "mesh", "cube.off", *MESHED, text=True, output="new.msh"),
    Input("cube.ply", "mesh", "cube.ply", *MESHED),
    Input("text.ply", "mesh", "text.ply", *MESHED, text=True, output="new.msh"),
    Input("cube.3ds", "mesh", "cube.3ds", *MESHED),
    Input("bar.inp", "solve", "bar.toml", "-o", "new.vtu", text=True, output="new.vtu"),
    Input("bar.msh", "solve", "gmsh.toml", "-o", "new.vtu", text=True, output="new.vtu"),
    Input("bar.toml", "solve", "bar.toml", "-o", "new.vtu", text=True, output="new.vtu"),
    Input("vtu.toml", *IMPORT, "vtu.toml", text=True),
    Input("level_1.vtu", *IMPORT, "vtu.toml"),
    Input("level_1.vtk", *IMPORT, "vtk.toml", text=True),
    Input("u1.csv", *IMPORT, "csv.toml", text=True),
    Input("u1.npy", *IMPORT, "npy.toml"),
    Input("bar.snapshots/campaign.h5", "reduce", "bar.snapshots", "-o", "new.palpable"),
    Input("bar.snapshots/site_0000.h5", "reduce", "bar.snapshots", "-o", "new.palpable"),
    Input("modes/vertices.npy", "import-modes", "modes", "-o", "new.palpable"),
    Input("modes/parameters.txt", "import-modes", "modes", "-o", "new.palpable", text=True),
    Input("modes.pxdmf", "import-modes", "modes.pxdmf", "-o", "new.palpable", text=True),
    Input("modes.pxdmf.h5", "import-modes", "modes.pxdmf", "-o", "new.palpable"),
    Input("run.palprec", "replay", "run.palprec"),
    Input("one/left/000000.png", *LIVE, *AT, "--source", "one"),
    Input("clip/rectified.yml", *LIVE, *AT, "--source", "clip", text=True),
    Input("raw.yml", *LIVE, *AT, "--source", "clip", "--calibration", "raw.yml", text=True),
    Input("SN1.conf", *LIVE, *AT, "--source", "wide", "--calibration", "SN1.conf", text=True),
    Input("clip/scene.toml", *LIVE, "--source", "clip", text=True),
    Input("place.txt", *LIVE, "--source", "clip", "--place", "place.txt", text=True),
    Input("depth/depth/0.png", *LIVE, *AT, "--source", "depth"),
    Input("depth/intrinsics.txt", *LIVE, *AT, "--source", "depth", text=True),
    Input("depth/rgb.txt", *LIVE, *AT, "--source", "depth", text=True),
    Input("eye.mp4", *LIVE, *AT, "--source", "eye.mp4", "--right", "other.mp4", "--calibration", "clip/rectified.yml"),
    Input("path.txt", "score", "--poses", "path.txt", "path2.txt", text=True),
    Input("path2.txt", "score", "--poses", "path.txt", "path2.txt", text=True),
    Input("truth/camera.toml", "score", "truth", "result", text=True),
    Input("truth/contact.jsonl", "score", "truth", "result", text=True),
    Input("truth/hand.jsonl", "score", "truth", "result", text=True),
    Input("truth/depth/000000.png", "score", "truth", "result"),
    Input("result/touches.jsonl", "score", "truth", "result", text=True),
    Input("result/trajectory.txt", "score", "truth", "result", text=True),
    Input("result/meshes/000000.ply", "score", "truth", "result", text=True),
    Input("report.csv", "report", "ball.palpable", "-o", "report.html", text=True),
]


def cube_surfaces(folder):
    """A cube of 80 mm in each format of surfaces."""
    corners = [[80 * (i >> k & 1) for k in range(3)] for i in range(8)]
    faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6),
             (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    base.write_stl(folder / "text.stl", base.cube(0, 80))
    triangles = [struct.pack("<12fH", 0, 0, 0, *(x for v in face for x in corners[v]), 0) for face in faces]
    (folder / "cube.stl").write_bytes(b"a cube".ljust(80) + struct.pack("<I", 12) + b"".join(triangles))
    rows = [" ".join(map(str, c)) for c in corners]
    (folder / "cube.obj").write_text("".join(f"v {r}\n" for r in rows)
                                     + "".join("f {} {} {}\n".format(*(v + 1 for v in f)) for f in faces))
    (folder / "cube.off").write_text("\n".join(["OFF", "8 12 0", *rows, *("3 {} {} {}".format(*f) for f in faces)]) + "\n")
    header = ("ply\nformat {} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
              "element face 12\nproperty list uchar int vertex_indices\nend_header\n")
    (folder / "text.ply").write_text(header.format("ascii") + "\n".join([*rows, *("3 {} {} {}".format(*f) for f in faces)]) + "\n")
    (folder / "cube.ply").write_bytes(header.format("binary_little_endian").encode()
                                      + b"".join(struct.pack("<3f", *c) for c in corners)
                                      + b"".join(struct.pack("<B3i", 3, *f) for f in faces))

    def chunk(kind, content):
        return struct.pack("<HI", kind, len(content) + 6) + content
    vertices = chunk(0x4110, struct.pack("<H", 8) + b"".join(struct.pack("<3f", *c) for c in corners))
    indices = chunk(0x4120, struct.pack("<H", 12) + b"".join(struct.pack("<4H", *f, 0) for f in faces))
    (folder / "cube.3ds").write_bytes(chunk(0x4D4D, chunk(0x3D3D, chunk(0x4000, b"cube\0" + chunk(0x4100, vertices + indices)))))


def gmsh_of(deck):
    """The bar of bar_deck() as a Gmsh file of version 2.2; lines of its own give the sets."""
    nodes = re.search(r"\*NODE\n(.*?)\*ELEMENT", deck, re.S)[1].split("\n")[:-1]
    tets = re.search(r"\*ELEMENT.*?\n(.*?)\*", deck, re.S)[1].split("\n")[:-1]
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes)), *(n.replace(",", " ") for n in nodes), "$EndNodes",
            "$Elements", str(len(tets))]
    for tet in tets:
        number, *corners = tet.replace(",", " ").split()
        text.append(" ".join([number, "4 2 1 1", *corners]))
    return "\n".join([*text, "$EndElements"]) + "\n"


def write_snapshots(programs, folder):
    """Two levels of a bar as files of other programs, and what describes them."""
    bar = base.write_bar(folder)
    (folder / "bar.msh").write_text(gmsh_of(base.bar_deck()))
    placed = base.BAR.replace('set = "BASE"', "below = 0.01").replace('sets = "TIP"', 'points = ["0 mm", "0 mm", "60 mm"]')
    (folder / "gmsh.toml").write_text(placed.replace("bar.inp", "bar.msh"))
    for level in (1, 2):
        programs.succeeds("solve", bar, "--level", level / 2, "-o", folder / f"level_{level}.vtu")
    (folder / "runs.toml").write_text(IMPORTED)
    only_u = re.sub(r'\[\[field\]\]\nname = "(stress|von_mises)"\n(from = .*\n)?', "", MANIFEST)
    assert "von_mises" not in only_u, only_u
    for kind in ("vtu", "vtk", "csv", "npy"):
        name = "level_{}" if kind in ("vtu", "vtk") else "u{}"
        text = only_u
        if kind == "csv":
            text = text.replace('name = "displacement"', 'name = "displacement"\nfrom = ["x", "y", "z"]')
        for n, what in ((1, "FIRST"), (2, "SECOND")):
            text = text.replace(what, f'file = "{name.format(n)}.{kind}"')
        (folder / f"{kind}.toml").write_text(text)
    for n in (1, 2):
        arrays = vtu_arrays(folder / f"level_{n}.vtu")

        def rows(name):
            components, numbers = arrays[name]
            return [numbers[i:i + components] for i in range(0, len(numbers), components)]
        u, points = rows("displacement"), rows("points")
        (folder / f"u{n}.npy").write_bytes(npy(f"({len(u)}, 3)", struct.pack(f"<{3 * len(u)}d", *(x for row in u for x in row))))
        (folder / f"u{n}.csv").write_text("node,x,y,z\n" + "".join(",".join(map(repr, (k, *row))) + "\n" for k, row in enumerate(u)))
        (folder / f"level_{n}.vtk").write_text("\n".join(
            ["# vtk DataFile Version 3.0", "t", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double",
             *(" ".join(map(repr, p)) for p in points), f"POINT_DATA {len(points)}", "FIELD f 1",
             f"displacement 3 {len(u)} double", *(" ".join(map(repr, row)) for row in u)]) + "\n")
    programs.succeeds("bake", bar, "-o", folder / "bar.palpable")


def npy(shape, data, kind="<f8"):
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header + data


FACTORY = """[LEFT_CAM_VGA]
fx=350
fy=350
cx=336
cy=188
k1=0
k2=0
k3=0
p1=0
p2=0
[RIGHT_CAM_VGA]
fx=350
fy=350
cx=336
cy=188
k1=0
k2=0
k3=0
p1=0
p2=0
[STEREO]
Baseline=63
TY=0
TZ=0
CV_VGA=0
RX_VGA=0
RZ_VGA=0
"""


def matrix(name, rows, columns, numbers):
    return f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {numbers} ]\n"


def write_recordings(programs, folder):
    clip = base.write_stereo(folder / "clip", frames=2)
    base.write_stereo(folder / "one", frames=1)  # a frame that cannot be read is left out where there are others
    (clip / "scene.toml").write_text("camera_from_body = [1, 0, 0, 0,  0, 0, -1, 0.04,  0, 1, 0, 0.42,  0, 0, 0, 1]\n")
    (folder / "place.txt").write_text("0 0.04 0.42\n0 0 0\n")
    camera = "175., 0., 159.5, 0., 175., 89.5, 0., 0., 1."
    (folder / "raw.yml").write_text("%YAML:1.0\n---\nimage_width: 320\nimage_height: 180\n" + "".join(
        matrix(f"K{eye}", 3, 3, camera) + matrix(f"D{eye}", 1, 5, "0., 0., 0., 0., 0.") for eye in "12")
        + matrix("R", 3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.") + matrix("T", 3, 1, "-0.063, 0., 0."))
    for eye, offset in (("left", 0), ("right", 25)):
        (folder / "wide" / eye).mkdir(parents=True)
        (folder / "wide" / eye / "0.png").write_bytes(base.png(672, 376, lambda x, y: (x + offset) * 7 % 251))
    (folder / "SN1.conf").write_text(FACTORY)
    for name in ("rgb", "depth"):
        (folder / "depth" / name).mkdir(parents=True)
    (folder / "depth/rgb/0.png").write_bytes(base.png(320, 180, base.texture(0)))
    (folder / "depth/depth/0.png").write_bytes(base.png(320, 180, lambda x, y: 2200 + x % 7, bits=16, channels=1))
    for name in ("rgb", "depth"):
        (folder / f"depth/{name}.txt").write_text(f"# stamps\n1305031102.175304 {name}/0.png\n")
    (folder / "depth/intrinsics.txt").write_text("175 175 159.5 89.5\n320 180\n")
    programs.succeeds("live", "ball.palpable", "--source", "clip", *AT, "--out", "first", "--record", "run.palprec", cwd=folder)
    for name in ("eye.mp4", "other.mp4"):
        shutil.copy(folder / "first/touch.mp4", folder / name)
    shutil.rmtree(folder / "first")


def write_results(programs, folder):
    truth, result = base.write_truth(folder / "truth"), base.write_result(folder / "result")
    for name in ("path.txt", "path2.txt"):
        base.lines(folder / name, [f"{1305031102 + n / 30:.6f} {0.01 * n} {0.001 * n * n} 0 0 {sin(0.01 * n):.9f} 0 {cos(0.01 * n):.9f}"
                                   for n in range(30)])
    programs.succeeds("export", "ball.palpable", "--to", "numpy", "-o", "modes", cwd=folder)
    programs.succeeds("export", "ball.palpable", "--to", "pxdmf", "-o", "modes.pxdmf", cwd=folder)
    programs.succeeds("report", "ball.palpable", "-o", "report.html", cwd=folder)
    assert truth and result


def write_inputs(programs, folder):
    """All INPUTS in a folder of the case's own; made once and shared by the cases."""
    kept = programs.work / "readers"
    kept.mkdir(parents=True, exist_ok=True)
    with open(kept / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = kept / "done"
        program = Path(programs.palpable).with_name("palpable-bake")
        newest = max(Path(__file__).stat().st_mtime, program.stat().st_mtime, Path(programs.palpable).stat().st_mtime)
        if not done.exists() or done.stat().st_mtime < newest:
            shutil.rmtree(kept / "all", ignore_errors=True)
            (kept / "all").mkdir()
            shutil.copy(programs.small_body(), kept / "all/ball.palpable")
            cube_surfaces(kept / "all")
            write_snapshots(programs, kept / "all")
            write_recordings(programs, kept / "all")
            write_results(programs, kept / "all")
            done.touch()
    shutil.copytree(kept / "all", folder, dirs_exist_ok=True)
    return folder


class Outcome:
    def __init__(self, returncode, stderr, seconds, most):
        self.returncode, self.stderr, self.seconds, self.most = returncode, stderr, seconds, most

    def line(self):
        """The error, if it is one."""
        lines = [line for line in self.stderr.split("\n") if line.startswith("palpable: ")]
        return lines[-1] if lines else ""


def outcome(programs, folder, words):
    """Runs a command to its end. most: peak resident memory, bytes."""
    for made in folder.glob("new*"):
        shutil.rmtree(made) if made.is_dir() else made.unlink()
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+", errors="backslashreplace") as err:
        process = subprocess.Popen([programs.palpable, *map(str, words)], stdout=subprocess.DEVNULL, stderr=err, stdin=subprocess.DEVNULL,
                                   cwd=folder)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid != 0:
                break
            if time.monotonic() - begin > LONGEST:
                process.kill()
                os.wait4(process.pid, 0)
                process.returncode = -9
                raise AssertionError(f"{words}: has not ended after {LONGEST} s")
            time.sleep(0.005)
        process.returncode = os.waitstatus_to_exitcode(status)
        err.seek(0)
        return Outcome(process.returncode, err.read(), time.monotonic() - begin, 1024 * usage.ru_maxrss)


def ends_well(programs, folder, given, what):
    """Runs the input's command; it ends by itself, within the memory, with a result or an error of one line."""
    found = outcome(programs, folder, given.words)
    where = f"{given}, {what}: exit code {found.returncode}, {found.most / 1e6:.0f} MB\n{found.stderr}"
    assert found.returncode in (0, 1), where
    assert found.most <= GIGABYTE, where
    assert "terminate called" not in found.stderr and ".cpp" not in found.stderr, where
    if found.returncode == 1:
        assert found.stderr.strip("\n").split("\n")[-1].startswith("palpable: "), where
    return found


def refused(programs, folder, given, what, most=GIGABYTE):
    """Like ends_well(), with an error that names the file, or the folder in which it is missed."""
    found = ends_well(programs, folder, given, what)
    print(f"{given}, {what}: {found.most / 1e6:.0f} MB, {found.seconds:.2f} s: {found.line()}")
    assert found.returncode == 1, f"{given}, {what}: was taken\n{found.stderr}"
    assert any(part in found.line() for part in Path(given.file).parts), f"{given}, {what}: is not named: {found.line()}"
    assert found.most <= most, f"{given}, {what}: {found.most / 1e6:.0f} MB"
    return found.line()


class Replaced:
    """Removes a file while a case puts something else at its path, and brings it back."""

    def __init__(self, path):
        self.path, self.good = path, path.read_bytes()

    def __enter__(self):
        self.path.unlink()
        return self.path

    def __exit__(self, *_):
        remove(self.path)
        self.path.write_bytes(self.good)


def remove(path):
    if path.is_dir() and not path.is_symlink():
        path.rmdir()
    else:
        path.unlink(missing_ok=True)


# ---- cases -------------------------------------------------------------------------------------

@case("every input is read as it should be: the other cases say something")
def _(programs, folder):
    write_inputs(programs, folder)
    for given in INPUTS:
        found = ends_well(programs, folder, given, "unchanged")
        assert found.returncode == 0, f"{given}: {found.stderr}"


def sparse(path, start, size):
    with open(path, "wb") as file:
        file.write(start)
        file.truncate(size)


@case("five gigabytes of zeros are refused by every reader at once and within a gigabyte of memory")
def _(programs, folder):
    write_inputs(programs, folder)
    for given in INPUTS:
        with Replaced(folder / given.file) as path:
            sparse(path, b"", 5_000_000_000)
            refused(programs, folder, given, "5 GB of zeros")


@case("five gigabytes that begin as they should are refused by every reader at once and within a gigabyte of memory")
def _(programs, folder):
    write_inputs(programs, folder)
    for given in INPUTS:
        good = (folder / given.file).read_bytes()
        with Replaced(folder / given.file) as path:
            sparse(path, good, 5_000_000_000)
            # A recording is played up to its damage; a video has all its pictures; HDF5 ignores what lies behind its end.
            taken = given.file in ("run.palprec", "eye.mp4", "modes.pxdmf.h5", "report.csv")
            (ends_well if taken else refused)(programs, folder, given, "5 GB, the first bytes right")


@case("surfaces of 1.5 GB are refused, one of 200 MB is read")
def _(programs, folder):
    write_inputs(programs, folder)
    for given in INPUTS:
        if given.words[0] != "mesh":
            continue
        good = (folder / given.file).read_bytes()
        for start in (b"", good):
            with Replaced(folder / given.file) as path:
                sparse(path, start, 1_500_000_000)
                line = refused(programs, folder, given, "1.5 GB")
                if start and not given.text:
                    assert "1500 MB, where 500 are read at most; reduce its triangles" in line, line
    stl = next(given for given in INPUTS if given.file == "cube.stl")
    good = (folder / stl.file).read_bytes()
    with Replaced(folder / stl.file) as path:
        count = 4_000_000
        path.write_bytes(good[:80] + struct.pack("<I", count) + good[84:134] * count)
        found = outcome(programs, folder, stl.words)
        # Read, and then judged as a surface: its triangles are all the same.
        assert "are read at most" not in found.stderr and found.returncode == 1, found.stderr
        assert "80 x" in found.stderr or "watertight" in found.stderr, found.stderr


@case("a pipe, a device, a folder or an empty file ends each reader with a message")
def _(programs, folder):
    write_inputs(programs, folder)
    for n, given in enumerate(INPUTS):
        with Replaced(folder / given.file) as path:
            # All judge alike, so each gets a pipe, at which a reader would wait, and one of the others.
            others = ((lambda: path.symlink_to("/dev/zero"), "a device"), (path.mkdir, "a folder"),
                      (lambda: path.write_bytes(b""), "an empty file"))
            for make, what in ((lambda: os.mkfifo(path), "a pipe"), others[n % len(others)]):
                make()
                # Truths and results without a touch or a mesh are allowed; so is a campaign in which a site is missing.
                may_be_empty = what == "an empty file" and given.words[0] in ("score", "report")
                (ends_well if may_be_empty else refused)(programs, folder, given, what)
                remove(path)


@case("files that are cut short or have a wrong byte end no reader by a crash, a hang or out of memory")
def _(programs, folder):
    """PALPABLE_FUZZ=50,200,7 is a longer round: cuts and bytes of each file, and the seed. A short one does either."""
    round_of = os.environ.get("PALPABLE_FUZZ")
    only = os.environ.get("PALPABLE_FUZZ_FILE", "")
    write_inputs(programs, folder)
    refusals = runs = 0
    for n, given in enumerate(INPUTS):
        cuts, flips, seed = map(int, round_of.split(",")) if round_of else (n % 2, 1 - n % 2, 58)
        if not given.file.startswith(only):
            continue
        good = (folder / given.file).read_bytes()
        dice = random.Random(f"{seed} {given.file}")
        damaged = [(f"cut to {n} of {len(good)} bytes", good[:n]) for n in (dice.randrange(len(good)) for _ in range(cuts))]
        for _ in range(flips):
            at, value = dice.randrange(min(len(good), dice.choice((200, len(good))))), dice.randrange(256)
            damaged.append((f"byte {at} is {value}", good[:at] + bytes([value]) + good[at + 1:]))
        with Replaced(folder / given.file) as path:
            for what, content in damaged:
                path.write_bytes(content)
                runs += 1
                refusals += ends_well(programs, folder, given, f"seed {seed}, {what}").returncode
    print(f"seed {seed}: {refusals} of {runs} refused")
    assert refusals > 0


@case("a count in a header that does not fit its file is refused before memory is taken")
def _(programs, folder):
    write_inputs(programs, folder)
    most = 300_000_000  # bytes; none of the files needs a third of it

    def announces(file, content, *says):
        given = next(given for given in INPUTS if given.file == file)
        with Replaced(folder / file) as path:
            path.write_bytes(content)
            line = refused(programs, folder, given, "a count", most)
            for text in says:
                assert text in line, f"'{text}' is not in: {line}"

    def good(file):
        return (folder / file).read_bytes()
    stl = good("cube.stl")
    announces("cube.stl", stl[:80] + b"\xff\xff\xff\xff" + stl[84:], "4294967295 triangles are announced, there is room for 12")
    for ply in ("cube.ply", "text.ply"):
        announces(ply, good(ply).replace(b"vertex 8", b"vertex 2000000000"), "2000000000 of the element 'vertex' are announced")
        announces(ply, good(ply).replace(b"face 12", b"face 9000000000000000000"), "of the element 'face' are announced")
    announces("cube.off", good("cube.off").replace(b"8 12 0", b"400000000 12 0"), "400000000 vertices are announced")
    announces("cube.off", good("cube.off").replace(b"8 12 0", b"8 99999999999999 0"), "faces are announced")
    announces("bar.msh", good("bar.msh").replace(b"$Nodes\n63", b"$Nodes\n2000000000"), "line 5", "more than the file holds")
    announces("level_1.vtk", re.sub(rb"POINTS \d+", b"POINTS 400000000", good("level_1.vtk")))
    announces("u1.npy", npy("(100000000, 3)", bytes(1000)), "is cut short: its shape (100000000, 3) needs more numbers than the 125")
    announces("modes/vertices.npy", npy("(500000000, 3)", bytes(24), "<f4"), "cut short")
    body = good("ball.palpable")
    announces("ball.palpable", re.sub(rb"bytes \d+\n", b"bytes 9999999999\n", body, count=1), "truncated or damaged")
    for shade, bits in ((b"\0\0\xea\x60", b"\x08"), (b"\x7f\xff\xff\xff", b"\x10")):
        image = good("one/left/000000.png")
        announces("one/left/000000.png", image[:16] + 2 * shade + bits + image[25:], "pixels")
    image = good("depth/depth/0.png")
    announces("depth/depth/0.png", image[:16] + 2 * b"\0\0\xea\x60" + image[24:], "60000 x 60000 pixels")
    # The same sizes in the other formats; the file's name does not decide.
    for start in (b"P5 60000 60000 65535\n", b"P6\n# a remark\n60000 60000\n255\n",
                  b"BM" + bytes(12) + struct.pack("<IiiHH", 40, 60000, -60000, 1, 24) + bytes(24),
                  b"II*\0" + struct.pack("<IHHHIIHHIII", 8, 2, 256, 4, 1, 60000, 257, 4, 1, 60000, 0)):
        announces("depth/depth/0.png", start + bytes(100), "60000 x 60000 pixels")
    announces("depth/depth/0.png", b"P5 4000 4000 65535\n" + bytes(100), "4000 x 4000 pixels do not fit")


def written_otherwise(text):
    """A text as other editors and systems write it, which is read all the same. (The single differences are tested beside the
    readers' sources.)"""
    return {"a byte-order mark and CRLF": b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n"),
            "lone CR and a zero byte at the end": text.replace(b"\n", b"\r") + b"\0"}


@case("a text is read the same with a byte-order mark, with any line ends and with a zero byte at its end")
def _(programs, folder):
    write_inputs(programs, folder)
    # report.csv is no input: it is written over where its beginning is what the program writes, byte for byte.
    for given in INPUTS:
        if not given.text or given.file == "report.csv":
            continue
        good = (folder / given.file).read_bytes()
        if given.output:
            ends_well(programs, folder, given, "unchanged")
        result = (folder / given.output).read_bytes() if given.output else None
        for how, content in written_otherwise(good).items():
            with Replaced(folder / given.file) as path:
                path.write_bytes(content)
                found = ends_well(programs, folder, given, how)
            assert found.returncode == 0, f"{given}, {how}: {found.stderr}"
            # What is said of the file, such as a key of a content's hash, may differ; the result does not.
            if given.output and given.file != "bar.toml":
                assert (folder / given.output).read_bytes() == result, f"{given}, {how}: another result"


@case("a text in UTF-16, or with zeros in it, is refused with its name")
def _(programs, folder):
    write_inputs(programs, folder)
    # Of report.csv only the beginning is read: whether it is the program's own.
    for n, given in enumerate(given for given in INPUTS if given.text and given.file != "report.csv"):
        text = (folder / given.file).read_text()
        others = (("UTF-16 without its mark", text.encode("utf-16-be")), ("zeros", text.encode() + bytes(512)))
        for what, content in (("UTF-16", text.encode("utf-16")), others[n % len(others)]):
            with Replaced(folder / given.file) as path:
                path.write_bytes(content)
                line = refused(programs, folder, given, what)
            assert "UTF-16" in line or "zero byte" in line or what != "zeros", line


@case("what a message quotes of a file does not steer the terminal")
def _(programs, folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "a.obj").write_bytes(b"v \x1b]0;mine\x07 0 0\n")
    said = programs.refuses("mesh", "a.obj", "-o", "a.msh", cwd=folder, says=["a.obj: line 1: '?]0;mine?' is not a coordinate"])
    assert all(letter >= " " for letter in said), repr(said)


@case("an OBJ with a byte-order mark keeps its first vertex")
def _(programs, folder):
    folder.mkdir(parents=True, exist_ok=True)
    cube_surfaces(folder)
    obj = (folder / "cube.obj").read_text()
    for name, content in (("plain", obj), ("marked", "\ufeff" + obj)):
        (folder / f"{name}.obj").write_text(content)
        said = programs.succeeds("mesh", f"{name}.obj", "-o", f"{name}.msh", "--unit", "mm", cwd=folder).stderr
        assert f"{name}.obj: 80 x 80 x 80 mm" in said, said
    assert (folder / "plain.msh").read_bytes() == (folder / "marked.msh").read_bytes()


@case("decimal commas are refused with the line and the remedy, and lists by commas are read")
def _(programs, folder):
    write_inputs(programs, folder)
    says = "has decimal commas; write 0.5, not 0,5"

    def given(file):
        return next(given for given in INPUTS if given.file == file)
    for file in ("path.txt", "path2.txt", "depth/intrinsics.txt", "place.txt", "depth/rgb.txt"):
        text = (folder / file).read_text()
        with Replaced(folder / file) as path:
            path.write_text(text.replace(".", ",").replace(",png", ".png").replace("320 180", "320,0 180,0"))
            if file == "depth/rgb.txt":
                continue
            line = refused(programs, folder, given(file), "decimal commas")
            assert says in line or file == "place.txt", line
        if file.startswith("path"):
            with Replaced(folder / file) as path:  # as a spreadsheet writes it
                path.write_text(text.replace(" ", ","))
                assert ends_well(programs, folder, given(file), "by commas").returncode == 0
    rows = (folder / "u1.csv").read_text()
    with Replaced(folder / "u1.csv") as path:
        path.write_text(rows.replace(",", ";").replace(".", ","))
        line = refused(programs, folder, given("u1.csv"), "decimal commas")
        assert "line 2" in line and says in line, line
        path.write_text(rows.replace(",", ";"))
        assert ends_well(programs, folder, given("u1.csv"), "by semicolons").returncode == 0
    deck = (folder / "bar.inp").read_text()
    with Replaced(folder / "bar.inp") as path:
        for number in ("1.5D-3", "1.5d-3", "+1.5E-3"):  # as Fortran prints them
            path.write_text(deck.replace("1, 0, 0, 0\n", f"1, {number}, 0, 0\n", 1))
            assert ends_well(programs, folder, given("bar.inp"), number).returncode == 0
        for number in ("2.3+2", "-7.-1", "1.5 D-3", "0x1p3"):
            path.write_text(deck.replace("1, 0, 0, 0\n", f"1, {number}, 0, 0\n", 1))
            line = refused(programs, folder, given("bar.inp"), number)
            assert "line 4" in line and number in line and "not a number" in line, line
        path.write_text(deck.replace("1, 0, 0, 0\n", "1, 0,5, 0,25, 1,0\n", 1))
        line = refused(programs, folder, given("bar.inp"), "decimal commas")
        assert "line 4" in line and says in line, line


@case("VTK files of both byte orders, with raw appended data, give the same snapshots")
def _(programs, folder):
    write_inputs(programs, folder)
    written = (folder / "level_1.vtu").read_bytes()
    given = next(given for given in INPUTS if given.file == "level_1.vtu")

    def store():
        assert ends_well(programs, folder, given, "VTU").returncode == 0
        return (folder / "new.snapshots/site_0000.h5").read_bytes()
    expected = store()
    kinds = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}
    arrays = vtu_arrays(folder / "level_1.vtu")
    for order, letter in (("LittleEndian", "<"), ("BigEndian", ">")):
        # As pyevtk writes it (nschloe/meshio#786): raw bytes behind an underscore, which may hold a '<'.
        text, data = "", b""

        def array(name, kind):
            nonlocal data
            components, numbers = arrays[name]
            line = f'<DataArray Name="{name}" type="{kind}" NumberOfComponents="{components}" format="appended" offset="{len(data)}"/>\n'
            packed = struct.pack(f"{letter}{len(numbers)}{kinds[kind]}", *numbers)
            data += struct.pack(f"{letter}Q", len(packed)) + packed
            return line
        points = len(arrays["points"][1]) // 3
        cells = len(arrays["types"][1])
        text = (f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{order}" header_type="UInt64">\n'
                f'<UnstructuredGrid><Piece NumberOfPoints="{points}" NumberOfCells="{cells}">\n<Points>\n{array("points", "Float64")}</Points>\n'
                f'<Cells>\n{array("connectivity", "Int32")}{array("offsets", "Int32")}{array("types", "UInt8")}</Cells>\n'
                f'<PointData>\n{array("displacement", "Float64")}</PointData>\n</Piece></UnstructuredGrid>\n<AppendedData encoding="raw">_')
        assert b"<" in data
        whole = text.encode() + data + b"</AppendedData></VTKFile>\n"
        with Replaced(folder / "level_1.vtu") as path:
            path.write_bytes(whole)
            assert store() == expected, order
            path.write_bytes(whole.replace(order.encode(), b"MiddleEndian"))
            assert "byte_order" in refused(programs, folder, given, "an unknown order")
            # A file that lies about its order has lengths that do not fit it.
            other = "BigEndian" if order == "LittleEndian" else "LittleEndian"
            path.write_bytes(whole.replace(order.encode(), other.encode()))
            refused(programs, folder, given, "the other order")
    assert (folder / "level_1.vtu").read_bytes() == written


if __name__ == "__main__":
    sys.exit(base.main())
