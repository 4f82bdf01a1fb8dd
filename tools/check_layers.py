#!/usr/bin/env python3
"""Compare the #include lines under src/palpable with the table in docs/architecture.md.

Exit code 0 when they agree; otherwise one line per include that the table does not allow. Also
compares the table with the USES of CMakeLists.txt and refuses rows without a folder.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# How a third party's headers look -> its name in the table.
THIRD_PARTIES = {
    r"Eigen/": "Eigen", r"fmt/": "fmt", r"opencv2/": "OpenCV", r"lib(av\w+|swscale)/": "FFmpeg", r"hdf5\.h$": "HDF5", r"pugixml\.hpp$": "pugixml",
    r"epoxy/": "epoxy", r"EGL/": "EGL", r"GLFW/": "GLFW", r"X11/": "X11", r"imgui": "imgui", r"png\.h$": "libpng",
    r"nlohmann/": "nlohmann-json", r"toml\+\+/": "tomlplusplus", r"CGAL/": "CGAL",
    r"tetgen\.h$": "TetGen", r"cholmod\.h$": "CHOLMOD", r"cblas\.h$": "OpenBLAS", r"catch2/": "Catch2", r"CLI/": "CLI11",
    r"ceres/": "Ceres", r"hwy/": "Highway", r"mpi\.h$": "MPI", r"zlib\.h$": "zlib",
}
POSIX = re.compile(r"^(unistd|fcntl|sys/\w+|poll|signal|pthread|sched|time|linux/videodev2)\.h$")
STANDARD = re.compile(r"^[a-z_0-9]+$")  # <vector>, <cmath>; C's <stdio.h> is not wanted


def read_table():
    """{module: (modules it may use, third parties it may use)}"""
    rows = {}
    for line in (ROOT / "docs/architecture.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if len(cells) == 4 and re.fullmatch(r"[a-z_]+", cells[0]) and cells[0] != "module":
            rows[cells[0]] = (set(cells[1].split()) - {"-"}, set(cells[2].split()) - {"-"})
    return rows


def third_party(header):
    for pattern, name in THIRD_PARTIES.items():
        if re.match(pattern, header):
            return name
    return None


def wrong_includes(allowed):
    for source in sorted((ROOT / "src/palpable").rglob("*")):
        if source.suffix not in (".h", ".cpp"):
            continue
        module = source.relative_to(ROOT / "src/palpable").parts[0]
        where = source.relative_to(ROOT)
        is_test = source.stem.endswith("_test")
        if module not in allowed:
            yield f"{where}: module '{module}' has no line in docs/architecture.md"
            continue
        modules, parties = allowed[module]
        for number, line in enumerate(source.read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s+(["<])([^">]+)[">]', line)
            if not match:
                continue
            header = match.group(2)
            ours = re.match(r"palpable/(\w+)/", header)
            party = third_party(header)
            if ours:
                if ours.group(1) not in modules | {module}:
                    yield f"{where}:{number}: {module} may not use {ours.group(1)}"
            elif header.startswith("tests/"):
                if not is_test:
                    yield f"{where}:{number}: only tests may include {header}"
            elif party:
                if party not in parties and not is_test:
                    yield f"{where}:{number}: {module} may not use {party}"
            elif match.group(1) == "<" and not STANDARD.match(header) and not POSIX.match(header):
                yield f"{where}:{number}: <{header}> is no known third party; tools/check_layers.py lists them"


def wrong_targets(allowed):
    text = (ROOT / "CMakeLists.txt").read_text()
    for match in re.finditer(r"palpable_module\(NAME (\w+)(?: USES ([\w ]+?))?(?:\s+LIBRARIES|\s*\))", text):
        module, uses = match.group(1), set((match.group(2) or "").split())
        if module in allowed and uses != allowed[module][0]:
            yield (f"CMakeLists.txt: {module} uses {sorted(uses)}, docs/architecture.md says "
                   f"{sorted(allowed[module][0])}")


def main():
    allowed = read_table()
    if not allowed:
        sys.exit("check_layers: docs/architecture.md has no table of modules")
    wrong = list(wrong_includes(allowed)) + list(wrong_targets(allowed))
    for module in allowed:
        if not (ROOT / "src/palpable" / module).is_dir():
            wrong.append(f"docs/architecture.md: module '{module}' has no folder")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
