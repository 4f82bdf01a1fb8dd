"""Presses the same finger into several bodies and compares how they push back.

    python3 compare_bodies.py soft.palpable hard.palpable compare_bodies.png
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from force_over_depth import press


def main(files, picture):
    depths = np.linspace(0, 0.006, 13)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4))
    stiffness = []
    for file in files:
        forces, _, _, stress = press(file, depths)
        stiffness.append(forces[-1] / depths[-1])
        left.plot(1000 * depths, forces, "o-", label=Path(file).stem)
        right.plot(np.linspace(0, 100, len(stress)), np.sort(stress)[::-1] / 1000, label=Path(file).stem)
    left.set(xlabel="depth of the finger, mm", ylabel="force, N")
    right.set(xlabel="share of the vertices with more stress, %", ylabel="von Mises stress, kPa", yscale="log")
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.legend()
    figure.tight_layout()
    figure.savefig(picture, dpi=100)
    for file, each in zip(files, stiffness):
        print(f"{Path(file).stem}: {each:.0f} N/m")
    return stiffness


if __name__ == "__main__":
    stiffness = main(sys.argv[1:-1], sys.argv[-1])
    assert all(each > 0 for each in stiffness)
