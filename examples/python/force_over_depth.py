"""Presses a finger into a body from above, in its middle, step by step, and plots the force over the depth.

    python3 force_over_depth.py bunny.palpable force_over_depth.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import palpable

RADIUS = 0.008  # m, of the finger


def press(file, depths):
    """Newtons on the body for each depth, and the skin under the last one."""
    with palpable.Body(file) as body, palpable.Session(body) as session:
        vertices = session.skin().vertices
        near_axis = vertices[np.hypot(vertices[:, 0], vertices[:, 1]) < RADIUS]
        top = near_axis[near_axis[:, 2].argmax()].astype(float)
        forces = []
        for depth in depths:
            tip = top + [0, 0, RADIUS - depth]
            session.press([*tip, *(tip + [0, 0, 0.06]), RADIUS, RADIUS])
            forces.append(-sum(touch.force[2] for touch in session.touches))
        skin = session.skin()
        return np.array(forces), skin.vertices.copy(), skin.triangles.copy(), skin.von_mises.copy()


def main(file, picture):
    depths = np.linspace(0, 0.008, 17)
    forces, vertices, triangles, stress = press(file, depths)
    figure = plt.figure(figsize=(9, 4))
    left = figure.add_subplot(1, 2, 1)
    left.plot(1000 * depths, forces, "o-")
    left.set(xlabel="depth of the finger, mm", ylabel="force, N")
    left.grid(alpha=0.3)
    right = figure.add_subplot(1, 2, 2, projection="3d")
    skin = right.plot_trisurf(*(1000 * vertices.T), triangles=triangles, cmap="viridis")
    skin.set_array(stress[triangles].mean(axis=1) / 1000)
    right.set_box_aspect(np.ptp(vertices, axis=0))
    figure.colorbar(skin, label="von Mises stress, kPa", shrink=0.7)
    figure.tight_layout()
    figure.savefig(picture, dpi=100)
    print(f"{forces[-1]:.2f} N at {1000 * depths[-1]:.0f} mm")
    return forces


if __name__ == "__main__":
    forces = main(*sys.argv[1:3])
    assert np.all(np.diff(forces) > 0), "a deeper finger is pushed back harder"
