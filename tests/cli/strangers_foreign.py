#!/usr/bin/env python3
"""Calibrations of other programs: OpenCV's pair, ROS's pair, Kalibr, RealSense, ZED; one case is one test, as in programs.py."""
import json
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case

WIDTH, HEIGHT = base.WIDTH, base.HEIGHT
K = [175, 0, 159.5, 0, 175, 89.5, 0, 0, 1]
EYE = [1, 0, 0, 0, 1, 0, 0, 0, 1]


def matrix(name, rows, columns, numbers):
    text = ", ".join(repr(float(n)) for n in numbers)
    return f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {text} ]\n"


LENSES = "%YAML:1.0\n---\n" + "".join(matrix(f"M{e}", 3, 3, K) + matrix(f"D{e}", 1, 5, [0.01, 0, 0, 0, 0]) for e in (1, 2))


def pose(x):
    return "%YAML:1.0\n---\n" + matrix("R", 3, 3, EYE) + matrix("T", 3, 1, [x, 0, 0]) + matrix("Q", 4, 4, range(16))


def ros(name, x, lens="plumb_bob"):
    def block(key, rows, columns, numbers):
        return f"{key}:\n  rows: {rows}\n  cols: {columns}\n  data: [{', '.join(map(str, numbers))}]\n"
    return (f"image_width: {WIDTH}\nimage_height: {HEIGHT}\ncamera_name: {name}\n" + block("camera_matrix", 3, 3, K)
            + f"distortion_model: {lens}\n" + block("distortion_coefficients", 1, 5, [0.01, 0, 0, 0, 0])
            + block("rectification_matrix", 3, 3, EYE) + block("projection_matrix", 3, 4, [175, 0, 159.5, 175 * x, 0, 175, 89.5, 0, 0, 0, 1, 0]))


def camchain(x, lens="radtan"):
    eye = (f"  camera_model: pinhole\n  distortion_coeffs: [0.01, 0.0, 0.0, 0.0]\n  distortion_model: {lens}\n"
           f"  intrinsics: [175.0, 175.0, 159.5, 89.5]\n  resolution: [{WIDTH}, {HEIGHT}]\n")
    return f"cam0:\n{eye}cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, {x}]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n{eye}"


def realsense(mm):
    sizes = {"0": (1920, 1080, 970.7), "1": (WIDTH, HEIGHT, 175.0)}
    entries = {"baseline": str(-mm)}
    for n, (width, height, f) in sizes.items():
        entries |= {f"rectified.{n}.{key}": str(value) for key, value in
                    (("fx", f), ("fy", f), ("ppx", width / 2), ("ppy", height / 2), ("width", width), ("height", height))}
    return json.dumps(entries, indent=1)


def stereo(folder):
    clip = base.write_stereo(folder / "clip", frames=1)
    (clip / "rectified.yml").unlink()
    return clip


def write(folder, **files):
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        stem, ending = name.rsplit("_", 1)
        (folder / f"{stem}.{ending}").write_text(text)
    return folder


def live(programs, source, calibration, *more):
    return ("live", programs.small_body(), "--source", source, "--calibration", calibration, "--place", "0 0.04 0.42 0 0 0", "--frames", "1",
            "--json", *more)


@case("the calibrations of OpenCV, ROS, Kalibr and RealSense are read: either file of a pair, and their folder")
def _(programs, folder):
    clip = stereo(folder)
    opencv = write(folder / "opencv", intrinsics_yml=LENSES, extrinsics_yml=pose(-0.063))
    eyes = write(folder / "ros", left_yaml=ros("left", 0), right_yaml="%YAML:1.0\n---\n" + ros("right", -0.063))
    kalibr = write(folder / "kalibr", camchain_yaml=camchain(-0.063))
    commas = write(folder / "commas", camchain_yaml=camchain(-0.063).replace(".", ","))
    rs = write(folder / "rs", calibration_json=realsense(63))
    for file in (opencv, opencv / "intrinsics.yml", opencv / "extrinsics.yml", eyes, eyes / "left.yaml", eyes / "right.yaml", kalibr,
                 kalibr / "camchain.yaml", commas, rs, rs / "calibration.json"):
        said = programs.succeeds(*live(programs, clip, file)).stderr
        assert "the eyes are 63.0 mm apart" in said, (file, said)
        assert ("no picture size is stated" in said) == (file.parent == opencv or file == opencv), (file, said)
    programs.succeeds("scan", clip, "--calibration", eyes, "-o", folder / "a.ply")


@case("a calibration of another program that cannot be used says whose it is, what is wrong and what to do")
def _(programs, folder):
    clip = stereo(folder)

    def refuses(says, **files):
        shutil.rmtree(folder / "c", ignore_errors=True)
        name = next(iter(files)).rsplit("_", 1)
        programs.refuses(*live(programs, clip, write(folder / "c", **files) / ".".join(name)), says=[".".join(name), *says])
    refuses(["extrinsics.yml beside it"], intrinsics_yml=LENSES)
    refuses(["squares"], intrinsics_yml=LENSES, extrinsics_yml=pose(-2.52))
    refuses(["millimetres"], intrinsics_yml=LENSES, extrinsics_yml=pose(-63))
    refuses(["swapped"], extrinsics_yml=pose(0.063), intrinsics_yml=LENSES)
    refuses(["one eye", "right.yaml"], left_yaml=ros("left", 0))
    refuses(["swapped"], left_yaml=ros("left", 0), right_yaml=ros("right", 0.063))
    refuses(["no distance of the eyes"], left_yaml=ros("left", 0), right_yaml=ros("right", 0))
    refuses(["equidistant"], left_yaml=ros("left", 0, "equidistant"), right_yaml=ros("right", -0.063))
    refuses(["equidistant", "radtan"], camchain_yaml=camchain(-0.063, "equidistant"))
    refuses(["omni"], camchain_yaml=camchain(-0.063).replace("pinhole", "omni"))
    refuses(["1920 x 1080", "not of"], rs_json=realsense(63).replace(f'"{WIDTH}"', '"848"'))
    refuses(["camodocal"], cam_yaml="%YAML:1.0\n---\nmodel_type: MEI\nprojection_parameters:\n   gamma1: 500\n")
    refuses(["K1", "M1", "camera_matrix", "Kalibr", "RealSense", "ZED", "intrinsics.txt"], notes_yaml="colour: blue\n")
    programs.refuses(*live(programs, clip, clip / "left"), says=["left", "no calibration"])


@case("a RealSense's calibration and a ROS file of one camera are of depth, too")
def _(programs, folder):
    depth = folder / "depth"
    depth.mkdir()
    (depth / "color_0.png").write_bytes(base.png(WIDTH, HEIGHT, base.texture(0)))
    (depth / "depth_0.png").write_bytes(base.png(WIDTH, HEIGHT, lambda x, y: 600, bits=16, channels=1))
    files = write(folder / "files", rs_json=realsense(50), depth_yaml=ros("depth", 0))
    said = programs.succeeds(*live(programs, depth, files / "rs.json", "--depth-unit", "1mm")).stderr
    assert "depth's view" in said, said
    programs.succeeds(*live(programs, depth, files / "depth.yaml", "--depth-unit", "1mm"))
    (files / "intrinsics.txt").write_text("175,0 175,0 159,5 89,5\n")
    programs.refuses(*live(programs, depth, files / "intrinsics.txt"), says=["intrinsics.txt", "decimal commas"])


@case("calibrate writes what OpenCV and ROS read, and reads it again")
def _(programs, folder):
    poses = [(0.35 * (n % 3 - 1), 0.35 * (n // 3 - 1), 0.02 * (n % 3), 0.01 * (n % 4) - 0.02, 0.36 + 0.02 * (n % 4)) for n in range(9)]
    base.write_boards(folder / "boards", poses)
    words = ("calibrate", "--source", folder / "boards", "--board", "7x4", "--square", "30mm")
    programs.succeeds(*words, "--accept", "-o", folder / "a.yml", "--export", folder / "out")
    assert {p.name for p in (folder / "out").iterdir()} == {"left.yaml", "right.yaml", "intrinsics.yml", "extrinsics.yml"}
    check = ("--largest-row-error", "5", "--json", "--check")
    truth = json.loads(programs.succeeds(*words, *check, folder / "a.yml").stdout)
    for name in ("left.yaml", "right.yaml", "intrinsics.yml", "extrinsics.yml"):
        again = json.loads(programs.succeeds(*words, *check, folder / "out" / name).stdout)
        for key in ("baseline_m", "row_error_px"):
            assert abs(again[key] - truth[key]) < 1e-6, (name, truth, again)  # pose from R and P of the text
    try:
        import cv2
    except ImportError:
        return
    file = cv2.FileStorage(str(folder / "out/intrinsics.yml"), cv2.FILE_STORAGE_READ)
    own = cv2.FileStorage(str(folder / "a.yml"), cv2.FILE_STORAGE_READ)
    assert (file.getNode("M1").mat() == own.getNode("K1").mat()).all() and (file.getNode("D2").mat() == own.getNode("D2").mat()).all()
    file = cv2.FileStorage(str(folder / "out/extrinsics.yml"), cv2.FILE_STORAGE_READ)
    assert (file.getNode("T").mat() == own.getNode("T").mat()).all()


if __name__ == "__main__":
    sys.exit(base.main())
