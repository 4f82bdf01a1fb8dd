#!/usr/bin/env python3
"""live_results.py BENCH.json [--note TEXT]: docs/results/live.json from what `palpable bench live --json` printed.

To be run where the bench ran, right after it: machine, day and commit are taken from there. The bench's own
figures stay in the file; tools/write_results.py makes a section of docs/results.md of it.
"""
from bench_section import write_section
from run_benchmark import origin


def section_of(figures):
    modes = figures["modes"]
    stages = list(dict.fromkeys(stage for mode in modes.values() for stage in mode["stage_ms"]))
    return {
        "title": "The live loop", "order": 28,
        "text": f"`{figures['body']}`, drawn by {figures['renderer'].split(' (')[0]}, {figures['threads']} threads; what the runs "
                "are is in [benchmark.md](benchmark.md#how-fast-the-loop-is). A frame is seen on one thread while the one before "
                f"is followed, answered and drawn on another. Paced: {figures['dropped']} frames dropped, the 99th of 100 "
                f"{figures['age_frames_p99']:.3g} frames old. Memory {figures['peak_memory_mb']:.0f} MB, the film included; "
                f"{figures['hot_allocations']} allocations while frames were counted.",
        "command": ["palpable bench live BODY --json > bench.json", "tools/live_results.py bench.json", "tools/write_results.py"],
        **origin(),
        "tables": [
            {"columns": ["run", "frames/s", "CPU (ms a frame)", "stages together (ms), median", "of 100 the 99th", "copy of its bytes (ms)"],
             "rows": [[name, mode["fps"], mode["cpu_ms_per_frame"], mode["sum_of_stages_ms"]["p50"], mode["sum_of_stages_ms"]["p99"],
                       mode["copy_ms"]] for name, mode in modes.items()]},
            {"heading": "By stage, median and 99th of 100 (ms)", "columns": ["run", *stages],
             "rows": [[name, *(f"{mode['stage_ms'][s]['p50']:.3g} / {mode['stage_ms'][s]['p99']:.3g}" if s in mode["stage_ms"] else None
                               for s in stages)] for name, mode in modes.items()]}]}


if __name__ == "__main__":
    write_section(__doc__, "live.json", section_of)
