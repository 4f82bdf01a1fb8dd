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
hand is kept too. --only without a name runs nothing and writes the tables anew. Recorded real sets below
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
import statistics
import subprocess
import sys
import time
import tomllib
from pathlib import Path

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
All sequences of `palpable synth`, played by `palpable live` and scored by `palpable score`. Today's chain
is a stereo matcher of our own (half resolution, refined at the full one) whose rows are watched and corrected,
a camera that is followed, and what moves left out of that. `-` is what a result does not hold, or what a
sequence has none of.
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
    words = [options.programs / "palpable", "synth", name, "--body", options.body, "--seed", seed,
             "-o", folder]
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
    live = run([program, "live", options.body, "--source", film / "frames", "--out", folder / "result", "--write", "+meshes"])
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


# The sequences over which errors relative to the full-order solution are pooled: those with a touch, except thin things,
# darkness, and a desk without texture.
POOLED = ("press", "cup", "slide", "palm", "two-hands", "squeeze", "rest", "press-axial", "press-behind")
ERRORS = ("displacement_error", "max_vertex_error_mm", "von_mises_error", "force_error")


def sequence_of(key):
    """The sequence of an entry: keys are "press", or "press/4711" for one of several seeds."""
    return key.partition("/")[0]


def pooled(scored, names):
    """Median and p90 of each error, as in palpable score, over all frames of the sequences; None without any."""
    frames = [frame for key, entry in scored.items() if sequence_of(key) in names
              for frame in entry["scores"].get("errors_by_frame") or []]
    frames = [frame for frame in frames if all(frame[key] is not None for key in ERRORS)]
    if len(frames) < 2:
        return None
    of = {key: [frame[key] for frame in frames] for key in ERRORS}
    return {"frames": len(frames), "seeds": len({key for key in scored if sequence_of(key) in names}),
            **{key: {"median": statistics.median(values),
                     "p90": statistics.quantiles(values, n=10, method="inclusive")[-1]} for key, values in of.items()}}


def pools(entries):
    """{what: pooled errors} of each touched sequence and of all of POOLED."""
    scored = {name: entry for name, entry in entries.items() if "scores" in entry}
    groups = {name: [name] for name in dict.fromkeys(map(sequence_of, scored))}
    groups |= {"pooled": POOLED, "pooled without squeeze": [name for name in POOLED if name != "squeeze"]}
    found = {what: pooled(scored, names) for what, names in groups.items()}
    return {what: errors for what, errors in found.items() if errors}


DISTANCES = ("0.2", "0.3", "0.5", "1", "2", "5", "10", "15")


def tables(entries, real):
    scored = {name: entry for name, entry in entries.items() if "scores" in entry}

    def rows(keys, percent=()):
        for name, entry in scored.items():
            cells = [entry["scores"].get(key) for key in keys]
            if any(cell is not None for cell in cells[1:]):
                yield [name] + [100 * value if key in percent and value is not None else value
                                for key, value in zip(keys, cells)]

    def pair(value, factor=1):
        """Median and p90 (or p99) as one cell."""
        if value is None:
            return None
        median, high = [value[key] for key in value][:2]
        return None if median is None else f"{factor * median:.3g}, {factor * high:.3g}"

    def full_answer():
        for name, entry in scored.items():
            s = entry["scores"]
            if not any(s.get(f"reference_frames{kind}") for kind in ("", "_shallow", "_unseen")):
                continue
            yield [name, s["reference_frames"], pair(s["displacement_error"], 100), pair(s["max_vertex_error_mm"]),
                   pair(s["max_vertex_error_mm_shallow"]), pair(s["von_mises_error"], 100),
                   pair(s["force_error"], 100), pair(s["excess_indentation_mm"]), s.get("reference_frames_unseen"),
                   pair(s.get("max_vertex_error_mm_unseen"))]
        for what, p in pools(entries).items():
            if p["seeds"] > 1 or what not in entries:
                yield [what, p["frames"], pair(p["displacement_error"], 100), pair(p["max_vertex_error_mm"]), None,
                       pair(p["von_mises_error"], 100), pair(p["force_error"], 100), None, None, None]

    def by_distance(key):
        for name, entry in scored.items():
            values = entry["scores"].get(key) or {}
            yield [name] + [None if values.get(d) is None else 100 * values[d] for d in DISTANCES]

    metres = [f"{d} m" for d in DISTANCES]
    touch = ("frames_touching", "touch_precision", "touch_recall", "touch_site_accuracy", "first_touch_delay_frames",
             "penetration_median_mm", "penetration_p99_mm", "largest_jump_mm")
    seen = ("touch_recall_3mm", "touch_false_discovery_5mm", "frames_too_deep", "frames_touch_unseen", "penetration_median_mm_unseen",
            "jumps_above_4mm")

    def camera():
        for name, entry in scored.items():
            s = entry["scores"]
            false = s["moving_false_positives"]
            yield [name, s["ate_mm"], s["rpe_mm"], pair(s.get("placement_error_mm")), s["jitter_mm"], s["moving_iou"],
                   s["moving_recall"], None if false is None else 100 * false, s["row_error_px"]]

    sight = ("occlusion_iou", "occlusion_iou_where_hidden", "edge_error_px", "edge_error_crossing_px", "flicker")
    hand = ("hand_near_frames", "hand_within_1pct", "too_close_called_far")
    yield {"heading": "Share of pixels within 1 % of their true depth, in %",
           "columns": ["sequence", *metres], "rows": list(by_distance("depth_within_1pct"))}
    yield {"heading": "Median error of depth, in % (the paper's camera: 1 near, 9 at 15 m)",
           "columns": ["sequence", *metres], "rows": list(by_distance("depth_error_median"))}
    yield {"heading": "Near hands, in %", "columns": ["sequence", "near frames", "hand within 1 %", "too close called far"],
           "rows": list(rows(hand, hand[1:]))}
    yield {"heading": "Touch", "columns": ["sequence", "true frames", "precision", "recall", "site", "delay (frames)",
                                           "penetration median (mm)", "99 of 100 (mm)", "largest pop (mm)"],
           "rows": list(rows(touch))}
    yield {"heading": "Touch, of what a camera can see",
           "columns": ["sequence", "recall beyond 3 mm", "false beyond 5 mm", "frames too deep", "frames seen by no camera",
                       "penetration in those, median (mm)", "pops of 4 mm"],
           "rows": list(rows(seen))}
    yield {"heading": "Against the full answer to the true hand (median, 90 of 100)",
           "text": "Frames in which the object is 4 mm or deeper and half or more of what touches is seen; displacement "
                   "and stress in % of the true field's size, force in % of the true one; overpress: how much too far "
                   "the drawn skin went (median, 99 of 100). Frames whose touch no camera sees are counted and not "
                   f"judged. Pooled are the frames of {', '.join(POOLED)}; the bars of issue 26: displacement 20, 45 %, "
                   "worst vertex 1.5, 3 mm, force 25, 50 %, overpress 2.5 mm.",
           "columns": ["sequence", "frames", "displacement (%)", "worst vertex (mm)", "the same, shallower (mm)",
                       "von Mises (%)", "force (%)", "overpress (mm)", "frames seen by no camera",
                       "worst vertex in those (mm)"],
           "rows": list(full_answer())}
    yield {"heading": "Occlusion", "columns": ["sequence", "IoU", "where hidden", "edge error (px)",
                                               "where a hand crosses the outline (px)", "flicker"],
           "rows": list(rows(sight))}
    yield {"heading": "Camera, anchor, what moves, rectification",
           "columns": ["sequence", "ATE (mm)", "RPE 1 s (mm)", "body off its place (mm; median, 90 of 100)", "jitter (mm)",
                       "moving IoU", "recall", "false, of all pixels (%)", "row error (px)"],
           "rows": list(camera())}
    yield {"heading": "Time",
           "columns": ["sequence", "frames", "film, CPU (s)", "film, wall (s)", "play, wall (s)", "ms a frame",
                       "full answer, wall (s)", "score, wall (s)"],
           "text": "On the machines named under Measured at, which other work shared; of filming the user CPU time, too.",
           "rows": [[name, entry["frames"], (entry.get("film") or {}).get("user_s"),
                     (entry.get("film") or {}).get("wall_s"), entry["play_s"], entry["frame_ms"],
                     entry.get("truth_s"), entry["score_s"]]
                    for name, entry in scored.items()]}
    refused = [[name, entry["refused"]] for name, entry in entries.items() if "refused" in entry]
    if refused:
        yield {"heading": "Not scored", "columns": ["sequence", "why"], "rows": refused}
    if real:
        yield {"heading": "Real recordings, by the same commands",
               "text": "Places of the body are made up; only the camera's path has a truth, where it has one.",
               "columns": ["recording", "frames", "ms a frame", "first touch", "ATE (mm)", "RPE 1 s (mm)", "remark"],
               "rows": [[name, entry.get("frames"), entry.get("frame_ms"), entry.get("first_touch_frame"),
                         entry.get("scores", {}).get("ate_mm"), entry.get("scores", {}).get("rpe_mm"),
                         entry.get("refused") or entry.get("remark") or ""] for name, entry in real.items()]}


def page(entries, real, lengths, note, fresh):
    """The content of the file."""
    text = TEXT
    if seeds := sorted({entry["seed"] for entry in entries.values() if "seed" in entry}):
        text += f"\nSeed {', '.join(map(str, seeds))}."
    cut = [f"{name} {entry['frames']} of {entry['cut_from']}"
           for name, entry in entries.items() if entry.get("cut_from")]
    if cut:
        text += f" **Cut to save time** (frames): {', '.join(cut)}."
    missing = [name for name in lengths if name not in map(sequence_of, entries)]
    if missing:
        text += f" Not run yet: {', '.join(missing)}."
    title, order, command = "Today's chain on the test ground", 20, "tools/run_benchmark.py"
    if fresh:
        title, order, command = f"{title}, held-out seeds", 21, f"{command} --fresh 3"
    return {"title": title, "order": order, "text": text,
            "command": [f"{command}    # all, at full length", "tools/write_results.py"],
            **({"note": note} if note else {}),
            "pooled": pools(entries), "tables": [one for one in tables(entries, real) if one["rows"]], "entries": entries, "real": real}


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
