#!/usr/bin/env python3
"""live_results.py BENCH.json [--note TEXT]: docs/results/live.json from what `palpable bench live --json` printed.

To be run where the bench ran, right after it: machine, day and commit are taken from there. The bench's own
figures stay in the file; tools/write_results.py makes a section of docs/results.md of it.
"""
from bench_section import write_section
from run_benchmark import origin

RUNS = {"bunny": "shown, nothing written", "bare": "nothing drawn", "files": "shown, all files written",
        "converted": "as `bunny`, camera sends colours", "site": "as `bunny`, `--contact site`", "paper": "as `bunny`, `--contact paper`",
        "paced": "as `bunny`, 30 frames/s for a minute", "672": "as `bunny`, 672 x 376", "1080p": "as `bunny`, 1920 x 1080",
        "bunny_moving": "as `bunny`, the camera moves", "dragon": "as `bunny`, the dragon"}
CPU, RATE = ("CPU of a frame", "cpu_ms_per_frame", "ms"), ("frames/s", "fps", "")
# run, figure, target, whether it is a lower bound
TARGETS = [("bunny", CPU, 38, False), ("bunny_moving", CPU, 44, False), ("dragon", CPU, 54, False), ("bunny", RATE, 42, True),
           ("files", RATE, 33, True), ("bare", RATE, 65, True), ("672", RATE, 90, True), ("dragon", RATE, 32, True),
           ("paced", ("frames dropped", "dropped", ""), 0, False),
           ("paced", ("age of a frame, 99th percentile", "age_frames_p99", "frames"), 2, False)]


def target_rows(modes):
    for run, (what, key, unit), target, at_least in TARGETS:
        if run in modes:
            value = modes[run][key]
            yield [f"`{run}`: {RUNS[run]}", what, f"at {'least' if at_least else 'most'} {target} {unit}".strip(), f"{value:.3g} {unit}".strip(),
                   value >= target if at_least else value <= target]


def section_of(figures):
    modes = figures["modes"]
    stages = list(dict.fromkeys(stage for mode in modes.values() for stage in mode["stage_ms"]))
    return {
        "title": "The live loop", "order": 28,
        "text": f"`palpable bench live` plays films from memory, at 1280 x 720 unless a size is named, on two threads: one measures the depth of "
                f"a frame while the other tracks, solves and draws the frame before. {figures['renderer'].split(' (')[0]} draws; no GPU is "
                f"used. [benchmark.md](benchmark.md#how-fast-the-loop-is) describes the runs. The process takes "
                f"{figures['peak_memory_mb']:.0f} MB, the film included.",
        "command": ["palpable bench live BODY --json > bench.json", "tools/live_results.py bench.json", "tools/write_results.py"],
        **origin(),
        "tables": [
            {"columns": ["run", "figure", "target", "measured", "met"], "rows": list(target_rows(modes))},
            {"folded": "All runs", "columns": ["run", "what", "frames/s", "CPU (ms a frame)", "stages together (ms), median", "99th percentile"],
             "rows": [[name, RUNS.get(name, ""), mode["fps"], mode["cpu_ms_per_frame"], mode["sum_of_stages_ms"]["p50"],
                       mode["sum_of_stages_ms"]["p99"]] for name, mode in modes.items()]},
            {"folded": "Wall time by stage (ms): median / 99th percentile", "columns": ["run", *stages],
             "rows": [[name, *(f"{mode['stage_ms'][s]['p50']:.3g} / {mode['stage_ms'][s]['p99']:.3g}" if s in mode["stage_ms"] else None
                               for s in stages)] for name, mode in modes.items()]}]}


if __name__ == "__main__":
    write_section(__doc__, "live.json", section_of)
