"""From displacements in NumPy arrays to a body file: how the error falls with the number of modes.

    python3 snapshots_to_modes.py snapshots_to_modes.png

The solutions are those of a clamped bar, bent by a force at one of several places: here from a formula, elsewhere from
a solver of yours.
"""

import itertools
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import palpable

LENGTH, SIDE, YOUNG, FORCE = 0.4, 0.04, 60e3, 0.06  # m, m, Pa, N
COUNT = (21, 3, 3)  # nodes along x, y, z


def bar():
    """Nodes (N, 3) and tetrahedra (E, 4): cubes, each cut into six."""
    size = np.array([LENGTH, SIDE, SIDE])
    index = np.arange(np.prod(COUNT)).reshape(COUNT)
    nodes = np.argwhere(index >= 0) * size / (np.array(COUNT) - 1)
    cells = []
    for corner in itertools.product(*(range(n - 1) for n in COUNT)):
        for order in itertools.permutations(range(3)):
            walk = [np.array(corner)]
            for axis in order:
                walk.append(walk[-1] + np.eye(3, dtype=int)[axis])
            cell = [index[tuple(place)] for place in walk]
            edges = nodes[cell[1:]] - nodes[cell[0]]
            cells.append(cell if np.linalg.det(edges) > 0 else [cell[0], cell[2], cell[1], cell[3]])
    return nodes, np.array(cells)


def bent(nodes, at, force):
    """Displacement (N, 3) of a bar clamped at x = 0 under a force down at x = `at`; cross-sections turn and stay flat."""
    x, z = nodes[:, 0], nodes[:, 2] - SIDE / 2
    near = np.minimum(x, at)
    stiffness = YOUNG * SIDE**4 / 12
    slope = -force * near * (2 * at - near) / (2 * stiffness)
    sag = -force * near**2 * (3 * at - near) / (6 * stiffness) + slope * (x - near)
    turn = np.arctan(slope)
    return np.stack([-z * np.sin(turn), 0 * x, sag + z * (np.cos(turn) - 1)], axis=1)


def main(picture):
    nodes, cells = bar()
    top = np.flatnonzero((nodes[:, 2] == SIDE) & (nodes[:, 1] == SIDE / 2) & (nodes[:, 0] > 0.1))
    levels = np.linspace(0.2, 1, 5)
    u = np.array([[bent(nodes, nodes[site, 0], level * FORCE) for level in levels] for site in top])
    parameters = palpable.Parameters(
        sites=top, forces=FORCE, levels=levels, direction=[0, 0, -1], patch=0, held=np.flatnonzero(nodes[:, 0] == 0), young=YOUNG
    )
    figure, axes = plt.subplots(figsize=(6, 4))
    with tempfile.TemporaryDirectory() as folder:
        for method, line in (("pod", "o-"), ("pgd", "s--"), ("cp", "x:")):
            made = palpable.snapshots(u, (nodes, cells), parameters).reduce(
                Path(folder) / f"{method}.palpable", method=method, tolerance=1e-5, max_modes=20
            )
            axes.semilogy(made.error_curve.modes, made.error_curve.pooled, line, label=method)
            print(f"{method}: {made.error_curve.modes[-1]} modes, relative error {made.body.displacement_error:.1e}")
    axes.set(xlabel="modes", ylabel="relative error of displacement")
    axes.grid(alpha=0.3)
    axes.legend()
    figure.tight_layout()
    figure.savefig(picture, dpi=100)
    return made.error_curve.pooled


if __name__ == "__main__":
    errors = main(sys.argv[1])
    assert errors[-1] < 1e-3, "a few modes describe the bar"
