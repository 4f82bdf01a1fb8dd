#!/usr/bin/env python3
"""Prints a hands file (docs/hands.md) in which the demo's bunny is rubbed: a finger presses its back and is dragged along it,
then finger and thumb take an ear and pull it.

usage: tools/rubbing_hands.py >rub.jsonl
       palpable live out/demo/bunny.palpable --source rub.jsonl --friction 0.6 --out result
"""
import json

FRAMES_PER_S = 30
RADIUS = 0.008  # m, of a fingertip
LENGTH = 0.045  # m, of a finger
AWAY = 0.06  # m from the skin, where fingers wait

# Frame of the body. The place of the back that is pressed (m), the direction from the finger's tip to its root, and the
# direction of the drag.
BACK = (0.006, 0.012, 0.0965)
UP = (0.25, -0.2, 0.947)
ALONG = (0.0, 1.0, -0.08)
# A point (m) inside an ear near its tip, the direction across which the ear is thin, and the direction from tip to root of
# both fingers. They pinch along THIN.
EAR = (-0.0134, -0.0075, 0.139)
THIN = (0.85, 0.49, 0.17)
FINGERS = (-0.05, -0.33, 0.94)
HALF = 0.0055  # m, of the ear's thickness there
PULL = FINGERS


def plus(a, b, factor=1.0):
    return tuple(x + factor * y for x, y in zip(a, b))


def smooth(t):
    """0 to 1 for t from 0 to 1, with a slow begin and end."""
    t = min(max(t, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def between(time, begin, end):
    return smooth((time - begin) / (end - begin))


def finger(tip, direction):
    """A capsule, of whose surface `tip` is the lowest point."""
    low = plus(tip, direction, RADIUS)
    return [*low, *plus(low, direction, LENGTH), RADIUS, RADIUS]


def back(time):
    depth = 0.006 * between(time, 0.3, 1.3) - 0.006 * between(time, 4.0, 4.6)
    away = AWAY * (1 - between(time, 0.0, 0.8)) + AWAY * between(time, 4.4, 5.2)
    along = 0.022 * between(time, 1.5, 2.6) - 0.022 * between(time, 2.8, 3.9)
    return finger(plus(plus(BACK, UP, away - depth), ALONG, along), UP)


def ear(time):
    closed = between(time, 5.6, 6.6) - between(time, 9.6, 10.4)
    gap = 0.025 * (1 - closed) - 0.0035 * closed
    up = 0.05 * (1 - between(time, 5.0, 5.8)) + 0.05 * between(time, 10.0, 10.8)
    middle = plus(plus(EAR, FINGERS, up), PULL, 0.012 * between(time, 6.9, 8.2) - 0.012 * between(time, 8.6, 9.5))
    capsules = []
    for side in (1, -1):
        tip = plus(plus(middle, THIN, side * (HALF + RADIUS + gap)), FINGERS, -0.012)
        capsules.append([*tip, *plus(tip, FINGERS, LENGTH), RADIUS, RADIUS])
    return capsules


def main():
    for frame in range(int(11.2 * FRAMES_PER_S)):
        time = frame / FRAMES_PER_S
        things = []
        if time < 5.2:
            things.append({"id": 1, "capsules": [back(time)]})
        if time > 5.0:
            things.append({"id": 2, "capsules": ear(time)})
        for thing in things:
            thing["capsules"] = [[round(x, 6) for x in capsule] for capsule in thing["capsules"]]
        print(json.dumps({"time": round(time, 4), "things": things}))


if __name__ == "__main__":
    main()
