#!/usr/bin/env python3
"""Live runs that are killed, hung up, started twice or out of disk space leave readable files."""
import contextlib
import fcntl
import json
import os
import pty
import shutil
import signal
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case
FRAMES = 10000  # of the clip: many more than are played before the interruption


def write_long_clip(folder):
    """A wall, whose two pictures are on the disk once with 10000 names each."""
    base.write_stereo(folder, frames=1)
    for eye in ("left", "right"):
        for n in range(1, FRAMES):
            os.link(folder / eye / "000000.png", folder / eye / f"{n:06d}.png")
    return folder


def boxes(film):
    """The names of an MP4's top-level boxes; empty if it is truncated."""
    data, at, names = film.read_bytes(), 0, []
    while at + 8 <= len(data):
        size = struct.unpack(">I", data[at:at + 4])[0]
        if size < 8 or at + size > len(data):
            break
        names.append(data[at + 4:at + 8].decode())
        at += size
    return names


def wait_for(process, happened):
    """Waits until it has; fails if the program ended before. A program that does nothing is ended by ctest."""
    while not happened():
        assert process.poll() is None, f"ended with {process.returncode}\n{process.communicate()}"
        time.sleep(0.01)


def is_under_way(out):
    """Whether the film and the text files have reached the disk more than once."""
    try:
        return boxes(out / "touch.mp4").count("moof") >= 2 and (out / "pose.jsonl").read_text().count("\n") >= 100
    except FileNotFoundError:  # not there yet, or being written anew
        return False


def rows_of(out):
    """Number of rows of timing.csv; checks that every line of every text file is complete."""
    header, *rows = (out / "timing.csv").read_text().splitlines()
    for row in rows:
        assert len(row.split(",")) == len(header.split(",")), row
    for name in ("touches.jsonl", "pose.jsonl", "rectification.jsonl"):
        text = (out / name).read_text()
        assert text == "" or text.endswith("\n"), name
        for line in text.splitlines():
            json.loads(line)
    for line in (out / "trajectory.txt").read_text().splitlines()[1:]:
        assert len(line.split()) == 8, line
    return len(rows)


def pictures_of(programs, folder, film):
    """Number of pictures that a player decodes, none of them damaged: live plays the film as both eyes of a camera."""
    eye = folder / "eye.mp4"
    shutil.copy(film, eye)
    programs.succeeds("live", programs.small_body(), "--source", eye, "--right", eye, "--calibration",
                      folder / "clip/rectified.yml", "--place", "0 0.04 0.42 0 0 0", "--write=-depth,-masks",
                      "--out", folder / "played", "--overwrite")
    played = json.loads((folder / "played/live.json").read_text())
    assert played["frames_unreadable"] == 0, played
    return played["frames"]


@case("a live run that is killed leaves a film that plays and lines that can be read")
def _(programs, folder):
    write_long_clip(folder / "clip")
    out = folder / "out"
    process = programs.start(*base.live(programs, folder))
    wait_for(process, lambda: is_under_way(out))
    process.kill()
    process.communicate()
    assert process.returncode == -signal.SIGKILL, process.returncode
    rows = rows_of(out)
    assert 100 <= rows < FRAMES, rows
    pictures = pictures_of(programs, folder, out / "touch.mp4")
    print(f"{rows} rows of timing.csv, {pictures} pictures in the film")
    assert 0 < pictures <= len(list((out / "visible").iterdir())), (pictures, rows)
    # The folder does not block anything: it is an earlier run's output.
    programs.refuses(*base.live(programs, folder), says=["out", "earlier run", "--overwrite"])
    programs.succeeds(*base.live(programs, folder, "--overwrite", "--frames", "2"))
    assert rows_of(out) == 2


@case("Ctrl-C and a terminal that is closed end a live run with all its files")
def _(programs, folder):
    write_long_clip(folder / "clip")
    out = folder / "out"
    for signals in ((signal.SIGINT,), (signal.SIGTERM,), (signal.SIGHUP, signal.SIGHUP)):
        process = programs.start(*base.live(programs, folder, "--overwrite"))
        wait_for(process, lambda: is_under_way(out))
        for number in signals:  # bash passes SIGHUP on to a program that has already received it
            process.send_signal(number)
        printed = process.communicate()
        assert process.returncode == 0, (signals, process.returncode, printed)
        rows = rows_of(out)
        live = json.loads((out / "live.json").read_text())
        assert rows == live["frames"] < FRAMES, (rows, live)
        assert "moov" in boxes(out / "touch.mp4") and "moof" not in boxes(out / "touch.mp4")
    assert pictures_of(programs, folder, out / "touch.mp4") == rows


@case("a live run whose terminal is gone ends with all its files, and one under nohup goes on")
def _(programs, folder):
    write_long_clip(folder / "clip")
    out = folder / "out"
    terminal, slave = pty.openpty()

    def own_terminal():
        os.setsid()
        fcntl.ioctl(slave, termios.TIOCSCTTY, 0)
    process = programs.start(*base.live(programs, folder), before=own_terminal, stdin=slave, stdout=slave, stderr=slave)
    os.close(slave)
    wait_for(process, lambda: is_under_way(out))
    os.close(terminal)  # now SIGHUP comes, and nothing can be printed any more
    process.wait()
    assert process.returncode >= 0, process.returncode
    assert rows_of(out) == json.loads((out / "live.json").read_text())["frames"] < FRAMES
    assert "moof" not in boxes(out / "touch.mp4")

    process = programs.start(*base.live(programs, folder, "--overwrite"),
                             before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    wait_for(process, lambda: is_under_way(out))
    process.send_signal(signal.SIGHUP)
    so_far = boxes(out / "touch.mp4").count("moof")
    wait_for(process, lambda: boxes(out / "touch.mp4").count("moof") > so_far + 1)
    process.send_signal(signal.SIGINT)
    printed = process.communicate()
    assert process.returncode == 0, printed


@case("a second live run into the same folder is refused while the first goes on")
def _(programs, folder):
    write_long_clip(folder / "clip")
    out = folder / "out"
    first = programs.start(*base.live(programs, folder))
    wait_for(first, out.exists)
    for more in ((), ("--overwrite",)):
        programs.refuses(*base.live(programs, folder, *more), says=["out", "another run"])
    wait_for(first, lambda: is_under_way(out))
    programs.refuses(*base.live(programs, folder, "--overwrite"), says=["out", "another run"])
    first.send_signal(signal.SIGINT)
    printed = first.communicate()
    assert first.returncode == 0, printed
    assert rows_of(out) == json.loads((out / "live.json").read_text())["frames"]
    # A run that cannot begin makes no folder.
    words = base.live(programs, folder)
    programs.refuses(words[0], folder / "none.palpable", *words[2:-1], folder / "a/b", says=["none.palpable"])
    assert not (folder / "a").exists()


@contextlib.contextmanager
def small_disk(folder, size):
    """Mounts a file system of this size at the folder; False without the permission to mount."""
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder],
                             capture_output=True, text=True).returncode == 0
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", folder], check=True)


def check_full(programs, folder, process, reason):
    out = folder / "disk/out"
    printed = process.communicate()[1]
    assert process.returncode == 1, (process.returncode, printed)
    line = printed.splitlines()[-1]
    print(line)
    assert line.startswith("palpable: ") and "disk/out/" in line and f"cannot be written: {reason}" in line, line
    rows = rows_of(out)
    pictures = pictures_of(programs, folder, out / "touch.mp4")
    assert 0 < rows < FRAMES and 0 < pictures < FRAMES, (rows, pictures)
    for name in ("depth", "visible", "body_depth"):
        images = sorted((out / name).iterdir())
        assert rows <= len(images) + 1, (name, rows, len(images))
        for image in images:
            assert image.read_bytes().endswith(b"IEND\xaeB`\x82"), image


@case("a full disk ends a live run when it happens, and leaves what was written before")
def _(programs, folder):
    write_long_clip(folder / "clip")
    words = (*base.live(programs, folder)[:-1], folder / "disk/out")
    (folder / "disk").mkdir()
    check_full(programs, folder, programs.start(*words, limit=110_000), "File too large")
    shutil.rmtree(folder / "disk")
    with small_disk(folder / "disk", "6m") as mounted:
        if not mounted:
            print("no file system may be mounted here: only a limit on the size of files was tried")
            return
        check_full(programs, folder, programs.start(*words), "No space left on device")


@case("Ctrl-C while the synthetic clip is filmed is no reason not to film it again")
def _(programs, folder):
    words = ("live", programs.small_body(), "--source", "synthetic", "--out", folder / "out")
    clip = folder / "out/clip"

    def is_filming():
        return any((clip / "frames/left").glob("*.jpg")) and not (clip / "frames/left/900000.jpg").exists()
    for _ in range(2):
        process = programs.start(*words)
        try:
            wait_for(process, is_filming)
        except AssertionError as error:
            if "EGL" in str(error):
                print("SKIPPED: no OpenGL here: " + str(error))
                return
            raise
        process.send_signal(signal.SIGINT)
        process.communicate()
        assert process.returncode == -signal.SIGINT, process.returncode
        (clip / "frames/left/900000.jpg").write_text("goes when the clip is filmed again")


@case("Ctrl-C while a sequence is filmed is no reason not to film it again")
def _(programs, folder):
    words = ("synth", "press", "--body", programs.small_body(), "--frames", "25", "-o", folder / "clip")
    clip = folder / "clip"
    for number in (signal.SIGINT, signal.SIGKILL):
        process = programs.start(*words)
        try:
            wait_for(process, lambda: any(clip.glob("frames/left/*.jpg")) and not (clip / "frames/left/900000.jpg").exists())
        except AssertionError as error:
            if "EGL" in str(error):
                print("SKIPPED: no OpenGL here: " + str(error))
                return
            raise
        process.send_signal(signal.SIGSTOP)  # it would otherwise finish before the other has begun
        programs.refuses(*words, says=["clip", "another run"])
        process.send_signal(number)
        process.send_signal(signal.SIGCONT)
        process.communicate()
        assert process.returncode == -number, process.returncode
        (clip / "frames/left/900000.jpg").write_text("goes when it is filmed again")
    (clip / "notes.txt").write_text("mine")
    programs.succeeds(*words)
    assert sorted(path.name for path in clip.iterdir()) == ["frames", "notes.txt", "truth"]
    assert len(list((clip / "frames/left").iterdir())) == 25 and (clip / "truth/camera.toml").exists()
    assert not (clip / "frames/left/900000.jpg").exists()
    programs.refuses(*words, says=["frames: exists"])  # a complete one is kept
    (folder / "other/frames").mkdir(parents=True)
    programs.refuses(*words[:-1], folder / "other", says=["frames: exists"])
    (folder / "mine").mkdir()
    (folder / "mine/unfinished-film.txt").write_text("a text of somebody")
    programs.refuses(*words[:-1], folder / "mine", says=["unfinished-film.txt: is in the way"])
    assert (folder / "mine/unfinished-film.txt").read_text() == "a text of somebody"


if __name__ == "__main__":
    sys.exit(base.main())
