"""Lets a tracked hand press a body: joints from a file in, touches out.

    python3 hand_to_touches.py bunny.palpable hand.csv hand_to_touches.png

A line of the file is a time (s), then x y z (m, world) of each of OpenXR's 26 joints. In hand.csv the tip of an index
finger comes down on a point 10 cm above the origin; the body is placed so that its skin is there.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import palpable


def placed(file):
    """The body, its skin 10 cm above the origin."""
    body = palpable.Body(file)
    with palpable.Session(body) as session:
        vertices = session.skin().vertices
        height = vertices[np.hypot(vertices[:, 0], vertices[:, 1]) < 0.008, 2].max()
    place = np.eye(4)
    place[2, 3] = 0.1 - height
    body.place(place)
    return body


def main(file, joints, picture):
    lines, count, forces, most = np.loadtxt(joints, delimiter=","), 0, [], -1.0
    with placed(file) as body, palpable.Session(body) as session:
        for time, *numbers in lines:
            hand = palpable.Hand(np.reshape(numbers, (26, 3)), layout="openxr", side="right")
            session.press(hand, time)
            if session.frame.answer is not palpable.Answer.REACHED:
                forces.append(np.nan)  # the skin has not given way: forces are not to be used
                continue
            touches = session.touches
            count += len(touches)
            force = sum(-touch.force[2] for touch in touches)
            forces.append(force)
            if force > most:
                most, skin = force, session.skin()
                moment = time, hand.capsules, skin.vertices + skin.world_from_body[:3, 3], skin.triangles.copy()
    draw(lines[:, 0], forces, *moment, picture)
    missing = np.count_nonzero(np.isnan(forces))
    print(f"{count} touches in {len(lines)} frames, at most {most:.2f} N; {missing} frames without an answer")
    return most


def draw(times, forces, moment, capsules, vertices, triangles, picture):
    """The force over time, and hand and skin at one moment."""
    figure = plt.figure(figsize=(9, 4))
    left = figure.add_subplot(1, 2, 1)
    left.plot(times, forces)  # nan, where there is no answer, is a gap
    left.set(xlabel="time, s", ylabel="force downwards, N")
    left.grid(alpha=0.3)
    right = figure.add_subplot(1, 2, 2, projection="3d", computed_zorder=False)
    right.plot_trisurf(*vertices.T, triangles=triangles, color="0.8", zorder=1)
    for ax, ay, az, bx, by, bz, radius, _ in capsules:
        right.plot([ax, bx], [ay, by], [az, bz], color="C1", linewidth=400 * radius, alpha=0.7, solid_capstyle="round", zorder=2)
    right.set_box_aspect(np.ptp(np.vstack([vertices, capsules[:, :3], capsules[:, 3:6]]), axis=0))
    right.set(title=f"at {moment:.2f} s", xticks=[], yticks=[], zticks=[])
    right.view_init(15, -70)
    figure.tight_layout()
    figure.savefig(picture, dpi=100)


if __name__ == "__main__":
    assert main(*sys.argv[1:4]) > 0.1, "the hand presses"
