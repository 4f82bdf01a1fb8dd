#!/usr/bin/env python3
"""The unit of what is seen: depth images in other units, with swapped bytes, or with nothing; and the right ones, which
must give no warning. One case is one test, as in programs.py. `--list` names the cases."""
import json
import random
import re
import shutil
import struct
import sys
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case
DATA = base.ROOT / "../shared/data"
WIDTH, HEIGHT, FOCAL = 160, 120, 140


def desk_mm(frame=0, noise=2):
    """Depths of a desk that rises towards the back and of a box on it, mm: 500 to 620, median 0.56 m."""
    random.seed(frame)
    return [[(520 if 60 < x < 100 and 40 < y < 80 else 620 - y) + random.randint(-noise, noise) for x in range(WIDTH)]
            for y in range(HEIGHT)]


def png16(rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 16, 0, 0, 0, 0)
    packed = b"".join(b"\0" + struct.pack(f">{len(row)}H", *row) for row in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(packed, 1)) + chunk(b"IEND", b"")


def swapped(value):
    return (value & 255) << 8 | value >> 8


def write_clip(folder, change=lambda value: value, frames=3, intrinsics="", depth_of=desk_mm):
    """Colour and depth of the desk; `change` turns millimetres into the numbers of the file."""
    folder.mkdir(parents=True)
    color = base.png(WIDTH, HEIGHT, base.texture(0))
    for n in range(frames):
        (folder / f"color_{n:06d}.png").write_bytes(color)
        rows = [[min(65535, change(value)) for value in row] for row in depth_of(n)]
        (folder / f"depth_{n:06d}.png").write_bytes(png16(rows))
    (folder / "intrinsics.txt").write_text(f"{FOCAL} {FOCAL} {WIDTH / 2} {HEIGHT / 2}\n{intrinsics}")
    return folder


def play(programs, clip, *more):
    """(what live said on stderr and stdout, the depth of live.json)"""
    out = clip.parent / (clip.name + "-out")
    result = programs.succeeds("live", programs.small_body(), "--source", clip, "--place", "0 0.04 0.5 0 0 0", "--out", out,
                               "--overwrite", "--write", "data,depth", *more)
    return result.stderr + result.stdout, json.loads((out / "live.json").read_text())["depth"]


def warnings(said):
    return [line for line in said.splitlines() if "warning" in line]


# What the numbers of a file are, and what makes them right.
UNITS = {"tum": (lambda mm: 5 * mm, "0.2mm", 0.0002), "icl": (lambda mm: 4 * mm, "0.25mm", 0.00025),
         "d405": (lambda mm: 10 * mm, "0.1mm", 0.0001), "tenths": (lambda mm: mm // 10, "10mm", 0.01),
         "mm": (lambda mm: mm, "1mm", 0.001)}


@case("depth in any unit is right where the unit is stated by option or by file, without a warning")
def _(programs, folder):
    for name, (change, option, metres) in UNITS.items():
        by_option, depth = play(programs, write_clip(folder / name, change), "--depth-unit", option)
        assert warnings(by_option) == [] and "nothing states" not in by_option, by_option
        assert abs(depth["median_m"] / 0.56 - 1) < 0.02 and depth["median_written"] == 1, (name, depth)  # steps of 10 mm, and of the histogram
        assert depth["unit_m"] == metres and not depth["unit_assumed"], (name, depth)
        assert depth["range_m"][0] > 0.48 and depth["range_m"][1] < 0.64, (name, depth)
        by_file, again = play(programs, write_clip(folder / (name + "-file"), change, intrinsics=f"unit_m {metres}\n"))
        assert warnings(by_file) == [] and again == depth, (by_file, again, depth)
    seventh = write_clip(folder / "seventh", UNITS["tum"][0])
    (seventh / "intrinsics.txt").write_text(f"{FOCAL} {FOCAL} {WIDTH / 2} {HEIGHT / 2} {WIDTH} {HEIGHT} 0.0002\n")
    said, depth = play(programs, seventh)
    assert warnings(said) == [] and depth["unit_m"] == 0.0002, (said, depth)


@case("options of other sources are refused for the built-in desk before it is filmed")
def _(programs, folder):
    body = programs.small_body()
    for words in (("--depth-unit", "1mm"), ("--right", "x.mp4"), ("--depth-source", "depth_%d.png"), ("--calibration", "c.yml")):
        programs.refuses("live", body, "--source", "synthetic", *words, "--frames", "1", cwd=folder, says=["built-in desk", words[0]])


@case("where nothing states the unit it stays 1 mm, is said once, and stands in live.json")
def _(programs, folder):
    said, depth = play(programs, write_clip(folder / "clip", frames=35))
    assert warnings(said) == [], said
    assert said.count("nothing states the unit") == 1 and "--depth-unit" in said and "unit_m" in said, said
    assert depth["unit_m"] == 0.001 and depth["unit_assumed"], depth
    line = re.search(r"^depth: measured in 100 % of the pixels, kept in 100 %; median (\S+) m, (\S+) to (\S+) m .*$", said, re.M)
    assert line and abs(float(line[1]) - 0.56) < 0.01 and "a step is 1 mm, which is assumed" in line[0], said
    room = programs.run("scan", folder / "clip", "-o", folder / "room.ply")
    assert room.stderr.count("nothing states the unit") == 1 and "depth: measured in" in room.stdout, room
    view = programs.succeeds("live", "--preview", "--source", folder / "clip")
    assert view.stderr.count("nothing states the unit") == 1 and "median 0.5" in view.stdout, view


@case("depth in another unit than the assumed one is warned of, with the unit that it has")
def _(programs, folder):
    for name, says in (("tum", ["multiples of 5 steps", "median 2.", "--depth-unit 0.2mm"]),
                       ("icl", ["multiples of 4 steps", "--depth-unit 0.25mm"]),
                       ("d405", ["multiples of 10 steps", "--depth-unit 0.1mm"]),
                       ("tenths", ["no depths from 0.1 to 5 m", "median 0.05", "unit", "1 mm, which is assumed"])):
        said, depth = play(programs, write_clip(folder / name, UNITS[name][0]))
        lines = warnings(said)
        assert len(lines) == 1 and all(text in lines[0] for text in says), (name, said)
        assert depth["unit_assumed"], depth
    # Noise that is finer than a millimetre: no common divisor, but the median and the assumption are said.
    said, depth = play(programs, write_clip(folder / "fine", lambda mm: 5 * mm + random.randint(0, 4)))
    assert "nothing states the unit" in said and "median 2.7" in said and depth["median_m"] > 2.7, (said, depth)
    # Metres as whole numbers, and a unit of a metre for millimetres.
    for clip, more in ((write_clip(folder / "metres", lambda mm: 1 + mm // 560), ()),
                       (write_clip(folder / "thousandfold"), ("--depth-unit", "1m")),
                       (write_clip(folder / "thousandth"), ("--depth-unit", "0.001mm"))):
        said, depth = play(programs, clip, *more)
        assert any("no depths from 0.1 to 5 m" in line and "unit" in line for line in warnings(said)), said


@case("swapped bytes are warned of by every command that reads depth, and in recordings")
def _(programs, folder):
    for frames in (1, 3, 12, 40):
        clip = write_clip(folder / f"swapped{frames}", swapped, frames)
        said, depth = play(programs, clip)
        lines = warnings(said)
        assert len(lines) == 1 and "bytes" in lines[0] and "swapped" in lines[0] and "median" in lines[0], said
    result = programs.run("scan", clip, "-o", folder / "room.ply")
    assert sum("bytes of each number are swapped" in line for line in result.stderr.splitlines()) == 1, result
    assert "bytes of each number are swapped" in programs.succeeds("live", "--preview", "--source", clip).stderr
    line = programs.refuses("live", programs.small_body(), "--source", folder / "swapped3", "--anchor", "plane", "--out",
                            folder / "plane", says=["swapped3", "no plane", "bytes of each number are swapped"])
    assert line.count("warning: ") == 1, line
    # Below 0.25 m: all numbers are multiples of 256, as in files of 256 steps in a millimetre.
    near = write_clip(folder / "near", lambda mm: swapped(mm // 3))
    said, _ = play(programs, near)
    assert any("swapped" in line and "--depth-unit 0.00390625mm" in line for line in warnings(said)), said
    said, depth = play(programs, near, "--depth-unit", "0.00390625mm")
    assert warnings(said) == [] and abs(depth["median_m"] - 0.186) < 0.004, (said, depth)


@case("a recording keeps the unit that was decided, and a replay gives the same states")
def _(programs, folder):
    clip = write_clip(folder / "clip", UNITS["tum"][0], frames=4)
    _, depth = play(programs, clip, "--depth-unit", "0.2mm", "--record", folder / "a.palprec")
    replay = programs.succeeds("replay", folder / "a.palprec", "--json", "--out", folder / "again")
    assert "equal" in replay.stderr + replay.stdout, replay
    again = json.loads((folder / "again/live.json").read_text())["depth"]
    assert again == depth and again["unit_m"] == 0.0002, (again, depth)
    _, assumed = play(programs, clip, "--record", folder / "b.palprec")
    said, as_source = play(programs, folder / "b.palprec")
    assert as_source["unit_assumed"] and as_source["median_m"] == assumed["median_m"], (as_source, assumed)
    assert any("multiples of 5" in line for line in warnings(said)), said
    programs.refuses("live", programs.small_body(), "--source", folder / "b.palprec", "--place", "0 0 0.5 0 0 0",
                     "--depth-unit", "0.2mm", says=["--depth-unit", "b.palprec", "metres"])


@case("what was measured and what was kept are two figures, and hardly any of either is a warning")
def _(programs, folder):
    for frames in (3, 40):
        said, depth = play(programs, write_clip(folder / f"zero{frames}", lambda mm: 0, frames))
        lines = warnings(said)
        assert len(lines) == 1 and "measured in 0 % of the pixels and kept in 0 %" in lines[0], said
        assert depth["median_measured"] == depth["median_kept"] == 0 and depth["median_m"] is None, depth
    said, depth = play(programs, folder / "zero40", "--depth-unit", "0.5mm")
    assert len(warnings(said)) == 1, said
    # The depth is there, and the largest depth leaves nothing of it.
    said, depth = play(programs, write_clip(folder / "far", frames=33), "--farthest", "300mm")
    lines = warnings(said)
    assert len(lines) == 1 and "measured in 100 % of the pixels and kept in 0 %" in lines[0] and "--farthest" in lines[0], said
    assert depth["median_measured"] == 1 and depth["median_kept"] == 0 and abs(depth["median_m"] - 0.56) < 0.01, depth
    # A colour camera that looks elsewhere, by the calibration.
    turned = write_clip(folder / "turned", frames=33, intrinsics=f"color {FOCAL} {FOCAL} 80 60  0 0 1 0  0 1 0 0  -1 0 0 0\n")
    said, depth = play(programs, turned)
    assert any("kept in 0 %" in line and "color_from_depth" in line for line in warnings(said)), said
    # Stereo of which all is nearer than is searched: 0.44 m times 2.5 mm / 63 mm.
    clip = base.write_stereo(folder / "stereo", frames=33)
    rectified = clip / "rectified.yml"
    rectified.write_text(rectified.read_text().replace("baseline_m: 0.063", "baseline_m: 0.0025"))
    said, depth = play(programs, clip, "--baseline-ok")
    assert any("2.5 mm" in line and "unit" in line for line in warnings(said)), said
    assert abs(depth["median_m"] - 0.0175) < 3e-4, depth
    # A scene that is a hundred times too large: its depths do not fit into depth/.
    rectified.write_text(rectified.read_text().replace("baseline_m: 0.0025", "baseline_m: 6.3"))
    said, depth = play(programs, clip, "--baseline-ok")
    assert any("depth/ has a depth in 0 %" in line and "unit" in line for line in warnings(said)), said
    assert depth["median_kept"] > 0.3 and depth["median_written"] == 0, depth
    # Half of the pixels are holes, written as 0 or as 65535.
    for hole in (0, 65535):
        holes = write_clip(folder / f"holes{hole}", lambda mm: hole if random.random() < 0.5 else mm)
        said, depth = play(programs, holes)
        assert warnings(said) == [] and abs(depth["median_measured"] - 0.5) < 0.02, (said, depth)


@case("right depth of odd scenes gives no warning")
def _(programs, folder):
    def flat(distance):
        return lambda n: [[distance] * WIDTH] * HEIGHT

    def boards(n):
        return [[512 + 256 * (x // 40) for x in range(WIDTH)]] * HEIGHT

    def hall(n):
        return [[(4000 if y > 110 else 9000 + 13 * y) + random.randint(-20, 20) for x in range(WIDTH)] for y in range(HEIGHT)]

    def staircase(n):
        return [[400 + 50 * (y // 12)] * WIDTH for y in range(HEIGHT)]
    for name, depth_of in (("wall", flat(500)), ("round", flat(1000)), ("near", flat(150)), ("boards", boards), ("hall", hall),
                           ("staircase", staircase), ("noise", lambda n: desk_mm(n, noise=40))):
        said, _ = play(programs, write_clip(folder / name, depth_of=depth_of, frames=31 if name == "hall" else 3))
        assert warnings(said) == [], (name, said)
    # A hand that covers the lens for half a second, and depth that comes late.
    for name, dark in (("covered", range(8, 24)), ("late", range(0, 20))):
        clip = write_clip(folder / name, frames=40, depth_of=lambda n: flat(0)(n) if n in dark else desk_mm(n))
        said, _ = play(programs, clip)
        assert warnings(said) == [], (name, said)


@case("recorded depth of four sensors, and stereo of a car and of a room, give no warning of their unit")
def _(programs, folder):
    zed = ("--calibration", DATA / "zed/SN10027514.conf")
    for name, more in (("hands_squirrel", ()), ("hands_desk", ()), ("rgbd_pose_7scenes", ()), ("stereo_video_kitti1", ()),
                       ("zed/raw", zed)):
        source = DATA / name
        if not source.exists():
            print(f"SKIPPED: no folder {source}")
            continue
        result = programs.succeeds("live", programs.small_body(), "--source", source, "--place", "0 0 0.6 0 0 0", "--frames",
                                   "12", "--out", folder / "out", "--overwrite", "--write", "data", *more)
        said = result.stderr + result.stdout
        assert not any("depth" in line or "baseline" in line for line in warnings(said)), (name, said)
        assert re.search(r"^depth: measured in .* median ", said, re.M), said


def read_png16(path):
    """The rows of a PNG of 16 bits, grey, without interlacing."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height = struct.unpack(">II", data[at + 8:at + 16])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    raw, stride, before, rows = zlib.decompress(packed), 2 * width, bytearray(2 * width), []

    def paeth(a, b, c):
        return min((a, b, c), key=lambda v: abs(a + b - c - v))
    for y in range(height):
        begin = y * (stride + 1)
        row = bytearray(raw[begin + 1:begin + 1 + stride])
        for i in range(stride):
            left, corner = (row[i - 2], before[i - 2]) if i > 1 else (0, 0)
            row[i] = (row[i] + (0, left, before[i], (left + before[i]) // 2, paeth(left, before[i], corner))[raw[begin]]) & 255
        before = row
        rows.append(struct.unpack(f">{width}H", bytes(row)))
    return rows


@case("a recorded desk in wrong units or with swapped bytes is warned of, each time by its cause")
def _(programs, folder):
    recording = DATA / "hands_squirrel"
    if not recording.exists():
        print(f"SKIPPED: no folder {recording}")
        return
    pictures = [read_png16(recording / f"depth_{n:06d}.png") for n in range(2)]
    for name, change, more, cause in (
            ("swapped", swapped, (), "bytes of each number are swapped"), ("tum", lambda mm: 5 * mm, (), "5000 steps in a metre"),
            ("icl", lambda mm: 4 * mm, (), "4000 steps in a metre"), ("metres", lambda mm: round(mm / 1000), (), "unit"),
            ("unit", lambda mm: mm, ("--depth-unit", "1m"), "unit"), ("zero", lambda mm: 0, (), "measured in 0 %"),
            ("right", lambda mm: mm, (), None), ("stated", lambda mm: 5 * mm, ("--depth-unit", "0.2mm"), None),
            ("half", lambda mm: mm // 2, ("--depth-unit", "2mm"), None)):
        clip = folder / name
        clip.mkdir()
        for n, rows in enumerate(pictures):
            shutil.copy(recording / f"color_{n:06d}.png", clip)
            (clip / f"depth_{n:06d}.png").write_bytes(png16([[min(65535, change(v)) for v in row] for row in rows]))
        shutil.copy(recording / "intrinsics.txt", clip)
        said, _ = play(programs, clip, *more)
        lines = warnings(said)
        if cause is None:
            assert lines == [], (name, said)
        else:
            assert any(cause in line for line in lines), (name, cause, said)


@case("a folder in TUM's layout has TUM's unit, which is said, and anything that is stated overrides it")
def _(programs, folder):
    # Bonn's moving scenes have TUM's layout, with intrinsics of their own; other recorders write millimetres.
    for name, change, intrinsics, more, metres in (("bonn", 5, "", (), 0.0002), ("own", 1, "unit_m 0.001\n", (), 0.001),
                                                   ("asked", 1, "", ("--depth-unit", "1mm"), 0.001)):
        clip = write_clip(folder / name, lambda mm: change * mm, frames=3, intrinsics=intrinsics)
        for kind, list_name in (("color", "rgb"), ("depth", "depth")):
            base.lines(clip / f"{list_name}.txt", [f"{1548266470.5 + n / 30:.6f} {kind}_{n:06d}.png" for n in range(3)])
        said, depth = play(programs, clip, *more)
        assert warnings(said) == [] and depth["unit_m"] == metres and not depth["unit_assumed"], (name, said, depth)
        assert abs(depth["median_m"] / 0.56 - 1) < 0.02, (name, depth)
        assert (said.count("0.2 mm, as known of recordings of TUM") == 1) == (name == "bonn"), said


@case("depth units out of range, of sources without depth images, and images that are no depth are refused with the cause")
def _(programs, folder):
    clip = write_clip(folder / "clip")
    words = ("live", programs.small_body(), "--place", "0 0 0.5 0 0 0", "--source")
    programs.refuses(*words, clip, "--depth-unit", "1", says=["--depth-unit", "1mm"])
    programs.refuses(*words, clip, "--depth-unit", "5000", says=["--depth-unit", "no unit"])
    programs.refuses(*words, clip, "--depth-unit", "2m", says=["--depth-unit", "1m"])
    programs.refuses(*words, clip, "--depth-unit", "1kPa", says=["--depth-unit", "no length"])
    for text, says in (("unit_m 5000", "0.0002"), ("unit_m 0", "0.001"), ("unit_m", "unit_m"), ("unit_m -0.001", "0.001")):
        (clip / "intrinsics.txt").write_text(f"140 140 80 60\n{text}\n")
        programs.refuses(*words, clip, says=["intrinsics.txt", says])
    (clip / "intrinsics.txt").write_text("140 140 80 60\n")
    stereo = base.write_stereo(folder / "stereo", frames=2)
    programs.refuses(*words, stereo, "--depth-unit", "1mm", says=["--depth-unit", "stereo pairs"])
    for n in range(3):
        (clip / f"depth_{n:06d}.png").write_bytes(base.png(WIDTH, HEIGHT, lambda x, y: 90 + y))
    programs.refuses(*words, clip, says=["depth_00000", "8 bit, 3 channels", "in colours"])


@case("inches are a unit of surfaces and of every length")
def _(programs, folder):
    description = base.write_ball(folder)
    sizes = {}
    for unit, metres in (("in", 0.0254), ("cm", 0.01), ("mm", 0.001)):
        result = programs.succeeds("mesh", folder / "ball.off", "-o", folder / f"{unit}.msh", "--unit", unit)
        sizes[unit] = float(re.search(r"volume (\S+) m\^3", result.stdout)[1]) / metres**3
    assert abs(sizes["in"] / sizes["cm"] - 1) < 1e-3 and abs(sizes["mm"] / sizes["cm"] - 1) < 1e-3, sizes
    inches = programs.succeeds("mesh", folder / "ball.off", "-o", folder / "a.msh", "--height", "4in", "--edge", "0.5 in")
    metric = programs.succeeds("mesh", folder / "ball.off", "-o", folder / "a.msh", "--height", "101.6mm", "--edge", "12.7mm")
    assert inches.stdout == metric.stdout, (inches.stdout, metric.stdout)
    text = description.read_text().replace('height = "100 mm"', 'unit = "in"').replace('edge = "12 mm"', 'edge = "0.2 in"')
    description.write_text(text)
    programs.succeeds("bake", description, "-o", folder / "inches.palpable")
    said = programs.succeeds("inspect", folder / "inches.palpable").stdout
    assert "50.8 x 50.8 x 50.8 mm" in said, said
    description.write_text(text.replace('"in"', '"inches"'))
    programs.succeeds("bake", description, "-o", folder / "inches.palpable")
    assert "50.8 x 50.8 x 50.8 mm" in programs.succeeds("inspect", folder / "inches.palpable").stdout
    description.write_text(text.replace('"in"', '"yd"'))
    programs.refuses("bake", description, "-o", folder / "x.palpable", says=["unit", "yd", "'in'"])
    programs.refuses("mesh", folder / "ball.off", "-o", folder / "x.msh", "--unit", "ft", says=["--unit"])
    _, depth = play(programs, write_clip(folder / "clip", lambda mm: 5 * mm), "--depth-unit", "0.00787401574803in")
    assert abs(depth["unit_m"] - 0.0002) < 1e-9 and abs(depth["median_m"] - 0.56) < 0.01, depth


if __name__ == "__main__":
    sys.exit(base.main())
