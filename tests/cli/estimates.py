#!/usr/bin/env python3
"""palpable bake --estimate: time, memory and bytes of a bake before it begins."""
import json
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
base.LONG.clear()
case = base.case

FACTOR = 2  # the figures promise this much, BakeEstimate::kFactor


def close(estimated, true, what):
    print(f"{what}: {estimated:.4g} estimated, {true:.4g} true")
    assert true / FACTOR <= estimated <= true * FACTOR, f"{what}: {estimated:.4g} estimated, {true:.4g} true"


@case("an estimate of a bake says time, memory and bytes, and writes no file")
def _(programs, folder):
    description = base.write_ball(folder, base.BALL)
    before = sorted(path.name for path in folder.iterdir())
    lines = programs.succeeds("bake", description, "--estimate", cwd=folder).stdout.splitlines()
    assert [line.split()[0] for line in lines] == ["time", "memory", "file"], lines
    assert all(" about " in line and " to " in line for line in lines), lines
    out = ("-o", folder / "ball.palpable")
    figures = json.loads(programs.succeeds("bake", "ball.toml", *out, "--estimate", "--json", "--threads", 2,
                                           cwd=folder).stdout)
    assert sorted(path.name for path in folder.iterdir()) == before
    for key in ("seconds", "cpu_seconds", "memory_bytes", "file_bytes", "snapshot_bytes"):
        assert figures[key] > 0, figures
    assert figures["threads"] == 2 and figures["seconds"] < figures["cpu_seconds"], figures
    assert abs(sum(figures["stages"].values()) - figures["cpu_seconds"]) < 1e-6 * figures["cpu_seconds"]
    close(figures["file_bytes"], programs.small_body().stat().st_size, "bytes of the file")

    part = json.loads(programs.succeeds("bake", "ball.toml", "--estimate", "--shard", "1/2", "--json",
                                        cwd=folder).stdout)
    assert part["file_bytes"] == 0 and part["snapshot_bytes"] < figures["snapshot_bytes"], part
    tables = base.write_ball(folder, base.TOUCHED_BALL.replace('"linear"', '"full"'))
    full = json.loads(programs.succeeds("bake", tables, "--estimate", "--json", cwd=folder).stdout)
    linear = json.loads(programs.succeeds("bake", tables, "--estimate", "--until", "linear", "--json",
                                          cwd=folder).stdout)
    none = json.loads(programs.succeeds("bake", tables, "--estimate", "--no-touch", "--json", cwd=folder).stdout)
    for key in ("cpu_seconds", "file_bytes"):
        assert full[key] > linear[key] > none[key], (key, full, linear, none)
    assert "large loads" in full["stages"] and "large loads" not in linear["stages"]


@case("an estimate refuses what the bake would refuse")
def _(programs, folder):
    description = base.write_ball(folder, base.BALL)
    programs.refuses("bake", description, says=["--out is required"])
    programs.refuses("bake", description, "--estimate", "--intrusive", says=["has no section [intrusive]"])
    programs.refuses("bake", description, "--estimate", "--intrusive", "--held-out", says=["--held-out"])
    programs.refuses("bake", description, "--estimate", "--solver", "calculix", says=["--solver calculix"])
    base.write_ball(folder, base.BALL.replace("below = 0.25", "below = 1e-9"))
    programs.refuses("bake", description, "--estimate", says=["support"])


@case("the estimate of the smallest body that ships is within a factor of two of its bake", long=True)
def _(programs, folder):
    subprocess.run([sys.executable, base.ROOT / "tools/make_post.py", folder / "post.off"], check=True)
    text = (base.ROOT / "bodies/post-small.toml").read_text()
    (folder / "post.toml").write_text(text.replace("../build/meshes/post.off", "post.off"))
    bake = ("bake", "post.toml", "--threads", 1)
    estimate = json.loads(programs.succeeds(*bake, "--estimate", "--json", cwd=folder).stdout)
    process = programs.start(*bake, "-o", "post.palpable", "-q", cwd=folder, stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    close(estimate["cpu_seconds"], used.ru_utime + used.ru_stime, "CPU seconds")
    close(estimate["memory_bytes"], 1024 * used.ru_maxrss, "bytes of memory")
    close(estimate["file_bytes"], (folder / "post.palpable").stat().st_size, "bytes of the file")
    snapshots = sum(path.stat().st_size for path in (folder / "post.snapshots").glob("*.h5"))
    close(estimate["snapshot_bytes"], snapshots, "bytes of snapshots")


if __name__ == "__main__":
    sys.exit(base.main())
