#!/usr/bin/env python3
"""The Debian packages of tools/package.sh on a new Debian 12 without this repository: their content and metadata,
installation into a clean root, running them there, use from C, and removal; the image of the Dockerfile; and the
programs on an old processor.

A clean root is made by mmdebstrap and unpacked for each case into its folder. Commands run in it in a mount namespace
of their own, so that nothing remains mounted, however a case ends. Downloads of apt are kept in the build folder
(cli/packages/archives)."""
import fcntl
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from installed import assert_rubber, round_ball

base.CASES.clear()
case = base.case

NAMES = ("palpable", "palpable-bake", "libpalpable0", "libpalpable-dev", "python3-palpable")
POST = "/usr/share/palpable/bodies/post.palpable"
LIBRARIES = "/usr/lib/x86_64-linux-gnu"
VERSION = re.search(r"\((\S+)\)", (base.ROOT / "packaging/changelog").read_text())[1]


class CannotRun(Exception):
    """The reason why a case is skipped."""


def skips_without_means(function):
    """Skips a case, with the reason, if the machine lacks something that it needs."""
    def run(programs, folder):
        try:
            function(programs, folder)
        except CannotRun as reason:
            print(f"SKIPPED: {reason}")
    return run


def run(*words, timeout=1200, **options):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=timeout,
                            stdin=subprocess.DEVNULL, **options)
    assert result.returncode == 0, f"{words}: exit code {result.returncode}\n{result.stdout[-4000:]}\n{result.stderr[-4000:]}"
    return result.stdout


def built_packages(programs):
    """{name: file} of the packages of this source tree; tools/package.sh builds those that are out of date."""
    if shutil.which("dpkg-shlibdeps") is None:
        raise CannotRun("dpkg-shlibdeps is not installed (tools/packages-package.txt)")
    with open(programs.work / "packages.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        begin = time.monotonic()
        run("tools/package.sh", cwd=base.ROOT, env=os.environ | {"PALPABLE_SETUP": "skip"})
        print(f"tools/package.sh took {time.monotonic() - begin:.0f} s")
    files = {file.name.split("_")[0]: file for file in (base.ROOT / "build/packages").glob("*.deb")}
    assert sorted(files) == sorted(NAMES), files
    return files


# ---- a clean root ------------------------------------------------------------------------------------

IN_NAMESPACE = """set -e
root=$1 archives=$2 user=$3
shift 3
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --bind "$archives" "$root/var/cache/apt/archives"
exec chroot --userspec="$user" "$root" "$@"
"""


def sources_of_apt():
    """The files with the package sources of the machine's apt."""
    folder = Path("/etc/apt/sources.list.d")
    files = [Path("/etc/apt/sources.list"), *sorted(folder.glob("*.list")), *sorted(folder.glob("*.sources"))]
    return [file for file in files if file.is_file() and "debian" in file.read_text()]


def options_of_apt():
    """Options for access to the sources: proxies and checks."""
    said = subprocess.run(["apt-config", "dump"], capture_output=True, text=True).stdout
    wanted = re.compile(r'^Acquire::(https?::|Check-|Retries|AllowInsecure)\S* ".+";$')
    return [line for line in said.splitlines() if wanted.match(line)]


class CleanRoot:
    """A Debian 12 with the minimum that apt needs, and functions to run commands in it as root."""
    def __init__(self, programs, folder):
        if os.geteuid() != 0:
            raise CannotRun("a clean root needs root's rights")
        if shutil.which("mmdebstrap") is None:
            raise CannotRun("mmdebstrap is not installed (tools/packages-check.txt)")
        kept = programs.work / "packages"
        self.archives = kept / "archives"
        (self.archives / "partial").mkdir(parents=True, exist_ok=True)
        self.path = folder / "root"
        self.path.mkdir()
        tar = self.base(kept)
        run("tar", "-xf", tar, "-C", self.path)
        shutil.copy("/etc/resolv.conf", self.path / "etc/resolv.conf")
        self.packages_before = self.packages()

    def base(self, kept):
        """The tar file of a root without installed packages, made once for the sources of this machine's apt."""
        sources, options = sources_of_apt(), options_of_apt()
        made_of = "\n".join([*(file.read_text() for file in sources), *options])
        tar, stamp = kept / "base.tar", kept / "base.txt"
        with open(kept / "lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (tar.exists() and stamp.exists() and stamp.read_text() == made_of):
                stamp.unlink(missing_ok=True)
                words = ["unshare", "--mount", "mmdebstrap", "--mode=root", "--variant=minbase", "--quiet",
                         *(f"--aptopt={option}" for option in options), "bookworm", tar, *sources]
                made = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=1200)
                if made.returncode != 0:
                    said = [line for line in made.stderr.splitlines() if line.strip()]
                    raise CannotRun("mmdebstrap cannot run here: " + " / ".join(said[-3:]))
                stamp.write_text(made_of)
        return tar

    def words(self, *command, user="0:0", cwd="/"):
        return ["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", IN_NAMESPACE, "sh",
                str(self.path), str(self.archives), user, "/bin/sh", "-c", f"cd {shlex.quote(cwd)} && exec \"$@\"", "sh",
                *map(str, command)]

    @property
    def environment(self):
        kept = {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}
        return kept | {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/tmp",
                       "LC_ALL": "C.UTF-8", "DEBIAN_FRONTEND": "noninteractive"}

    def run(self, *command, user="0:0", cwd="/"):
        return run(*self.words(*command, user=user, cwd=cwd), env=self.environment)

    def install(self, *packages):
        self.run("apt-get", "install", "-y", "-q", "--no-install-recommends", *packages)

    def packages(self):
        return set(run("dpkg-query", f"--admindir={self.path}/var/lib/dpkg", "-W", "-f", "${Package}\n").split())

    def __truediv__(self, path):
        return self.path / str(path).lstrip("/")


def first_file(folder, pattern, found):
    """Watches the folder until a file that matches the pattern exists, and stores the time."""
    while "end" not in found:
        if next(folder.glob(pattern), None) is not None:
            found["at"] = time.monotonic()
            return
        time.sleep(0.05)


def check_run(out, pictures):
    """Checks that `palpable live` wrote the film of a hand that presses the body."""
    told = json.loads((out / "live.json").read_text())
    assert told["frames"] == 300, told
    for name in pictures:
        data = (out / name).read_bytes()
        assert data.startswith(b"\x89PNG") and len(data) > 20000, f"{name}: {len(data)} bytes"
    assert (out / "touch.mp4").stat().st_size > 100000
    lines = [json.loads(line) for line in (out / "touches.jsonl").read_text().splitlines()]
    forces = [sum(c * c for c in touch["force"])**0.5 for line in lines for touch in line["touches"]]
    # The demo presses three times and squeezes once, 10 mm deep: the force of a soft rubber is some newtons.
    assert len(lines) > 40 and 0.5 < max(forces) < 30, (len(lines), max(forces, default=None))
    return len(lines), max(forces)


# ---- cases -------------------------------------------------------------------------------------------


def fields(package):
    text = run("dpkg-deb", "--field", package)
    return {key: value for key, value in re.findall(r"^(\S+): (.*(?:\n .*)*)", text, re.MULTILINE)}


def listing(package):
    """(mode, owner, path) of the files that a package installs; a link's path without its target."""
    for line in run("dpkg-deb", "--contents", package).splitlines():
        mode, owner, _, _, _, path = line.split(None, 5)
        yield mode, owner, path.split(" -> ")[0].lstrip(".")


@case("the Debian packages say what they hold, need and are licensed under", long=True)
@skips_without_means
def _(programs, folder):
    packages = built_packages(programs)
    held, said = {}, {}
    for name, package in packages.items():
        said[name] = fields(package)
        held[name] = [path for _, _, path in listing(package) if not path.endswith("/")]
        assert said[name]["Version"] == VERSION and VERSION.startswith("0.2.0~dev1"), said[name]
        assert said[name]["Source"] == "palpable" and said[name]["Priority"] == "optional", said[name]
        assert "\n " in said[name]["Description"] and "<" in said[name]["Maintainer"], said[name]
        for mode, owner, path in listing(package):
            assert owner == "root/root" and (mode[8] != "w" or mode[0] == "l"), f"{mode} {owner} {path}"
            assert path.startswith("/usr/") or path in ("/", "/usr/"), path
        for file in ("copyright", "changelog.Debian.gz"):
            assert f"/usr/share/doc/{name}/{file}" in held[name], held[name]
        size = package.stat().st_size / 1e6
        print(f"{name}: {size:.2f} MB, installed {int(said[name]['Installed-Size']) / 1000:.1f} MB; {said[name]['Depends']}")
    assert {"/usr/bin/palpable", POST, "/usr/share/bash-completion/completions/palpable",
            "/usr/share/zsh/vendor-completions/_palpable", "/usr/share/palpable/npm/index.js",
            "/usr/share/palpable/npm/dist/palpable.wasm"} <= set(held["palpable"])
    # What package.json names is in the package for npm, and the page's bundle is whole.
    npm = json.loads((base.ROOT / "web/package.json").read_text())
    for file in (*npm["files"], "package.json"):
        assert f"/usr/share/palpable/npm/{file}" in held["palpable"], file
    for file in ("index.html", "page.js", "page-classic.js", "palpable.wasm"):
        assert f"/usr/share/palpable/web/{file}" in held["palpable"], file
    # Each command has its page in the package of the program that has it.
    for name, of in (("palpable", ("palpable", "palpable-live", "palpable-synth", "palpable-doctor")),
                     ("palpable-bake", ("palpable-bake", "palpable-mesh", "palpable-truth", "palpable-export"))):
        manual = {path.removeprefix("/usr/share/man/man1/") for path in held[name] if "/man1/" in path}
        assert {f"{page}.1.gz" for page in of} <= manual and len(manual) >= 12, manual
    assert "/usr/bin/palpable-bake" in held["palpable-bake"] and "/usr/bin/palpable-bake" not in held["palpable"]
    for file in (f"{LIBRARIES}/libpalpable.so", f"{LIBRARIES}/cmake/palpable/palpableConfig.cmake",
                 f"{LIBRARIES}/pkgconfig/palpable.pc", "/usr/include/palpable/palpable.h"):
        assert file in held["libpalpable-dev"], held["libpalpable-dev"]
    assert f"{LIBRARIES}/libpalpable.so.0" in held["libpalpable0"] and f"{LIBRARIES}/libpalpable.so" not in held["libpalpable0"]
    modules = "/usr/lib/python3/dist-packages/palpable"
    assert {f"{modules}/__init__.py", f"{modules}/py.typed"} <= set(held["python3-palpable"])
    assert "_all.deb" in packages["python3-palpable"].name and not any(".pyc" in path for path in held["python3-palpable"])
    for name, needs in (("palpable-bake", f"palpable (= {VERSION})"), ("python3-palpable", "python3-numpy"),
                        ("python3-palpable", "libpalpable0 (>= 0.2.0~dev1)"), ("palpable-bake", "libopenblas0-pthread"),
                        ("palpable-bake", "libtet1.5"), ("libpalpable-dev", f"libpalpable0 (= {VERSION})"),
                        ("palpable", "libopencv-core406"), ("palpable", "libgl1-mesa-dri"), ("libpalpable0", "libhwy1")):
        assert needs in said[name]["Depends"], f"{name}: {said[name]['Depends']}"
    # The live half does not depend on the GPL libraries of the offline half.
    for name in ("palpable", "libpalpable0", "libpalpable-dev", "python3-palpable"):
        for library in ("libtet", "libcholmod", "libgmp", "libmpfr", "openmpi", "openblas", "palpable-bake"):
            assert library not in said[name].get("Depends", ""), f"{name}: {library}"
    terms = {}
    for name, package in packages.items():
        run("dpkg-deb", "--extract", package, folder / name)
        terms[name] = (folder / name / f"usr/share/doc/{name}/copyright").read_text()
        for file in held[name]:
            path = folder / name / file.lstrip("/")
            if not path.is_symlink() and path.read_bytes()[:4] == b"\x7fELF":
                sections = run("readelf", "-SW", path)
                assert ".symtab" not in sections and ".debug" not in sections, f"{file} was not stripped"
                assert "RUNPATH" not in run("readelf", "-d", path), file
    for script in ("page.js", "page-classic.js"):  # the notice that its licence asks for
        text = (folder / f"palpable/usr/share/palpable/web/{script}").read_text()
        assert "Three.js Authors" in text and "SPDX-License-Identifier: MIT" in text, script
    assert "three.js" in terms["palpable"]
    for licence in ("Apache", "MPL-2.0"):
        assert all(licence in text for text in terms.values()), licence
    for licence in ("GNU AFFERO GENERAL PUBLIC LICENSE", "TetGen", "CGAL", "CHOLMOD", "GPL-3", "LGPL-3"):
        assert licence in terms["palpable-bake"], licence
        assert licence not in terms["palpable"], licence
    control = folder / "control"
    run("dpkg-deb", "--control", packages["libpalpable0"], control)
    assert (control / "shlibs").read_text().startswith("libpalpable 0 libpalpable0 (>= 0.2.0~dev1)")
    assert (control / "triggers").read_text() == "activate-noawait ldconfig\n"
    # No maintainer script runs as root.
    scripts = [file.name for file in control.iterdir() if file.name in ("preinst", "postinst", "prerm", "postrm")]
    assert not scripts, scripts
    # The shipped body is small, is not a scan, and does not reveal where it was baked.
    body = folder / "palpable" / POST.lstrip("/")
    told = programs.succeeds("inspect", body).stdout
    told = told.replace(str(body), "")  # the path to which this test unpacked it
    assert body.stat().st_size < 8e6 and "bunny" not in told and str(base.ROOT) not in told, told
    assert str(base.ROOT).encode() not in body.read_bytes()


# Tags of lintian that are accepted: tag -> reason.
LEFT = {
    "initial-upload-closes-no-bugs": "the packages are no upload to Debian, where a bug would have asked for them",
}


@case("lintian finds no error in the Debian packages, and no warning that is not explained", long=True)
@skips_without_means
def _(programs, folder):
    packages = built_packages(programs)
    if shutil.which("lintian") is None:
        raise CannotRun("lintian is not installed (tools/packages-check.txt)")
    words = ["lintian", "--allow-root", "--tag-display-limit", "0", *map(str, sorted(packages.values()))]
    result = subprocess.run(words, capture_output=True, text=True, timeout=600)
    found = [line for line in result.stdout.splitlines() if re.match(r"[EWI]: ", line)]
    for line in found:
        print(line)
    assert result.returncode in (0, 1, 2) and "N: " not in result.stderr, result.stderr
    left = [line for line in found if line[0] in "EW" and line.split(": ")[2].split()[0] not in LEFT]
    assert not left, "\n".join(left)
    unused = [tag for tag in LEFT if not any(f" {tag}" in line for line in found)]
    assert not unused, f"lintian does not complain of {unused} any more: take them out of LEFT"


@case("the packages work in a clean Debian 12, serve programs in C there, and leave nothing behind", long=True)
@skips_without_means
def _(programs, folder):
    packages = built_packages(programs)
    root = CleanRoot(programs, folder)
    (root / "packages").mkdir()
    for package in packages.values():
        shutil.copy(package, root / "packages")
    root.run("apt-get", "update", "-q")
    begin = time.monotonic()
    root.install(*(f"/packages/{package.name}" for package in packages.values()))
    installed = time.monotonic() - begin
    # Neither compiler nor headers nor other parts of the build environment are present.
    for tool in ("cc", "gcc", "g++", "cmake", "make", "pkg-config"):
        assert not (root / f"usr/bin/{tool}").exists(), tool
    headers = [name for name in root.packages() if name.endswith("-dev") and name != "libpalpable-dev"]
    assert not headers and not (root / "usr/include/stdio.h").exists(), headers
    assert not (root / str(base.ROOT)).exists()
    owned = {name: [path for path in root.run("dpkg", "-L", name).split("\n") if path and (root / path).is_file()]
             for name in NAMES}
    for program in ("palpable", "palpable-bake"):
        assert "0.2.0~dev1" in root.run(program, "--version")
    root.run("dpkg", "--audit")

    # As a user without privileges, in a folder of the user's own.
    user, out = "65534:65534", root / "tmp/out"
    found = {}
    watch = threading.Thread(target=first_file, args=(out, "pictures/*.png", found))
    watch.start()
    try:
        print(root.run("palpable", "live", "post", "--source", "synthetic", "--out", "/tmp/out", "--write", "+stills",
                       "--frame-pictures", "0", "120", user=user, cwd="/tmp"))
    finally:
        found["end"] = True
        watch.join()
    frames, force = check_run(out, ("touch.png", "hand_nearer.png", "body_nearer.png", "pictures/000120.png"))
    print(f"apt install: {installed:.0f} s; to the first picture: {found['at'] - begin:.0f} s; "
          f"{frames} frames touched, {force:.1f} N at most")
    # A page by the bundle that is installed, of the body that ships.
    root.run("palpable", "export", "post", "--to", "page", "-o", "/tmp/page", user=user, cwd="/tmp")
    page = (root / "tmp/page/index.html").read_text()
    assert page.startswith("<!doctype html>") and "palpable:page" not in page, page[:300]
    facts = json.loads(re.search(r'id="page">(.*?)</script>', page)[1])
    assert facts["inline"] is True and [body["name"] for body in facts["bodies"]] == ["post"], str(facts)[:300]
    assert "credit" not in facts["bodies"][0] and facts["bodies"][0]["skin"]["vertices"], str(facts)[:300]
    # The default body is the shipped one.
    root.run("palpable", "synth", "press", "--frames", "2", "-o", "/tmp/clip", user=user, cwd="/tmp")
    assert (root / "tmp/clip/frames").is_dir()
    # The first touch from Python is that of docs/python.md.
    first = re.search(r"```python\n(.*?)```", (base.ROOT / "docs/python.md").read_text(), re.DOTALL)[1]
    (root / "tmp/first.py").write_text(first)
    assert re.search(r"N at .*\n\d+ Pa", root.run("python3", "first.py", user=user, cwd="/tmp"))
    # The offline half meshes, solves and reduces.
    base.write_ball(root / "tmp/ball", base.TOUCHED_BALL)
    (root / "tmp/ball/ball.off").write_text(round_ball())
    root.run("palpable", "bake", "ball.toml", "-o", "ball.palpable", cwd="/tmp/ball")

    # The library, found by CMake and by pkg-config.
    root.install("gcc", "libc6-dev", "cmake", "make", "pkg-config")
    shutil.copytree(base.ROOT / "examples/installed", root / "tmp/examples")
    root.run("cmake", "-S", ".", "-B", "by-cmake", cwd="/tmp/examples")
    root.run("cmake", "--build", "by-cmake", cwd="/tmp/examples")
    assert_rubber(root.run("by-cmake/press_finger", "/tmp/ball/ball.palpable", cwd="/tmp/examples"))
    root.run("make", "touch_depth", cwd="/tmp/examples")
    told = root.run("./touch_depth", "/tmp/ball/ball.palpable", cwd="/tmp/examples")
    assert 0.5 < float(re.match(r"([\d.]+) N", told)[1]) < 10, told
    libraries = root.run("ldd", "./touch_depth", cwd="/tmp/examples")
    assert re.search(r"libpalpable\.so\.0 => (/usr)?/lib/x86_64-linux-gnu/", libraries), libraries

    root.run("apt-get", "purge", "-y", "-q", *NAMES)
    assert not root.packages() & set(NAMES)
    left = [path for paths in owned.values() for path in paths if (root / path).exists()]
    for top in ("usr", "etc", "var", "lib", "opt", "root", "home"):
        for path, _, files in os.walk(root / top):
            left += [f"{path}/{file}" for file in files if "palpable" in file]
            left += [path] if Path(path).name in NAMES else []
    left = [path for path in left if "/var/cache/apt/" not in path]
    assert not left, left
    assert "palpable" not in root.run("ldconfig", "-p")
    root.run("apt-get", "autoremove", "--purge", "-y", "-q")
    print(f"{len(root.packages() - root.packages_before)} packages are left of those for building the examples")


# ---- the Dockerfile ----------------------------------------------------------------------------------


def instructions(text):
    """(word, rest) of each instruction of a Dockerfile; a backslash at the end continues the line."""
    text = re.sub(r"^\s*#.*\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"\\\n\s*", " ", text)
    return [tuple(line.strip().split(None, 1)) for line in text.splitlines() if line.strip()]


def in_context(source):
    """The files that a COPY can find: .dockerignore excludes everything except what its last lines name."""
    lines = [line.strip() for line in (base.ROOT / ".dockerignore").read_text().splitlines()]
    lines = [line for line in lines if line and not line.startswith("#")]
    assert lines[0] == "*", lines
    allowed = {file for line in lines[1:] for file in base.ROOT.glob(line.removeprefix("!")) if line.startswith("!")}
    return sorted(file for file in base.ROOT.glob(source) if file in allowed)


@case("the Dockerfile's lines make a clean Debian 12 in which its command films and presses the post", long=True)
@skips_without_means
def _(programs, folder):
    built_packages(programs)
    root = CleanRoot(programs, folder)
    cwd, command = "/", None
    for word, rest in instructions((base.ROOT / "Dockerfile").read_text()):
        if word == "FROM":
            assert re.fullmatch(r"debian:(12|bookworm)-slim", rest), rest
            assert 'VERSION_ID="12"' in (root / "etc/os-release").read_text()
        elif word == "COPY":
            *sources, target = rest.split()
            (root / target).mkdir(parents=True)
            files = [file for source in sources for file in in_context(source)]
            assert len(files) == len(NAMES), files
            print(f"the context has {sum(file.stat().st_size for file in files) / 1e6:.1f} MB")
            for file in files:
                shutil.copy(file, root / target)
        elif word == "RUN":
            root.run("/bin/sh", "-c", rest, cwd=cwd)
        elif word == "WORKDIR":
            cwd = rest
            (root / cwd).mkdir(parents=True, exist_ok=True)
        elif word == "CMD":
            command = json.loads(rest)
        else:
            raise AssertionError(f"the test does not know {word}")
    assert not (root / "packages").exists() and not any((root / "var/lib/apt/lists").iterdir())
    print(root.run(*command, cwd=cwd))
    check_run(root / "out", ("touch.png",))
    # A second run into the same folder, like `docker run` with the same volume.
    assert "--overwrite" in command


# ---- an old processor --------------------------------------------------------------------------------

# Executes an instruction that not every x86-64 processor has.
USES_AVX2 = """#include <immintrin.h>
#include <stdio.h>
int main(int argc, char** argv) {
  (void)argv;
  __m256i x = _mm256_set1_epi32(argc);
  x = _mm256_mullo_epi32(x, x);
  printf("%d\\n", _mm256_extract_epi32(x, 7));
  return 0;
}
"""


@case("the programs run on a processor with the instructions of every x86-64 alone, with the same result", long=True)
@skips_without_means
def _(programs, folder):
    emulator = shutil.which("qemu-x86_64")
    if emulator is None or os.uname().machine != "x86_64":
        raise CannotRun("qemu-x86_64 is not installed (tools/packages-check.txt)")
    # With an AMD vendor OpenBLAS would select its Opteron kernels, which use 3DNow!, and the emulator lacks it.
    old = [emulator, "-cpu", "qemu64,vendor=GenuineIntel"]
    # Check that the emulated processor rejects what an old one rejects.
    (folder / "avx2.c").write_text(USES_AVX2)
    run("cc", "-O0", "-mavx2", folder / "avx2.c", "-o", folder / "avx2")
    refused = subprocess.run([*old, folder / "avx2"], capture_output=True)
    assert refused.returncode != 0, "the emulated processor has AVX2: this test shows nothing"

    bake = programs.palpable + "-bake"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("OPENBLAS_")}
    description = base.write_ball(folder, base.TOUCHED_BALL)
    run(*old, bake, "bake", description, "-o", folder / "old.palpable", env=environment)
    programs.succeeds("bake", description, "-o", folder / "new.palpable")
    # The same body gives the same bytes on both. The finger arrives at frame 102; the emulator is slow.
    body = folder / "new.palpable"
    film = programs.run("synth", "press", "--body", body, "--frames", "160", "-o", folder / "clip")
    if film.returncode != 0 and "EGL" in film.stderr:
        raise CannotRun("no OpenGL here: " + film.stderr.strip())
    assert film.returncode == 0, film.stderr
    told = {}
    for name, words in (("new", [programs.palpable]), ("old", [*old, programs.palpable])):
        begin = time.monotonic()
        run(*words, "live", body, "--source", folder / "clip/frames", "--frames", "110", "--out", folder / name,
            "--write=-depth,-masks", env=environment)
        print(f"{name}: {time.monotonic() - begin:.0f} s")
        told[name] = (folder / name / "touches.jsonl").read_text()
    assert told["new"].count("\n") > 3, "nothing was touched: the comparison proves little"
    assert told["old"] == told["new"]
    # Bodies baked on both are equal up to the order of additions.
    facts = [json.loads(programs.succeeds("inspect", folder / f"{name}.palpable", "--json").stdout) for name in ("old", "new")]
    assert facts[0]["sites"] == facts[1]["sites"], facts


# ---- another architecture ----------------------------------------------------------------------------

# Tools of this machine's architecture, because they run here.
TOOLS_FOR_ARM64 = ("crossbuild-essential-arm64", "cmake", "ninja-build", "pkg-config", "python3", "qemu-user", "catch2",
                   "libeigen3-dev", "fonts-dejavu-core")
MODULES_FOR_ARM64 = ("base", "geometry")


@case("the modules base and geometry pass their tests on arm64, cross-compiled and emulated", long=True)
@skips_without_means
def _(programs, folder):
    root = CleanRoot(programs, folder)
    root.run("dpkg", "--add-architecture", "arm64")
    root.run("apt-get", "update", "-q")
    listed = [line.split("#")[0].strip() for line in (base.ROOT / "tools/packages.txt").read_text().splitlines()]
    begin = time.monotonic()
    root.install(*TOOLS_FOR_ARM64, *(f"{name}:arm64" for name in listed
                                     if name.endswith("-dev") and name not in TOOLS_FOR_ARM64))
    installed = time.monotonic()
    shutil.copytree(base.ROOT, root / "src", ignore=shutil.ignore_patterns("build", "out", ".git", "__pycache__"))
    shutil.copytree(base.ROOT / "build/web", root / "src/build/web")
    root.run("cmake", "-S", "/src", "-B", "/build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
             "-DCMAKE_TOOLCHAIN_FILE=/src/cmake/toolchain-arm64.cmake")
    programs_of_tests = [f"{module}_tests" for module in MODULES_FOR_ARM64]
    root.run("cmake", "--build", "/build", "--target", *programs_of_tests)
    for program in programs_of_tests:
        made = run("file", "-b", next((root / "build").rglob(program)))
        assert "ARM aarch64" in made, made
    # posix_spawn reports a failure through memory shared with the child; qemu-user turns it into a fork, which does not share.
    said = root.run("ctest", "--test-dir", "/build", "-L", f"^unit\\.({'|'.join(MODULES_FOR_ARM64)})$",
                    "-E", "a program that is not there is a problem that names it")
    print(f"libraries: {installed - begin:.0f} s, build and tests: {time.monotonic() - installed:.0f} s")
    passed = re.search(r"100% tests passed, 0 tests failed out of (\d+)", said)
    assert passed and int(passed[1]) > 20, said
    print(passed[0])


if __name__ == "__main__":
    sys.exit(base.main())
