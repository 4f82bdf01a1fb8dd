#!/usr/bin/env python3
"""Writes the beam of bodies/beam.toml: a box of tetrahedra as a CalculiX deck, nodes and sets only.

0.40 x 0.10 x 0.05 m, 58 x 30 x 6 cells of six tetrahedra each: 12,803 nodes, 62,640 tetrahedra, a skin
of 4,538 nodes. Sets: CLAMP, the nodes of the end x = 0; TOP, the 1,798 nodes of the top face that are
not clamped; THIRD, every third of them in x and y, 190;
UNDER_TIP, every second node in x and y of the lower face within 0.10 m of the free end.
"""
import itertools
import pathlib
import sys

SIZE = (0.40, 0.10, 0.05)
CELLS = (58, 30, 6)


def number(i, j, k):
    return 1 + i + (CELLS[0] + 1) * (j + (CELLS[1] + 1) * k)


def main():
    path = pathlib.Path(sys.argv[1])
    points = (n + 1 for n in CELLS)
    lines = ["*NODE"]
    for k, j, i in itertools.product(*(range(n) for n in reversed(list(points)))):
        x = [f"{SIZE[a] * c / CELLS[a]:.9g}" for a, c in enumerate((i, j, k))]
        lines.append(f"{number(i, j, k)}, {', '.join(x)}")
    lines.append("*ELEMENT, TYPE=C3D4, ELSET=ALL")
    element = 0
    for k, j, i in itertools.product(range(CELLS[2]), range(CELLS[1]), range(CELLS[0])):
        # The six paths from the first to the last corner of the cell, one axis after the other.
        for order in itertools.permutations(range(3)):
            corner = [i, j, k]
            nodes = [number(*corner)]
            for axis in order:
                corner[axis] += 1
                nodes.append(number(*corner))
            if order in ((0, 2, 1), (1, 0, 2), (2, 1, 0)):  # mirrored
                nodes[1], nodes[2] = nodes[2], nodes[1]
            element += 1
            lines.append(f"{element}, {', '.join(map(str, nodes))}")
    top = [(i, j) for j in range(CELLS[1] + 1) for i in range(1, CELLS[0] + 1)]
    sets = {
        "CLAMP": [number(0, j, k) for k in range(CELLS[2] + 1) for j in range(CELLS[1] + 1)],
        "TOP": [number(i, j, CELLS[2]) for i, j in top],
        # The lower face within 0.10 m of the free end, every second node in x and y.
        "UNDER_TIP": [number(i, j, 0) for i, j in top
                      if SIZE[0] * i / CELLS[0] >= SIZE[0] - 0.10 and i % 2 == 0 and j % 2 == 1],
        # Beginning two nodes from each edge: 19 in x, 10 in y.
        "THIRD": [number(i, j, CELLS[2]) for i, j in top if i % 3 == 2 and j % 3 == 1],
    }
    for name, nodes in sets.items():
        lines.append(f"*NSET, NSET={name}")
        for first in range(0, len(nodes), 10):
            lines.append(", ".join(map(str, nodes[first:first + 10])))
    path.parent.mkdir(parents=True, exist_ok=True)
    aside = path.with_name(path.name + ".part")
    aside.write_text("\n".join(lines) + "\n")
    aside.replace(path)


main()
