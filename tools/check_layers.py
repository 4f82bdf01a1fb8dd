#!/usr/bin/env python3
"""Compare the #include lines of modules, programs, benches and examples with the tables in
docs/architecture.md.

Exit code 0 when they agree; otherwise one line per include that the tables do not allow. Also
compares the table of modules with the USES of CMakeLists.txt and with the folders of src/palpable, refuses
circular dependencies, modules of common that use another folder's, programs of the live half that
depend on a module of the bake half, and two types of one name in one namespace, which the linker
would mix up without a message.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Dependencies that response, contact and things must not have, so that they can be compiled for a web page: threads, files, HDF5, OpenCV.
PURE = ("response", "contact", "things")
IMPURE = re.compile(r"(thread|mutex|atomic|condition_variable|future|fstream|filesystem|cstdio)$|hdf5|opencv2/"
                    r"|palpable/common/(body_file/|base/(parallel_work|child_process|whole_file|output_file))")

# Pattern of a third party's headers -> its name in the table.
THIRD_PARTIES = {
    r"Eigen/": "Eigen", r"fmt/": "fmt", r"opencv2/": "OpenCV", r"lib(av\w+|swscale)/": "FFmpeg", r"hdf5\.h$": "HDF5", r"pugixml\.hpp$": "pugixml",
    r"epoxy/": "epoxy", r"EGL/": "EGL", r"GLFW/": "GLFW", r"X11/": "X11", r"imgui": "imgui", r"png\.h$": "libpng",
    r"nlohmann/": "nlohmann-json", r"toml\+\+/": "tomlplusplus", r"CGAL/": "CGAL",
    r"tetgen\.h$": "TetGen", r"cholmod\.h$": "CHOLMOD", r"cblas\.h$": "OpenBLAS", r"catch2/": "Catch2", r"CLI/": "CLI11",
    r"ceres/": "Ceres", r"hwy/": "Highway", r"mpi\.h$": "MPI", r"zlib\.h$": "zlib", r"zstd\.h$": "zstd",
    r"boost/": "Boost",
}
SYSTEM = re.compile(r"^(unistd|fcntl|spawn|sys/\w+|netinet/\w+|poll|signal|cpuid|pthread|sched|time|linux/videodev2|immintrin|stddef|stdint)\.h$")
STANDARD = re.compile(r"^[a-z_0-9]+$")  # <vector>, <cmath>; of C's <stdio.h> only what palpable.h needs


FOLDERS = ("common", "live", "desk", "bake")  # of src/palpable, each with the modules of one column
PROGRAMS = re.compile(r"(apps|bench)/[a-z-]+|examples")
LIVE_PROGRAMS = ("apps/palpable", "bench/live", "examples")


def read_tables():
    """{module or folder of a program: (our modules that it may use, third parties that it may use)}, and {module: its
    folder of src/palpable}, with which the title above its table begins."""
    rows, folders, title = {}, {}, ""
    for line in (ROOT / "docs/architecture.md").read_text().splitlines():
        title = line if line.startswith("**") else title
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if len(cells) != 4 or cells[0] in ("module", "folder") or not (
                re.fullmatch(r"[a-z_]+", cells[0]) or PROGRAMS.fullmatch(cells[0])):
            continue
        rows[cells[0]] = (set(cells[1].split()) - {"-"}, set(cells[2].split()) - {"-"})
        if not PROGRAMS.fullmatch(cells[0]):
            folders[cells[0]] = title.strip("*").split(":")[0].split(",")[0]
    return rows, folders


def folder_of(path):
    """The row of the table to which a path belongs, that of a file or of an #include."""
    parts = path.split("/")
    if parts[0] == "palpable":
        return parts[2]
    return parts[0] if parts[0] == "examples" else "/".join(parts[:2])


def third_party(header):
    for pattern, name in THIRD_PARTIES.items():
        if re.match(pattern, header):
            return name
    return None


def sources():
    for folder in ("src/palpable", "apps", "bench", "examples"):
        for source in sorted((ROOT / folder).rglob("*")):
            if source.suffix in (".h", ".cpp"):
                yield source.relative_to(ROOT)


def wrong_includes(allowed):
    for where in sources():
        folder = folder_of(str(where).removeprefix("src/"))
        is_test = where.stem.endswith("_test")
        if folder not in allowed:
            yield f"{where}: '{folder}' has no line in docs/architecture.md"
            continue
        ours, parties = allowed[folder]
        for number, line in enumerate((ROOT / where).read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s+(["<])([^">]+)[">]', line)
            if not match:
                continue
            header = match.group(2)
            party = third_party(header)
            if folder in PURE and not is_test and IMPURE.match(header):
                yield f"{where}:{number}: {folder} keeps threads, files, HDF5 and OpenCV out: {header}"
            if re.match(r"(palpable|apps|bench|examples)/", header):
                if folder_of(header) not in ours | {folder}:
                    yield f"{where}:{number}: {folder} may not use {folder_of(header)}"
            elif header.startswith("tests/"):
                if not is_test:
                    yield f"{where}:{number}: only tests may include {header}"
            elif party:
                if party not in parties and not is_test:
                    yield f"{where}:{number}: {folder} may not use {party}"
            elif match.group(1) == "<" and not STANDARD.match(header) and not SYSTEM.match(header):
                yield f"{where}:{number}: <{header}> is no known third party; tools/check_layers.py lists them"


def reached(allowed, folder):
    found, todo = set(), [folder]
    while todo:
        here = todo.pop()
        if here not in found:
            found.add(here)
            todo += allowed.get(here, ((), ()))[0]
    return found


def circles(allowed):
    """Modules that depend on themselves."""
    for module in sorted(allowed):
        if any(module in reached(allowed, used) for used in allowed[module][0]):
            yield f"docs/architecture.md: {module} uses what uses it"


def wrong_folders(folders):
    there = {}
    for folder in FOLDERS:
        for path in sorted((ROOT / "src/palpable" / folder).iterdir()):
            if path.name in there:
                yield f"src/palpable/{folder}: {path.name} is also a module of {there[path.name]}"
            there[path.name] = folder
    for module in sorted({*folders, *there}):
        if folders.get(module) != there.get(module):
            yield (f"docs/architecture.md: {module} stands below '{folders.get(module)}', its folder is in "
                   f"src/palpable/{there.get(module)}")


def wrong_halves(allowed, folders):
    bake = {module for module in folders if folders[module] == "bake"}
    for module in (module for module in folders if folders[module] == "common"):
        for used in sorted(allowed[module][0]):
            if folders.get(used) != "common":
                yield f"docs/architecture.md: {module} of common may not use {used} of {folders.get(used)}"
    for program in LIVE_PROGRAMS:
        if program not in allowed:
            yield f"docs/architecture.md: {program} has no line"
        for module in sorted(reached(allowed, program) & bake):
            yield f"docs/architecture.md: {program} belongs to the live half and reaches {module} of the bake half"


def wrong_targets(allowed, folders):
    text = (ROOT / "CMakeLists.txt").read_text()
    found = set(re.findall(r"palpable_module\(\w+/(\w+)", text))
    for module in sorted(found ^ set(folders)):
        yield f"CMakeLists.txt and docs/architecture.md: one of them lacks {module}"
    for match in re.finditer(r"palpable_module\(\w+/(\w+)(?: USES ([\w ]+?))?(?:\s+(?:TEST_)?LIBRARIES|\s*\))", text):
        module, uses = match.group(1), set((match.group(2) or "").split())
        if module in allowed and uses != allowed[module][0]:
            yield (f"CMakeLists.txt: {module} uses {sorted(uses)}, docs/architecture.md says "
                   f"{sorted(allowed[module][0])}")


def same_names():
    there = {}
    for where in sources():
        if where.suffix != ".h":
            continue
        namespace = ""
        for number, line in enumerate((ROOT / where).read_text().splitlines(), 1):
            opened = re.match(r"namespace ([\w:]+) \{", line)
            namespace = opened.group(1) if opened else namespace
            match = re.match(r"(?:struct|class|enum class) (?:alignas\([^)]*\) )?(\w+)(?: final)?(?: : [^;]*)? \{", line)
            if not match:
                continue
            name = f"{namespace}::{match.group(1)}"
            if name in there:
                yield f"{where}:{number}: {name} is also a type of {there[name]}"
            there.setdefault(name, f"{where}:{number}")


def main():
    allowed, folders = read_tables()
    if set(folders.values()) != set(FOLDERS):
        sys.exit(f"check_layers: the titles of docs/architecture.md's tables of modules begin with {FOLDERS}")
    wrong = [*wrong_includes(allowed), *wrong_targets(allowed, folders), *circles(allowed), *wrong_folders(folders),
             *wrong_halves(allowed, folders), *same_names()]
    for row in allowed:
        if PROGRAMS.fullmatch(row) and not (ROOT / row).is_dir():
            wrong.append(f"docs/architecture.md: '{row}' has no folder")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
