#!/usr/bin/env python3
"""Browsers at a run of `palpable live --serve`, among them silent, slow and malformed ones."""
import json
import os
import re
import socket
import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from events import end, start, touched_body, written_touches
from hands import begin_socket_run, connect, finger, write_lines
from interruptions import write_long_clip
from with_wall_clip import SCENE

base.CASES.clear()
case = base.case


def write_bundle(folder):
    """A bundle of the page in the place where programs that are not installed look for it, from the folder in which they run."""
    bundle = folder / "web/dist/page"
    bundle.mkdir(parents=True)
    (bundle / "index.html").write_text("<html>/*palpable:page*/<!-- palpable:scripts --></html>")
    for name in ("page.js", "page-classic.js", "palpable.wasm"):
        (bundle / name).write_text(f"of {name}")


def address(process):
    """(port, token) of a run that has printed its page."""
    line = process.stdout.readline()
    words = re.fullmatch(r"page: http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/\n", line)
    assert words, line
    return int(words[1]), words[2]


def ask(port, target, *headers, host=None):
    """Sends a request; returns the connection and a file of what comes back."""
    connection = socket.create_connection(("127.0.0.1", port), timeout=60)
    lines = [f"GET {target} HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", *headers, "", ""]
    connection.sendall("\r\n".join(lines).encode())
    return connection, connection.makefile("rb")


def answer(port, target, *headers, **options):
    """The status and the content of an answer."""
    connection, coming = ask(port, target, *headers, **options)
    with connection, coming:
        head, _, content = coming.read().partition(b"\r\n\r\n")
    return int(head.split()[1]), content


UPGRADE = ("Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==")


class Page:
    """A client of the WebSocket."""

    def __init__(self, port, token, *wishes):
        self.connection, self.coming = ask(port, f"/{token}/live", *UPGRADE, f"Origin: http://127.0.0.1:{port}")
        status = self.coming.readline()
        assert status.startswith(b"HTTP/1.1 101 "), status
        while self.coming.readline().strip():
            pass
        self.code = None  # with which the other side has closed
        if wishes:
            self.send(json.dumps({"want": wishes}))

    def send(self, text, kind=1):
        data = text if isinstance(text, bytes) else text.encode()
        assert len(data) < 126
        # A mask of zeros leaves the text as it is.
        self.connection.sendall(bytes([0x80 | kind, 0x80 | len(data)]) + bytes(4) + data)

    def read(self):
        """The next message: an object for a text, bytes; None: the connection has ended, with `code` if it was closed in order."""
        while True:
            begin = self.coming.read(2)
            if len(begin) < 2:
                return None
            kind, size = begin[0] & 15, begin[1]
            if size > 125:
                size = int.from_bytes(self.coming.read(2 if size == 126 else 8), "big")
            data = self.coming.read(size)
            if kind == 9:
                self.send(data, 10)
            elif kind == 8:
                (self.code,) = struct.unpack(">H", data[:2])
                return None
            else:
                return json.loads(data) if kind == 1 else data

    def read_to_the_end(self):
        """What comes until the run says that it ends."""
        while self.read() is not None:
            pass
        assert self.code == 1001, self.code

    def await_close(self):
        """Waits until the other side has ended the connection; fails if it does not."""
        try:
            while self.coming.read(65536):
                pass
        except ConnectionError:
            pass

    def until(self, happened):
        """Reads until it has; returns all messages."""
        messages = [self.read()]
        while not happened(messages[-1]):
            assert messages[-1] is not None, "the run has ended"
            messages.append(self.read())
        return messages


def is_frame(message):
    return isinstance(message, dict) and message["type"] == "frame"


def jpeg_size(data):
    """(width, height)"""
    at = 2
    while not 0xC0 <= data[at + 1] <= 0xC2:
        assert data[at] == 0xFF, data[at]
        at += 2 + int.from_bytes(data[at + 2:at + 4], "big")
    height, width = struct.unpack(">HH", data[at + 5:at + 9])
    return width, height


def skin_counts(data):
    """Numbers of vertices of a skin's bodies; checks that there is nothing else."""
    counts, at = [], 12
    for _ in range(struct.unpack("<I", data[8:12])[0]):
        counts.append(struct.unpack("<I", data[at:at + 4])[0])
        at += 4 + 28 * counts[-1]
    assert at == len(data), (at, len(data))
    return counts


@case("a page gets a run's touches as the files have them, its picture at half size, and the skins")
def _(programs, folder):
    write_bundle(folder)
    process = start(programs, folder, "none", "--serve", "0", body=touched_body(programs))
    port, token = address(process)
    status, page = answer(port, f"/{token}/")
    assert status == 200 and b'{"live":"live"}' in page and b'src="page.js"' in page, page
    assert answer(port, f"/{token}/page.js") == (200, b"of page.js")
    client = Page(port, token, "picture", "skin")
    kinds = {b"MESH": [], b"SKIN": [], b"\xff\xd8\xff\xe0": []}
    hello, facts, frames = client.read(), client.read(), []
    while len(frames) < 20 or not all(kinds.values()):
        message = client.read()
        assert message is not None
        if is_frame(message):
            frames.append(message)
        else:
            kinds[message[:4]].append(message)
    printed = end(process)
    assert "page: 1 clients, 0 refused" in printed, printed
    client.read_to_the_end()
    (body,) = hello["bodies"]
    assert hello["type"] == "hello" and facts["type"] == "page" and facts["picture"] is True, (hello, facts)
    assert facts["stress_top"] > 100 and "neo-hookean" in facts["bodies"][0]["material"], facts
    assert all(frame["dropped"] == 0 for frame in frames)
    assert [frame["frame"] for frame in frames] == [*range(frames[0]["frame"], frames[0]["frame"] + len(frames))]
    written = written_touches(folder)
    touched = [frame for frame in frames if frame["bodies"][0]["touches"]]
    assert touched, "the wall presses"
    for frame in touched:
        told, kept = frame["bodies"][0]["touches"], written[frame["frame"]]["touches"]
        assert [(t["point"], t["force"]) for t in told] == [(t["point"], t["force"]) for t in kept], frame["frame"]
    (mesh,) = kinds[b"MESH"]
    assert struct.unpack("<II", mesh[4:12]) == (1, body["triangles"]) and len(mesh) == 12 + 12 * body["triangles"]
    assert skin_counts(kinds[b"SKIN"][0]) == [body["vertices"]]
    assert jpeg_size(kinds[b"\xff\xd8\xff\xe0"][0]) == (base.WIDTH // 2, base.HEIGHT // 2)


@case("a page of a run that shows and writes nothing else gets pictures, too")
def _(programs, folder):
    write_bundle(folder)
    write_long_clip(folder / "clip")
    process = programs.start("live", programs.small_body(), "--source", "clip", "--place", "0 0.04 0.42 0 0 0", "--serve", "0",
                             cwd=folder)
    client = Page(*address(process), "picture")
    client.until(lambda message: isinstance(message, bytes))
    client.connection.close()
    assert "page: 1 clients" in end(process)


@case("a page shows several views side by side, without files")
def _(programs, folder):
    write_bundle(folder)
    write_long_clip(folder / "clip")
    process = programs.start("live", programs.small_body(), "--source", "clip", "--place", "0 0.04 0.42 0 0 0", "--serve", "0",
                             "--view", "camera", "depth", cwd=folder)
    client = Page(*address(process), "picture")
    picture = client.until(lambda message: isinstance(message, bytes))[-1]
    assert jpeg_size(picture) == (base.WIDTH // 2, base.HEIGHT // 4), jpeg_size(picture)  # two tiles, each half as wide and high
    client.connection.close()
    assert "page: 1 clients" in end(process)


@case("a run's results do not depend on who looks at it")
def _(programs, folder):
    write_bundle(folder)
    write_long_clip(folder / "clip")
    (folder / "clip/scene.toml").write_text(SCENE)
    run = ("live", touched_body(programs), "--source", "clip", "--frames", "300", "--write", "data", "--out")
    programs.succeeds(*run, "alone", cwd=folder)
    process = programs.start(*run, "served", "--serve", "0", cwd=folder)
    client = Page(*address(process), "picture", "skin")
    client.read_to_the_end()
    printed = process.communicate()
    assert process.returncode == 0, printed
    touches = (folder / "alone/touches.jsonl").read_text()
    assert touches and touches == (folder / "served/touches.jsonl").read_text()


@case("a page is refused with another token, origin or host, and no other file is served")
def _(programs, folder):
    write_bundle(folder)
    (folder / "secret").write_text("secret")
    process = start(programs, folder, "none", "--serve", "0")
    port, token = address(process)
    other, socket_of_run = "0" * 32, f"/{token}/live"
    ours = f"Origin: http://localhost:{port}"
    for target, headers, host, status in (
            (f"/{other}/", (), None, 403), ("/", (), None, 403), ("/page.js", (), None, 403),
            (f"/{other}/live", (*UPGRADE, ours), None, 403),
            (socket_of_run, (*UPGRADE, "Origin: http://evil.example"), None, 403),
            (socket_of_run, (*UPGRADE, "Origin: null"), None, 403),
            (socket_of_run, (*UPGRADE, f"Origin: http://127.0.0.1:{port + 1}"), None, 403),
            (socket_of_run, (*UPGRADE, ours), "evil.example", 403),
            (f"/{token}/", (), f"evil.example:{port}", 403), (f"/{token}/", ("Host: evil.example",), None, 403),
            (f"/{token}/", ("Origin: http://evil.example",), None, 403),
            (f"/{token}/../../../secret", (), None, 404), (f"/{token}/%2e%2e/secret", (), None, 404), (socket_of_run, (), None, 400)):
        assert answer(port, target, *headers, host=host)[0] == status, (target, headers, host)
    connection, coming = ask(port, socket_of_run, *UPGRADE, ours)
    assert coming.readline().startswith(b"HTTP/1.1 101 ")
    connection.close()
    assert "page: 1 clients, 11 refused" in end(process)


@case("slow, silent and malformed pages do not hinder a run, nor those who read")
def _(programs, folder):
    write_bundle(folder)
    process = start(programs, folder, "none", "--serve", "0", body=touched_body(programs))
    port, token = address(process)
    reader = Page(port, token)
    slow = [Page(port, token, "picture", "skin") for _ in range(2)]  # they never read
    binary = Page(port, token)
    binary.send('{"want":[]}', 2)
    binary.await_close()
    malformed = [binary]
    for text, first, masked in ((b"{}", 0x81, True), (b"x" * 70000, 0x81, True), (b"[]", 0x81, False), (b"{}", 0xF3, True), (b"", 0x80, True)):
        malformed.append(Page(port, token))
        size = struct.pack(">BQ", (0x80 if masked else 0) | 127, len(text))
        try:
            malformed[-1].connection.sendall(bytes([first]) + size + (bytes(4) if masked else b"") + text)
        except OSError:
            pass  # it was ended before all was sent
        malformed[-1].await_close()
    silent = [socket.create_connection(("127.0.0.1", port)) for _ in range(200)]
    for connection in silent[:3]:
        connection.sendall(f"GET /{token}/live HTTP/1.1\r\nHo".encode())
    frames = [message for message in reader.until(lambda message: message["type"] == "frame" and message["frame"] >= 150)
              if is_frame(message)]
    assert all(frame["dropped"] == 0 for frame in frames)
    numbers = [frame["frame"] for frame in frames]
    assert numbers == [*range(numbers[0], 151)], numbers
    printed = end(process)
    assert re.search(r"^page: \d+ clients", printed, re.MULTILINE), printed
    for connection in (*silent, *(page.connection for page in (reader, *slow, *malformed))):
        connection.close()


@case("a page shows a run without a camera: touches and skins, and no picture")
def _(programs, folder):
    write_bundle(folder)
    write_lines(folder / "hands.jsonl", [finger(0.02 * k, 0.00002 * k, id=77) for k in range(3000)])
    process = programs.start("live", touched_body(programs), "--source", "hands.jsonl", "--paced", "--serve", "0", cwd=folder)
    client = Page(*address(process), "picture", "skin")
    hello, facts = client.read(), client.read()
    assert facts["picture"] is False and hello["frames"]["world"].startswith("the frame in which"), (hello, facts)
    pressed = lambda message: is_frame(message) and message["bodies"][0]["touches"]
    messages = client.until(pressed)
    messages += client.until(lambda message: isinstance(message, bytes) and message[:4] == b"SKIN")
    assert messages[-1][:4] == b"SKIN" and skin_counts(messages[-1]) == [hello["bodies"][0]["vertices"]]
    (touch,) = next(filter(pressed, messages))["bodies"][0]["touches"]
    assert touch["thing"] == 77 and touch["force"][2] < 0, touch
    client.connection.close()
    assert "page: 1 clients" in end(process)


@case("without a camera, too, results do not depend on who looks: not even those of bodies that press each other")
def _(programs, folder):
    write_bundle(folder)
    body = base.ROOT / "tests/data/touched_ball_v1.palpable"
    (folder / "two.toml").write_text("".join(f'[[body]]\nname = "{name}"\nfile = "{body}"\n{at}' for name, at in (
        ("one", ""), ("two", 'at = ["89 mm", "0 mm", "0 mm"]\n'))))
    # A fingertip pushes the first one from the side against the second.
    tips = [-0.056 + 0.001 * k for k in range(20)]
    write_lines(folder / "hands.jsonl", [{"time": 0.1 * k, "things": [{"id": 1, "capsules": [[x, 0, 0.05, x - 0.05, 0, 0.05, 0.008, 0.008]]}]}
                                         for k, x in enumerate(tips)])
    run = ("live", "two.toml", "--source", "hands.jsonl", "--write", "data", "--out")
    programs.succeeds(*run, "alone", cwd=folder)
    programs.succeeds(*run, "served", "--serve", "0", cwd=folder)
    touches = (folder / "alone/touches.jsonl").read_bytes()
    assert b'"by"' in touches and touches == (folder / "served/touches.jsonl").read_bytes()


@case("a page that is opened while no client sends gets the last touches and skins, and each page gets them once")
def _(programs, folder):
    write_bundle(folder)
    process = begin_socket_run(programs, folder, "--serve", "0")
    line = process.stdout.readline()
    assert line.startswith("events: "), line
    port, token = address(process)
    at = os.open(folder, os.O_RDONLY)
    presser, answers = connect(at)

    def press(time, depth):
        presser.sendall(json.dumps(finger(time, depth, id=5)).encode() + b"\n")
        return json.loads(next(answers))

    press(0, 0.002)
    pressed = press(1, 0.004)
    assert pressed["frame"] == 1 and pressed["bodies"][0]["touches"], pressed

    def is_skin(message):
        return isinstance(message, bytes) and message[:4] == b"SKIN" and struct.unpack("<I", message[4:8])[0] == 1

    pages, came = [], []
    for _ in range(2):
        pages.append(Page(port, token, "skin"))
        came.append([])
        while not (any(map(is_frame, came[-1])) and any(map(is_skin, came[-1]))):
            came[-1].append(pages[-1].read())
            assert came[-1][-1] is not None, came
    press(2, 0.003)
    for page, messages in zip(pages, came):
        messages += page.until(lambda message: is_frame(message) and message["frame"] == 2)
        frames = list(filter(is_frame, messages))
        assert [frame["frame"] for frame in frames] == [1, 2], frames
        assert frames[0]["bodies"] == pressed["bodies"], (frames[0], pressed)
        assert sum(map(is_skin, messages)) == 1
    for page in pages:
        page.connection.close()
    assert "page: 2 clients" in end(process)
    os.close(at)


@case("--serve names a port that is taken, the command that builds the page, and what it cannot show")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=2)
    words = ("live", programs.small_body(), "--source", "clip", "--place", "0 0.04 0.42 0 0 0")
    programs.refuses(*words, "--serve", "0", cwd=folder, says=["--serve: web/dist/page/index.html", "web/build.sh"])
    write_bundle(folder)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        programs.refuses(*words, "--serve", port, cwd=folder, says=[f"--serve: 127.0.0.1:{port}: ", "in use", "0 finds a free port"])
    programs.refuses(*words, "--serve", "70000", cwd=folder, says=["--serve", "70000", "65535"])
    programs.refuses("live", "--preview", "--source", "clip", "--serve", "0", cwd=folder, says=["--serve: ", "no body"])


if __name__ == "__main__":
    sys.exit(base.main())
