#!/usr/bin/env python3
"""Films, plays and scores the sequences of the synthetic desk, one after another: docs/results/chain.json.

    tools/run_benchmark.py [--programs DIR] [--body FILE] [--describes TOML] [--frames N] [--seed N | --fresh N]
                           [--only NAME ...] [--data DIR] [--work DIR] [--films DIR] [--keep] [-o FILE]

Each sequence is filmed (palpable synth), played (palpable live, as a user would), given the full answer to the
true hand (palpable truth, by the description that the body was baked from, which it checks) and scored
(palpable score --body); its folders are removed before the next unless --keep. With --films a sequence that
was written there before (DIR/NAME, of the same seed and body; anything else is refused) is played as it is
and stays. What filming took stands beside the film, in NAME/film.json: {"user_s", "wall_s", "commit", "date",
"machine"}, each may be missing; it is written where this tool films, and read wherever a film is played.

Each figure keeps the commit, day and machine of its own run. The file is written after each, and sequences
that are not run again keep their figures, so it can be stopped and gone on with; a "note" written into it by
hand is kept too. --only without a name runs nothing and writes text and pooled errors anew. Recorded real sets below
--data (default ../shared/data) are played by the same commands; those with a true camera path are scored for
it. Then: tools/write_results.py.

Seeds from 1000 on are held out: they are not used for tuning. --fresh N draws N of them for each sequence, prints
each, and keeps all figures in chain-fresh.json, one entry for each seed, and pooled over seeds. Called again, it runs
only what is missing: seeds that were run stay, whatever they gave.
"""
import argparse
import collections
import datetime
import json
import os
import platform
import random
import re
import resource
import shutil
import subprocess
import sys
import time
import tomllib
from pathlib import Path

from chain_tables import pools, sequence_of

ROOT = Path(__file__).resolve().parent.parent
HELD_OUT = range(1000, 1_000_000)  # seeds

# Places are positions where a person might put the body; they were not measured. {data} and {work} are folders; "intrinsics" is
# written to {work}/intrinsics.txt; "poses": the data set has the true camera path.
REAL = {
    "hands_squirrel": {"folder": "hands_squirrel", "place": "-0.125 0.063 0.667 0 29 0", "words": []},
    "hands_shoe": {"folder": "hands_shoe", "place": "0 0.05 0.3 0 40 0", "intrinsics": "920 920 640 360",
                   "words": ["--calibration", "{work}/intrinsics.txt"],
                   "remark": "its intrinsics are not published; a guess"},
    "7-Scenes, kitchen": {"folder": "rgbd_pose_7scenes", "place": "0 0 0.6 0 20 0", "poses": True},
    "KITTI, 16 pairs": {"folder": "stereo_video_kitti1", "place": "0 0.9 6 0 0 0", "words": ["--scale", "5"],
                        "poses": True},
    "ZED Mini, raw": {"folder": "zed/raw", "place": "0 0.1 1.2 0 0 0",
                      "words": ["--calibration", "{data}/zed/SN10027514.conf"]},
}

TEXT = """\
Films of `palpable synth` with the demo's body, played by `palpable live` and scored by `palpable score`.
"""


# Keys of `palpable score --json` as version 0.1 wrote them, and their present names. Entries of runs that were
# scored by it stay in the file.
RENAMED_SCORES = {
    "depth_median": "depth_error_median", "moving_false": "moving_false_positives", "trajectory_share": "trajectory_coverage",
    "touch_site": "touch_site_accuracy", "touch_false_5mm": "touch_false_discovery_5mm", "frames_unseen": "frames_touch_unseen",
    "largest_pop_mm": "largest_jump_mm", "largest_pop_frame": "largest_jump_frame", "pops_4mm": "jumps_above_4mm",
    "deformed_frames": "reference_frames", "deformed_frames_shallow": "reference_frames_shallow",
    "deformed_frames_unseen": "reference_frames_unseen", "deformed_by_frame": "errors_by_frame",
    "displacement_error_mm": "max_vertex_error_mm", "displacement_error_mm_shallow": "max_vertex_error_mm_shallow",
    "displacement_error_mm_unseen": "max_vertex_error_mm_unseen", "overpress_mm": "excess_indentation_mm"}


def with_present_names(scores):
    """A score's figures with the present names of their keys, whichever version wrote them."""
    if isinstance(scores, list):
        return [with_present_names(one) for one in scores]
    if not isinstance(scores, dict):
        return scores
    return {RENAMED_SCORES.get(key, key): with_present_names(value) for key, value in scores.items()}


def run(words, **options):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, **options)


def complaint(process):
    lines = [line for line in process.stderr.splitlines() if line.startswith("palpable: ")]
    return lines[-1].removeprefix("palpable: ") if lines else f"exit code {process.returncode}"


def commit():
    words = run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"]).stdout.strip()
    changed = run(["git", "-C", ROOT, "status", "--porcelain", "-uno", "--", "src", "apps", "bodies", "cmake",
                   "tools", "CMakeLists.txt", "CMakePresets.json"]).stdout.strip()
    return words + (" with changes" if changed else "")


def machine():
    with open("/proc/cpuinfo") as info:
        models = [line.split(":")[1].strip() for line in info if line.startswith("model name")]
    return f"{len(os.sched_getaffinity(0))} cores of {models[0] if models else platform.machine()}"


def origin():
    return {"commit": commit(), "date": datetime.date.today().isoformat(), "machine": machine()}


def full_lengths(programs):
    """{sequence: frames}, as the program lists them."""
    if not (programs / "palpable").is_file():
        sys.exit(f"run_benchmark: no {programs / 'palpable'}; ./check or ./demo builds it")
    text = run([programs / "palpable", "synth", "--help"]).stdout
    return {name: int(frames) for name, frames in re.findall(r"^  ([a-z][a-z-]*) +(\d+)  ", text, re.MULTILINE)}


def written_film(options, name):
    """The folder of an existing film, or None."""
    film = options.films / name if options.films else None
    return film if film and (film / "truth").is_dir() else None


def film_frames(film):
    return tomllib.loads((film / "truth/script.toml").read_text())["frames"]


def refuse_other_films(options):
    """Stops before anything is run if an existing film is not the requested one."""
    for name in options.only:
        film = written_film(options, name)
        if film is None:
            continue
        if options.fresh:
            sys.exit(f"run_benchmark: --fresh films its own seeds, and {film} is of another; leave --films out")
        camera = tomllib.loads((film / "truth/camera.toml").read_text())
        wanted = {"sequence": name, "seed": options.seed, "body": options.body.name}
        if options.frames:
            camera["frames"], wanted["frames"] = film_frames(film), options.frames
        for key, value in wanted.items():
            if camera.get(key) != value:
                sys.exit(f"run_benchmark: {film}: its {key} is {camera.get(key)}, not {value}")


def write_film(options, name, seed, folder):
    """Renders the film into the folder and writes film.json. Returns the process."""
    # Without friction, as all films before bodies stated some: a camera's error is compared from version to version.
    words = [options.programs / "palpable", "synth", name, "--body", options.body, "--seed", seed,
             "--friction", 0, "-o", folder]
    if options.frames:
        words += ["--frames", options.frames]
    begin, used = time.time(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    written = run(words)
    took = {"user_s": round(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - used, 1),
            "wall_s": round(time.time() - begin, 1), **origin()}
    if written.returncode == 0:
        (folder / "film.json").write_text(json.dumps(took) + "\n")
    return written


def touches_truly(film):
    lines = (film / "truth/contact.jsonl").read_text().splitlines()
    return any(json.loads(line)["touching"] for line in lines)


def solve_truth(options, film):
    """Adds truth/deformed to a film with touches. Returns an error message, or None."""
    if not touches_truly(film):
        return None
    solved = run([options.programs / "palpable", "truth", film, "--description", options.describes, "--body", options.body])
    return complaint(solved) if solved.returncode != 0 else None


def timings(result):
    live = json.loads((result / "live.json").read_text())
    unreadable = live["frames_unreadable"] if "frames_unreadable" in live else live["unreadable"]  # of version 0.1
    return {"frames": live["frames"], "frame_ms": 1e3 * live["wall_s"] / max(1, live["frames"]),
            "first_touch_frame": live["first_touch_frame"], "unreadable": unreadable}


def play(options, name, seed, folder):
    """The entry of one sequence: its scores, or the error message of the command that failed."""
    program = options.programs / "palpable"
    film = written_film(options, name)
    if film is None:
        film = folder
        written = write_film(options, name, seed, folder)
        if written.returncode != 0:
            return {"refused": f"synth: {complaint(written)}"}
    begin = time.time()
    live = run([program, "live", options.body, "--source", film / "frames", "--dynamics", "off", "--out", folder / "result", "--write", "+meshes"])
    if live.returncode != 0:
        return {"refused": f"live: {complaint(live)}"}
    played = time.time()
    solved = solve_truth(options, film)
    if solved:
        return {"refused": f"truth: {solved}"}
    answered = time.time()
    score = run([program, "score", film / "truth", folder / "result", "--body", options.body, "--json"])
    if score.returncode != 0:
        return {"refused": f"score: {complaint(score)}"}
    full = options.lengths[name]
    took = film / "film.json"
    return {"seed": seed, "body": options.body.name,
            "cut_from": full if film_frames(film) < full else None,
            **timings(folder / "result"), "film": json.loads(took.read_text()) if took.is_file() else None,
            "play_s": round(played - begin, 1), "truth_s": round(answered - played, 1),
            "score_s": round(time.time() - answered, 1),
            "scores": json.loads(score.stdout)}


def play_real(options, name, _seed, folder):
    real = REAL[name]
    source = options.data / real["folder"]
    if not source.is_dir():
        return {"refused": f"no folder {source}"}
    if "intrinsics" in real:
        (folder / "intrinsics.txt").write_text(real["intrinsics"] + "\n")
    words = [word.format(data=options.data, work=folder) for word in real.get("words", [])]
    program = options.programs / "palpable"
    live = run([program, "live", options.body, "--source", source, "--place", real["place"], *words,
                "--out", folder / "result"])
    if live.returncode != 0:
        return {"refused": complaint(live)}
    entry = {**timings(folder / "result"), "remark": real.get("remark")}
    if real.get("poses"):
        score = run([program, "score", "--poses", source, folder / "result", "--json"])
        if score.returncode != 0:
            return {"refused": f"score: {complaint(score)}"}
        entry["scores"] = json.loads(score.stdout)
    return entry


def page(entries, real, lengths, note, fresh):
    """The content of the file."""
    text = TEXT
    if seeds := sorted({entry["seed"] for entry in entries.values() if "seed" in entry}):
        text += f"Seed {', '.join(map(str, seeds))}."
    cut = [f"{name} {entry['frames']} of {entry['cut_from']}"
           for name, entry in entries.items() if entry.get("cut_from")]
    if cut:
        text += f" **Cut to save time** (frames): {', '.join(cut)}."
    missing = [name for name in lengths if name not in map(sequence_of, entries)]
    if missing:
        text += f" Not run yet: {', '.join(missing)}."
    title, order, command = "Live on synthetic films", 20, "tools/run_benchmark.py"
    if fresh:
        title, order, command = f"{title}, held-out seeds", 10, f"{command} --fresh 3"
    return {"title": title, "order": order, "text": text,
            "command": [f"{command}    # all, at full length", "tools/write_results.py"],
            **({"note": note} if note else {}),
            "pooled": pools(entries), "entries": entries, "real": real}


def planned(options, entries):
    """The runs to be made: (sequence, seed). With --fresh, one seed of every sequence before the second of any."""
    if not options.fresh:
        return [(name, options.seed) for name in options.only]
    drawn = random.SystemRandom()
    counts = collections.Counter(sequence_of(key) for key, entry in entries.items() if "scores" in entry)
    return [(name, drawn.choice(HELD_OUT)) for turn in range(options.fresh) for name in options.only
            if name in options.lengths and counts[name] <= turn]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=Path, default=ROOT / "build/release/bin")
    parser.add_argument("--body", type=Path)
    parser.add_argument("--frames", type=int, help="of each sequence; default: its full length")
    parser.add_argument("--describes", type=Path, metavar="TOML", help="what --body was baked from")
    seeds = parser.add_mutually_exclusive_group()
    seeds.add_argument("--seed", type=int, default=1)
    seeds.add_argument("--fresh", type=int, default=0, metavar="N", help="N held-out seeds of each sequence, drawn and printed")
    parser.add_argument("--only", nargs="*", metavar="NAME")
    parser.add_argument("--data", type=Path, default=ROOT / "../shared/data")
    parser.add_argument("--work", type=Path, default=ROOT / "build/benchmark")
    parser.add_argument("--films", type=Path, help="sequences that were written before")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("-o", "--out", type=Path)
    options = parser.parse_args()
    if options.out is None:
        options.out = ROOT / "docs/results" / ("chain-fresh.json" if options.fresh else "chain.json")
    options.lengths = full_lengths(options.programs)
    known = [*options.lengths, *REAL]
    if options.only is None:
        options.only = known
    for name in options.only:
        if name not in known:
            sys.exit(f"run_benchmark: no sequence '{name}'; there are: {', '.join(known)}")
    if options.body is None:
        bodies = [ROOT / "build/bodies/bunny-dense.palpable", ROOT / "out/demo/bunny.palpable"]
        options.body = next((body for body in bodies if body.is_file()), None)
    if options.only and (options.body is None or not options.body.is_file()):
        sys.exit(f"run_benchmark: no body {options.body or 'in build/bodies or out/demo'}; ./demo bakes one")
    if options.films and options.films.resolve() == options.work.resolve():
        sys.exit("run_benchmark: --films is --work, whose folders are removed")
    if options.describes is None and options.body is not None:
        # The demo's body is named bunny, its description bunny-demo.
        names = {"bunny": "bunny-demo"}
        options.describes = ROOT / "bodies" / f"{names.get(options.body.stem, options.body.stem)}.toml"
    if options.only and not options.describes.is_file():
        sys.exit(f"run_benchmark: no description {options.describes}; --describes names what the body was baked from")
    refuse_other_films(options)
    file = json.loads(options.out.read_text()) if options.out.is_file() else {}
    entries, real = file.get("entries", {}), file.get("real", {})
    for entry in entries.values():
        if "scores" in entry:
            entry["scores"] = with_present_names(entry["scores"])

    def write():
        content = page({key: entries[key] for name in options.lengths for key in entries if sequence_of(key) == name},
                       {key: real[key] for key in REAL if key in real}, options.lengths,
                       file.get("note"), options.fresh)
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(json.dumps(content, indent=1) + "\n")

    for name, seed in planned(options, entries):
        key = f"{name}/{seed}" if options.fresh else name
        folder = options.work / key.replace(" ", "_").replace(",", "").replace("/", "-")
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        into, player = (real, play_real) if name in REAL else (entries, play)
        print(key, "...", flush=True)
        into[key] = {**origin(), **player(options, name, seed, folder)}
        if not options.keep:
            shutil.rmtree(folder)
        print(key, {word: value for word, value in into[key].items() if word != "scores"}, flush=True)
        write()
    write()
    print(f"{options.out}; now run tools/write_results.py")


if __name__ == "__main__":
    main()
