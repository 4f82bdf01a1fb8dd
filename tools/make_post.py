#!/usr/bin/env python3
"""Writes the post of bodies/post.toml as an OFF file: an upright round bar with a rounded top.

0.13 m high, 0.04 m wide; the bake makes triangles of its own from it.
"""
import math
import pathlib
import sys

RADIUS, HEIGHT = 0.020, 0.130
AROUND, RINGS = 48, 12  # vertices of a ring, rings of the top


def main():
    straight = HEIGHT - RADIUS
    rings = [(RADIUS, straight * k / 24) for k in range(25)]
    for k in range(1, RINGS):
        angle = math.pi / 2 * k / RINGS
        rings.append((RADIUS * math.cos(angle), straight + RADIUS * math.sin(angle)))
    points = [(0.0, 0.0, 0.0)]
    for radius, z in rings:
        for k in range(AROUND):
            angle = 2 * math.pi * k / AROUND
            points.append((radius * math.cos(angle), radius * math.sin(angle), z))
    points.append((0.0, 0.0, HEIGHT))
    top = len(points) - 1

    def at(ring, k):
        return 1 + AROUND * ring + k % AROUND

    faces = []
    for k in range(AROUND):
        faces.append((0, at(0, k + 1), at(0, k)))
        faces.append((top, at(len(rings) - 1, k), at(len(rings) - 1, k + 1)))
        for ring in range(len(rings) - 1):
            faces.append((at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)))
            faces.append((at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)))
    lines = ["OFF", f"{len(points)} {len(faces)} 0"]
    lines += [" ".join(f"{c:.9g}" for c in point) for point in points]
    lines += ["3 " + " ".join(str(v) for v in face) for face in faces]
    pathlib.Path(sys.argv[1]).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
