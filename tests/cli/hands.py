#!/usr/bin/env python3
"""Runs without a camera: hands files that press bodies."""
import json
import os
import re
import signal
import socket
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from interruptions import wait_for
from live_files import film_size

base.CASES.clear()
case = base.case


def touched_body(programs):
    """A ball of some 0.09 m with tables of touch, which stands on Z = 0 around the Z axis."""
    return programs.baked_ball(programs.work / "touched", base.TOUCHED_BALL)


def finger(time, depth, at=(0, 0, 0), id=1):
    """A line: a fingertip of 8 mm this deep (m) in the top of a ball that stands at `at`, whose mesh ends 92 mm above it."""
    x, y, z = at
    tip = z + 0.092 + 0.008 - depth
    return {"time": time, "things": [{"id": id, "capsules": [[x, y, tip, x, y, tip + 0.05, 0.008, 0.008]]}]}


def write_lines(file, lines):
    file.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return file


def read_touches(out):
    return [json.loads(line) for line in (out / "touches.jsonl").read_text().splitlines()]


@case("a hands file presses a body without a camera, and the files of the run tell what it did")
def _(programs, folder):
    body = touched_body(programs)
    hands = write_lines(folder / "hands.jsonl", [finger(0.1 * k, 0.001 * (k - 3), id=77) for k in range(9)])
    out = folder / "out"
    result = programs.succeeds("live", body, "--source", hands, "--out", out, "--write", "data,meshes")
    assert "9 frames in " in result.stdout and "touched in " in result.stdout, result.stdout
    touches = read_touches(out)
    assert touches[0]["frame"] >= 3 and touches[-1]["frame"] == 8, touches
    forces = [line["touches"][0]["force"][2] for line in touches]
    assert all(after < before < 0 for before, after in zip(forces, forces[1:])), forces
    assert all(touch["thing"] == 77 for line in touches for touch in line["touches"]), touches
    assert all(line["answer"] == "reached" for line in touches), touches
    live = json.loads((out / "live.json").read_text())
    assert live["frames"] == 9 and live["source"] == str(hands) and live["contact"] == "anywhere", live
    assert live["first_touch_frame"] == touches[0]["frame"], live
    assert (out / "meshes/rest.ply").exists() and (out / "meshes/000008.ply").exists()
    assert (out / "meshes/000000.ply").read_bytes() != (out / "meshes/000008.ply").read_bytes()
    assert not {"trajectory.txt", "pose.jsonl", "depth", "touch.mp4"} & {file.name for file in out.iterdir()}
    programs.refuses("live", body, "--source", hands, "--out", out, says=["holds an earlier run", "--overwrite"])
    # Twice the same lines are the same bytes.
    programs.succeeds("live", body, "--source", hands, "--out", folder / "again", "--frames", "6", "--write=-film")
    assert read_touches(folder / "again") == [line for line in touches if line["frame"] < 6]


@case("with --friction a finger that is dragged takes the skin along, and the touch says with which force")
def _(programs, folder):
    body = touched_body(programs)
    lines = [finger(0.1 * k, 0.001 * k) for k in range(5)] + [finger(0.5 + 0.1 * k, 0.004, at=(0.001 * k, 0, 0)) for k in range(1, 4)]
    hands = write_lines(folder / "hands.jsonl", lines)

    def dragged(out, *more):
        programs.succeeds("live", body, "--source", hands, "--out", folder / out, "--write", "data", *more)
        return read_touches(folder / out)[-1]["touches"][0]

    free, held = dragged("free"), dragged("held", "--friction", "0.8")
    assert "friction" not in free, free
    assert held["friction_coefficient"] == 0.8 and held["friction"][0] > 0.1, held
    assert held["force"][0] > free["force"][0] + 0.1, (free, held)
    assert json.loads((folder / "held/live.json").read_text())["friction_residual_m"] < 1e-5


@case("palpable hands makes a hands file from joints and from a film, and it presses as joints and film did")
def _(programs, folder):
    body = touched_body(programs)
    # A right hand whose index finger goes down on the ball, once in metres with Z up, once as a headset would tell it.
    example = [[float(cell) for cell in line.split(",")] for line in (base.ROOT / "examples/python/hand.csv").read_text().splitlines()]
    (folder / "joints.csv").write_text("".join(",".join(map(str, row)) + "\n" for row in example))
    turned = []
    for time, *numbers in example:
        points = [numbers[k:k + 3] for k in range(0, len(numbers), 3)]
        turned.append([1e3 * time] + [1e3 * c for x, y, z in points for c in (x, z, -y)])
    (folder / "headset.csv").write_text("time,wrist and so on\n" + "".join(";".join(f"{c:.4f}" for c in row) + "\n" for row in turned))
    told = programs.succeeds("hands", folder / "joints.csv", "-o", folder / "a.jsonl").stdout
    assert f"{len(example)} lines over " in told, told
    assert "joints: openxr (26 joints without radii, by the number of columns), right hand; coordinates in m, times in s, Z up" in told
    assert re.search(r"they are within X \S+ to \S+, Y \S+ to \S+, Z \S+ to \S+ m", told), told
    # Whose table it is decides whether it may be replaced: a hands file may, anything else is somebody's.
    programs.succeeds("hands", folder / "joints.csv", "-o", folder / "a.jsonl")
    (folder / "notes.jsonl").write_text("my notes\n")
    programs.refuses("hands", folder / "joints.csv", "-o", folder / "notes.jsonl", says=["is there already and is no hands file"])
    programs.refuses("hands", folder / "joints.csv", "-o", folder / "joints.csv", says=["is read as input"])
    programs.refuses("hands", folder / "joints.csv", "-o", folder / "a.json", says=[".jsonl"])
    # What was probably forgotten is named.
    result = programs.run("hands", folder / "joints.csv", "--time-unit", "ms", "-o", folder / "quick.jsonl")
    assert result.returncode == 0 and "warning: " in result.stderr and "--time-unit" in result.stderr, result.stderr
    told = json.loads(programs.succeeds("hands", folder / "headset.csv", "--up", "y", "--unit", "mm", "--time-unit", "ms", "-o",
                                        folder / "b.jsonl", "--json").stdout)
    assert told["lines"] == told["lines_with_things"] == len(example), told
    assert told["joints"] == "openxr" and told["right"] and not told["left"] and not told["radii"], told
    assert all(low < high for low, high in zip(told["low_m"], told["high_m"])) and 0.005 < told["step_s"] < 0.2, told
    for one, other in zip(*((folder / name).read_text().splitlines() for name in ("a.jsonl", "b.jsonl"))):
        one, other = json.loads(one), json.loads(other)
        assert len(one["things"][0]["capsules"]) == 26
        for p, q in zip(one["things"][0]["capsules"], other["things"][0]["capsules"]):
            assert max(abs(x - y) for x, y in zip(p, q)) < 2e-6, (p, q)
    programs.refuses("hands", folder / "headset.csv", "-o", folder / "c.jsonl", says=["headset.csv: line 2: ", "metres? (--unit"])
    assert not (folder / "c.jsonl").exists()
    # The top of the example's bunny is elsewhere than that of the ball: the body is raised until the finger presses it.
    programs.succeeds("live", body, "--source", folder / "a.jsonl", "--place", "0 0 0.022 0 0 0", "--out", folder / "played")
    assert len(read_touches(folder / "played")) > 3

    film = programs.run("synth", "press", "--body", body, "--frames", "122", "-o", folder / "clip")
    if film.returncode != 0 and "EGL" in film.stderr:
        print("SKIPPED: no OpenGL here: " + film.stderr.strip())
        return
    assert film.returncode == 0, film.stderr
    programs.succeeds("hands", folder / "clip", "-o", folder / "film.jsonl")
    programs.succeeds("live", body, "--source", folder / "film.jsonl", "--out", folder / "filmed")
    truth = [json.loads(line) for line in (folder / "clip/truth/contact.jsonl").read_text().splitlines()]
    touching = {line["frame"] for line in truth if line["touching"]}
    felt = {line["frame"] for line in read_touches(folder / "filmed")}
    assert len(touching) > 10 and len(touching ^ felt) <= 2, (sorted(touching - felt), sorted(felt - touching))


@case("a hands file is filmed from outside, with what presses")
def _(programs, folder):
    body = touched_body(programs)
    hands = write_lines(folder / "hands.jsonl", [finger(0.1 * k, 0.001 * (k - 3)) for k in range(9)])
    result = programs.run("live", body, "--source", hands, "--out", folder / "out", "--frame-pictures", "0", "8")
    if result.returncode != 0 and "EGL" in result.stderr:
        assert "--write=-film" in result.stderr, result.stderr
        print("SKIPPED: no OpenGL here: " + result.stderr.strip())
        return
    assert result.returncode == 0, result.stderr
    assert film_size(folder / "out/touch.mp4") == (1280, 720)
    first, last = ((folder / f"out/pictures/{frame:06}.png").read_bytes() for frame in (0, 8))
    assert first != last and len(list((folder / "out/pictures").iterdir())) == 2
    assert json.loads((folder / "out/live.json").read_text())["video_codec"], "the summary names the codec"


@case("with a hands file a body is pressed where --place or a scene puts it")
def _(programs, folder):
    body = touched_body(programs)
    there = (0.5, -0.25, 1)
    at_origin = write_lines(folder / "origin.jsonl", [finger(k, 0.003) for k in range(3)])
    moved = write_lines(folder / "moved.jsonl", [finger(k, 0.003, there) for k in range(3)])
    run = ("live", body, "--source")
    programs.succeeds(*run, at_origin, "--out", folder / "a")
    programs.succeeds(*run, moved, "--place", "0.5 -0.25 1 0 0 0", "--out", folder / "b")
    a, b = (read_touches(folder / name)[-1]["touches"][0] for name in "ab")
    assert max(abs(p - q) for p, q in zip(a["force"], b["force"])) < 1e-3 * abs(a["force"][2]), (a, b)
    said = programs.succeeds(*run, moved).stdout
    assert re.search(r"never touched\nthing 1 came no nearer than 1\d\d\d\.\d mm to a vertex of ball, at 0 s\n.*--place", said), said
    scene = folder / "two.toml"
    scene.write_text("".join(f'[[body]]\nname = "{name}"\nfile = "{body}"\n{at}' for name, at in (
        ("one", ""), ("two", 'at = ["500 mm", "-250 mm", "1000 mm"]\n'))))
    programs.succeeds("live", scene, "--source", moved, "--out", folder / "c")
    assert {line["body"] for line in read_touches(folder / "c")} == {"two"}


@case("a line of a hands file that is wrong is named, and what was played before is complete")
def _(programs, folder):
    body = touched_body(programs)
    hands = write_lines(folder / "hands.jsonl", [finger(0, 0), finger(1, 0.002), finger(1, 0.003)])
    run = ("live", body, "--source", hands)
    programs.refuses(*run, "--out", folder / "out", says=["hands.jsonl: line 3: ", "times must grow"])
    assert json.loads((folder / "out/live.json").read_text())["frames"] == 2
    for text, says in (("", ["has no line"]), ("{}", ["line 1: ", '"time"']), ('{"time":NaN,"things":[]}', ["NaN"]),
                       ('{"time":0,"things":[{"id":1,"capsules":[[0,0,0,0,0,0,0,1]]}]}', ["thing 0: capsule 0", "radius 0 m"]),
                       ('{"time":0,"things":[{"id":1,"hand":"openxr","side":"left","joints":[[0,0,0]]}]}', ["26 joints"])):
        hands.write_text(text + "\n")
        programs.refuses(*run, says=["hands.jsonl: ", *says])
    programs.refuses("live", body, "--source", folder / "none.jsonl", says=["none.jsonl", "no such file"])
    programs.refuses("live", body, "--source", folder / "joints.csv", says=["joints.csv: is a table", "palpable hands ", "joints.jsonl"])
    write_lines(hands, [finger(0, 0)])
    programs.refuses("live", programs.small_body(), "--source", hands, says=["ball.palpable: has no tables of touch"])


@case("what means nothing without a camera is refused by name")
def _(programs, folder):
    body = touched_body(programs)
    hands = write_lines(folder / "hands.jsonl", [finger(0, 0)])
    for words, says in ((["--anchor", "plane"], ["--anchor: there is no camera"]),
                        (["--calibration", "c.yml"], ["--calibration: there is no camera"]),
                        (["--fixed-camera"], ["--fixed-camera: "]), (["--refine", "x.toml"], ["--refine: "]),
                        (["--contact-rate", "100"], ["--contact-rate: "]), (["--press-static"], ["--press-static: "]),
                        (["--preview"], ["--preview: "]), (["--paused"], ["--paused: there is no camera"]),
                        (["--record", "r.palprec"], ["--record: ", "is the recording"]),
                        (["--contact", "site"], ["--contact site: "]),
                        (["--write", "data,depth", "--out", "o"], ["--write depth: ", "film, data or meshes"]),
                        (["--place", "1 2 3"], ["--place 1 2 3: ", "six numbers"])):
        programs.refuses("live", body, "--source", hands, *words, cwd=folder, says=says)
    assert {file.name for file in folder.iterdir()} == {"hands.jsonl"}


def begin_socket_run(programs, folder, *more):
    process = programs.start("live", touched_body(programs), "--source", "socket", "--events", "unix:touch.sock", *more,
                             cwd=folder)
    wait_for(process, (folder / "touch.sock").exists)
    return process


def connect(folder):
    """A client that has read its hello. The name of a socket must be short."""
    client = socket.socket(socket.AF_UNIX)
    client.settimeout(60)
    client.connect(f"/proc/self/fd/{folder}/touch.sock")
    lines = client.makefile(encoding="utf-8")
    assert json.loads(next(lines))["type"] == "hello"
    return client, lines


def end(process):
    process.send_signal(signal.SIGINT)
    printed = process.communicate()
    assert process.returncode == 0, (process.returncode, printed)
    return printed[0]


@case("the client that touch_events.md prints presses a body through the socket and gets forces and skin back")
def _(programs, folder):
    page = (base.ROOT / "docs/touch_events.md").read_text()
    _, sender = re.findall(r"^```python\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    assert len(sender.splitlines()) <= 20, "twenty lines"
    (folder / "client.py").write_text(sender)
    process = begin_socket_run(programs, folder, "--out", "out")
    client = subprocess.run([sys.executable, "client.py"], cwd=folder, text=True, capture_output=True, timeout=120)
    assert client.returncode == 0, client.stderr
    printed = end(process)
    felt = [re.fullmatch(r"(\d+) thing 1 feels (\S+) N, skin up to (\S+) m", line) for line in client.stdout.splitlines()]
    assert len(felt) >= 5 and all(felt), client.stdout
    written = {line["frame"]: line["touches"] for line in read_touches(folder / "out")}
    assert [int(line[1]) for line in felt] == sorted(written), (client.stdout, written)
    for line in felt:
        assert -written[int(line[1])][0]["force"][2] == float(line[2]), line[0]
    heights = [float(line[3]) for line in felt]
    assert heights[-1] < heights[0] and float(felt[-1][2]) > float(felt[0][2]) > 0, client.stdout
    assert "events: 1 clients" in printed, printed
    assert not (folder / "touch.sock").exists()


@case("a client that sends garbage is answered and dropped, and the one that presses does not notice")
def _(programs, folder):
    process = begin_socket_run(programs, folder)
    at = os.open(folder, os.O_RDONLY)
    presser, answers = connect(at)
    watcher, frames = connect(at)

    def press(time, depth, **more):
        presser.sendall(json.dumps(finger(time, depth) | more).encode() + b"\n")
        return json.loads(next(answers))

    def is_refused(text, says):
        hostile, its_lines = connect(at)
        said = []
        try:
            hostile.sendall(text)
        except OSError:
            pass  # the connection was ended while it sent; why can be read all the same
        try:
            for line in its_lines:
                said.append(json.loads(line))
        except OSError:
            pass
        errors = [line for line in said if line["type"] == "error"]
        assert len(errors) == 1 and says in errors[0]["reason"], (text[:40], said)
        hostile.close()
    http = b"GET / HTTP/1.1\r\n\r\n"
    is_refused(http, "no JSON object")
    assert press(0, 0.002)["bodies"][0]["touches"][0]["thing"] == 1
    for text, says in ((http, "another client"), (json.dumps(finger(9, 0)).encode() + b"\n", "another client"), (b"x" * (3 << 20), "bytes")):
        is_refused(text, says)
    answer = press(1, 0.003, want=["vertices"])
    assert answer["frame"] == 1 and answer["skipped"] == 0 and len(answer["bodies"][0]["vertices"]) > 100, answer
    assert [json.loads(next(frames)).get("frame") for _ in range(2)] == [0, 1]
    # A line whose time does not grow ends the one that presses: nothing presses then.
    presser.sendall(json.dumps(finger(1, 0.003)).encode() + b"\n")
    assert "times must grow" in [json.loads(line) for line in answers][-1]["reason"]
    released = json.loads(next(frames))
    assert released["frame"] == 2 and released["bodies"][0]["touches"] == [], released
    # Its place is free, and times begin anew.
    watcher.sendall(json.dumps(finger(0, 0.002)).encode() + b"\n")
    assert json.loads(next(frames))["bodies"][0]["touches"], "it presses"
    assert "sent away" in end(process)
    os.close(at)


@case("--source socket needs an address")
def _(programs, folder):
    run = ("live", touched_body(programs), "--source", "socket")
    programs.refuses(*run, says=["--source socket: ", "--events"])
    programs.refuses(*run, "--events", "0", "--paced", says=["--paced: "])


if __name__ == "__main__":
    sys.exit(base.main())
