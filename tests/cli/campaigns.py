#!/usr/bin/env python3
"""Campaigns on the command line: snapshots, resumption, shards, MPI, other solvers, imports."""
import json
import os
import random
import re
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

# Solved in a second or two: long enough to be killed in the middle.
BLOCK = base.BAR.replace('sets = "TIP"', "count = 6\nabove = 0.5").replace(
    "direction = [1, 0, 0]", "").replace("levels = 2", "levels = 6").replace('"3 mm"', '"2 mm"')

# Solved in some seconds: more sites than run in parallel, so that some are finished before others.
LARGE = BLOCK.replace('unit = "mm"', 'unit = "mm"\norder = 2').replace("count = 6", "count = 60").replace(
    "above = 0.5", "above = 0.3").replace("levels = 6", "levels = 8") + "[reduction]\nmax_modes = 2\n"


def files_of(folder):
    return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


def start(programs, *words, cwd, limit=None):
    def prepare():
        if limit is not None:
            # Writing beyond the limit fails, as on a full disk, without a signal.
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    return subprocess.Popen([programs.palpable, *map(str, words)], cwd=cwd, preexec_fn=prepare,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            stdin=subprocess.DEVNULL)


@case("snapshots of an edited description are kept, and used again when it is edited back")
def _(programs, folder):
    description = base.write_bar(folder, BLOCK)
    bake = ("bake", "bar.toml", "-o", "bar.palpable")
    programs.succeeds(*bake, cwd=folder)
    first = files_of(folder / "bar.snapshots")
    description.write_text(BLOCK.replace("60 kPa", "70 kPa"))
    edited = programs.succeeds(*bake, cwd=folder).stdout
    kept = re.search(r"bar.snapshots held 6 sites of another description: kept in (\S+)", edited)
    assert kept and "6 sites solved" in edited, edited
    assert files_of(folder / kept[1]) == first
    description.write_text(BLOCK)
    back = programs.succeeds(*bake, cwd=folder).stdout
    assert "0 sites solved, 6 were there" in back and "brought back" in back, back
    assert files_of(folder / "bar.snapshots") == first


@case("a bake that is killed again and again ends with the bytes of one that is not")
def _(programs, folder):
    words = ("bake", "bar.toml", "-o", "bar.palpable", "--threads", "2")
    for name in ("whole", "killed"):
        base.write_bar(folder / name, LARGE)
    begin = time.time()
    programs.succeeds(*words, cwd=folder / "whole")
    wall = time.time() - begin
    dice = random.Random(5)
    kills = partly = 0
    store = folder / "killed/bar.snapshots"

    def sites():
        return {p.name for p in store.glob("site_*.h5")} if store.exists() else set()

    for attempt in range(10):
        before = sites()
        process = programs.start(*words, cwd=folder / "killed")
        if attempt % 2 == 0:
            time.sleep(dice.uniform(0.0, 0.5) * wall)
        else:  # while sites are being finished
            while process.poll() is None and sites() == before:
                time.sleep(0.001)
        process.kill()
        process.communicate()
        kills += process.returncode == -signal.SIGKILL
        finished = sites()
        if 0 < len(finished) < 60:
            partly += 1
    print(f"{kills} kills, {partly} of them found some sites finished and others not")
    assert kills >= 3 and partly >= 1, (kills, partly)
    result = programs.succeeds(*words, cwd=folder / "killed")
    whole, killed = files_of(folder / "whole/bar.snapshots"), files_of(folder / "killed/bar.snapshots")
    assert sorted(whole) == sorted(killed), (sorted(whole), sorted(killed))
    assert whole == killed
    assert (folder / "whole/bar.palpable").read_bytes() == (folder / "killed/bar.palpable").read_bytes()
    assert "were there" in result.stdout, result.stdout


@case("a bake that is killed while it makes tables of touch ends with the bytes of one that is not", long=True)
def _(programs, folder):
    words = ("bake", "ball.toml", "-o", "ball.palpable", "--threads", "2")
    for name in ("whole", "killed"):
        base.write_ball(folder / name, base.BALL.replace('"none"', '"full"\nregions = 6\nheld_out = 3'))
    said = programs.succeeds(*words, cwd=folder / "whole").stdout
    assert "touch: anywhere, several at a time, 3rd order; 6 regions" in said, said
    tables, body = folder / "killed/ball.snapshots/touch", folder / "killed/ball.palpable"

    def kept():
        return {path.name for path in tables.glob("*.h5")} if tables.exists() else set()

    partly = 0
    while True:
        before = kept()
        process = programs.start(*words, cwd=folder / "killed")
        while process.poll() is None and kept() == before:
            time.sleep(0.001)
        process.kill()
        process.communicate()
        if process.returncode == 0:
            break
        assert process.returncode == -signal.SIGKILL, process.returncode
        partly += 1
        assert partly < 20, kept()  # each run finishes at least one table
        if "tables.h5" in kept():  # the linear tables are complete, and the body file has them or is about to
            assert '"touch"' in programs.succeeds("inspect", body, "--json").stdout
    assert partly >= 4, partly
    whole, killed = files_of(folder / "whole/ball.snapshots/touch"), files_of(tables)
    assert sorted(whole) == sorted(killed), (sorted(whole), sorted(killed))
    assert whole == killed
    assert (folder / "whole/ball.palpable").read_bytes() == body.read_bytes()
    told = programs.succeeds("inspect", body).stdout
    assert re.search(r"^ +touch +anywhere, several at a time, 3rd order; 6 regions; \S+ MB; 3 touches \(1 finger, 1 palm, "
                     r"1 rim; \S+ to \S+ mm deep\) against full finite elements: displacement \S+ % off", told, re.M), told

    # Other modes of the same campaign keep the tables; imported modes of another program have none.
    programs.succeeds("reduce", "ball.snapshots", "--tolerance", "1e-2", "-o", "coarse.palpable", cwd=folder / "whole")
    coarse = json.loads(programs.succeeds("inspect", folder / "whole/coarse.palpable", "--json").stdout)
    assert coarse["touch"]["regions"] == 6 and coarse["touch"]["response_order"] == 3, coarse["touch"]
    held_out = coarse["touch"]["held_out"]
    assert [touch["obstacle"] for touch in held_out["touches"]] == ["finger", "palm", "rim"], held_out
    assert 0 < held_out["displacement_median"] <= held_out["displacement_worst"] < 0.5, held_out
    programs.succeeds("report", "coarse.palpable", cwd=folder / "whole")
    assert "\nheld_out_touch,force,,,,rim " in (folder / "whole/coarse.csv").read_text()
    assert "touch" in coarse["provenance"], coarse["provenance"]
    # Additional regions are made beside the existing ones.
    description = folder / "whole/ball.toml"
    description.write_text(description.read_text().replace("regions = 6", "regions = 7"))
    programs.succeeds(*words, cwd=folder / "whole")
    more = files_of(folder / "whole/ball.snapshots/touch")
    assert len(more) == len(whole) + 1
    # Held-out touches depend on all tables together.
    assert all(more[name] == whole[name] for name in whole if name not in ("tables.h5", "held_out.h5"))
    # Without them the body file has none; the tables remain in the folder.
    description.write_text(base.BALL)
    programs.succeeds(*words, cwd=folder / "whole")
    plain = programs.succeeds("inspect", folder / "whole/ball.palpable").stdout
    assert re.search(r"^ +touch +at its sites, one at a time$", plain, re.M), plain
    assert files_of(folder / "whole/ball.snapshots/touch") == more


@case("a bake until its linear tables can be touched, and goes on to the bytes of one that was never stopped")
def _(programs, folder):
    words = ("bake", "ball.toml", "-o", "ball.palpable")
    coarse = base.BALL.replace('edge = "12 mm"', 'edge = "20 mm"')
    for name in ("whole", "staged"):
        base.write_ball(folder / name, coarse.replace('"none"', '"full"\nregions = 3\nheld_out = 1'))
    programs.succeeds(*words, cwd=folder / "whole")
    body = folder / "staged/ball.palpable"
    said = programs.succeeds(*words, "--until", "linear", cwd=folder / "staged").stdout
    assert "without --until goes on" in said, said
    touch = json.loads(programs.succeeds("inspect", body, "--json").stdout)["touch"]
    assert touch["response_order"] == 1 and touch["held_out"] is None, touch
    tables = folder / "staged/ball.snapshots/touch"
    # tables.h5 lists the complete tables and is written again after each stage.
    linear = {path: path.stat().st_mtime_ns for path in tables.glob("*.h5") if path.name != "tables.h5"}
    assert linear, "no table was kept"
    programs.succeeds(*words, cwd=folder / "staged")
    assert all(path.stat().st_mtime_ns == time for path, time in linear.items()), "the linear tables were made again"
    assert body.read_bytes() == (folder / "whole/ball.palpable").read_bytes()
    base.write_ball(folder / "none", coarse)
    programs.refuses(*words, "--until", "linear", cwd=folder / "none", says=["--until", "no tables of touch"])
    programs.refuses(*words, "--until", "regions", cwd=folder / "none", says=["--until", "regions", "linear"])


@case("a description that does not speak of touch gets tables and their errors")
def _(programs, folder):
    text = base.BALL.replace('[touch]\ntables = "none"\n', "").replace('edge = "12 mm"', 'edge = "20 mm"')
    base.write_ball(folder, text)
    said = programs.succeeds("bake", "ball.toml", "-o", "ball.palpable", cwd=folder).stdout
    assert re.search(r"^touch: anywhere, several at a time, 3rd order; .* touches \(7 finger, 7 palm, 6 rim;", said, re.M), said


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
    process = programs.start(*words, cwd=folder / "full", limit=limit)
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
    # With another material no snapshot is valid.
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
    # Snapshots of another campaign in the output folder are removed, and a message says so.
    base.write_bar(folder / "other", BLOCK.replace("60 kPa", "70 kPa"))
    programs.succeeds("bake", "bar.toml", "-o", "bar.palpable", "--shard", "1/3", cwd=folder / "other")
    there = files_of(folder / "other/bar.snapshots")
    said = programs.succeeds("merge", *parts, "-o", folder / "other/bar.snapshots").stdout
    kept = re.search(r"bar.snapshots held 2 sites of another description: kept in (\S+)", said)
    assert kept and files_of(kept[1]) == there, said


@case("a campaign by CalculiX makes the same body, and says what ccx says")
def _(programs, folder):
    if shutil.which("ccx") is None:
        print("SKIPPED: ccx is not installed")
        return
    law = BLOCK.replace("[material]", '[material]\nlaw = "neo-hooke-abaqus"').replace("count = 6", "count = 2")
    toml = base.write_bar(folder, law)
    said = programs.succeeds("bake", toml, "-o", folder / "ccx.palpable", "--solver", "calculix")
    assert "solving sites" in said.stderr and "2 sites solved, 0 were there" in said.stdout, said
    programs.succeeds("bake", toml, "-o", folder / "own.palpable")
    modes = {}
    for name in ("ccx", "own"):
        text = programs.succeeds("inspect", folder / f"{name}.palpable").stdout
        assert ("CalculiX (ccx)" in text) == (name == "ccx"), text
        modes[name] = re.findall(r"(\d+) modes, relative L2", text)
    assert modes["ccx"] == modes["own"], modes
    # Snapshots of one solver are not valid for the other.
    again = programs.succeeds("bake", toml, "-o", folder / "ccx.palpable").stdout
    assert "2 sites solved, 0 were there" in again, again
    toml.write_text(BLOCK)
    programs.refuses("bake", toml, "-o", folder / "x.palpable", "--solver", "calculix",
                     says=["site 0", "neo-hookean", "CalculiX"])
    path = os.environ["PATH"]
    os.environ["PATH"] = str(folder)
    try:
        programs.refuses("bake", toml, "-o", folder / "x.palpable", "--solver", "calculix",
                         says=["'ccx' is not installed"])
    finally:
        os.environ["PATH"] = path


@case("linear responses are stored beside the snapshots, and used again")
def _(programs, folder):
    base.write_bar(folder, BLOCK.replace("count = 6", "count = 2\nlinear = true"))
    words = ("bake", "bar.toml", "-o", "bar.palpable")
    said = programs.succeeds(*words, cwd=folder).stdout
    assert "linear responses of 49 vertices: 1 of 1 files made now" in said, said
    whole = files_of(folder / "bar.snapshots")
    assert len(whole["linear_0000.h5"]) > 49 * 58 * 12
    assert "0 of 1 files made now" in programs.succeeds(*words, cwd=folder).stdout
    (folder / "bar.snapshots/linear_0000.h5").write_bytes(whole["linear_0000.h5"][:-100])
    # Another press depth invalidates all snapshots but no unit response; a damaged file is made again.
    assert "1 of 1 files made now" in programs.succeeds(*words, cwd=folder).stdout
    assert files_of(folder / "bar.snapshots") == whole
    base.write_bar(folder, BLOCK.replace("count = 6", "count = 2\nlinear = true").replace('"2 mm"', '"1 mm"'))
    said = programs.succeeds(*words, cwd=folder).stdout
    assert "2 sites solved" in said and "0 of 1 files made now" in said, said
    for i in (1, 2):
        programs.succeeds("bake", "bar.toml", "-o", f"{i}.palpable", "--shard", f"{i}/2", cwd=folder)
    programs.succeeds("merge", folder / "1.snapshots", folder / "2.snapshots", "-o", folder / "all.snapshots")
    assert files_of(folder / "all.snapshots") == files_of(folder / "bar.snapshots")


@case("a body file may hold the inside, and half precision, and says what that costs")
def _(programs, folder):
    base.write_bar(folder, BLOCK)
    said = programs.succeeds("bake", "bar.toml", "-o", "bar.palpable", "--volume", cwd=folder).stdout
    assert "inside: 63 nodes, 144 tetrahedra" in said and "half precision" not in said, said
    assert re.search(r"^between sites: .* for \d+ touches .*: [\d.e-]+ at the median", said, re.M), said
    store = folder / "bar.snapshots"
    half = programs.succeeds("reduce", store, "--float16", "-o", folder / "half.palpable").stdout
    assert half.count("stored in half precision, which adds") == 2 and "inside" not in half, half
    programs.succeeds("reduce", store, "-o", folder / "plain.palpable")

    def figures(name):
        return json.loads(programs.succeeds("inspect", folder / name, "--json").stdout)
    whole, plain, small = figures("bar.palpable"), figures("plain.palpable"), figures("half.palpable")
    assert whole["volume_nodes"] == 63 and plain["volume_nodes"] == small["volume_nodes"] == 0
    assert plain["stress_rounding"] == 0 and 0 < small["stress_rounding"] < 2 ** -11, small["stress_rounding"]
    # The error of touches between sites is stored with the snapshots, whoever reduces them.
    assert 0.01 < whole["between_sites_error"] == plain["between_sites_error"] < 2, whole["between_sites_error"]
    sizes = [(folder / name).stat().st_size for name in ("bar.palpable", "plain.palpable", "half.palpable")]
    assert sizes[0] > sizes[1] > sizes[2], sizes
    # The live half opens both, because it draws only the boundary.
    for name in ("bar.palpable", "half.palpable"):
        result = programs.run("view", folder / name, "--out", folder / "pictures")
        assert result.returncode == 0 or "EGL" in result.stderr, result.stderr
    # Other programs get the volume.
    for name, cells in (("bar.palpable", 144), ("plain.palpable", 112)):
        out = folder / f"{name}.inside"
        programs.succeeds("export", folder / name, "--to", "vtu", "--site", "0", "-o", out)
        text = next(out.glob("*.vtu")).read_bytes()[:2000].decode(errors="replace")
        assert f'NumberOfCells="{cells}"' in text, text


@case("values between those of a parameter are solved afresh and compared, if asked")
def _(programs, folder):
    base.write_bar(folder, BLOCK.replace("count = 6", "count = 2").replace("levels = 6", "levels = 3") + base.UPPER_HALF)
    words = ("bake", "bar.toml", "-o", "bar.palpable", "--held-out")
    said = programs.succeeds(*words, cwd=folder).stdout
    found = re.findall(r"against 6 presses at upper = ([\d.]+), .*: displacement ([\d.e-]+) pooled", said)
    assert [value for value, _ in found] == ["0.75", "1.5"], said
    # A parabola through three values of a stiffness is less accurate than a solve, but better than a guess.
    assert all(1e-5 < float(error) < 0.1 for _, error in found), found
    assert (folder / "bar.between-upper/campaign.xdmf").exists()
    assert "held out, upper" in programs.succeeds("inspect", folder / "bar.palpable").stdout


@case("the job array of the Slurm example leaves nothing to solve")
def _(programs, folder):
    base.write_bar(folder, BLOCK)
    for i in (1, 2):
        env = dict(os.environ, SLURM_ARRAY_TASK_ID=str(i), SLURM_ARRAY_TASK_COUNT="2", SLURM_CPUS_PER_TASK="1",
                   PATH=f"{Path(programs.palpable).parent}:{os.environ['PATH']}")
        subprocess.run(["bash", base.ROOT / "examples/campaign.slurm", "bar.toml"], cwd=folder, env=env, check=True)
    said = programs.succeeds("bake", "bar.toml", "-o", "bar.palpable", cwd=folder).stdout
    assert "0 sites solved, 6 were there" in said, said


@case("mpirun with four ranks leaves the bytes of one process, and a killed rank loses nothing")
def _(programs, folder):
    mpirun = shutil.which("mpirun")
    if mpirun is None:
        print("SKIPPED: mpirun is not installed")
        return
    env = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    for name in ("one", "four"):
        base.write_bar(folder / name, LARGE)
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
    assert code != 0 or there == 60
    code, out, error = ranks(4)
    assert code == 0, error
    assert f"{60 - there} sites solved, {there} were there" in out, out
    assert files_of(folder / "four/bar.snapshots") == files_of(folder / "one/bar.snapshots")
    assert (folder / "four/bar.palpable").read_bytes() == (folder / "one/bar.palpable").read_bytes()
    # One error message, from the leading rank, and no rank waits for ever.
    (folder / "four/bar.toml").write_text(BLOCK.replace('"2 mm"', '"2 m"'))
    code, out, error = ranks(4)
    assert code != 0, out
    said = [line for line in error.splitlines() if line.startswith("palpable: ")]
    assert len(said) >= 1 and "past the centre of mass" in said[0], error


@case("a campaign with a third parameter is its product, and a body file holds all of it or one value")
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
    said = programs.succeeds("bake", toml, "-o", folder / "bar.palpable", "--set", "ratio=2").stdout
    assert "6 sites solved" in said and "one value of each parameter" in said, said
    assert len(list((folder / "bar.snapshots").glob("point_*_site_*.h5"))) == 6
    store = folder / "bar.snapshots"
    stiff = programs.succeeds("inspect", folder / "bar.palpable").stdout
    assert "ratio 2" in stiff, stiff
    programs.succeeds("reduce", store, "--set", "ratio=0.5", "-o", folder / "soft.palpable")
    assert "ratio 0.5" in programs.succeeds("inspect", folder / "soft.palpable").stdout
    # Without --set the parameter stays free, and the reader chooses its value.
    programs.succeeds("reduce", store, "-o", folder / "free.palpable")
    assert "ratio" in programs.succeeds("inspect", folder / "free.palpable").stdout
    programs.refuses("reduce", store, "--method", "pod", "-o", folder / "x.palpable",
                     says=["'pod' has no functions of 'ratio'", "--set ratio="])
    programs.refuses("reduce", store, "--method", "sparse-pgd", "-o", folder / "x.palpable",
                     says=["'sparse-pgd' has no functions of 'ratio'", "--set ratio="])
    programs.refuses("reduce", store, "--set", "ratio=3", "-o", folder / "x.palpable",
                     says=["'ratio' has no value 3", "0.5 1 2"])
    programs.refuses("reduce", store, "--set", "ears=1", "-o", folder / "x.palpable",
                     says=["no parameter 'ears'", "'ratio'"])


@case("a body learnt from a part of its snapshots is inspected, compared and played live")
def _(programs, folder):
    # The side x = 0 of the bar, its upper half: there the position of a press is a parameter.
    side = [9 * z + 3 * y + 1 for z in range(3, 7) for y in range(3)]
    deck = base.bar_deck().replace("NSET=TIP\n59\n", f"NSET=TIP\n{', '.join(map(str, side))}\n")
    base.write_bar(folder, base.BAR.replace("levels = 2", "levels = 4"), deck)
    programs.succeeds("bake", "bar.toml", "-o", "bar.palpable", cwd=folder)
    reduce, out = ("reduce", folder / "bar.snapshots"), ("-o", folder / "sparse.palpable")
    learn = (*reduce, *out, "--method", "sparse-pgd")
    said = programs.succeeds(*learn, "--part", "0.6").stdout
    assert re.search(r"^displacement: sparse-pgd, \d+ modes, error \S+ pooled, \S+ at the worst snapshot; learnt from 29 "
                     r"snapshots, of the 19 others \S+ pooled, \S+ at the worst$", said, re.M), said
    body = json.loads(programs.succeeds("inspect", folder / "sparse.palpable", "--json").stdout)
    assert body["basis"] == "global", body
    assert re.match(r"sparse-pgd \(learnt from 29 snapshots of 48, drawn at random with seed 1; where it is pressed is a "
                    r"quantity, y and z;", body["provenance"]["reduction"]), body["provenance"]
    first = (folder / "sparse.palpable").read_bytes()
    programs.succeeds(*learn, "--part", "0.6", "--seed", "2")
    assert (folder / "sparse.palpable").read_bytes() != first

    # That side penetrates a wall 0.441 m away by 2 mm; the wall presses it.
    clip = base.write_stereo(folder / "clip", frames=4)
    (clip / "scene.toml").write_text("press_static = true\ncamera_from_body = [0, 1, 0, 0,  0, 0, -1, 0.04,  -1, 0, 0, 0.433,  "
                                     "0, 0, 0, 1]\n")
    programs.succeeds("live", folder / "sparse.palpable", "--source", clip, "--out", folder / "out")
    touches = [json.loads(line) for line in (folder / "out/touches.jsonl").read_text().splitlines()]
    assert json.loads((folder / "out/live.json").read_text())["frames"] == 4
    assert touches and 0 <= touches[-1]["touches"][0]["site"] < 12 and touches[-1]["touches"][0]["level"] > 0.2, touches
    programs.succeeds("report", folder / "sparse.palpable", "-o", folder / "sparse.html")
    assert "error_all_together,displacement," in (folder / "sparse.csv").read_text()
    programs.succeeds("compare", folder / "bar.snapshots", folder / "sparse.palpable", "-o", folder / "c.html")
    assert "sparse.palpable (sparse-pgd)" in (folder / "c.csv").read_text()

    # Options of one method are refused with the other.
    for more, says in (((*learn, "--tolerance", "1e-3"), ["--tolerance", "sparse-pgd"]),
                       ((*learn, "--norm", "own"), ["--norm", "sparse-pgd"]),
                       ((*learn, "--part", "0.05"), ["0.05 of 48 snapshots are 2", "at least 5"]),
                       ((*learn, "--part", "1"), ["--part"]),
                       ((*reduce, *out, "--part", "0.5"), ["--part", "only --method sparse-pgd"]),
                       ((*reduce, *out, "--method", "pgd", "--seed", "3"), ["--seed", "only --method sparse-pgd"]),
                       (("compare", folder / "bar.snapshots", "--method", "sparse-pgd"), ["sparse-pgd"])):
        programs.refuses(*more, says=says)
    base.write_bar(folder, base.BAR + '[reduction]\nmethod = "sparse-pgd"\n')
    programs.refuses("bake", folder / "bar.toml", *out,
                     says=["'method' in [reduction] is 'sparse-pgd'", "palpable reduce --method sparse-pgd"])


@case("a bad parameter of a body is refused with its line")
def _(programs, folder):
    def refuses(parameter, *says):
        toml = base.write_bar(folder, BLOCK.replace("[support]", f"""
[[material.group]]
name = "upper"
set = "MIDDLE"
C1 = "10 kPa"
D1 = "40 kPa"
[[parameter]]
{parameter}
[support]"""))
        programs.refuses("bake", toml, "-o", folder / "bar.palpable", says=["bar.toml:", *says])

    refuses('name = "a"\nof = "uper"\nstiffness = [1, 2]', "'of'", "'uper'", "'upper'")
    refuses('name = "a"\nof = "upper"', "needs one of 'stiffness'")
    refuses('name = "a"\nof = "upper"\nstiffness = [2, 1]', "values that grow")
    refuses('name = "a"\nof = "upper"\nstiffness = "2"', "must be a list")
    refuses('name = "a"\nof = "upper"\npoisson = [0.1, 0.2]', "vary its 'stiffness'")
    refuses('name = "a"\nof = "body"\npoisson = [0.1, 0.6]', "0.6")
    refuses('name = "a"\nof = "body"\nyoung = [1, 2]', "young")
    refuses('name = "level"\nof = "body"\npoisson = [0.1]', "which every body has")
    refuses('name = "a"\nof = "upper"\nstiffness = [1]\nvalue = 2', "unknown key 'value'")


@case("bad shards, folders and values are refused in one line")
def _(programs, folder):
    toml = base.write_bar(folder, BLOCK)
    out = ("-o", folder / "bar.palpable")
    for shard in ("0/4", "5/4", "1", "1/4x", "a/b"):
        programs.refuses("bake", toml, *out, "--shard", shard, says=[f"--shard {shard}", "I/N"])
    programs.refuses("bake", toml, *out, "--set", "ratio", says=["--set ratio", "stiffness=2"])
    programs.refuses("reduce", folder / "none.snapshots", *out, says=["none.snapshots", "no such folder"])
    programs.refuses("reduce", folder, *out, says=["not a folder of snapshots"])
    programs.refuses("bake", toml, *out, "--snapshots", folder, says=["could be destroyed"])
    (folder / "other").mkdir()
    (folder / "other/letter.txt").write_text("of somebody")
    programs.refuses("bake", toml, *out, "--snapshots", folder / "other", says=["holds something else"])
    # A body file among the snapshots would replace one of them, or block the next site's file.
    programs.succeeds("bake", toml, *out, "--shard", "1/6")
    before = files_of(folder / "bar.snapshots")
    for name in ("campaign.h5", "site_0000.h5", "site_0005.h5", "../bar.snapshots/x"):
        programs.refuses("bake", toml, "-o", folder / "bar.snapshots" / name, "--snapshots", folder / "bar.snapshots",
                         says=[name, "lies in the folder of the snapshots"])
    assert files_of(folder / "bar.snapshots") == before
    for output in ("./x", "x", "../" + folder.name + "/x"):
        programs.refuses("bake", "bar.toml", "-o", output, "--snapshots", "x", cwd=folder, says=["name of its snapshots"])
    assert not (folder / "x").exists()
    (folder / "bad.snapshots").mkdir()
    (folder / "bad.snapshots/campaign.h5").write_bytes(b"palpable campaign, layout 9\n")
    programs.refuses("reduce", folder / "bad.snapshots", *out, says=["campaign.h5", "layout version '9'"])


def vtu_arrays(path):
    """Arrays of a grid as written by `palpable solve`: name -> (components, numbers)."""
    data = path.read_bytes()
    head, raw = data.split(b"<AppendedData", 1)
    raw = raw[raw.index(b"_") + 1:]
    arrays = {}
    for tag in re.findall(rb"<DataArray [^>]*>", head):
        field = {k.decode(): v.decode() for k, v in re.findall(rb'(\w+)="([^"]*)"', tag)}
        at = int(field["offset"])
        size = struct.unpack("<Q", raw[at:at + 8])[0]
        kind = {"Float64": "d", "Int32": "i", "UInt8": "B"}[field["type"]]
        count = size // struct.calcsize(kind)
        arrays[field["Name"]] = (int(field["NumberOfComponents"]),
                                 struct.unpack(f"<{count}{kind}", raw[at + 8:at + 8 + size]))
    return arrays


def rows_of(array):
    components, numbers = array
    return [numbers[i:i + components] for i in range(0, len(numbers), components)]


IMPORTED = base.BAR.replace('mesh = "bar.inp"\nunit = "mm"', 'mesh = "level_2.vtu"').replace(
    'set = "BASE"', "below = 0.01").replace('sets = "TIP"', 'points = ["0 mm", "0 mm", "60 mm"]')
MANIFEST = """body = "runs.toml"
[[field]]
name = "displacement"
[[field]]
name = "stress"
from = "cauchy_stress"
[[field]]
name = "von_mises"
[[snapshot]]
site = 0
level = 0.5
FIRST
[[snapshot]]
site = 0
force = "1.5 N"
SECOND
"""


def both(first, second):
    return MANIFEST.replace("FIRST", first).replace("SECOND", second)


@case("snapshots of others are taken over, whatever file they are in, and make the same body")
def _(programs, folder):
    bar = base.write_bar(folder)
    runs = folder / "runs"
    runs.mkdir()
    for level in (1, 2):
        programs.succeeds("solve", bar, "--level", level / 2, "-o", runs / f"level_{level}.vtu")
    (runs / "runs.toml").write_text(IMPORTED)

    def files(kind):
        return both(*(f'files = {{displacement = "u{n}.{kind}", stress = "s{n}.{kind}", '
                      f'von_mises = "m{n}.{kind}"}}' for n in (1, 2)))

    manifests = {"vtu": both('file = "level_1.vtu"', 'file = "level_2.vtu"'),
                 "vtk": both('file = "level_1.vtk"', 'file = "level_2.vtk"'),
                 "npy": files("npy"), "csv": files("csv")}
    manifests["csv"] = manifests["csv"].replace(
        'name = "displacement"', 'name = "displacement"\nfrom = ["x", "y", "z"]').replace(
        'from = "cauchy_stress"', 'from = ["1", "2", "3", "4", "5", "6"]').replace(
        'name = "von_mises"', 'name = "von_mises"\nfrom = "1"')
    for n in (1, 2):
        arrays = vtu_arrays(runs / f"level_{n}.vtu")
        for letter, name in (("u", "displacement"), ("s", "cauchy_stress"), ("m", "von_mises")):
            components, numbers = arrays[name]
            shape = f"({len(numbers) // components}, {components})"
            header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
            (runs / f"{letter}{n}.npy").write_bytes(
                b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header
                + struct.pack(f"<{len(numbers)}d", *numbers))
            rows = list(enumerate(rows_of(arrays[name])))
            random.Random(n).shuffle(rows)
            (runs / f"{letter}{n}.csv").write_text(
                ("node,x,y,z\n" if letter == "u" else "")
                + "".join(",".join(map(repr, (node, *row))) + "\n" for node, row in rows))
        points = rows_of(arrays["points"])
        text = ["# vtk DataFile Version 3.0", "t", "ASCII", "DATASET UNSTRUCTURED_GRID",
                f"POINTS {len(points)} double", *(" ".join(map(repr, p)) for p in reversed(points)),
                f"POINT_DATA {len(points)}", "FIELD f 3"]
        for name in ("displacement", "cauchy_stress", "von_mises"):
            rows = rows_of(arrays[name])
            text += [f"{name} {arrays[name][0]} {len(rows)} double",
                     *(" ".join(map(repr, row)) for row in reversed(rows))]
        (runs / f"level_{n}.vtk").write_text("\n".join(text) + "\n")
    stores = {}
    for kind, manifest in manifests.items():
        (runs / f"{kind}.toml").write_text(manifest)
        said = programs.succeeds("import-snapshots", runs, "--manifest", runs / f"{kind}.toml", "-o",
                                 folder / f"{kind}.snapshots").stdout
        assert "1 sites x 2 levels, displacement stress von_mises" in said, said
        stores[kind] = files_of(folder / f"{kind}.snapshots")
    for kind in manifests:
        assert stores[kind]["site_0000.h5"] == stores["vtu"]["site_0000.h5"], kind
    programs.succeeds("reduce", folder / "npy.snapshots", "-o", folder / "npy.palpable")
    text = programs.succeeds("inspect", folder / "npy.palpable").stdout
    assert "imported by npy.toml" in text, text


@case("a bad manifest or file of snapshots gives one clear error")
def _(programs, folder):
    bar = base.write_bar(folder)
    for level in (1, 2):
        programs.succeeds("solve", bar, "--level", level / 2, "-o", folder / f"level_{level}.vtu")
    (folder / "runs.toml").write_text(IMPORTED)
    good = both('file = "level_1.vtu"', 'file = "level_2.vtu"')

    def refuses(manifest, *says):
        (folder / "m.toml").write_text(manifest)
        programs.refuses("import-snapshots", folder, "--manifest", folder / "m.toml", "-o",
                         folder / "x.snapshots", says=says)

    refuses(good.replace("level = 0.5", "levle = 0.5"), "m.toml:11", "unknown key 'levle'", "did you mean 'level'?")
    refuses(good.replace("cauchy_stress", "cauchy_stres"), "level_", "'cauchy_stres'",
            "did you mean 'cauchy_stress'?")
    refuses(good.replace("level_1.vtu", "none.vtu"), "m.toml", "none.vtu: no such file")
    refuses(good.replace("level_1.vtu", "level_1.odb"), "level_1.odb", "no such file")
    refuses(good.replace("level = 0.5", "level = 1"), "the same site and level as")
    refuses(good.replace("site = 0\nlevel", "site = 3\nlevel"), "site 3", "sites 0 to 0")
    refuses(good.replace('force = "1.5 N"', ""), "needs 'force'")
    refuses(good.replace('name = "displacement"', 'name = "displacment"'), "displacement")
    refuses(good.replace('"level_1.vtu"', '"level_2.vtu"'),
            "has moved", "not more than")
    refuses(good.replace("from = \"cauchy_stress\"", "from = \"von_mises\""), "stress needs 6")
    (folder / "runs.toml").write_text(IMPORTED.replace("0 mm\", \"0 mm\", \"60 mm", "0 m\", \"0 kg\", \"60 mm"))
    refuses(good, "runs.toml", "kg")
    short = (folder / "level_1.vtu").read_bytes()[:-2000]
    (folder / "short.vtu").write_bytes(short)
    (folder / "runs.toml").write_text(IMPORTED)
    refuses(good.replace("level_1.vtu", "short.vtu"), "short.vtu", "cut short")


if __name__ == "__main__":
    sys.exit(base.main())
