#!/usr/bin/env python3
"""Depth from any method, scored: score_my_depth.py CLIP RESULT [PALPABLE]

CLIP is what palpable synth wrote. Put your method into depth_of; all else is format
(docs/benchmark.md). As it stands it guesses a wall, and the scores say how good a guess that is.
"""
import struct, subprocess, sys, tomllib, zlib
from pathlib import Path

def depth_of(left, right, camera):
    """Two image files to rows of Z in metres, rectified left camera at half size; None: unknown."""
    return [[0.5] * camera["width"] for _ in range(camera["height"])]

def write_depth(path, rows, unit):
    counts = [[0 if z is None else min(round(z / unit), 65534) for z in row] for row in rows]
    data = b"".join(b"\0" + struct.pack(f">{len(row)}H", *row) for row in counts)
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 16, 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(data, 1)) + chunk(b"IEND", b""))

if len(sys.argv) not in (3, 4):
    sys.exit("usage: score_my_depth.py CLIP RESULT [PALPABLE]")
clip, result, *program = map(Path, sys.argv[1:])
if not (clip / "truth/camera.toml").exists():
    sys.exit(f"score_my_depth: {clip} has no truth/camera.toml: is it what palpable synth wrote?")
camera = tomllib.loads((clip / "truth/camera.toml").read_text())
(result / "depth").mkdir(parents=True, exist_ok=True)
pairs = zip(*(sorted((clip / "frames" / eye).iterdir()) for eye in ("left", "right")))
for number, (left, right) in enumerate(pairs):
    write_depth(result / f"depth/{number:06d}.png", depth_of(left, right, camera), camera["depth_unit_m"])
try:
    sys.exit(subprocess.run([*(program or ["palpable"]), "score", clip / "truth", result, "--json"]).returncode)
except FileNotFoundError as error:
    sys.exit(f"score_my_depth: {error.filename} cannot be started: name the program palpable as third word")
