#!/usr/bin/env python3
"""Cameras, as far as the programs can be tried without one; the rest is tested with cameras made of code
(src/palpable/live/sources/camera_*_test.cpp). One case is one test, as in programs.py. `--list` names the cases."""
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case
NONE = "/dev/video987654"
INTRINSICS = "140 140 80 60 160 120\n"


@case("a camera that is not there, or is none, is refused by what it is")
def _(programs, folder):
    body = programs.small_body()
    programs.refuses("live", body, "--source", NONE, says=[NONE, "palpable cameras"])
    programs.refuses("live", body, "--source", "/dev/null", says=["/dev/null is no video device"])
    programs.refuses("calibrate", NONE, says=[NONE, "palpable cameras"])
    (folder / "intrinsics.txt").write_text(INTRINSICS)
    programs.refuses("live", body, "--source", NONE, "--depth-source", "auto", "--calibration", folder / "intrinsics.txt",
                     says=[NONE, "palpable cameras"])


@case("one device cannot be two, however it is named")
def _(programs, folder):
    body = programs.small_body()
    (folder / "intrinsics.txt").write_text(INTRINSICS)
    for other in (NONE, "/dev/../dev/video987654"):
        programs.refuses("live", body, "--source", NONE, "--right", other, says=["is named twice", "--right", "palpable cameras"])
        programs.refuses("live", body, "--source", NONE, "--depth-source", other, "--calibration",
                         folder / "intrinsics.txt", says=["is named twice", "--depth-source"])


@case("the depth of the same camera is for cameras only")
def _(programs, folder):
    body = programs.small_body()
    clip = base.write_stereo(folder / "clip", frames=1)
    programs.refuses("live", body, "--source", clip, "--depth-source", "auto", says=["--depth-source auto", "cameras only", "clip"])
    programs.refuses("live", body, "--source", clip / "left/*.png", "--depth-source", "auto", says=["--depth-source auto", "cameras only"])


@case("a scene file keeps the depth of the same camera as a word, not as a file")
def _(programs, folder):
    (folder / "intrinsics.txt").write_text(INTRINSICS)
    text = programs.succeeds("live", programs.small_body(), "--source", NONE, "--depth-source", "auto", "--calibration",
                             folder / "intrinsics.txt", "--print-config").stdout
    assert 'depth-source = "auto"' in text, text
    scene = folder / "camera.toml"
    scene.write_text(text)
    again = programs.succeeds("live", scene, "--print-config").stdout
    assert 'depth-source = "auto"' in again, again


@case("cameras lists what this machine has")
def _(programs, folder):
    listed = json.loads(programs.succeeds("cameras", "--json").stdout)["cameras"]
    for camera in listed:
        assert camera["device"].startswith("/dev/video"), camera
        assert "trouble" in camera or {"usb_megabits", "users", "may_slow_down"} <= camera.keys(), camera
    text = programs.succeeds("cameras").stdout
    assert listed or "USB 3 port" in text, text
    help_text = programs.succeeds("cameras", "--help").stdout
    assert "interleaved" in help_text and "USB" in " ".join(help_text.split()), help_text
    assert "auto" in programs.succeeds("scan", "--help").stdout.split("--depth-source", 1)[1][:600]


if __name__ == "__main__":
    sys.exit(base.main())
