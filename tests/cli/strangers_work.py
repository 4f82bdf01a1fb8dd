#!/usr/bin/env python3
"""Outputs that are what their names say, and work that is not lost: what is finished, recorded or somebody else's stays."""
import json
import os
import random
import re
import shlex
import shutil
import signal
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from events import touched_body
from interruptions import wait_for, write_long_clip
from recordings import states_of, write_clip
from with_wall_clip import SCENE

base.CASES.clear()
case = base.case

# A ball that is baked in seconds, with all stages of the tables of touch.
STAGED = base.BALL.replace('edge = "12 mm"', 'edge = "20 mm"').replace('"none"', '"full"\nregions = 2\nheld_out = 1')
PARAMETER = '\n[[parameter]]\nname = "hardness"\nof = "body"\nstiffness = [0.5, 1, 2]\n'


def facts(programs, body):
    return json.loads(programs.succeeds("inspect", body, "--json").stdout)


def stage(programs, body):
    """The stage that a body file states; None for a finished one."""
    return facts(programs, body).get("stage")


def without_gl(result):
    if result.returncode != 0 and "EGL" in result.stderr:
        print("SKIPPED: no OpenGL here: " + result.stderr.strip())
        return True
    return False


# ---- outputs that are what their name says -------------------------------------------------------


@case("the ending of a mesh decides its format, and each format is read again as the same mesh")
def _(programs, folder):
    base.write_ball(folder)
    begins = {"msh": b"$MeshFormat", "vtu": b'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid"', "inp": b"** palpable mesh\n*NODE"}
    for order in (1, 2):
        said = {}
        for ending, begin in begins.items():
            mesh = f"ball{order}.{ending}"
            programs.succeeds("mesh", "ball.off", "-o", mesh, "--height", "100mm", "--edge", "20mm", "--order", order, cwd=folder)
            assert (folder / mesh).read_bytes().startswith(begin), (mesh, (folder / mesh).read_bytes()[:80])
            text = re.sub(r"\[shape\].*\[material\]", f'[shape]\nmesh = "{mesh}"\n[material]', base.BALL.replace("depth = 0.08", "depth = 0.05"), flags=re.S)
            (folder / f"{ending}.toml").write_text(text)
            solved = json.loads(programs.succeeds("solve", f"{ending}.toml", "--level", "0.3", "-o", "x.vtu", "--json", cwd=folder).stdout)
            solved.pop("seconds")
            said[ending] = solved
        assert said["msh"] == said["vtu"] == said["inp"], said


@case("an output whose name says another format is refused before the work, with the ending to use")
def _(programs, folder):
    base.write_ball(folder)
    base.write_stereo(folder / "clip", frames=2)
    body = shutil.copy(programs.small_body(), folder / "b.palpable")
    store = programs.work / "ball.snapshots"
    files = {
        ("mesh", "ball.off"): ((".stl", ".vtk", ""), ".msh or .vtu or .inp"),
        ("solve", "ball.toml"): ((".stl", ".txt", ""), ".vtu"),
        ("bake", "ball.toml"): ((".h5", ".vtu", ".json", ""), ".palpable"),
        ("reduce", store): ((".h5", ".npy", ""), ".palpable"),
        ("report", body): ((".json", ".palpable", ""), ".html or .htm"),
        ("compare", body): ((".png", ""), ".html or .htm"),
        ("export", body, "--to", "xdmf"): ((".vtu", ".h5", ".pxdmf", ""), ".xdmf or .xmf"),
        ("export", body, "--to", "pxdmf"): ((".xdmf", ".vtu", ""), ".pxdmf"),
        ("calibrate", "clip", "--square", "25mm"): ((".json", ".xml", ""), ".yml or .yaml"),
        ("scan", "clip"): ((".stl", ".png", ""), ".ply"),
        ("scan", "clip", "-o", "room.ply", "--picture"): ((".jpg", ".ply", ""), ".png"),
    }
    for words, (endings, right) in files.items():
        for ending in endings:
            option = () if words[-1] == "--picture" else ("-o",)
            programs.refuses(*words, *option, f"x{ending}", cwd=folder, says=[f"x{ending}: what is written is a", f"ends in {right}; call it x{right.split()[0]}"])
    programs.succeeds("export", body, "--to", "numpy", "-o", "modes", cwd=folder)
    programs.refuses("import-modes", "modes", "-o", "x.h5", cwd=folder, says=["ends in .palpable"])
    for words, name in ((("export", body, "--to", "vtu"), "x.vtu"), (("export", body, "--to", "numpy"), "x.npy"),
                        (("export", body, "--to", "numpy"), "x.npz"), (("merge", store), "x.h5"), (("view", body), "x.png"),
                        (("synth", "press", "--frames", "1"), "x.mp4"),
                        (("bake", "ball.toml", "-o", "b2.palpable", "--snapshots"), "x.h5"),
                        (("live", body, "--source", "clip", "--out"), "x.mp4"), (("live", body, "--source", "clip", "--out"), "x.json"),
                        (("live", "--preview", "--source", "clip", "--out"), "x.avi")):
        option = () if words[-1] in ("--out", "--snapshots") else ("-o",)
        programs.refuses(*words, *option, name, cwd=folder, says=[name, "folder"])
        assert not (folder / name).exists(), name
    programs.refuses("reproduce", "beams", "-o", folder / "x.html", cwd=base.ROOT, says=["x.html", "folder"])
    programs.refuses("live", body, "--source", "clip", "--record", "x.mp4", cwd=folder, says=["--record x.mp4", ".palprec"])
    assert sorted(path.name for path in folder.glob("x*")) == [], list(folder.glob("x*"))


@case("right names of outputs are taken: every ending that is offered, and folders with dots")
def _(programs, folder):
    base.write_ball(folder)
    base.write_stereo(folder / "clip", frames=2)
    body = programs.small_body()
    for words, name in ((("export", body, "--to", "xdmf"), "x.xdmf"), (("export", body, "--to", "xdmf"), "x.xmf"),
                        (("export", body, "--to", "pxdmf"), "x.pxdmf"), (("export", body, "--to", "numpy"), "run.2"),
                        (("export", body, "--to", "vtu", "--site", "0"), "2026.11.29"), (("report", body), "x.htm"),
                        (("report", body), "a.b.html"), (("reduce", programs.work / "ball.snapshots"), "nu_0.4.palpable")):
        said = programs.succeeds(*words, "-o", name, cwd=folder)
        assert (folder / name).exists() and "warning" not in said.stderr, said.stderr
    # A folder of somebody's that has the name of a file is a folder.
    (folder / "old.vtu").mkdir()
    programs.succeeds("export", body, "--to", "vtu", "--site", "0", "-o", "old.vtu", cwd=folder)


@case("export does what --set and --site ask, in every format, or refuses it")
def _(programs, folder):
    bar = base.write_bar(folder, base.BAR + PARAMETER)
    body = folder / "bar.palpable"
    programs.succeeds("bake", bar, "-o", body)
    axes = lambda name: (folder / name / "parameters.txt").read_text().splitlines()
    programs.succeeds("export", body, "--to", "numpy", "-o", folder / "all")
    assert axes("all") == ["site choice", "level quantity", "hardness quantity"], axes("all")
    programs.succeeds("export", body, "--to", "numpy", "--set", "hardness=1.5", "-o", folder / "one")
    assert axes("one") == ["site choice", "level quantity"], axes("one")
    programs.succeeds("export", body, "--to", "pxdmf", "-o", folder / "all.pxdmf")
    programs.succeeds("export", body, "--to", "pxdmf", "--set", "hardness=1.5", "-o", folder / "one.pxdmf")
    text = lambda name: (folder / name).read_text()
    assert "hardness" in text("all.pxdmf") and "hardness" not in text("one.pxdmf")
    # The modes at one value give the body at this value.
    programs.succeeds("import-modes", folder / "one", "-o", folder / "again.palpable")
    pressed = [json.loads(programs.succeeds("press", file, "--load", f"0,0,0.06={force}", *more, "--json").stdout)["largest_displacement_m"]
               for file, force, more in ((body, 0.01, ("--set", "hardness=1.5")), (body, 0.01, ("--set", "hardness=0.5")))]
    assert pressed[1] > 2.5 * pressed[0] > 0, pressed
    for to in ("numpy", "pxdmf"):
        programs.refuses("export", body, "--to", to, "--site", "0", "-o", folder / f"x.{to}" if to == "pxdmf" else folder / "x",
                         says=["--site 0", "of all sites together", "--to vtu"])
    # Of snapshots.
    store = folder / "bar.snapshots"
    programs.succeeds("export", store, "--to", "numpy", "-o", folder / "s_all")
    programs.succeeds("export", store, "--to", "numpy", "--set", "hardness=2", "-o", folder / "s_one")
    units = lambda name: sorted(path.name for path in (folder / name).glob("unit_*_displacement.npy"))
    assert len(units("s_all")) == 3 and units("s_one") == ["unit_00002_displacement.npy"], (units("s_all"), units("s_one"))
    programs.succeeds("export", store, "--to", "vtu", "--set", "hardness=0.5", "--site", "0", "-o", folder / "s_vtu")
    assert all(path.name.startswith("unit_00000_") for path in (folder / "s_vtu").iterdir())
    programs.refuses("export", store, "--to", "vtu", "--set", "hardness=3", "-o", folder / "x", says=["'hardness' has no value 3"])
    programs.refuses("export", store, "--to", "vtu", "--site", "7", "-o", folder / "x", says=["--site 7", "sites 0 to 0"])
    assert not (folder / "x").exists()


@case("a parameter that is not there, or a value that is no number, is refused everywhere before the work")
def _(programs, folder):
    bar = base.write_bar(folder, base.BAR + PARAMETER)
    programs.succeeds("bake", bar, "-o", folder / "bar.palpable")
    base.write_stereo(folder / "clip", frames=2)
    body, store = folder / "bar.palpable", folder / "bar.snapshots"
    plain = programs.small_body()
    takers = [("export", body, "--to", to, "-o", folder / out) for to, out in (("numpy", "n"), ("pxdmf", "x.pxdmf"), ("vtu", "v"), ("xdmf", "x.xdmf"))]
    takers += [("export", store, "--to", "numpy", "-o", folder / "n"), ("export", store, "--to", "vtu", "-o", folder / "v"),
               ("view", body, "--out", folder / "p"), ("press", body, "--load", "0,0,0.06=0.01"),
               ("live", body, "--source", folder / "clip", "--place", "0 0.04 0.42 0 0 0", "--out", folder / "out"),
               ("reduce", store, "-o", folder / "r.palpable"), ("compare", store, "-o", folder / "c.html"),
               ("bake", bar, "-o", folder / "other.palpable", "--snapshots", folder / "other"), ("bake", bar, "--estimate")]
    wrongs = (("ears=1", "ears"), ("hardness=nan", "--set hardness=nan"), ("hardness=1e9", "hardness"), ("a=nan", "--set a=nan"),
              ("hardness=inf", "--set hardness=inf"), ("hardness=", "--set hardness="), ("hardness", "--set hardness"), ("=1", "--set =1"))
    for k, words in enumerate(takers):
        # Each is given an unknown name and the reported a=nan; the other ways to be wrong take turns.
        for wrong, says in {wrongs[0], wrongs[3], wrongs[k % len(wrongs)]}:
            programs.refuses(*words, "--set", wrong, says=[says])
    for words in takers[0], takers[6]:
        programs.refuses(*words, "--set", "hardness=1", "--set", "hardness=2", says=["--set hardness=2", "has a value already"])
    # A body without parameters, or no snapshots at all.
    for words in (("export", plain, "--to", "numpy", "-o", folder / "n"), ("view", plain, "--out", folder / "p")):
        programs.refuses(*words, "--set", "a=1", says=["'a' is no parameter"])
    programs.refuses("compare", body, "--set", "hardness=1", "-o", folder / "c.html", says=["--set hardness=1", "no"])
    made = [name for name in ("n", "v", "p", "x.pxdmf", "x.xdmf", "r.palpable", "c.html", "other", "other.palpable") if (folder / name).exists()]
    assert made == [], made
    # The right ones are taken without a word.
    for words in (takers[0], takers[5], ("press", body, "--load", "0,0,0.06=0.01")):
        said = programs.succeeds(*words, "--set", "hardness=1")
        assert "warning" not in said.stderr, said.stderr


# ---- what is somebody else's ---------------------------------------------------------------------


@case("--overwrite removes a run's files, and nothing that somebody put beside them")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    out = folder / "out"
    words = base.live(programs, folder, "--write", "+meshes", "--frame-pictures", "all")
    programs.succeeds(*words)
    mine = ["notes.txt", "depth/notes.txt", "depth/mine.png", "depth/00.png", "visible/a/000000.png", "meshes/mine.ply",
            "pictures/holiday.png", "more/000000.png", "live.json.bak"]
    for name in mine:
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_text("mine")
    (out / "depth/000007.png").write_text("of an earlier, longer run")
    assert (out / "depth/000002.png").exists() and (out / "meshes/000002.ply").exists() and (out / "pictures/000002.png").exists()
    programs.succeeds(*base.live(programs, folder, "--overwrite", "--frames", "1", "--write=-masks"))
    assert all((out / name).read_text() == "mine" for name in mine)
    left = sorted(str(path.relative_to(out)) for path in out.rglob("*") if path.is_file() and str(path.relative_to(out)) not in mine)
    assert [name for name in left if "/" in name] == ["depth/000000.png"], left
    # What has the name of a run's file but is a folder is in the way, before anything is removed.
    (out / "touch.mp4").unlink()
    (out / "touch.mp4").mkdir()
    programs.refuses(*base.live(programs, folder, "--overwrite"), says=["touch.mp4: is a folder and in the way"])
    assert (out / "depth/000000.png").exists() and (out / "live.json").exists()


@case("results are not written among a source's images, and a source inside the output is kept")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=2)
    before = sorted(folder.rglob("*"))
    for inside in ("clip/left", "clip", "clip/left/out", "clip/out", "clip/../clip/right"):
        programs.refuses(*base.live(programs, folder)[:-1], folder / inside, says=[inside, "is read by this run"])
        programs.refuses("live", "--preview", "--source", folder / "clip", "--out", folder / inside, says=[inside, "is read by this run"])
    by_name = ("live", programs.small_body(), "--source", "clip/left/*.png", "--right", "clip/right/*.png", "--calibration",
               "clip/rectified.yml", "--place", "0 0.04 0.42 0 0 0", "--out")
    programs.refuses(*by_name, "clip/left", cwd=folder, says=["clip/left: is read by this run"])
    programs.refuses(*by_name, "clip/right", "--overwrite", cwd=folder, says=["clip/right: is read by this run"])
    programs.refuses("scan", "clip", "-o", "room.ply", "--picture", "clip/left/000100.png", cwd=folder, says=["clip/left", "is read by this run"])
    assert sorted(folder.rglob("*")) == before
    # Right ones: beside the clip, around it, and in a folder within that of images by name.
    for out in ("out", ".", "clip/left/more"):
        programs.succeeds(*by_name, out, cwd=folder)
        assert (folder / out / "live.json").exists()
    # The next run reads depth/ of the earlier output, which --overwrite would remove.
    programs.refuses(*by_name, "out", "--overwrite", "--depth-source", "out/depth/*.png", cwd=folder, says=["out"])
    programs.refuses("live", programs.small_body(), "--source", "clip/left/*.png", "--depth-source", "out/depth/*.png", "--calibration",
                     "clip/rectified.yml", "--place", "0 0.04 0.42 0 0 0", "--out", "out", "--overwrite", cwd=folder,
                     says=["out/depth", "is needed by this run"])
    assert (folder / "out/depth/000001.png").exists()


@case("a new film of the synthetic desk leaves what somebody put beside the old one, and two runs do not mix")
def _(programs, folder):
    body = shutil.copy(programs.small_body(), folder / "b.palpable")
    env = os.environ | {"XDG_CACHE_HOME": str(folder / "cache")}
    words = ("live", body, "--source", "synthetic", "--frames", "2", "--record")

    def is_filming():
        return any(folder.glob("cache/palpable/desk-*/frames/left/*.jpg"))
    first = programs.start(*words, folder / "1.palprec", env=env)
    try:
        wait_for(first, is_filming)
    except AssertionError as error:
        if "EGL" in str(error):
            print("SKIPPED: no OpenGL here: " + str(error))
            return
        raise
    first.send_signal(signal.SIGSTOP)  # it would otherwise finish before the other has begun
    wait_for(first, lambda: all(path.read_text().rpartition(")")[2].split()[0] == "T" for path in Path(f"/proc/{first.pid}/task").glob("*/stat")))
    clip, = folder.glob("cache/palpable/desk-*")
    filmed = sorted(clip.rglob("*"))
    second = programs.start(*words, folder / "2.palprec", env=env)
    said = second.communicate()[1]
    assert second.returncode == 1 and f"{clip}: another run is writing into it" in said, said
    assert sorted(clip.rglob("*")) == filmed, set(filmed) ^ set(clip.rglob("*"))
    first.kill()
    first.communicate()
    (clip / "frames/left/notes.txt").write_text("mine")
    third = programs.start(*words, folder / "3.palprec", env=env)
    wait_for(third, lambda: len(list(clip.glob("frames/left/*.jpg"))) > 2)
    third.kill()
    third.communicate()
    assert (clip / "frames/left/notes.txt").read_text() == "mine"


# ---- bakes ---------------------------------------------------------------------------------------


@case("a finished body stays whole at 20 random moments at which its re-bake is killed")
def _(programs, folder):
    base.write_ball(folder, STAGED)
    body = folder / "ball.palpable"
    words = ("bake", "ball.toml", "-o", "ball.palpable")
    begin = time.monotonic()
    programs.succeeds(*words, cwd=folder)
    takes = time.monotonic() - begin
    seed = random.SystemRandom().randrange(10**6)
    print(f"seed {seed}; a bake takes {takes:.1f} s")
    moments = random.Random(seed)
    stayed = 0
    for k in range(20):
        finished = body.read_bytes()
        (folder / "ball.toml").write_text(STAGED.replace("60 kPa", f"{61 + k} kPa"))  # another body each time
        process = programs.start(*words, cwd=folder)
        time.sleep(moments.uniform(0.02, 1.0) * takes)
        process.send_signal(moments.choice((signal.SIGKILL, signal.SIGTERM, signal.SIGINT)))
        process.communicate()
        if body.read_bytes() == finished:
            stayed += 1
            continue
        # It was replaced, by one that is as good.
        found = facts(programs, body)
        assert "stage" not in found and found["touch"]["response_order"] == 3 and found["touch"]["held_out"], found
        assert f"{61 + k}" in found["material"] or f"{6.1 + k / 10:g}e+04" in found["material"], found["material"]
    print(f"{stayed} of 20 kept the earlier body, the others had just finished")
    assert stayed >= 5, stayed
    # No part of a body is left under the body's name or beside it.
    assert stage(programs, body) is None
    programs.succeeds(*words, cwd=folder)
    assert stage(programs, body) is None


@case("a first bake publishes its stages, live and inspect say which, and it goes on to the whole body")
def _(programs, folder):
    base.write_ball(folder, STAGED.replace("regions = 2", "regions = 6"))
    base.write_stereo(folder / "clip", frames=2)
    body = folder / "ball.palpable"
    words = ("bake", "ball.toml", "-o", "ball.palpable")
    process = programs.start(*words, cwd=folder)
    wait_for(process, body.exists)
    process.kill()
    process.communicate()
    found = stage(programs, body)
    assert found in ("reduced", "linear", "tables"), found
    first = programs.succeeds("inspect", body).stdout.splitlines()[0]
    assert "its bake has not ended" in first, first
    run = programs.succeeds("live", body, "--source", folder / "clip", "--place", "0 0.04 0.42 0 0 0", "--out", folder / "out")
    said = [line for line in run.stderr.splitlines() if "its bake has not ended" in line]
    assert len(said) == 1 and "the same command goes on: palpable bake ball.toml -o ball.palpable" in said[0], run.stderr
    print(said[0])
    # Taken up again it never falls behind the stage that is there.
    ranks = ["reduced", "linear", "tables", None]
    process = programs.start(*words, cwd=folder)
    seen = [found]
    while process.poll() is None:
        now = stage(programs, body)
        assert ranks.index(now) >= ranks.index(seen[-1]), (seen, now)
        seen.append(now)
    assert process.returncode == 0, process.communicate()
    process.communicate()
    assert stage(programs, body) is None
    assert "has not ended" not in programs.succeeds("inspect", body).stdout
    again = programs.succeeds("live", body, "--source", folder / "clip", "--place", "0 0.04 0.42 0 0 0", "--out", folder / "out", "--overwrite")
    assert "has not ended" not in again.stderr, again.stderr


@case("--until linear makes a stage, and does not replace a body that is baked further")
def _(programs, folder):
    base.write_ball(folder, STAGED)
    body = folder / "ball.palpable"
    words = ("bake", "ball.toml", "-o", "ball.palpable")
    programs.succeeds(*words, "--until", "linear", cwd=folder)
    assert stage(programs, body) == "linear"
    base.write_stereo(folder / "clip", frames=2)
    run = programs.succeeds("live", body, "--source", folder / "clip", "--place", "0 0.04 0.42 0 0 0", "--out", folder / "out")
    assert "the same without --until goes on" in run.stderr, run.stderr
    programs.succeeds(*words, "--until", "linear", cwd=folder)  # as good as what is there
    programs.succeeds(*words, cwd=folder)
    finished = body.read_bytes()
    assert stage(programs, body) is None
    programs.refuses(*words, "--until", "linear", cwd=folder, says=["ball.palpable: holds a body that is baked further"])
    assert body.read_bytes() == finished
    # A finished body without tables is what was asked for, and may replace it; it says so at once.
    said = programs.succeeds(*words, "--no-touch", cwd=folder)
    assert "ball.palpable: stays as it is until this bake is finished" in said.stderr, said.stderr
    assert stage(programs, body) is None and facts(programs, body)["touch"] is None
    # A description whose tables end with the linear ones is finished with them.
    (folder / "ball.toml").write_text(base.TOUCHED_BALL.replace('edge = "12 mm"', 'edge = "20 mm"'))
    programs.succeeds(*words, "--until", "linear", cwd=folder)
    assert stage(programs, body) is None


@case("who ends a bake reads what is kept and the command that goes on, which does")
def _(programs, folder):
    text = base.BALL.replace("levels = 5", "levels = 24").replace('edge = "12 mm"', 'edge = "8 mm"')
    for number in (signal.SIGINT, signal.SIGTERM):
        inside = folder / f"my bodies {number}"
        base.write_ball(inside, text)
        words = ("bake", "ball.toml", "-o", inside / "ball.palpable")
        process = programs.start(*words, cwd=inside)
        wait_for(process, lambda: list((inside / "ball.snapshots").glob("site_*.h5")))
        process.send_signal(number)
        said = process.communicate()[1].splitlines()
        assert process.returncode == -number, (process.returncode, said)
        line, = [line for line in said if line.startswith("palpable: ")]
        print(line)
        assert "stopped; what is done is kept in" in line and "ball.snapshots" in line, line
        command = shlex.split(line[line.index("palpable bake "):])
        assert command == ["palpable", *map(str, words)], command
    goes_on = programs.succeeds(*command[1:], cwd=inside).stdout
    solved, there = map(int, re.search(r"(\d+) sites solved, (\d+) were there", goes_on).groups())
    assert there >= 1 and solved + there == 6, goes_on
    # A bake that ends by itself says nothing of that.
    assert "stopped" not in goes_on


# ---- recordings ----------------------------------------------------------------------------------


def recorded(programs, folder, name="a.palprec", *more):
    return programs.start("live", touched_body(programs), "--source", folder / "clip", "--record", folder / name, *more)


def write_endless_clip(folder):
    write_long_clip(folder)
    (folder / "scene.toml").write_text(SCENE)


def is_under_way(file):
    return lambda: file.exists() and file.stat().st_size > 1_000_000


@case("of two recordings into one new file at once one is refused, and the other is what it says")
def _(programs, folder):
    write_clip(folder / "clip")
    file = folder / "a.palprec"
    for more in ((), ("--overwrite",)):
        file.unlink(missing_ok=True)
        ended = [(p.communicate(), p.returncode) for p in [recorded(programs, folder, "a.palprec", *more) for _ in range(2)]]
        good = [printed for printed, code in ended if code == 0]
        bad = [printed[1] for printed, code in ended if code != 0]
        assert len(good) >= 1, ended
        assert all("a.palprec: is there already" in said or "a.palprec: another run is writing it" in said for said in bad), bad
        assert len(bad) == 1 or more, ended  # with --overwrite the second may begin when the first has ended
        replayed = programs.succeeds("replay", file).stdout
        frames = {re.search(r"a\.palprec: (\d+) frames", printed[0])[1] for printed in good}
        assert frames == {"12"} and "12 of 12 states of the live run: equal" in replayed, (frames, replayed)
        assert states_of(replayed) in [states_of(printed[0]) for printed in good]


@case("a second run does not touch a recording that is being written, with --overwrite or without")
def _(programs, folder):
    write_endless_clip(folder / "clip")
    first = recorded(programs, folder)
    wait_for(first, is_under_way(folder / "a.palprec"))
    words = ("live", touched_body(programs), "--source", folder / "clip", "--record", folder / "a.palprec")
    programs.refuses(*words, says=["a.palprec", "is there already"])
    programs.refuses(*words, "--overwrite", says=["a.palprec: another run is writing it"])
    first.send_signal(signal.SIGINT)
    printed = first.communicate()
    assert first.returncode == 0, printed
    frames = int(re.search(r"a\.palprec: (\d+) frames", printed[0])[1])
    result = programs.succeeds("replay", folder / "a.palprec")
    assert states_of(result.stdout) == states_of(printed[0]) and frames >= int(states_of(printed[0])[1]), (printed, result)


@case("a recording that is removed, replaced or cut off while it is written is said to be lost")
def _(programs, folder):
    write_endless_clip(folder / "clip")
    write_clip(folder / "short/clip")
    other = recorded(programs, folder / "short")
    assert other.communicate() and other.returncode == 0
    file = folder / "a.palprec"

    def replace():
        file.unlink()
        shutil.copy(folder / "short/a.palprec", file)
    for meanwhile, says in ((file.unlink, "No such file"), (replace, "holds 12 frames"), (lambda: os.truncate(file, 5000), "a.palprec")):
        file.unlink(missing_ok=True)
        process = recorded(programs, folder)
        wait_for(process, is_under_way(file))
        meanwhile()
        process.send_signal(signal.SIGINT)
        printed, said = process.communicate()
        line = said.splitlines()[-1]
        print(line)
        assert process.returncode == 1 and line.startswith("palpable: ") and says in line, (process.returncode, said)
        assert "frames were written to" in line and "was changed while it was recorded" in line, line
        assert "replay plays it" not in printed, printed


# As bitcoin-like "checkpoint overwritten by a partial one" reports: RevBayes #930, camfort #172.
@case("a run that fails before its first frame leaves the recording that --overwrite would have replaced")
def _(programs, folder):
    write_clip(folder / "clip")
    assert recorded(programs, folder).communicate() and (folder / "a.palprec").exists()
    whole = (folder / "a.palprec").read_bytes()
    for eye in ("left", "right"):
        for picture in (folder / "clip" / eye).glob("*.png"):
            if picture.stem != "000000":
                picture.write_bytes(b"no picture")
    words = ("live", touched_body(programs), "--source", folder / "clip", "--record")
    broken = folder / "clip/left/000000.png"
    size = broken.read_bytes()
    broken.write_bytes(size[:len(size) // 2])
    said = programs.run(*words, folder / "a.palprec", "--overwrite")
    assert said.returncode == 1, said
    assert (folder / "a.palprec").read_bytes() == whole
    said = programs.run(*words, folder / "new.palprec")
    assert said.returncode == 1 and not (folder / "new.palprec").exists(), said


# ---- refinement ----------------------------------------------------------------------------------


@case("a description for --refine that cannot be used is refused at the start, whatever its size")
def _(programs, folder):
    write_clip(folder / "clip", frames=3)
    body = touched_body(programs)
    words = ("live", body, "--source", folder / "clip", "--out", folder / "out", "--refine")
    good = (body.parent / "ball.toml").read_text()
    with open(folder / "huge.toml", "wb") as file:
        file.truncate(5_000_000_000)  # a sparse file
    (folder / "typo.toml").write_text(good.replace("young", "yung"))
    (folder / "text.toml").write_text("not = a description = at all\n")
    (folder / "away.toml").write_text(good)  # without its ball.off
    shutil.copy(body.parent / "ball.off", folder / "shape.off")
    for name, says in (("huge.toml", ["huge.toml"]), ("typo.toml", ["typo.toml", "yung"]),
                       ("text.toml", ["text.toml"]), ("away.toml", ["ball.off: no such file"]), ("shape.off", ["shape.off"]),
                       (body, ["ball.palpable: is a baked body"]), ("none.toml", ["none.toml", "no file"])):
        begin = time.monotonic()
        programs.refuses(*words, folder / name, says=["--refine", *says])
        assert time.monotonic() - begin < 20
    assert not (folder / "out").exists()
    said = programs.succeeds(*words, body.parent / "ball.toml")
    assert "--refine" not in said.stderr, said.stderr


if __name__ == "__main__":
    sys.exit(base.main())
