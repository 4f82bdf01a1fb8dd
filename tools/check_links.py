#!/usr/bin/env python3
"""check_links.py palpable: what the live program must not link, it does not link (design: two halves)."""
import re
import subprocess
import sys

FORBIDDEN = re.compile(r"lib(cholmod|tet\b|gmsh|CGAL|mpi|metis|amd|colamd|gmp|mpfr|openblas|lapack)")
# One class of each part of the bake half: its static libraries leave no name in the list of the shared ones.
BAKE_HALF = re.compile(r"palpable::(EquilibriumSolver|ContactWalk|PressSolver|SnapshotStore|TetMesh|BodyDescription)\b")


def main():
    output = subprocess.run(["readelf", "-d", sys.argv[1]], check=True, capture_output=True, text=True).stdout
    needed = re.findall(r"\(NEEDED\).*\[(.+)\]", output)
    if not needed:
        sys.exit(f"check_links: {sys.argv[1]} needs no library at all; is it the right file?")
    wrong = [name for name in needed if FORBIDDEN.match(name)]
    for name in wrong:
        print(f"{sys.argv[1]} links {name}, which belongs to the bake half")
    names = subprocess.run(["nm", "-C", sys.argv[1]], check=True, capture_output=True, text=True).stdout
    if "palpable::" not in names:
        sys.exit(f"check_links: {sys.argv[1]} was stripped: nobody can tell what it holds")
    inside = sorted(set(BAKE_HALF.findall(names)))
    for name in inside:
        print(f"{sys.argv[1]} holds palpable::{name}, which belongs to the bake half")
    return 1 if wrong or inside else 0


if __name__ == "__main__":
    sys.exit(main())
