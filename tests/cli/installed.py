#!/usr/bin/env python3
"""An installed copy without the rest of this repository: its files, its programs, and examples/installed, which use its
library."""
import fcntl
import os
import re
import shutil
import subprocess
import sys
from math import sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Werror"


def run(*words, **options):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=280,
                            stdin=subprocess.DEVNULL, **options)
    assert result.returncode == 0, f"{words}: exit code {result.returncode}\n{result.stdout}\n{result.stderr}"
    return result.stdout


def round_ball(parts=3):
    """An octahedron whose faces were split in four `parts` times, its vertices projected onto the unit sphere; as OFF."""
    corners = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(parts):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                x = [(p + q) / 2 for p, q in zip(corners[a], corners[b])]
                corners.append(tuple(c / sqrt(sum(d * d for d in x)) for c in x))
                middles[key] = len(corners) - 1
            return middles[key]

        parted = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            parted += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = parted
    lines = ["OFF", f"{len(corners)} {len(faces)} 0"]
    lines += [f"{x:.9f} {y:.9f} {z:.9f}" for x, y, z in corners]
    return "\n".join(lines + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n"


class Installed:
    """Made once and shared by the cases: the copy, a ball baked by its programs, the examples built by CMake."""
    def __init__(self, programs):
        build = Path(programs.palpable).parent.parent
        place = programs.work / "installed"
        self.prefix, self.body, self.examples = place / "usr", place / "ball.palpable", place / "examples"
        stamp = place / "done"
        made_of = [programs.palpable, programs.palpable + "-bake", build / "lib/libpalpable.so",
                   base.ROOT / "src/palpable/live/capi/palpable.h", base.ROOT / "src/palpable/live/capi/hands.h",
                   *(base.ROOT / "examples/installed").iterdir(),
                   *(base.ROOT / "cmake").iterdir(), __file__]
        assert (build / "lib/libpalpable.so").exists(), "the target palpable_library was not built"
        with open(programs.work / "installed.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if stamp.exists() and all(Path(file).stat().st_mtime < stamp.stat().st_mtime for file in made_of):
                return
            shutil.rmtree(place, ignore_errors=True)
            run("cmake", "--install", build, "--prefix", self.prefix)
            describes = base.write_ball(place, base.TOUCHED_BALL)
            (place / "ball.off").write_text(round_ball())
            # The programs find each other although they are not on the path.
            run(self.prefix / "bin/palpable", "bake", describes, "-o", self.body)
            run("cmake", "-S", base.ROOT / "examples/installed", "-B", self.examples, "-G", "Ninja",
                f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_C_FLAGS={WARNINGS}")
            run("cmake", "--build", self.examples)
            stamp.touch()


@case("an installed copy has its library, header, programs and licence, and its programs find each other")
def _(programs, folder):
    copy = Installed(programs)
    for file in ("lib/libpalpable.so", "lib/libpalpable.so.0", "include/palpable/palpable.h", "bin/palpable",
                 "bin/palpable-bake", "lib/pkgconfig/palpable.pc", "lib/cmake/palpable/palpableConfig.cmake",
                 "lib/cmake/palpable/palpableConfigVersion.cmake", "lib/cmake/palpable/palpableTargets.cmake",
                 "share/doc/palpable/LICENSE"):
        assert (copy.prefix / file).exists(), file
    assert sorted(p.name for p in (copy.prefix / "include").rglob("*.h")) == ["hands.h", "palpable.h"], "and no header of C++"
    # No installed file contains a path of the build.
    for file in (copy.prefix / "lib").rglob("*"):
        if file.suffix in (".cmake", ".pc"):
            assert str(base.ROOT) not in file.read_text() and "/usr/lib" not in file.read_text(), file
    assert "touch" in run(copy.prefix / "bin/palpable", "inspect", copy.body)


@case("an installed copy presses its own bodies by their names, and the post where none is named")
def _(programs, folder):
    copy = Installed(programs)
    place = folder / "usr"
    shutil.copytree(copy.prefix / "bin", place / "bin")
    shipped = place / "share/palpable/bodies"
    shipped.mkdir(parents=True)
    shutil.copy(copy.body, shipped / "post.palpable")
    program = place / "bin/palpable"

    def facts(body):  # without the third line, whose time is measured
        lines = run(program, "inspect", body, cwd=folder).splitlines()
        assert lines[2].startswith("speed:"), lines[:3]
        return lines[:2] + lines[3:]
    assert facts("post") == facts(shipped / "post.palpable")
    refused = subprocess.run([program, "inspect", "pest"], cwd=folder, capture_output=True, text=True)
    assert refused.returncode == 1 and "pest" in refused.stderr, refused.stderr
    # The repository's own bodies would be found first; here there are none.
    filmed = subprocess.run([program, "synth", "still", "--frames", "1", "-o", "clip"], cwd=folder, capture_output=True, text=True)
    if filmed.returncode != 0 and "EGL" in filmed.stderr:
        print("SKIPPED: no OpenGL here: " + filmed.stderr.strip())
        return
    assert filmed.returncode == 0 and (folder / "clip/frames").is_dir(), filmed.stderr
    (shipped / "post.palpable").unlink()
    refused = subprocess.run([program, "synth", "still", "--frames", "1", "-o", "other"], cwd=folder, capture_output=True, text=True)
    assert refused.returncode == 1 and str(shipped / "post.palpable") in refused.stderr, refused.stderr


def assert_rubber(told):
    """Hertz: 4/3 E* sqrt(R) d^1.5 with E* = E / (1 - nu^2), 1/R = 1/8 mm + 1/50 mm, d = 4 mm."""
    hertz = 4 / 3 * 60e3 / (1 - 0.4**2) * sqrt(1 / (1 / 0.008 + 1 / 0.05)) * 0.004**1.5
    force = float(re.match(r"([\d.]+) N", told)[1])
    assert 0.7 * hertz < force < 2 * hertz, f"{told} Hertz: {hertz:.2f} N; the mesh's edges are as long as the finger is wide"


@case("a finger in the installed example feels the force of a ball of rubber")
def _(programs, folder):
    copy = Installed(programs)
    assert_rubber(run(copy.examples / "press_finger", copy.body))


@case("depth images in, touches out, in the installed example")
def _(programs, folder):
    copy = Installed(programs)
    told = run(copy.examples / "touch_depth", copy.body)
    assert 0.5 < float(re.match(r"([\d.]+) N", told)[1]) < 10, told


@case("stereo pairs in, depth and touches out, in the installed example")
def _(programs, folder):
    copy = Installed(programs)
    told = run(copy.examples / "touch_stereo", copy.body)
    assert abs(float(re.match(r"([\d.]+) m", told)[1]) - 0.441) < 0.01, told


@case("the ten lines of docs/c_interface.md do what the page says")
def _(programs, folder):
    copy = Installed(programs)
    lines = re.search(r"```c\n(.*?)```", (base.ROOT / "docs/c_interface.md").read_text(), re.DOTALL)[1]
    (folder / "lines.c").write_text("#include <palpable/palpable.h>\n#include <stdio.h>\n\nint main(void) {\n"
                                    f"{lines}return 0;\n}}\n")
    run("cc", "-std=c11", *WARNINGS.split(), f"-I{copy.prefix}/include", folder / "lines.c", "-o", folder / "lines",
        f"-L{copy.prefix}/lib", "-lpalpable", f"-Wl,-rpath,{copy.prefix}/lib")
    assert_rubber(run(folder / "lines", cwd=copy.body.parent))


@case("the hand of docs/c_interface.md presses as the finger of the ten lines does")
def _(programs, folder):
    copy = Installed(programs)
    hand = re.search(r"```C\n(.*?)```", (base.ROOT / "docs/c_interface.md").read_text(), re.DOTALL)[1]
    # An index finger that points straight down, its tip (joint 10, radius 8 mm) 4 mm deep in the ball; the rest is above it.
    (folder / "hand.c").write_text("#include <palpable/palpable.h>\n#include <stdio.h>\n\n" + hand + """
int main(void) {
  palpable_body* body;
  palpable_session* session;
  const palpable_setup setup = {.size = sizeof setup};
  palpable_touch touch = {.size = sizeof touch};
  double joints[26 * 3], radii[26];
  const double ways[5] = {0.17, 0.10, 0.055, 0.028, 0};
  for (int i = 0; i < 26; ++i) {
    const int finger = i < 6 ? -1 : (i - 6) / 5, at = i < 6 ? 0 : (i - 6) % 5;
    radii[i] = 0.008;
    joints[3 * i] = finger < 1 ? 0 : 0.02 * finger;
    joints[3 * i + 1] = i > 1 && i < 6 ? 0.03 : 0;
    joints[3 * i + 2] = 0.104 + (finger < 0 ? 0.18 : finger == 0 ? ways[at] : 0.09 + ways[at]);
  }
  if (palpable_load_body("ball.palpable", 1, &body) != PALPABLE_OK) return puts(palpable_last_error()), 1;
  if (palpable_open((const palpable_body* const*)&body, 1, &setup, &session) != PALPABLE_OK) return 1;
  if (press_with_hand(session, joints, radii, 0.5) != PALPABLE_OK) return puts(palpable_last_error()), 1;
  if (palpable_get_touch(session, 0, &touch) != PALPABLE_OK) return puts(palpable_last_error()), 1;
  if (touch.thing != 1) return puts("another thing"), 1;
  printf("%.2f N down\\n", -touch.force[2]);
  return 0;
}
""")
    run("cc", "-std=c11", *WARNINGS.split(), f"-I{copy.prefix}/include", folder / "hand.c", "-o", folder / "hand",
        f"-L{copy.prefix}/lib", "-lpalpable", f"-Wl,-rpath,{copy.prefix}/lib")
    assert_rubber(run(folder / "hand", cwd=copy.body.parent))


@case("pkg-config builds the examples from a copy that was moved elsewhere")
def _(programs, folder):
    copy = Installed(programs)
    moved, sources = folder / "moved", folder / "sources"
    shutil.copytree(copy.prefix / "lib", moved / "lib", symlinks=True)
    shutil.copytree(copy.prefix / "include", moved / "include")
    shutil.copytree(base.ROOT / "examples/installed", sources)
    run("make", "-C", sources, "press_finger", f"CFLAGS={WARNINGS} -Wl,-rpath,{moved}/lib",
        env=os.environ | {"PKG_CONFIG_PATH": str(moved / "lib/pkgconfig")})
    told = run(sources / "press_finger", copy.body)
    assert told == run(copy.examples / "press_finger", copy.body), told
    libraries = run("ldd", sources / "press_finger")
    assert f"{moved}/lib/libpalpable.so.0" in libraries, libraries


@case("find_package takes this major version from what is asked for on, and the header is C++ as well as C")
def _(programs, folder):
    copy = Installed(programs)
    text = ("cmake_minimum_required(VERSION 3.16)\nproject(p LANGUAGES CXX)\nfind_package(palpable {} REQUIRED)\n"
            "add_executable(p p.cpp)\ntarget_link_libraries(p palpable::palpable)\n")
    (folder / "p.cpp").write_text("#include <palpable/palpable.h>\n#include <cstdio>\n"
                                  "int main() { std::puts(palpable_version()); }\n")
    for version, fits in (("0.2", True), ("0.1", True), ("0.0", True), ("0.3", False), ("1.0", False)):
        (folder / "CMakeLists.txt").write_text(text.format(version))
        shutil.rmtree(folder / "b", ignore_errors=True)
        result = subprocess.run(["cmake", "-S", folder, "-B", folder / "b", f"-DCMAKE_PREFIX_PATH={copy.prefix}",
                                 f"-DCMAKE_CXX_FLAGS={WARNINGS}"], capture_output=True, text=True)
        assert (result.returncode == 0) == fits, f"{version}: {result.stderr}"
        if fits:
            run("cmake", "--build", folder / "b")
            program = run(copy.prefix / "bin/palpable", "--version")
            assert run(folder / "b/p").strip() in program, program


if __name__ == "__main__":
    sys.exit(base.main())
