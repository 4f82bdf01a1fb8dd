#!/usr/bin/env python3
"""compare_states.py record|compare DIR [--programs BUILD]: checks whether a change of the code changes live runs.

record   bakes bodies, films and plays them, and keeps in DIR, outside of the repository, what came out: recordings of
         the demo's film, of a squeeze, of two crossed beams and of two posts (300 frames each), and the states of a
         body that capsules press through the C interface. What is there already is kept, so that it can be stopped.
compare  plays all of it again with the programs as they are now, and says for each whether it is the same to the bit.

BUILD is a build folder with bin/ and lib/ (default: build/release). Record with the code before the change, compare
with the code after it, both compiled by the same compiler on the same machine.

Examples:
  tools/compare_states.py record /tmp/states
  ninja -C build/release && tools/compare_states.py compare /tmp/states
"""
import argparse
import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FRAMES = 300
BODIES = {"bunny": ("bodies/bunny-demo.toml",), "post": ("bodies/post-small.toml",),
          "beam": ("bodies/beam.toml", "--intrusive")}
# Name: the synthetic sequence, and the scene file or the body.
FILMS = {"demo": ("demo", "bunny"), "squeeze": ("squeeze", "bunny"), "beams": ("beams", "scenes/crossed-beams.toml"),
         "posts": ("press", "scenes/two-posts.toml")}


def run(*words, **more):
    print("$", *words, flush=True)
    subprocess.run([str(word) for word in words], check=True, **more)


def bake(palpable, folder):
    for name, words in BODIES.items():
        body = folder / f"{name}.palpable"
        # bake continues an interrupted campaign, and does nothing if the body file is complete.
        run(palpable, "bake", *words, "-o", body, cwd=ROOT)


def scene_in(folder, scene):
    """The scene of the repository with the bodies of the folder."""
    text = (ROOT / scene).read_text()
    text = re.sub(r'"\.\./out/bodies/(\w+)\.palpable"', lambda m: f'"{folder / m[1]}.palpable"', text)
    text = re.sub(r'"\.\./bodies/post\.toml"', f'"{ROOT}/bodies/post-small.toml"', text)
    text = text.replace('"../bodies/', f'"{ROOT}/bodies/')
    path = folder / Path(scene).name
    path.write_text(text)
    return path


def record(build, folder):
    palpable = build / "bin/palpable"
    folder.mkdir(parents=True, exist_ok=True)
    # One folder holds the output of one build.
    made_by = f"{palpable}, {hashlib.sha256(palpable.read_bytes()).hexdigest()[:16]}"
    kept = folder / "programs.txt"
    if kept.exists() and kept.read_text().strip() != made_by:
        sys.exit(f"compare_states: {folder} was begun with {kept.read_text().strip()}, this is {made_by}; take another folder")
    kept.write_text(made_by + "\n")
    bake(palpable, folder)
    for name, (sequence, of) in FILMS.items():
        recording = folder / f"{name}.palprec"
        if recording.exists():
            continue
        film = folder / f"{name}-film"
        shutil.rmtree(film, ignore_errors=True)
        if of.endswith(".toml"):
            scene = scene_in(folder, of)
            what, played = ["--scene", scene], [scene]
        else:
            what, played = ["--body", folder / f"{of}.palpable"], [folder / f"{of}.palpable"]
        run(palpable, "synth", sequence, *what, "--frames", FRAMES, "-o", film)
        run(palpable, "live", *played, "--source", film / "frames", "--record", folder / "unfinished.palprec", "--overwrite")
        (folder / "unfinished.palprec").rename(recording)
        shutil.rmtree(film)
    if not (folder / "capsules.txt").exists():
        (folder / "capsules.txt").write_text(capsule_states(build, folder))


def capsule_states(build, folder):
    header, = (ROOT / "src/palpable").rglob("palpable.h")
    with tempfile.TemporaryDirectory() as scratch:
        include = Path(scratch) / "include/palpable"
        include.mkdir(parents=True)
        shutil.copy(header, include)
        program = Path(scratch) / "capsule_states"
        run("cc", "-std=c11", "-O1", "-I", include.parent, ROOT / "tools/capsule_states.c", "-o", program,
            "-L", build / "lib", "-lpalpable", "-lm", f"-Wl,-rpath,{build / 'lib'}")
        result = subprocess.run([program, folder / "bunny.palpable"], stdout=subprocess.PIPE, text=True)
        if result.returncode != 0 or len(result.stdout.splitlines()) != FRAMES:
            sys.exit(f"compare_states: capsules: exit code {result.returncode}, {len(result.stdout.splitlines())} states")
        return result.stdout


def compare(build, folder):
    for name in (*(f"{name}.palprec" for name in FILMS), "capsules.txt", "programs.txt"):
        if not (folder / name).exists():
            sys.exit(f"compare_states: {folder / name} is missing: 'compare_states.py record {folder}' goes on")
    print(f"recorded with {(folder / 'programs.txt').read_text().strip()}")
    wrong = []
    for name in FILMS:
        result = subprocess.run([build / "bin/palpable", "replay", folder / f"{name}.palprec"], capture_output=True, text=True)
        said = re.search(r"^.* states of the live run: .*$", result.stdout, re.MULTILINE)
        same = result.returncode == 0 and said is not None and said[0] == f"{FRAMES} of {FRAMES} states of the live run: equal"
        print(f"{name}: {said[0] if said else result.stderr.strip()}", flush=True)
        wrong += [] if same else [name]
    before, now = (folder / "capsules.txt").read_text(), capsule_states(build, folder)
    differ = [a.split()[0] for a, b in zip(before.splitlines(), now.splitlines()) if a != b]
    if before != now:
        wrong.append("capsules")
    print(f"capsules: {len(before.splitlines())} states: " + (f"differ from frame {differ[0] if differ else '?'} on"
                                                             if before != now else "equal"))
    if wrong:
        sys.exit(f"compare_states: not the same: {', '.join(wrong)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["record", "compare"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--programs", type=Path, default=ROOT / "build/release", metavar="BUILD")
    given = parser.parse_args()
    {"record": record, "compare": compare}[given.what](given.programs.resolve(), given.folder.resolve())


if __name__ == "__main__":
    main()
