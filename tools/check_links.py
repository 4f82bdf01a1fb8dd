#!/usr/bin/env python3
"""check_links.py palpable: checks that the live program does not link libraries of the bake half (design: two halves).
check_links.py libpalpable.so palpable.h hands.h: the same for the library, which must not link windows, picture files or
films either, and must export the functions of its headers and nothing else. None of them may compute by a processor's
approximate reciprocals and roots: they differ from maker to maker, and a run gives the same bytes on each."""
import re
import subprocess
import sys
from pathlib import Path

FORBIDDEN = re.compile(r"lib(cholmod|tet\b|gmsh|CGAL|mpi|metis|amd|colamd|gmp|mpfr|openblas|lapack)")
# Libraries that a program which uses the library should not need.
NOT_IN_LIBRARY = re.compile(r"lib(GL|EGL|OpenGL|epoxy|glfw|X11|av\w+|sw\w+|png|opencv_(highgui|videoio|imgcodecs)|pugixml)")
# One class of each part of the bake half, because its static libraries do not appear in the list of shared ones.
BAKE_HALF = re.compile(r"palpable::(EquilibriumSolver|ContactWalk|PressSolver|SnapshotStore|TetMesh|BodyDescription)\b")


# Instructions of x86-64 and of arm64, and functions that only draw a window's menus.
APPROXIMATE = re.compile(r"\s(v?r(?:sqrt|cp)(?:14|28)?[ps]s|fr(?:sqrt|ecp)e)\s")
OF_MENUS = re.compile(r"\bIm[A-Z]\w*::|\bImGui")


def output_of(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def wrong_exports(library, headers):
    """Differences between the exported symbols and the functions of the headers."""
    exported = set(re.findall(r"^\w+ \w (\S+)$", output_of("nm", "-D", "--defined-only", library), re.MULTILINE))
    declared = set()
    for header in headers:
        functions = re.findall(r"^PALPABLE_API [^;(]*?(\w+)\(", Path(header).read_text(), re.MULTILINE)
        if not functions:
            sys.exit(f"check_links: {header} declares no function")
        declared.update(functions)
    for name in sorted(exported - declared):
        yield f"{library} exports {name}, which no header declares"
    for name in sorted(declared - exported):
        yield f"{library} does not export {name}, which a header declares"
    if not re.search(r"\(SONAME\).*\[libpalpable\.so\.\d+\]", output_of("readelf", "-d", library)):
        yield f"{library} has no SONAME with the major version"


def approximations(file):
    """Functions of a program that use approximate instructions."""
    function, found = "", set()
    for line in output_of("objdump", "-d", "-C", "--no-show-raw-insn", file).splitlines():
        if line.endswith(">:"):
            function = line.partition("<")[2][:-2]
        elif APPROXIMATE.search(line) and not OF_MENUS.search(function):
            found.add(function)
    return [f"{file}: {name} uses an approximate reciprocal or root, which differs from processor to processor"
            for name in sorted(found)]


def main():
    file, headers = sys.argv[1], sys.argv[2:]
    needed = re.findall(r"\(NEEDED\).*\[(.+)\]", output_of("readelf", "-d", file))
    if not needed:
        sys.exit(f"check_links: {file} needs no library at all; is it the right file?")
    wrong = [f"{file} links {name}, which belongs to the bake half" for name in needed if FORBIDDEN.match(name)]
    names = output_of("nm", "-C", file)
    if "palpable::" not in names:
        sys.exit(f"check_links: {file} was stripped: what it holds cannot be read")
    wrong += [f"{file} holds palpable::{name}, which belongs to the bake half"
              for name in sorted(set(BAKE_HALF.findall(names)))]
    if headers:
        wrong += [f"{file} links {name}, which its users do not want" for name in needed if NOT_IN_LIBRARY.match(name)]
        wrong += wrong_exports(file, headers)
    wrong += approximations(file)
    for line in wrong:
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
