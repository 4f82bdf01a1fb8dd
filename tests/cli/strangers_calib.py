#!/usr/bin/env python3
"""Calibrations in wrong units, statements and guesses, times that are no seconds; one case is one test, as in programs.py."""
import json
import os
import shutil
import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from campaigns import rows_of, vtu_arrays

base.CASES.clear()
case = base.case

WIDTH, HEIGHT = base.WIDTH, base.HEIGHT


def matrix(name, rows, columns, numbers):
    text = ", ".join(repr(float(n)) for n in numbers)
    return f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {text} ]\n"


def rig(T, cx=159.5, f=175.0):
    """An OpenCV YAML rig without distortion for write_stereo()."""
    K = [f, 0, cx, 0, f, 89.5, 0, 0, 1]
    return (f"%YAML:1.0\n---\nimage_width: {WIDTH}\nimage_height: {HEIGHT}\nfps: 30.0\n" + matrix("K1", 3, 3, K) + matrix("D1", 1, 5, [0] * 5)
            + matrix("K2", 3, 3, K) + matrix("D2", 1, 5, [0] * 5) + matrix("R", 3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1]) + matrix("T", 3, 1, T))


def rectified(baseline, cx=159.5, f=175.0, width=WIDTH, height=HEIGHT):
    return (f"%YAML:1.0\n---\nfx: {float(f)}\nfy: {float(f)}\ncx: {float(cx)}\ncy: {height / 2}\nwidth: {width}\nheight: {height}\n"
            f"baseline_m: {float(baseline)}\ndoffs_px: 0.0\nfps: 30.0\n")


def factory(baseline, cx=640, ty=0.0, tz=0.0):
    """A ZED's file for eyes of 1280 x 720 px; lengths in mm."""
    eye = f"fx=700\nfy=700\ncx={cx}\ncy=360\nk1=0\nk2=0\n"
    return f"[LEFT_CAM_HD]\n{eye}[RIGHT_CAM_HD]\n{eye}[STEREO]\nBaseline={baseline}\nTY={ty}\nTZ={tz}\nCV_HD=0\nRX_HD=0\nRZ_HD=0\n"


def kitti(baseline, cx=159.5, f=175.0):
    row = f"{f} 0 {cx} {{}} 0 {f} 89.5 0 0 0 1 0"
    return f"P0: {row.format(0)}\nP1: {row.format(-f * baseline)}\n"


def middlebury(baseline_mm, cx=159.5, f=175.0):
    return (f"cam0=[{f} 0 {cx}; 0 {f} 89.5; 0 0 1]\ncam1=[{f} 0 {cx}; 0 {f} 89.5; 0 0 1]\ndoffs=0\nbaseline={baseline_mm}\n"
            f"width={WIDTH}\nheight={HEIGHT}\n")


def euroc(x, cx=159.5, f=175.0):
    return (f"T_BS:\n  data: [1, 0, 0, {x}, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nrate_hz: 20\nresolution: [{WIDTH}, {HEIGHT}]\n"
            f"intrinsics: [{f}, {f}, {cx}, 89.5]\ndistortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n")


class Pictures:
    """One stereo pair in the layouts whose calibration is a file of its own."""

    def __init__(self, folder):
        self.folder = folder
        clip = base.write_stereo(folder / "plain", frames=1)
        (clip / "rectified.yml").unlink()
        left, right = clip / "left/000000.png", clip / "right/000000.png"
        for camera, eye in (("cam0", left), ("cam1", right)):
            self.copy(eye, f"euroc/mav0/{camera}/data/1403636579750000000.png")
        for camera, eye in (("image_0", left), ("image_1", right)):
            self.copy(eye, f"kitti/{camera}/000000.png")
        self.copy(left, "middlebury/im0.png")
        self.copy(right, "middlebury/im1.png")

    def copy(self, source, name):
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, self.folder / name)

    def with_baseline(self, metres, **numbers):
        """(name of the calibration, words of live) of every kind of file, all with this baseline."""
        def write(name, text):
            (self.folder / name).write_text(text)
            return self.folder / name
        write("euroc/mav0/cam0/sensor.yaml", euroc(0, **numbers))
        write("euroc/mav0/cam1/sensor.yaml", euroc(metres, **numbers))
        write("kitti/calib.txt", kitti(metres, **numbers))
        write("middlebury/calib.txt", middlebury(1e3 * metres, **numbers))
        plain = ("--source", self.folder / "plain", "--calibration")
        return [("rig.yml", (*plain, write("rig.yml", rig([-metres, 0, 0], **numbers)))),
                ("rectified.yml", (*plain, write("rectified.yml", rectified(metres, **numbers)))),
                ("sensor.yaml", ("--source", self.folder / "euroc")), ("calib.txt", ("--source", self.folder / "kitti")),
                ("calib.txt", ("--source", self.folder / "middlebury"))]


def live(programs, *words):
    return ("live", programs.small_body(), *words, "--place", "0 0.04 0.42 0 0 0", "--frames", "1", "--json")


@case("a baseline in squares, centimetres or twice divided is refused in every kind of calibration file")
def _(programs, folder):
    pictures = Pictures(folder)
    for metres, said in ((2.52, "2.52 squares of 25 mm are 63.0 mm"), (6.3, "in centimetres"), (6, "in centimetres"), (0.0025, "squares of a board")):
        for name, words in pictures.with_baseline(metres):
            programs.refuses(*live(programs, *words), says=[name, "apart", "metre", said, "--baseline-ok"])
    for name, words in pictures.with_baseline(2.52):
        taken = programs.succeeds(*live(programs, *words, "--baseline-ok"))
        assert "the eyes are 2.520 m apart" in taken.stderr, taken.stderr
        programs.refuses("scan", *words[1:], "-o", folder / "a.ply", says=[name, "2.52 squares"])
    # 63 m is no pair of eyes.
    for name, words in pictures.with_baseline(63):
        programs.refuses(*live(programs, *words, "--baseline-ok"), says=[name, "millimetres", "squares"])


@case("usual baselines are taken and printed, whatever the kind of file")
def _(programs, folder):
    pictures = Pictures(folder)
    for metres, said in ((0.01, "10.0 mm"), (0.063, "63.0 mm"), (0.193, "193.0 mm"), (0.537, "0.537 m"), (1.0, "1.000 m")):
        for name, words in pictures.with_baseline(metres):
            result = programs.succeeds(*live(programs, *words))
            assert result.stderr.count(f"the eyes are {said} apart") == 1, (name, result.stderr)
            assert "squares" not in result.stderr, (name, result.stderr)
            # With 10 mm the pictures really show a wall 70 mm away, of which the depth is warned.
            assert metres < 0.05 or "warning" not in result.stderr, (name, result.stderr)
    scanned = programs.succeeds("scan", *pictures.with_baseline(0.063)[0][1][1:], "-o", folder / "a.ply")
    assert scanned.stderr.count("the eyes are 63.0 mm apart") == 1, scanned.stderr


@case("principal points outside the picture and focal lengths of no picture are refused in every kind of file")
def _(programs, folder):
    pictures = Pictures(folder)
    for numbers, said in (({"cx": 325.0}, "principal point"), ({"cx": -162.5}, "principal point"), ({"f": 0.35}, "0.35 px")):
        for name, words in pictures.with_baseline(0.063, **numbers):
            programs.refuses(*live(programs, *words), says=[name, said, "320 x 180"])
    for name, words in pictures.with_baseline(0.063, cx=2.0):  # a crop
        assert "principal" not in programs.succeeds(*live(programs, *words)).stderr, name
    (folder / "SN1.conf").write_text(factory(63.5, cx=-640))
    programs.refuses(*live(programs, "--source", folder / "plain", "--calibration", folder / "SN1.conf"), says=["SN1.conf", "not for 320 x 180"])
    depth = folder / "depth"
    depth.mkdir()
    (depth / "color_0.png").write_bytes(base.png(WIDTH, HEIGHT, base.texture(0)))
    (depth / "depth_0.png").write_bytes(base.png(WIDTH, HEIGHT, lambda x, y: 600, bits=16, channels=1))
    for text, said in (("175 175 325 90", "principal point"), ("175 175 160 -90 320 180 0.001", "principal point"), ("0.35 0.35 160 90", "0.35 px"),
                       ("175 175 160 90\ncolor 175 175 400 90", "colour principal point")):
        (depth / "intrinsics.txt").write_text(text)
        programs.refuses(*live(programs, "--source", depth), says=["intrinsics.txt", said])
    (depth / "intrinsics.txt").write_text("175 175 160 90 320 180 0.001")
    programs.succeeds(*live(programs, "--source", depth))


@case("swapped eyes are called so in every kind of file, and one eye that is given twice")
def _(programs, folder):
    pictures = Pictures(folder)
    for name, words in pictures.with_baseline(-0.063):
        programs.refuses(*live(programs, *words), says=[name, "the eyes are swapped"])
    for name, words in pictures.with_baseline(0.0):
        programs.refuses(*live(programs, *words), says=[name, "in one place"])


@case("a board measured with the wrong side of its squares is refused with that side")
def _(programs, folder):
    poses = [(0.35 * (n % 3 - 1), 0.35 * (n // 3 - 1), 0.02 * (n % 3), 0.01 * (n % 4) - 0.02, 0.36 + 0.02 * (n % 4)) for n in range(9)]
    base.write_boards(folder / "boards", poses)
    words = ("calibrate", "--source", folder / "boards", "--board", "7x4", "--accept", "-o", folder / "a.yml")
    programs.refuses(*words, "--square", "1m", says=["2.3", "squares of a board", "--square 1000mm", "--baseline-ok"])
    programs.refuses(*words, "--square", "1mm", says=["2.3 mm", "--square 1mm"])
    assert not (folder / "a.yml").exists()
    programs.succeeds(*words, "--square", "1m", "--baseline-ok")
    check = ("calibrate", "--source", folder / "boards", "--board", "7x4", "--check", folder / "a.yml", "--largest-row-error", "5")
    programs.refuses(*check, says=["a.yml", "squares of a board"])
    assert "baseline 2.3" in programs.succeeds(*check, "--baseline-ok").stdout
    said = programs.succeeds(*words, "--square", "30mm").stdout
    assert "baseline 70." in said or "baseline 69." in said, said
    assert "baseline 70." in programs.succeeds(*check).stdout or "baseline 69." in programs.succeeds(*check).stdout


def write_avi(path, width, height, pictures):
    """Uncompressed, 20 frames/s. pictures: functions of (x, y) to grey levels."""
    def chunk(name, data):
        return name + struct.pack("<I", len(data)) + data + b"\0" * (len(data) % 2)

    def of_kind(kind, name, data):
        return chunk(kind, name + data)
    pad = b"\0" * (-3 * width % 4)
    frames = []
    for shade in pictures:
        rows = [b"".join(bytes([shade(x, y)] * 3) for x in range(width)) + pad for y in range(height)]
        frames.append(b"".join(reversed(rows)))
    size = len(frames[0])
    main = struct.pack("<14I", 50000, size * 20, 0, 0x10, len(frames), 0, 1, size, width, height, 0, 0, 0, 0)
    stream = b"vidsDIB " + struct.pack("<IHHIIIIIIII4H", 0, 0, 0, 0, 1, 20, 0, len(frames), size, 0xFFFFFFFF, 0, 0, 0, width, height)
    form = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, size, 0, 0, 0, 0)
    header = of_kind(b"LIST", b"hdrl", chunk(b"avih", main) + of_kind(b"LIST", b"strl", chunk(b"strh", stream) + chunk(b"strf", form)))
    movie, index = b"", b""
    for frame in frames:
        index += b"00db" + struct.pack("<III", 0x10, 4 + len(movie), size)
        movie += chunk(b"00db", frame)
    path.write_bytes(of_kind(b"RIFF", b"AVI ", header + of_kind(b"LIST", b"movi", movie) + chunk(b"idx1", index)))


@case("a calibration says whether a video shows both eyes side by side, whatever its shape")
def _(programs, folder):
    width, height = 427, 480
    both = lambda x, y: base.texture(0 if x < width else 25 - width)(x, y)
    write_avi(folder / "both.avi", 2 * width, height, [both, both])
    words = ("--source", folder / "both.avi")
    programs.refuses(*live(programs, *words), says=["854 x 480", "no pair side by side"])
    (folder / "own.yml").write_text(rectified(0.063, cx=213, f=230, width=width, height=height))
    result = programs.succeeds(*live(programs, *words, "--calibration", folder / "own.yml"))
    assert "assumed" not in result.stderr and "taken for" not in result.stderr, result.stderr
    shutil.copy(folder / "own.yml", folder / "both.yml")
    programs.succeeds(*live(programs, *words))
    # The calibration of the whole picture: it is one eye's.
    (folder / "whole.yml").write_text(rectified(0.063, cx=427, f=460, width=2 * width, height=height))
    programs.refuses(*live(programs, *words, "--calibration", folder / "whole.yml"), says=["--right", "whole.yml", "854 x 480"])
    # A fault of the calibration is what is said, not the shape.
    (folder / "bad.yml").write_text(rectified(2.52, cx=213, f=230, width=width, height=height))
    programs.refuses(*live(programs, *words, "--calibration", folder / "bad.yml"), says=["bad.yml", "squares"])


def write_kinect(folder, names, intrinsics=None, width=640, height=480):
    """One frame of colour and depth; names: (colour, depth)."""
    folder.mkdir(parents=True)
    for name, bits, channels, shade in ((names[0], 8, 3, lambda x, y: (7 * x + 11 * y) % 200), (names[1], 16, 1, lambda x, y: 900)):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(base.png(width, height, shade, bits=bits, channels=channels))
    if intrinsics:
        (folder / "intrinsics.txt").write_text(intrinsics)
    return folder


@case("numbers that a folder states are taken as they are, and what is assumed is said")
def _(programs, folder):
    seven = ("frame-000000.color.png", "frame-000000.depth.png")

    def said(name, names, intrinsics=None, **size):
        return programs.succeeds(*live(programs, "--source", write_kinect(folder / name, names, intrinsics, **size))).stderr
    # f = 585 px of another camera: with its size, or with another centre.
    for n, text in enumerate(("585 585 320 240 640 480 0.001", "585 585 320 240 640 480", "585 585 319.5 239.5", "585 586 320 240")):
        assert "colour camera is assumed" not in said(f"own{n}", seven, text), text
    assert "has the numbers of 7-Scenes: its colour camera is assumed" in said("published", seven, "585 585 320 240")
    assert "colour camera is assumed" not in said("line", seven, "585 585 320 240\ncolor 585 585 320 240")
    assert "no intrinsics.txt: those of 7-Scenes are assumed" in said("none", seven)
    programs.refuses(*live(programs, "--source", write_kinect(folder / "small", seven, width=320, height=240)), says=["320 x 240", "intrinsics.txt"])

    tum = ("rgb/a.png", "depth/a.png")

    def stamped(name, intrinsics=None, stamp="7.5", **size):
        write_kinect(folder / name, tum, intrinsics, **size)
        base.lines(folder / name / "rgb.txt", [f"{stamp} rgb/a.png"])
        base.lines(folder / name / "depth.txt", [f"{stamp} depth/a.png"])
        return "--source", folder / name
    noted = programs.succeeds(*live(programs, *stamped("freiburg3/freiburg1_xyz"))).stderr
    assert "those of freiburg1 are assumed from its name" in noted, noted
    noted = programs.succeeds(*live(programs, *stamped("freiburg1_mine", "500 500 320 240"))).stderr
    assert "freiburg1 are assumed" not in noted, noted
    programs.refuses(*live(programs, *stamped("freiburg2_small", width=320, height=240)), says=["freiburg2", "320 x 240", "intrinsics.txt"])
    for unit, stamp in (("nanoseconds", "1305031102175304000"), ("microseconds", "1305031102175304")):
        programs.refuses(*live(programs, *stamped(unit, "500 500 320 240", stamp)), says=["rgb.txt", unit, "divide"])


@case("a rate that no file states is said")
def _(programs, folder):
    clip = base.write_stereo(folder / "clip", frames=3)
    assert "no times: a rate of 30 Hz is assumed" in programs.succeeds(*live(programs, "--source", clip)).stderr
    (clip / "rectified.yml").write_text((clip / "rectified.yml").read_text() + "fps: 15.0\n")
    assert "assumed" not in programs.succeeds(*live(programs, "--source", clip)).stderr
    (folder / "drive").mkdir()
    for camera, eye in (("image_0", "left"), ("image_1", "right")):
        shutil.copytree(clip / eye, folder / "drive" / camera)
    (folder / "drive/calib.txt").write_text(kitti(0.063))
    assert "10 Hz is assumed" in programs.succeeds(*live(programs, "--source", folder / "drive")).stderr
    base.lines(folder / "drive/times.txt", ["0", "0.1", "0.2"])
    assert "assumed" not in programs.succeeds(*live(programs, "--source", folder / "drive")).stderr
    base.lines(folder / "drive/times.txt", ["0", "103736000", "207472000"])
    programs.refuses(*live(programs, "--source", folder / "drive"), says=["times.txt", "nanoseconds"])


def write_path(path, times):
    base.lines(path, [f"{t} {0.03 * n:.4f} {0.01 * n:.4f} {-0.02 * n:.4f} 0 0 0 1" for n, t in enumerate(times)])
    return path


@case("paths whose times are no seconds are refused with their unit, truth and result alike")
def _(programs, folder):
    seconds = [f"{0.1 * n:.1f}" for n in range(100)]
    good = write_path(folder / "good.txt", seconds)
    wrong = {"nanoseconds": [100000000 * n for n in range(100)], "microseconds": [100000 * n for n in range(100)],
             "milliseconds": [100 * n for n in range(100)]}
    for unit, times in wrong.items():
        bad = write_path(folder / f"{unit}.txt", times)
        programs.refuses("score", "--poses", bad, bad, says=[f"{unit}.txt", unit, "seconds", "divide"])
    for unit in ("nanoseconds", "microseconds"):
        programs.refuses("score", "--poses", good, folder / f"{unit}.txt", says=[f"{unit}.txt", unit])
        programs.refuses("scan", base.write_stereo(folder / f"clip_{unit}", frames=2), "--trajectory", folder / f"{unit}.txt", "-o", folder / "a.ply",
                         says=[f"{unit}.txt", unit])
    # What ORB-SLAM writes for EuRoC.
    orb = write_path(folder / "orb.txt", [f"{1403636579763555584 + 50000000 * n}.000000" for n in range(20)])
    programs.refuses("score", "--poses", good, orb, says=["orb.txt", "nanoseconds"])
    base.lines(folder / "commas.txt", [f"1311870427,{644555 + n} 0,000602 0,1 -0,2 0,0 0,0 0,0 1,0" for n in range(9)])
    for words in ((folder / "commas.txt", good), (good, folder / "commas.txt")):
        programs.refuses("score", "--poses", *words, says=["commas.txt", "decimal commas"])
    for begin, rate in ((0, 30), (1403636579.76, 200), (1.7e9, 1), (12, 0.2), (86400, 1000)):
        path = write_path(folder / "right.txt", [f"{begin + n / rate:.6f}" for n in range(40)])
        score = json.loads(programs.succeeds("score", "--poses", path, path, "--json").stdout)
        assert score["poses_matched"] == 40, (begin, rate, score)


@case("a factory file is read the same under a locale with decimal commas")
def _(programs, folder):
    eyes = folder / "eyes"
    for eye, shift in (("left", 0), ("right", 60)):
        (eyes / eye).mkdir(parents=True)
        (eyes / eye / "0.png").write_bytes(base.png(1280, 720, lambda x, y, s=shift: ((x + s) // 3 * 7 + y // 3 * 13) % 199))
    (eyes / "SN10025811.conf").write_text(factory(63.5, ty=1.5, tz=-0.75))
    said = []
    for language in ("C", "de_DE.UTF-8"):
        os.environ["LC_ALL"] = language
        try:
            said.append(programs.succeeds(*live(programs, "--source", eyes)).stderr)
        finally:
            del os.environ["LC_ALL"]
    assert all("the eyes are 63.5 mm apart" in text for text in said), said


def npy(path, rows):
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({len(rows)}, {len(rows[0])}), }}\n".encode()
    numbers = [n for row in rows for n in row]
    path.write_bytes(b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header + struct.pack(f"<{len(numbers)}d", *numbers))


def in_order_of_deck(arrays):
    """A solution's arrays in the order of the bar's deck: x runs fastest, then y, then z, in steps of 10 mm."""
    steps = [[round((x + 0.01 * (k < 2)) / 0.01) for k, x in enumerate(place)] for place in rows_of(arrays["points"])]
    order = sorted(range(len(steps)), key=lambda i: steps[i][::-1])
    return {name: (arrays[name][0], [n for i in order for n in rows_of(arrays[name])[i]])
            for name in ("displacement", "cauchy_stress", "von_mises")}


def turned_deck(to_file):
    """The bar's deck with each node's place turned."""
    lines, of_nodes = [], False
    for line in base.bar_deck().splitlines():
        if line.startswith("*"):
            of_nodes = line == "*NODE"
        elif of_nodes:
            number, *place = line.split(",")
            line = ", ".join([number, *(word.strip() for word in to_file(place))])
        lines.append(line)
    return "\n".join(lines) + "\n"


MANIFEST = """body = "bar.toml"
[[field]]
name = "displacement"
[[field]]
name = "stress"
[[field]]
name = "von_mises"
[[snapshot]]
site = 0
level = 0.5
files = {displacement = "u1.npy", stress = "s1.npy", von_mises = "m1.npy"}
[[snapshot]]
site = 0
force = "1.5 N"
files = {displacement = "u2.npy", stress = "s2.npy", von_mises = "m2.npy"}
"""


@case("snapshots of a solid that stands another way up are turned as it is, every component of them")
def _(programs, folder):
    solved = base.write_bar(folder / "solved", base.BAR.replace('direction = [1, 0, 0]', 'direction = [3, -2, 1]'))
    fields = {}
    for level in (1, 2):
        programs.succeeds("solve", solved, "--level", level / 2, "-o", folder / f"level_{level}.vtu")
        fields[level] = in_order_of_deck(vtu_arrays(folder / f"level_{level}.vtu"))
    # From the body's axes to those of a file in which the body's z is x, y or z: places and vectors, then xx yy zz xy yz zx.
    ways = {"z": ((0, 1, 2), (0, 1, 2, 3, 4, 5)),
            "y": ((1, 2, 0), (1, 2, 0, 4, 5, 3)),  # file x y z = body y z x; file xy is body yz, yz is zx, zx is xy
            "x": ((2, 0, 1), (2, 0, 1, 5, 3, 4))}  # file x y z = body z x y
    stores = {}
    for up, (vector, tensor) in ways.items():
        there = folder / up
        base.write_bar(there, base.BAR.replace('unit = "mm"', f'unit = "mm"\nup = "{up}"').replace('direction = [1, 0, 0]', 'direction = [3, -2, 1]'),
                       turned_deck(lambda place, order=vector: [place[k] for k in order]))
        for level, arrays in fields.items():
            npy(there / f"u{level}.npy", [[row[k] for k in vector] for row in rows_of(arrays["displacement"])])
            npy(there / f"s{level}.npy", [[row[k] for k in tensor] for row in rows_of(arrays["cauchy_stress"])])
            npy(there / f"m{level}.npy", rows_of(arrays["von_mises"]))
        (there / "m.toml").write_text(MANIFEST)
        programs.succeeds("import-snapshots", there, "--manifest", there / "m.toml", "-o", there / "bar.snapshots")
        stores[up] = (there / "bar.snapshots/site_0000.h5").read_bytes()
    assert min(abs(n) for row in rows_of(fields[2]["cauchy_stress"])[40:41] for n in row) > 0
    assert stores["y"] == stores["z"] and stores["x"] == stores["z"]


@case("a real car's rig and a real Kinect open without a warning, and say what they are")
def _(programs, folder):
    data = base.ROOT.parent / "shared/data"
    if not data.is_dir():
        print("SKIPPED: no " + str(data))
        return
    said = programs.succeeds(*live(programs, "--source", data / "stereo_video_kitti1")).stderr
    assert "the eyes are 0.537 m apart" in said and "unit" not in said, said
    said = programs.succeeds(*live(programs, "--source", data / "rgbd_pose_7scenes")).stderr
    assert "7-Scenes" in said, said


if __name__ == "__main__":
    sys.exit(base.main())
