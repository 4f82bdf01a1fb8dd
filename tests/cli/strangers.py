#!/usr/bin/env python3
"""Pictures, rigs and files for which nothing was tuned; one case is one test, as in programs.py. `--list` names the cases."""
import json
import shutil
import sys
from math import cos, pi, sin
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from events import touched_body
from with_wall_clip import SCENE

base.CASES.clear()
case = base.case


def write_pair(folder, left="imL.png", right="imR.png"):
    """One frame of base.write_stereo() as two named pictures."""
    clip = base.write_stereo(folder / "clip", frames=1)
    shutil.copy(clip / "left/000000.png", folder / left)
    shutil.copy(clip / "right/000000.png", folder / right)
    return clip / "rectified.yml"


@case("one pair is read by the names of its two pictures, by live and by scan")
def _(programs, folder):
    calibration = write_pair(folder)
    pair = (folder / "imL.png", "--right", folder / "imR.png")
    programs.refuses("scan", *pair, "-o", folder / "a.ply", says=["imL.png has no calibration", "beside it", "baseline_m"])
    shutil.copy(calibration, folder / "rectified.yml")
    said = programs.succeeds("scan", *pair, "-o", folder / "a.ply").stdout
    assert "1 frames, 1 fused" in said and "triangles" in said, said
    programs.succeeds("live", programs.small_body(), "--source", *pair, "--place", "0 0.04 0.42 0 0 0", "--out", folder / "out")
    assert json.loads((folder / "out/live.json").read_text())["frames"] == 1
    programs.refuses("scan", pair[0], "-o", folder / "a.ply", says=["no pair side by side", "--right"])
    programs.refuses("scan", folder / "none.png", "--right", pair[2], "-o", folder / "a.ply", says=["no image is called", "none.png"])
    # An input must not be overwritten.
    programs.refuses("scan", *pair, "-o", folder / "b.ply", "--picture", folder / "imR.png", says=["imR.png"])


@case("a folder in no known layout is told those that are")
def _(programs, folder):
    shutil.move(write_pair(folder, "rgb_0.png", "notes.png"), folder / "rectified.yml")
    shutil.rmtree(folder / "clip")
    (folder / "notes.png").unlink()
    (folder / "depth_0.npz").write_bytes(b"PK")
    programs.refuses("scan", folder, "-o", folder / "a.ply",
                     says=["was not recognised", "rgb_0.png is 320 x 180 px", "imL and imR", "*_0 and *_1", "depth_* (16-bit images)"])


def pose_rows(angle, x):
    """world_from_camera, 3 rows, of a camera rotated about Y."""
    return [[cos(angle), 0, sin(angle), x], [0, 1, 0, 0.1 * x * x], [-sin(angle), 0, cos(angle), 0]]


def line_of(numbers):
    return " ".join(f"{n:.9g}" for n in numbers)


@case("a path is scored against the poses that TUM, KITTI, 7-Scenes and EuRoC publish")
def _(programs, folder):
    begin, count = 1403636579.75, 40
    poses = [pose_rows(0.02 * n, 0.05 * n) for n in range(count)]
    quaternions = [(0, sin(0.01 * n), 0, cos(0.01 * n)) for n in range(count)]
    places = [[row[3] for row in pose] for pose in poses]

    def write_path(name, rate, begin):
        base.lines(folder / name, [line_of([*p, *q]).join((f"{begin + n / rate:.6f} ", ""))
                                   for n, (p, q) in enumerate(zip(places, quaternions))])
        return folder / name
    write_path("groundtruth.txt", 30, begin)
    base.lines(folder / "poses.txt", [line_of(sum(pose, [])) for pose in poses])
    (folder / "scene").mkdir()
    for n, pose in enumerate(poses):
        base.lines(folder / f"scene/frame-{n:06d}.pose.txt", [line_of(row) for row in pose] + ["0 0 0 1"])
    base.lines(folder / "data.csv", ["#timestamp"] + [
        f"{1403636579750000000 + round(n * 1e9 / 30)}," + ",".join(map(str, [*p, q[3], *q[:3], 0, 0, 0]))
        for n, (p, q) in enumerate(zip(places, quaternions))])
    for poses_of, rate, start in (("groundtruth.txt", 30, begin), ("poses.txt", 10, 0), ("scene", 30, 0),
                                  ("scene/frame-000003.pose.txt", 30, 0), ("data.csv", 30, begin)):
        path = write_path("found.txt", rate, start)
        score = json.loads(programs.succeeds("score", "--poses", folder / poses_of, path, "--json").stdout)
        assert score["poses_matched"] == count and score["ate_mm"] < 0.01, (poses_of, score)
        assert score["end_error_percent"] < 0.01 and abs(score["path_m"] - 2) < 0.5, (poses_of, score)
    table = programs.succeeds("score", "--poses", folder / "poses.txt", "--fps", "30", write_path("found.txt", 30, 0)).stdout
    assert "mm rms after alignment" in table and "absolute trajectory error" in table, table
    base.lines(folder / "long.txt", [f"{n / 30:.6f} {1.1 * p[0]} {p[1]} {p[2]} {line_of(q)}"
                                     for n, (p, q) in enumerate(zip(places, quaternions))])
    score = json.loads(programs.succeeds("score", "--poses", folder / "scene", folder / "long.txt", "--json").stdout)
    assert 5 < score["end_error_percent"] < 10 and score["ate_mm"] > 20, score

    found = folder / "found.txt"
    refusals = ((("--poses", folder / "groundtruth.txt", found), ["found.txt", "published are 1403636579.750", "--fps"]),
                (("--poses", folder / "none.txt", found), ["none.txt", "is not there"]),
                (("--poses", found, folder / "none.txt"), ["none.txt"]),
                (("--poses", Path(__file__), found), ["strangers.py", "TUM"]),
                (("--poses", found, found, found), ["--poses", "alone"]),
                ((found,), ["result"]), ((found, found, "--fps", "30"), ["--fps"]))
    for words, says in refusals:
        programs.refuses("score", *words, says=says)


@case("trajectory.txt has the recording's own clock, and so has a replay's")
def _(programs, folder):
    clip = base.write_stereo(folder / "clip", frames=3)
    mav = folder / "flight/mav0"
    for camera, eye in (("cam0", "left"), ("cam1", "right")):
        (mav / camera / "data").mkdir(parents=True)
        for n in range(3):
            shutil.copy(clip / eye / f"{n:06d}.png", mav / camera / f"data/{1403636579750000000 + n * 50000000}.png")
        (mav / camera / "sensor.yaml").write_text(
            f"T_BS:\n  data: [1, 0, 0, {0.063 if eye == 'right' else 0}, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nrate_hz: 20\n"
            "resolution: [320, 180]\nintrinsics: [175, 175, 159.5, 89.5]\ndistortion_model: radial-tangential\n"
            "distortion_coefficients: [0, 0, 0, 0]\n")
    times = "1403636579.750000 1403636579.800000 1403636579.850000".split()

    def times_in(out):
        return [line.split()[0] for line in (folder / out / "trajectory.txt").read_text().splitlines()[1:]]
    programs.succeeds(*base.live(programs, folder, "--record", folder / "a.palprec", source="flight"))
    assert times_in("out") == times, times_in("out")
    programs.succeeds("replay", folder / "a.palprec", "--out", folder / "again")
    assert times_in("again") == times, times_in("again")


@case("stereo is matched at full size when it is asked to be, and a replay does as the run did")
def _(programs, folder):
    clip = base.write_stereo(folder / "clip", frames=3)
    (clip / "scene.toml").write_text(SCENE)
    words = ("live", touched_body(programs), "--source", clip, "--out", folder / "out", "--overwrite")
    sizes = {}
    for size in ("half", "full", "auto"):
        programs.succeeds(*words, "--stereo-size", size, "--farthest", "3m", "--record", folder / f"{size}.palprec")
        picture = (folder / "out/depth/000001.png").read_bytes()
        sizes[size] = int.from_bytes(picture[16:20], "big")
        depth = json.loads((folder / "out/live.json").read_text())["depth"]
        assert depth["median_density"] > 0.5 and depth["frames_sparse_depth"] == [], depth
        assert "equal" in programs.succeeds("replay", folder / f"{size}.palprec").stdout
    assert sizes == {"half": 160, "full": 320, "auto": 320}, sizes
    programs.succeeds(*words, "--farthest", "0.3m")  # the wall is 0.44 m away
    assert json.loads((folder / "out/live.json").read_text())["depth"]["median_density"] == 0
    programs.refuses(*words, "--stereo-size", "double", says=["--stereo-size"])
    programs.refuses(*words, "--farthest", "0m", says=["--farthest"])
    programs.refuses(*words, "--farthest", "nan", says=["--farthest"])
    programs.refuses(*words, "--farthest", "3", says=["--farthest", "3m"])
    # Of 0.1: --depth was of the size, and of a depth camera or depth images.
    programs.refuses(*words, "--depth", "full", says=["--depth", "--stereo-size", "--depth-source"])


@case("boards that are few or hardly tilted are refused with the uncertainty, or accepted with it")
def _(programs, folder):
    poses = [(0.1 * cos(2 * pi * n / 5), 0.1 * sin(2 * pi * n / 5), 0.02 * (n % 3), 0.01 * n - 0.02, 0.38 + 0.02 * (n % 4))
             for n in range(5)]
    base.write_boards(folder / "boards", poses)
    words = ("calibrate", "--source", folder / "boards", "--board", "7x4", "--square", "30mm", "-o", folder / "a.yml")
    programs.refuses(*words, says=["in 5 pairs; 6 are wanted", "tilted by at most", "standard deviation", "--accept"])
    assert not (folder / "a.yml").exists()
    said = programs.succeeds(*words, "--accept").stdout
    assert "accepted although" in said and "standard deviation" in said, said
    found = json.loads(programs.succeeds(*words, "--accept", "--json").stdout)
    assert "5 pairs" in found["weakness"], found
    # The error is within the stated uncertainty.
    assert abs(found["left"]["fx_px"] / 300 - 1) < 4 * found["focal_sigma"], found


@case("a body is put on the pixel of the desk that is asked for")
def _(programs, folder):
    base.write_desk(folder / "desk")
    words = ("live", programs.small_body(), "--source", folder / "desk", "--out", folder / "out", "--overwrite", "--anchor", "plane")
    for u, v in ((100, 110), (220, 70)):
        programs.succeeds(*words, "--at-pixel", f"{u},{v}")
        pose = json.loads((folder / "out/live.json").read_text())["camera_from_body"]
        x, y, z = pose[3], pose[7], pose[11]
        assert abs(175 * x / z + 159.5 - u) < 1 and abs(175 * y / z + 89.5 - v) < 1, pose
        assert pose[6] < -0.6 and pose[10] < -0.6, pose
    programs.refuses(*words, "--at-pixel", "400,20", says=["400, 20 is outside of the picture of 320 x 180"])
    programs.refuses(*words, "--at-pixel", "100", says=["--at-pixel 100", "320,200"])
    programs.refuses(*words, "--at-pixel", "a,b", says=["--at-pixel a,b"])
    programs.refuses(*words[:-2], "--at-pixel", "1,2", says=["--at-pixel", "--anchor plane"])


if __name__ == "__main__":
    sys.exit(base.main())
