#!/usr/bin/env python3
"""Clients that connect to a live run, among them the client printed in docs/touch_events.md."""
import json
import os
import re
import signal
import socket
import stat
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from interruptions import wait_for, write_long_clip
from with_wall_clip import SCENE

base.CASES.clear()
case = base.case


def touched_body(programs):
    """A ball with tables of touch."""
    return programs.baked_ball(programs.work / "touched", base.TOUCHED_BALL)


def start(programs, folder, events, *more, body=None):
    """A run of thousands of frames in which a wall presses the body; it runs in `folder` until it is ended."""
    if not (folder / "clip").exists():
        write_long_clip(folder / "clip")
        (folder / "clip/scene.toml").write_text(SCENE)
    return programs.start("live", body or programs.small_body(), "--source", "clip", "--write=-depth,-masks", "--out",
                          "out", "--overwrite", "--events", events, *more, cwd=folder)


def end(process):
    process.send_signal(signal.SIGINT)
    printed = process.communicate()
    assert process.returncode == 0, (process.returncode, printed)
    return printed[0]


def written_touches(folder):
    """{frame: line of touches.jsonl}"""
    lines = map(json.loads, (folder / "out/touches.jsonl").read_text().splitlines())
    return {line["frame"]: line for line in lines}


def printed_client():
    """The Python code printed in docs/touch_events.md."""
    blocks = re.findall(r"^```python\n(.*?)^```$", (base.ROOT / "docs/touch_events.md").read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) == 2, f"{len(blocks)} clients"  # the second one presses: tests/cli/hands.py
    assert len([line for line in blocks[0].splitlines() if line]) <= 10, "a ten-line client"
    return blocks[0]


@case("the client that touch_events.md prints receives where and how hard, as touches.jsonl has it")
def _(programs, folder):
    process = start(programs, folder, "unix:touch.sock", body=touched_body(programs))
    wait_for(process, (folder / "touch.sock").exists)
    (folder / "client.py").write_text(printed_client())
    client = subprocess.Popen([sys.executable, "-u", "client.py"], cwd=folder, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE)
    printed = [client.stdout.readline()]
    while printed[-1] and int(printed[-1].split()[0]) < int(printed[0].split()[0]) + 10:
        printed.append(client.stdout.readline())
    end(process)
    printed += client.stdout
    complaints = client.stderr.read()
    assert client.wait() == 0 and complaints == "", complaints
    written = written_touches(folder)
    told = {}
    for line in printed:
        words = re.fullmatch(r"(\d+) ball at (\[.*\]) m with (\[.*\]) N\n", line)
        assert words, line
        told.setdefault(int(words[1]), []).append((json.loads(words[2]), json.loads(words[3])))
    assert len(told) >= 10, told
    for frame, touches in told.items():
        assert touches == [(touch["point"], touch["force"]) for touch in written[frame]["touches"]], frame
    assert max(abs(value) for touches in told.values() for _, force in touches for value in force) > 0.01, told
    assert not (folder / "touch.sock").exists()


def connect(address):
    host, port = address.rsplit(":", 1)
    connection = socket.create_connection((host, int(port)), timeout=60)
    return connection, connection.makefile(encoding="utf-8")


@case("a client at a free port gets every frame, and all that touches.jsonl says of it")
def _(programs, folder):
    for body, kind in ((touched_body(programs), "area"), (programs.small_body(), "site")):
        process = start(programs, folder, "0", body=body)
        address = process.stdout.readline().removeprefix("events: ").strip()
        assert re.fullmatch(r"127\.0\.0\.1:\d+", address), address
        connection, lines = connect(address)
        asleep, _ = connect(address)  # never reads, and must not disturb the others
        connection.sendall(b"GET / HTTP/1.1\r\n\r\n")
        hello = json.loads(next(lines))
        assert hello["type"] == "hello" and hello["version"] == 2, hello
        assert [body["name"] for body in hello["bodies"]] == ["ball"], hello
        frames = [json.loads(next(lines)) for _ in range(60)]
        printed = end(process)
        frames += map(json.loads, lines)
        asleep.close()
        assert "events: 2 clients, 0 refused" in printed, printed
        assert all(frame["type"] == "frame" and frame["dropped"] == 0 for frame in frames)
        numbers = [frame["frame"] for frame in frames]
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers))), numbers
        assert numbers[-1] == json.loads((folder / "out/live.json").read_text())["frames"] - 1, numbers
        written = written_touches(folder)
        place = hello["bodies"][0]["world_from_body"]
        touching = 0
        for frame in frames:
            told, = frame["bodies"]
            of_file = written.get(frame["frame"], {"touches": []})
            for key in ("displacement_error", "stress_error"):
                assert told.get(key) == of_file.get(key), (key, frame)
            assert len(told["touches"]) == len(of_file["touches"]), frame
            assert told["world_from_body"] == place
            for touch, other in zip(told["touches"], of_file["touches"]):
                touching += 1
                assert kind in touch, touch
                assert frame["time"] == other.pop("time"), frame
                assert {key: touch.get(key) for key in other} == other, (touch, other)
                world = [sum(place[4 * i + k] * touch["point"][k] for k in range(3)) + place[4 * i + 3] for i in range(3)]
                assert max(abs(a - b) for a, b in zip(world, touch["world"]["point"])) < 2e-6, (world, touch)
        print(f"{len(frames)} frames, {touching} touches")
        assert touching >= 20, touching


@case("with --contact-rate a client is told of every moment between frames, in order")
def _(programs, folder):
    process = start(programs, folder, "0", "--contact-rate", "300", body=touched_body(programs))
    connection, lines = connect(process.stdout.readline().removeprefix("events: ").strip())
    assert json.loads(next(lines))["type"] == "hello"
    told = [json.loads(next(lines)) for _ in range(600)]
    printed = end(process)
    connection.close()
    assert re.search(r"between frames: \d+ ticks, 0 left out", printed), printed
    ticks = [line for line in told if line["type"] == "tick"]
    frames = [line for line in told if line["type"] == "frame"]
    assert len(frames) >= 40 and len(ticks) >= 400, (len(frames), len(ticks))
    numbers = [line["frame"] for line in told]
    assert numbers == sorted(numbers), numbers
    by_frame = {}
    for tick in ticks:
        by_frame.setdefault(tick["frame"], []).append(tick)
    for frame in frames[1:-2]:
        of_frame = by_frame[frame["frame"]]
        assert [tick["tick"] for tick in of_frame] == list(range(1, 11)), of_frame
        assert abs(of_frame[-1]["time"] - frame["time"] - 10 / 300) < 2e-6, (frame, of_frame[-1])
        assert all(body["name"] == "ball" for tick in of_frame for body in tick["bodies"])
    assert any(tick["bodies"][0]["touches"] for tick in ticks)
    words = ("live", programs.small_body(), "--source", "clip", "--contact-rate", "300")
    programs.refuses(*words, cwd=folder, says=["--contact-rate: ", "tables of touch"])


@case("the socket that a killed run left is replaced, and one with a listener or any other file is refused")
def _(programs, folder):
    process = start(programs, folder, "unix:s")
    wait_for(process, (folder / "s").exists)
    assert stat.S_IMODE((folder / "s").stat().st_mode) == 0o600
    words = ("live", programs.small_body(), "--source", "clip", "--out", "other", "--events")
    programs.refuses(*words, "unix:s", cwd=folder, says=["--events: s: another program listens there", "name another"])
    process.kill()
    process.communicate()
    assert (folder / "s").is_socket()
    process = start(programs, folder, "unix:s")
    assert process.stdout.readline() == "events: unix:s\n"
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(os.path.relpath(folder / "s")))
        assert json.loads(next(client.makefile()))["type"] == "hello"
    end(process)
    assert not (folder / "s").exists()

    (folder / "mine.txt").write_text("mine")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        for events, says in (("unix:mine.txt", ["mine.txt", "is no socket"]), ("unix:none/s", ["none/s", "No such file"]),
                             (str(port), [f"127.0.0.1:{port}", "in use", "free port"]), ("70000", ["70000", "65535"]),
                             ("", ["unix:PATH"]), ("0.0.0.0:80", ["unix:PATH"]), ("unix:" + 120 * "n", ["107"])):
            programs.refuses(*words, events, cwd=folder, says=["--events: ", *says])
    assert (folder / "mine.txt").read_text() == "mine" and not (folder / "other").exists()


if __name__ == "__main__":
    sys.exit(base.main())
