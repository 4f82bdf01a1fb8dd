#!/usr/bin/env python3
"""Folders of phones and of data sets as people have them: colour and depth of two sizes, lists, apps' exports. One case is one
test, as in programs.py. `--list` names the cases."""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
import strangers_depth as depth

base.CASES.clear()
case = base.case
WIDTH, HEIGHT = depth.WIDTH, depth.HEIGHT
WORDS = ("--place", "0 0 0.5 0 0 0", "--source")


def half_mm(frame):
    """The desk as a phone measures it: half as many rows and columns."""
    return [row[::2] for row in depth.desk_mm(frame)[::2]]


def write_phone(folder, intrinsics, color="color_{:06d}.png", steps="depth_{:06d}.png", frames=3):
    for n in range(frames):
        for name, data in ((color, base.png(WIDTH, HEIGHT, base.texture(0))), (steps, depth.png16(half_mm(n)))):
            path = folder / name.format(n)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
    (folder / "intrinsics.txt").write_bytes(intrinsics)
    return folder


@case("depth with half of the colour's pixels is read with the numbers of either")
def _(programs, folder):
    full, half = b"140 140 79.5 59.5", b"70 70 39.5 29.5"
    for name, numbers, says in (("color", full + b" 160 120\n", "f = 70 px there and 140 px here"),
                                ("depth", half + b" 80 60\n", "f = 70 px there and 140 px here"),
                                ("guessed", full + b"\n", "taken for the colour's, 160 x 120 px"),
                                ("mark", b"\xef\xbb\xbf" + half + b"\r\n", "taken for the depth's, 80 x 60 px")):
        said, found = depth.play(programs, write_phone(folder / name, numbers))
        assert says in said and depth.warnings(said) == [], (name, said)
        assert abs(found["median_m"] / 0.56 - 1) < 0.02 and found["median_density"] > 0.93, (name, found)  # borders, jumps
    words = ("live", programs.small_body(), *WORDS)
    programs.refuses(*words, write_phone(folder / "other", full + b" 640 480\n"), says=["640 x 480 px", "160 x 120"])
    programs.refuses(*words, write_phone(folder / "comma", b"140,5 140,5 79,5 59,5\n"), says=["intrinsics.txt", "decimal commas"])


@case("folders color/ or rgb/ with depth/, and a folder of OpenLORIS, are read")
def _(programs, folder):
    numbers = b"140 140 79.5 59.5 160 120\n"
    for name in ("color", "rgb"):
        said, found = depth.play(programs, write_phone(folder / f"of-{name}", numbers, name + "/{}.png", "depth/{}.png"))
        assert abs(found["median_m"] / 0.56 - 1) < 0.02, (said, found)
    loris = write_phone(folder / "loris", b"", "color/{}.png", "aligned_depth/{}.png")
    (loris / "intrinsics.txt").unlink()
    for name, places in (("color", "color"), ("aligned_depth", "aligned_depth")):
        base.lines(loris / f"{name}.txt", [f"{100 + n / 30:.6f} {places}/{n}.png" for n in range(3)])
    (loris / "sensors.yaml").write_text(
        "%YAML:1.0\nd400_color_optical_frame:\n   fps: 30\n   width: 160\n   height: 120\n   intrinsics: !!opencv-matrix\n"
        "      rows: 1\n      cols: 4\n      dt: d\n      data: [ 140., 79.5, 140., 59.5 ]\n")
    said, found = depth.play(programs, loris)
    assert "as known of recordings of OpenLORIS" in said and found["unit_m"] == 0.001, (said, found)
    assert abs(found["median_m"] / 0.56 - 1) < 0.02, found
    (loris / "aligned_depth.txt").rename(loris / "depth.txt")
    programs.refuses("live", programs.small_body(), *WORDS, loris, says=["has no aligned_depth.txt"])


@case("exports of phones that cannot be read are refused with what to export")
def _(programs, folder):
    words = ("live", programs.small_body(), *WORDS)
    base.lines(folder / "r3d/metadata", ["{}"])
    base.lines(folder / "r3d/rgbd/0.depth", ["bvx2"])
    programs.refuses(*words, folder / "r3d", says=["Record3D", "export the recording in the app as EXR + RGB"])
    base.lines(folder / "clip.r3d", ["PK"])
    programs.refuses(*words, folder / "clip.r3d", says=["Record3D", "EXR + RGB"])
    stray = folder / "stray"
    base.lines(stray / "camera_matrix.csv", ["140,0,79.5", "0,140,59.5", "0,0,1"])
    base.lines(stray / "odometry.csv", ["timestamp, frame, x, y, z, qx, qy, qz, qw", "1.5, 000000, 0, 0, 0, 0, 0, 0, 1"])
    (stray / "depth").mkdir()
    programs.refuses(*words, stray, says=["Stray Scanner", "has no rgb.mp4"])


if __name__ == "__main__":
    sys.exit(base.main())
