#!/usr/bin/env python3
"""Campaigns as a stranger meets them: snapshots, resumption, shards, MPI, other solvers, imports."""
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case

# Solved in a second or two: enough to be killed in the middle.
BLOCK = base.BAR.replace('sets = "TIP"', "count = 6\nabove = 0.5").replace(
    "direction = [1, 0, 0]", "").replace("levels = 2", "levels = 6").replace('"3 mm"', '"2 mm"')


def files_of(folder):
    return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


def start(programs, *words, cwd, limit=None):
    def prepare():
        if limit is not None:
            # Writing beyond the limit fails as on a full disk, instead of a signal.
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    return subprocess.Popen([programs.palpable, *map(str, words)], cwd=cwd, preexec_fn=prepare,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            stdin=subprocess.DEVNULL)


@case("a bake that is killed again and again ends with the bytes of one that is not")
def _(programs, folder):
    words = ("bake", "bar.toml", "-o", "bar.palpable", "--threads", "2")
    for name in ("whole", "killed"):
        base.write_bar(folder / name, BLOCK)
    begin = time.time()
    programs.succeeds(*words, cwd=folder / "whole")
    wall = time.time() - begin
    dice = random.Random(5)
    kills = finished_before = 0
    for _ in range(12):
        process = start(programs, *words, cwd=folder / "killed")
        time.sleep(dice.uniform(0.05, 0.9) * wall)
        process.kill()
        process.communicate()
        kills += process.returncode == -signal.SIGKILL
        store = folder / "killed/bar.snapshots"
        finished = {p.name for p in store.glob("site_*.h5")} if store.exists() else set()
        if 0 < len(finished) < 6:
            finished_before += 1
    assert kills >= 3, kills
    result = programs.succeeds(*words, cwd=folder / "killed")
    whole, killed = files_of(folder / "whole/bar.snapshots"), files_of(folder / "killed/bar.snapshots")
    assert sorted(whole) == sorted(killed), (sorted(whole), sorted(killed))
    assert whole == killed
    assert (folder / "whole/bar.palpable").read_bytes() == (folder / "killed/bar.palpable").read_bytes()
    assert "were there" in result.stdout, result.stdout


@case("a full disk ends a bake with one line and loses no finished site")
def _(programs, folder):
    words = ("bake", "bar.toml", "-o", "bar.palpable")
    for name in ("whole", "full"):
        base.write_bar(folder / name, BLOCK)
    programs.succeeds(*words, cwd=folder / "whole")
    whole = files_of(folder / "whole/bar.snapshots")
    programs.succeeds(*words, "--shard", "1/2", cwd=folder / "full")
    before = files_of(folder / "full/bar.snapshots")
    assert any(name.startswith("site_") for name in before)
    limit = len(whole["site_0000.h5"]) // 2
    process = start(programs, *words, cwd=folder / "full", limit=limit)
    error = process.communicate(timeout=200)[1]
    said = [line for line in error.splitlines() if line.startswith("palpable: ")]
    assert process.returncode == 1 and len(said) == 1, error
    assert "site_" in said[0] and "cannot be written: File too large" in said[0], said
    print(said[0])
    after = files_of(folder / "full/bar.snapshots")
    assert before == after, (sorted(before), sorted(after))
    programs.succeeds(*words, cwd=folder / "full")
    assert files_of(folder / "full/bar.snapshots") == whole


@case("later bakes and reduce use the snapshots that are there")
def _(programs, folder):
    toml = base.write_bar(folder, BLOCK)
    first = programs.succeeds("bake", toml, "-o", folder / "bar.palpable").stdout
    assert "6 sites solved, 0 were there" in first, first
    toml.write_text(BLOCK + "[reduction]\ntolerance = 1e-2\n")
    again = programs.succeeds("bake", toml, "-o", folder / "bar.palpable").stdout
    assert "0 sites solved, 6 were there" in again, again
    store = folder / "bar.snapshots"
    programs.succeeds("reduce", store, "--tolerance", "0.01", "-o", folder / "a.palpable")
    one = programs.succeeds("inspect", folder / "a.palpable").stdout
    assert "palpable reduce" in one and "asked 0.01" in one, one
    programs.succeeds("reduce", store, "--max-modes", "1", "-o", folder / "b.palpable")
    # Another material: nothing is valid.
    toml.write_text(BLOCK.replace("60 kPa", "50 kPa"))
    other = programs.succeeds("bake", toml, "-o", folder / "bar.palpable").stdout
    assert "6 sites solved, 0 were there" in other, other


@case("shards of a campaign merge to the bytes of one bake")
def _(programs, folder):
    for name in ("whole", "parts"):
        base.write_bar(folder / name, BLOCK)
    programs.succeeds("bake", "bar.toml", "-o", "bar.palpable", cwd=folder / "whole")
    for i in (1, 2, 3):
        said = programs.succeeds("bake", "bar.toml", "-o", f"{i}.palpable", "--shard", f"{i}/3",
                                 cwd=folder / "parts").stdout
        assert "palpable merge" in said, said
        assert not (folder / f"parts/{i}.palpable").exists()
    parts = [folder / f"parts/{i}.snapshots" for i in (1, 2, 3)]
    assert all(0 < len(list(part.glob("site_*"))) < 6 for part in parts)
    programs.refuses("merge", *parts[:2], "-o", folder / "bar.snapshots",
                     says=["in none of the folders", "missing"])
    programs.succeeds("merge", *parts, "-o", folder / "bar.snapshots")
    assert files_of(folder / "bar.snapshots") == files_of(folder / "whole/bar.snapshots")
    programs.succeeds("reduce", folder / "bar.snapshots", "-o", folder / "bar.palpable")


@case("mpirun with four ranks leaves the bytes of one process; a killed rank loses nothing")
def _(programs, folder):
    mpirun = shutil.which("mpirun")
    if mpirun is None:
        print("SKIPPED: mpirun is not installed")
        return
    env = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    for name in ("one", "four"):
        base.write_bar(folder / name, BLOCK)
    words = ("bake", "bar.toml", "-o", "bar.palpable")
    programs.succeeds(*words, cwd=folder / "one")

    def ranks(n, kill_one=False):
        process = subprocess.Popen([mpirun, "--oversubscribe", "-n", str(n), programs.palpable, *words],
                                   cwd=folder / "four", env=env, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if kill_one:
            children, patience = [], time.time() + 60
            while len(children) < n and time.time() < patience:
                time.sleep(0.05)
                children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
            while not list((folder / "four").glob("bar.snapshots/site_*.h5")) and time.time() < patience:
                time.sleep(0.01)
            os.kill(int(children[-1]), signal.SIGKILL)
        out, error = process.communicate(timeout=250)
        return process.returncode, out, error

    code, out, error = ranks(4, kill_one=True)
    there = len(list((folder / "four").glob("bar.snapshots/site_*.h5")))
    print(f"killed: exit code {code}, {there} sites there")
    assert code != 0 or there == 6
    code, out, error = ranks(4)
    assert code == 0, error
    assert f"{6 - there} sites solved, {there} were there" in out, out
    assert files_of(folder / "four/bar.snapshots") == files_of(folder / "one/bar.snapshots")
    assert (folder / "four/bar.palpable").read_bytes() == (folder / "one/bar.palpable").read_bytes()
    # One error, of the leader, and no rank is left waiting.
    (folder / "four/bar.toml").write_text(BLOCK.replace('"2 mm"', '"2 m"'))
    code, out, error = ranks(4)
    assert code != 0, out
    said = [line for line in error.splitlines() if line.startswith("palpable: ")]
    assert len(said) >= 1 and "past the centre of mass" in said[0], error


@case("a campaign with a third parameter is its product, and a body file holds one value")
def _(programs, folder):
    toml = base.write_bar(folder, BLOCK.replace("count = 6", "count = 2").replace("[support]", """
[[material.group]]
name = "upper"
set = "MIDDLE"
young = "60 kPa"
poisson = 0.4
[[parameter]]
name = "ratio"
of = "upper"
stiffness = [0.5, 1, 2]
[support]"""))
    said = programs.succeeds("bake", toml, "-o", folder / "bar.palpable", "--at", "ratio=2").stdout
    assert "6 sites solved" in said and "one value of each parameter" in said, said
    assert len(list((folder / "bar.snapshots").glob("point_*_site_*.h5"))) == 6
    store = folder / "bar.snapshots"
    stiff = programs.succeeds("inspect", folder / "bar.palpable").stdout
    assert "ratio 2" in stiff, stiff
    programs.succeeds("reduce", store, "--at", "ratio=0.5", "-o", folder / "soft.palpable")
    assert "ratio 0.5" in programs.succeeds("inspect", folder / "soft.palpable").stdout
    programs.refuses("reduce", store, "--at", "ratio=3", "-o", folder / "x.palpable",
                     says=["'ratio' has no value 3", "0.5 1 2"])
    programs.refuses("reduce", store, "--at", "ears=1", "-o", folder / "x.palpable",
                     says=["no parameter 'ears'", "'ratio'"])


@case("bad shards, folders and values are refused in one line")
def _(programs, folder):
    toml = base.write_bar(folder, BLOCK)
    out = ("-o", folder / "bar.palpable")
    for shard in ("0/4", "5/4", "1", "1/4x", "a/b"):
        programs.refuses("bake", toml, *out, "--shard", shard, says=[f"--shard {shard}", "I/N"])
    programs.refuses("bake", toml, *out, "--at", "ratio", says=["--at ratio", "ears=0.5"])
    programs.refuses("reduce", folder / "none.snapshots", *out, says=["none.snapshots", "no such folder"])
    programs.refuses("reduce", folder, *out, says=["not a folder of snapshots"])
    programs.refuses("bake", toml, *out, "--snapshots", folder, says=["holds something else"])
    (folder / "bad.snapshots").mkdir()
    (folder / "bad.snapshots/campaign.h5").write_bytes(b"palpable campaign, layout 9\n")
    programs.refuses("reduce", folder / "bad.snapshots", *out, says=["campaign.h5", "layout version '9'"])


if __name__ == "__main__":
    sys.exit(base.main())
