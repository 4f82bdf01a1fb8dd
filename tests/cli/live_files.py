#!/usr/bin/env python3
"""The files that a live run writes; one case is one test, as in programs.py. `--list` names the cases."""
import json
import os
import shutil
import struct
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case


def without_out(programs, folder, *more):
    words = list(base.live(programs, folder, *more))
    at = words.index("--out")
    del words[at:at + 2]
    return words


@case("live without --out plays, writes nothing and says at the end what happened")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    before = sorted(folder.rglob("*"))
    # Without a window and without files nothing is drawn, so that neither OpenGL nor a display is needed.
    result = programs.succeeds(*without_out(programs, folder), cwd=folder)
    assert "3 frames in" in result.stdout and "touch.mp4" not in result.stdout, result.stdout
    assert "live" in result.stderr and "100 %" in result.stderr, result.stderr
    assert sorted(folder.rglob("*")) == before, "something was written"
    programs.refuses(*without_out(programs, folder, "--view", "camera,map"), says=["--view", "several views", "--out"])
    for words in (("--write", "+stills"), ("--write", "film,data"), ("--write=-depth",), ("--overwrite",)):
        programs.refuses(*without_out(programs, folder, *words), says=[words[0][:7], "--out"])
    assert sorted(folder.rglob("*")) == before, "something was written"


@case("live alone films the built-in desk into the cache, says that there is no screen, and writes the film", long=True)
def _(programs, folder):
    # The body that ships, as an installed copy has it beside its programs.
    copy = folder / "copy"
    (copy / "bin").mkdir(parents=True)
    (copy / "share/palpable/bodies").mkdir(parents=True)
    shutil.copy(programs.palpable, copy / "bin")
    shutil.copy(programs.small_body(), copy / "share/palpable/bodies/post.palpable")
    (folder / "here").mkdir()
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}

    def palpable(*words):
        return subprocess.run([copy / "bin/palpable", *words], cwd=folder / "here", env=environment, capture_output=True, text=True)
    result = palpable("live")
    assert result.returncode == 0, result.stderr
    assert "there is no screen for a window: the film goes to palpable-live/" in result.stderr, result.stderr
    assert "writing the sequence" in result.stderr, result.stderr
    assert (folder / "here/palpable-live/touch.mp4").stat().st_size > 10_000
    assert not (folder / "here/palpable-live/clip").exists() and not (folder / "here/palpable-live/depth").exists()
    assert len(list((folder / "cache/palpable").iterdir())) == 1
    again = palpable("live")  # nothing is filmed again, and the film is replaced
    assert again.returncode == 0 and "writing the sequence" not in again.stderr, again.stderr
    other = palpable("live", "--no-window", "--frames", "2")
    assert other.returncode == 0 and "nothing is shown or written" in other.stderr, other.stderr


@case("a preview shows camera, depth and what moves without a body, and tells how much depth there is")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    words = ("live", "--source", folder / "clip", "--preview")
    # In this folder no body is found either.
    told = json.loads(programs.succeeds(*words, "--out", folder / "out", "--json", cwd=folder).stdout)
    assert told["frames"] == 3 and told["film"] == str(folder / "out/preview.mp4"), told
    assert 0.2 < told["known_share"] <= 1, told
    width, height = film_size(folder / "out/preview.mp4")
    assert (width, height) == (3 * (base.WIDTH // 2), base.HEIGHT // 2), (width, height)
    programs.refuses(*words, "--out", folder / "out", cwd=folder, says=["preview.mp4", "--overwrite"])
    assert "3 frames" in programs.succeeds(*words, cwd=folder).stdout
    programs.refuses("live", "--preview", cwd=folder, says=["--preview", "--source"])


@case("doctor names what is missing and what to do, and fails where live would not run")
def _(programs, folder):
    folder.mkdir(parents=True, exist_ok=True)
    result = programs.succeeds("doctor", "--json", cwd=folder)
    findings = {finding["what"]: finding for finding in json.loads(result.stdout)["findings"]}
    assert {"processor", "memory", "disk", "OpenGL", "screen", "bake", "loop"} <= findings.keys(), findings.keys()
    for finding in findings.values():
        assert finding["verdict"] in ("ok", "limited"), finding
        assert bool(finding["remedy"]) == (finding["verdict"] != "ok"), finding
    assert findings["screen"]["verdict"] == "limited" and "--out" in findings["screen"]["remedy"], findings["screen"]
    assert "OpenBLAS" in findings["bake"]["state"], findings["bake"]
    # Without any driver of EGL there is no OpenGL.
    environment = {**os.environ, "__EGL_VENDOR_LIBRARY_DIRS": str(folder)}
    blind = subprocess.run([programs.palpable, "doctor"], cwd=folder, env=environment, capture_output=True, text=True)
    assert blind.returncode == 1 and "missing  OpenGL" in blind.stdout, (blind.returncode, blind.stdout)
    assert "would not run here: OpenGL" in blind.stderr and "loop" not in blind.stdout, blind.stderr


@case("live without --out shows itself in a window and writes nothing")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    before = sorted(folder.rglob("*"))
    result = base.on_screen(programs, *without_out(programs, folder, "--window"))
    if result is None:
        return
    assert result.returncode == 0, result.stderr
    assert "3 frames in" in result.stdout, result.stdout
    assert sorted(folder.rglob("*")) == before, "something was written"


def film_size(path):
    """(width, height) of a film's pictures, from its track's header."""
    data = path.read_bytes()
    at = data.index(b"tkhd") - 4
    width, height = struct.unpack_from(">II", data, at + struct.unpack_from(">I", data, at)[0] - 8)
    return width >> 16, height >> 16


@case("live writes several views side by side, with the truth where a film has one")
def _(programs, folder):
    base.write_stereo(folder / "clip/frames", frames=2)
    words = base.live(programs, folder, source="clip/frames")
    for wrong, says in ((("camera,ears",), "ears"), (("ears",), "ears"), (("camera", "truth"), "no truth/depth")):
        programs.refuses(*words, "--view", *wrong, says=["--view", says])
    programs.refuses(*words, "--view", "camera", "mask", "--window", says=["--view", "--window"])
    programs.refuses(*words, "--view", "camera", "mask", "--write", "+stills", says=["--view", "stills"])
    truth = folder / "clip/truth"
    (truth / "depth").mkdir(parents=True)
    (truth / "camera.toml").write_text("fps = 30.0\ndepth_unit_m = 0.00025\n")
    # The true depth of the second frame is unknown.
    (truth / "depth/000000.png").write_bytes(base.png(base.WIDTH // 2, base.HEIGHT // 2, lambda x, y: 1764, bits=16, channels=1))
    programs.succeeds(*words, "--view", "camera", "depth", "mask", "truth")
    assert json.loads((folder / "out/live.json").read_text())["view"] == "camera,depth,mask,truth"
    sizes = {}
    for count, views in ((4, "out"), (2, "two")):
        if count == 2:
            programs.succeeds(*[folder / "two" if word == folder / "out" else word for word in words],
                              "--view", "camera", "moving", "--write=-masks")
        sizes[count] = film_size(folder / views / "touch.mp4")
    assert sizes == {4: (base.WIDTH, base.HEIGHT), 2: (base.WIDTH, base.HEIGHT // 2)}, sizes
    assert not (folder / "two/visible").exists() and (folder / "out/visible").exists()


STUCK = range(30, 34)  # frames, of which a paced run may drop some


def drain(readers):
    for reader in readers:
        try:
            os.read(reader, 1 << 20)
        except BlockingIOError:
            pass


def play_on_stuck_disk(programs, folder, *more):
    """Plays three seconds of frames as a camera delivers them; the disk blocks for a second at each frame of STUCK.

    Returns the output, and live.json.
    """
    out = folder / "out"
    process = programs.start(*base.live(programs, folder, "--paced", *more))
    readers = []
    try:
        while not (out / "moving").exists():  # the last one that is made
            assert process.poll() is None, process.communicate()
            time.sleep(0.002)
        for n in STUCK:  # opening one blocks until it is read
            os.mkfifo(out / f"depth/{n:06d}.png")
        time.sleep(2.2)
        readers = [os.open(out / f"depth/{n:06d}.png", os.O_RDWR | os.O_NONBLOCK) for n in STUCK]
        while process.poll() is None:
            drain(readers)
            time.sleep(0.01)
        printed = process.communicate()
    finally:
        process.kill()
        process.wait()
        for reader in readers:
            os.close(reader)
    assert process.returncode == 0, printed
    return printed[0], json.loads((out / "live.json").read_text())


def lines_of(file):
    return len(file.read_text().splitlines())


@case("a camera's frames that a slow disk has no time for are left out of the pictures, not of the texts")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=90)
    out = folder / "out"
    printed, live = play_on_stuck_disk(programs, folder)
    frames, left_out = live["frames"], live["frames_left_out"]
    print(f"{frames} frames, {left_out} left out, {live['source_troubles']['dropped']} dropped")
    assert left_out >= 10 and live["lines_left_out"] == 0, live
    assert f"{left_out} of these frames" in printed and "--every-frame" in printed, printed
    assert lines_of(out / "timing.csv") == frames + 1 and lines_of(out / "pose.jsonl") == frames
    for name in ("visible", "body_depth"):
        assert len(list((out / name).iterdir())) == frames - left_out, name
    # The loop did not wait for the disk: it processed frames all the time.
    assert live["processed"][-1] == 89 and not any(b - a > 10 for a, b in zip(live["processed"], live["processed"][1:]))


@case("with --every-frame a camera's run waits for a slow disk and is complete")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=90)
    out = folder / "out"
    printed, live = play_on_stuck_disk(programs, folder, "--every-frame")
    assert live["frames_left_out"] == 0 and "--every-frame" not in printed, (live, printed)
    for name in ("visible", "body_depth"):
        assert len(list((out / name).iterdir())) == live["frames"], name
    assert live["source_troubles"]["dropped"] >= 10, live  # during the waits


@case("live tells each second and at the end how fast it goes when it is asked to, and live.json always")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=90)
    words = base.live(programs, folder, "--paced", "--overwrite", "--write=-masks")
    for more in ((), ("--stats",)):
        result = programs.succeeds(*words, *more)
        live = json.loads((folder / "out/live.json").read_text())
        stats = live["stats"]
        assert 5 < stats["frames_per_s"] <= 31, stats
        assert 0 < stats["age_p50_ms"] <= stats["age_p99_ms"] < 2000, stats
        assert 0 < stats["cpu_ms_per_frame"] < 2000, stats
        assert stats["stage_p50_ms"].keys() == stats["stage_p99_ms"].keys() >= {"read", "disparity", "contact", "draw"}
        lines = [line for line in result.stderr.splitlines() if "frames/s" in line]
        assert (2 <= len(lines) <= 6) if more else not lines, result.stderr
        assert ("frames/s" in result.stdout) == bool(more), result.stdout
    print(lines[-1])
    for text in ("age", "p99", "dropped", "texts only", "CPU", "contact"):
        assert text in lines[-1] and text in result.stdout, text
    result = programs.succeeds(*without_out(programs, folder, "--paced", "--stats"))
    assert "frames/s" in result.stdout and "draw" not in result.stdout, result.stdout


if __name__ == "__main__":
    sys.exit(base.main())
