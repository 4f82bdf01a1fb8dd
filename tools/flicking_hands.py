#!/usr/bin/env python3
"""Prints a hands file (docs/hands.md) in which an ear of the demo's bunny is bent and let go, then flicked.

usage: tools/flicking_hands.py >flick.jsonl
       palpable live out/demo/bunny.palpable --source flick.jsonl --out result
"""
import json

FRAMES_PER_S = 60
RADIUS = 0.008  # m, of a fingertip
LENGTH = 0.05  # m, of a finger

# Frame of the body: the top of an ear (m), the direction in which it is bent, that from the finger's tip to its root.
EAR = (-0.0217, 0.0001, 0.15)
DOWN = (0.0, 0.0, -1.0)
FINGER = (0.5, 0.3, 0.81)
END = 4.5  # s

# (s, m): the way of the finger down, straight between these. It touches at 0, bends the ear by 7 mm and goes back faster than
# the ear follows; later it hits the ear at 0.3 m/s and goes back at once.
WAY = ((0.0, -0.04), (0.4, -0.004), (1.1, 0.007), (1.4, 0.007), (1.44, -0.04), (2.9, -0.04), (3.05, 0.005), (3.1, -0.04), (END, -0.04))


def way(time):
    """m, of the finger at a time, s."""
    for (t0, x0), (t1, x1) in zip(WAY, WAY[1:]):
        if time <= t1:
            return x0 + (x1 - x0) * (time - t0) / (t1 - t0)
    return WAY[-1][1]


def main():
    for frame in range(int(END * FRAMES_PER_S)):
        time = frame / FRAMES_PER_S
        tip = [e + (way(time) - RADIUS) * d for e, d in zip(EAR, DOWN)]
        root = [t + LENGTH * d for t, d in zip(tip, FINGER)]
        capsule = [round(x, 6) for x in (*tip, *root, RADIUS, RADIUS)]
        print(json.dumps({"time": round(time, 4), "things": [{"id": 1, "capsules": [capsule]}]}))


if __name__ == "__main__":
    main()
