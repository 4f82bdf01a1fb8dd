"""A simulated force device leans on a body and shakes: a thousand forces a second.

    python3 force_device.py bunny.palpable force_device.png

With a real device the loop stays as it is: its position is read where this one computes it, and the force is sent to it.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import palpable

TICK, SECONDS = 1e-3, 3.0  # s
MASS, GRIP, DAMPING = 0.05, 300.0, 3.0  # kg, N/m and N s/m: a device of 50 g, and the hand that holds it
RADIUS = 0.008  # m, of the ball at its end


def side_of(session):
    """The point of the skin that is farthest along X, half way up."""
    vertices = session.skin().vertices
    height = vertices[:, 2] / vertices[:, 2].max()
    return vertices[np.where(abs(height - 0.5) < 0.1, vertices[:, 0], -1).argmax()].astype(float)


def lean(session, skin):
    """Lets the hand lead the device into the body, along -X: time, depth and force, tick by tick."""
    place, speed, force = skin + [RADIUS + 0.003, 0, 0], np.zeros(3), np.zeros(3)
    rows = []
    for tick in range(1, int(SECONDS / TICK)):
        time = tick * TICK
        ball = palpable.Capsules([[*place, *place, RADIUS, RADIUS]], id=1)
        felt, reached = session.tick([ball], time)
        force = felt[0, :3] if reached else force  # N, on the device
        depth = min(0.008, 0.02 * time - 0.003) + (0.002 * np.sin(2 * np.pi * 4 * time) if 1 < time < 2 else 0)
        hand = GRIP * (skin + [RADIUS - depth, 0, 0] - place) - DAMPING * speed
        speed += TICK / MASS * (hand + force)
        place = place + TICK * speed
        rows.append((time, skin[0] + RADIUS - place[0], force[0]))
    return np.array(rows).T


def main(file, picture):
    with palpable.Body(file) as body, palpable.Session(body) as session:
        time, depth, force = lean(session, side_of(session))
    figure, (above, below) = plt.subplots(2, 1, figsize=(8, 5), sharex=True)
    above.plot(time, 1e3 * depth)
    above.set(ylabel="depth of the device, mm")
    below.plot(time, force)
    below.set(xlabel="time, s", ylabel="force on the device, N")
    for axes in (above, below):
        axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(picture, dpi=110)
    print(f"{force[-1]:.2f} N at {1e3 * depth[-1]:.1f} mm, {force.max():.2f} N at most; {len(time)} ticks")


if __name__ == "__main__":
    main(*sys.argv[1:3])
