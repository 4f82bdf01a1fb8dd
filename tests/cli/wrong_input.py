#!/usr/bin/env python3
"""Invalid options and files: an error in one line that names the cause, or tolerated."""
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case


@case("numbers of options that are not finite are refused by their option")
def _(programs, folder):
    body = programs.small_body()
    for value in ("nan", "inf", "-inf", "1e999"):
        for words in (("view", body, "--out", folder / "x", "--level"),
                      ("view", body, "--close-after"),
                      ("live", body, "--source", folder, "--out", folder / "x", "--scale"),
                      ("solve", folder / "a.toml", "-o", folder / "x.vtu", "--level"),
                      ("reduce", folder, "-o", folder / "x.palpable", "--tolerance")):
            # A value that begins with "-" is recognized as a value only after "=".
            said = programs.refuses(*words[:-1], f"{words[-1]}={value}", says=[words[-1], value, "finite"])
            assert ".cpp" not in said, said
        for words in (("scan", folder, "-o", folder / "x.ply", "--voxel"), ("calibrate", "--source", folder, "--square"),
                      ("mesh", folder / "a.off", "-o", folder / "x.msh", "--edge")):
            for length in (value, f"{value}mm"):
                programs.refuses(*words[:-1], f"{words[-1]}={length}", says=[words[-1], length])
        programs.refuses("view", body, "--out", folder / "x", f"--set=heat={value}", says=["--set", "heat"])
        programs.refuses("press", body, "--load", f"0,0,{value}=1", says=["--load", "finite"])
        programs.refuses("press", body, "--load", f"0,0,0={value}", says=["--load", "finite"])
    for value in ("abc", "-1", "1,5"):  # and not the largest double, in 308 digits
        programs.refuses("view", body, f"--site={value}", says=[f"--site: must be 0 or more, not '{value}', see"])
        programs.refuses("view", body, f"--close-after={value}", says=["--close-after: "])
    programs.refuses("view", body, "--close-after=0", says=["--close-after: must be above 0, not '0'"])
    assert not (folder / "x").exists()


@case("shards and sizes that no integer holds are refused")
def _(programs, folder):
    base.write_ball(folder)
    for shard in ("1/99999999999", "0/4", "5/4", "1/4294967297", "1", "1/2/3", "a/b", "1/100001"):
        programs.refuses("bake", folder / "ball.toml", "-o", folder / "x.palpable", "--shard", shard,
                         says=[f"--shard {shard}: must be I/N"])
    for size in ("4294968576x720", "nanx3", "640x-1", "640", "640x480x2"):
        programs.refuses("view", programs.small_body(), "--out", folder / "x", "--size", size,
                         says=[f"--size {size}"])
        programs.refuses("scan", "/dev/video9", "-o", folder / "x.ply", f"--size={size}", says=[f"--size {size}"])


@case("a shape handed to bake or solve is answered with a description to begin with")
def _(programs, folder):
    base.write_ball(folder)
    for command, result in (("bake", "x.palpable"), ("solve", "x.vtu")):
        said = programs.run(command, folder / "ball.off", "-o", folder / result)
        *description, refusal = said.stderr.splitlines()
        assert said.returncode == 1 and said.stdout == "" and len(description) == 5, said.stderr
        assert refusal.startswith(f"palpable: {folder}/ball.off: is a shape") and "ball.toml" in refusal, refusal
        found = tomllib.loads("\n".join(description))
        assert found["name"] == "ball" and found["shape"] == {"surface": "ball.off", "unit": "m", "edge": "100 mm"}, found
    body = programs.small_body()
    for command, result in (("bake", "x.palpable"), ("solve", "x.vtu")):
        programs.refuses(command, body, "-o", folder / result, says=[f"{body}: is a baked body", "BODY.toml"])
        programs.refuses(command, folder, "-o", folder / result, says=[f"{folder}: is a folder", "BODY.toml"])
    with open(folder / "large.toml", "wb") as file:
        file.truncate(5_000_000_000)  # a sparse file
    programs.refuses("bake", folder / "large.toml", "-o", folder / "x.palpable", says=["large.toml: line 1: a zero byte"])
    programs.refuses("bake", folder / "none.stl", "-o", folder / "x.palpable", says=["none.stl: no such file"])
    (folder / "bad.stl").write_text("solid\nnothing\n")
    programs.refuses("bake", folder / "bad.stl", "-o", folder / "x.palpable", says=["bad.stl: "])


@case("what goes wrong is said with the file or the option that it is about")
def _(programs, folder):
    base.write_ball(folder, base.BALL.replace('up = "z"', 'up = "z"\nwrap = "10 mm"'))
    (folder / "ball.off").write_text(re.sub("^0 0 -?1$", "0 0 0", base.octahedron(), flags=re.M))
    programs.refuses("bake", folder / "ball.toml", "-o", folder / "x.palpable", says=["ball.off: ", "no height"])
    base.write_ball(folder)
    inside = "sphere 8mm at 0,0,0.05 to 0,0,0.04"
    programs.refuses("solve", folder / "ball.toml", "--obstacle", inside, "-o", folder / "x.vtu",
                     says=[f"--obstacle '{inside}': the obstacle lies inside the body"])
    for option in ("--largest-reprojection", "--largest-row-error"):
        programs.refuses("calibrate", "--source", folder, f"{option}=-1", says=[option, "above 0"])


@case("a press past the centre of mass is refused with the site, by bake and by solve")
def _(programs, folder):
    base.write_ball(folder, base.BALL.replace("depth = 0.08", "depth = 0.95"))
    for command, result in (("bake", "x.palpable"), ("solve", "x.vtu")):
        programs.refuses(command, folder / "ball.toml", "-o", folder / result,
                         says=["ball.toml: a press of 0.088", "'depth' in [press]", "push site ", " at (",
                               "past the centre of mass", "ask for a depth below 0."])
        assert not (folder / result).exists()


@case("too few places for sites are explained setting by setting")
def _(programs, folder):
    base.write_ball(folder, base.BALL.replace("above = 0.5", "above = 0.97"))
    programs.refuses("bake", folder / "ball.toml", "-o", folder / "x.palpable",
                     says=["ball.toml: only", "'count' in [sites] is 6", "lie lower than 'above' in [sites]",
                           "lower 'above'"])
    base.write_ball(folder, base.BALL.replace("[press]", "patch = 20\n[press]").replace("above = 0.5", "above = 0"))
    programs.refuses("bake", folder / "ball.toml", "-o", folder / "x.palpable",
                     says=["ball.toml: only 0 of", "'patch' in [sites]: 20 edges", "[support] holds",
                           "make 'patch' smaller"])


@case("texts that would overflow a parser's stack are refused with file and line")
def _(programs, folder):
    body = programs.small_body()
    deep = 60_000
    base.write_stereo(folder / "clip")
    (folder / "deep.yml").write_text("%YAML:1.0\nimage_width: " + "[" * deep)
    programs.refuses("live", body, "--source", folder / "clip", "--out", folder / "out", "--place", "0 0 0.4 0 0 0",
                     "--calibration", folder / "deep.yml", says=["deep.yml: line 2: nested more than 64 deep"])
    for text in ("name = " + "[" * deep, "a" + ".a" * deep + " = 1", "[" + "a." * deep + "a]"):
        (folder / "deep.toml").write_text("# a body\n" + text + "\n")
        programs.refuses("bake", folder / "deep.toml", "-o", folder / "x.palpable",
                         says=["deep.toml:2: nested more than 64 deep"])
        (folder / "clip/scene.toml").write_text("# a scene\n" + text + "\n")
        programs.refuses("live", body, "--source", folder / "clip", "--out", folder / "out",
                         says=["scene.toml: line 2: nested more than 64 deep"])
    (folder / "clip/scene.toml").unlink()
    (folder / "deep.vtu").write_text("<VTKFile>\n" + "<a>" * deep)
    (folder / "mesh.toml").write_text(base.BAR.replace("bar.inp", "deep.vtu"))
    programs.refuses("bake", folder / "mesh.toml", "-o", folder / "x.palpable",
                     says=["deep.vtu: line 2: nested more than 64 deep"])
    (folder / "deep.pxdmf").write_text("<Xdmf>\n" + "<a>" * deep)
    programs.refuses("import-modes", folder / "deep.pxdmf", "-o", folder / "x.palpable",
                     says=["deep.pxdmf: line 2: nested more than 64 deep"])
    base.write_truth(folder / "truth")
    base.write_result(folder / "result")
    (folder / "result/touches.jsonl").write_text('{"frame":0}\n{"frame":' + "[" * deep + "\n")
    programs.refuses("score", folder / "truth", folder / "result",
                     says=["touches.jsonl: line 2: nested more than 64 deep"])


@case("a name of many stars is matched before anybody gets impatient")
def _(programs, folder):
    (folder / ("a" * 200 + ".png")).write_bytes(b"")
    programs.refuses("scan", folder / ("*a" * 40 + "*b.png"), "-o", folder / "x.ply", says=["no image is called"],
                     timeout=60)  # trying all distributions of 200 letters among 40 stars would take for ever


def on_small_disk(programs, limit, *words, cwd=None):
    """No file may grow beyond the limit, as with ulimit -f."""
    def prepare():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    return subprocess.run([programs.palpable, *map(str, words)], capture_output=True, text=True, preexec_fn=prepare,
                          stdin=subprocess.DEVNULL, timeout=120, cwd=cwd)


def bytes_of(path):
    """The content of a file, or of all files in a folder by their names; None if there is none."""
    if path.is_dir():
        return {inner.name: inner.read_bytes() for inner in path.iterdir()}
    return path.read_bytes() if path.exists() else None


@case("a full disk ends every command with one line, and what was there stays as it was")
def _(programs, folder):
    base.write_ball(folder)
    body = programs.small_body()
    shutil.copy(body, folder / "b.palpable")
    programs.succeeds("export", body, "--to", "numpy", "-o", folder / "modes")
    for name, *words in (("a.msh", "mesh", "ball.off"), ("a.vtu", "solve", "ball.toml"),
                         ("a.palpable", "reduce", programs.work / "ball.snapshots", "--method", "pod"),
                         ("m.palpable", "import-modes", "modes"),
                         ("a.html", "report", "b.palpable"), ("c.html", "compare", "b.palpable"),
                         ("vtu", "export", "b.palpable", "--to", "vtu", "--site", "1"),
                         ("numpy", "export", "b.palpable", "--to", "numpy")):
        output = folder / name
        for before in (False, True):
            if before:
                programs.succeeds(*words, "-o", name, cwd=folder)
            there = bytes_of(output)
            result = on_small_disk(programs, 100, *words, "-o", name, cwd=folder)
            said = [line for line in result.stderr.splitlines() if line.startswith("palpable: ")]
            assert result.returncode == 1 and len(said) == 1, (words, result.returncode, result.stderr)
            assert name in said[0] and "cannot be written: File too large" in said[0], said
            # In a folder, files that fit may remain.
            assert before or not output.is_dir() or all(len(data) <= 100 for data in bytes_of(output).values())
            assert bytes_of(output) == there or (output.is_dir() and not before), (words, before)
            assert not list(folder.rglob("*.part*")), list(folder.rglob("*.part*"))


@case("what cannot be printed is an error, and what is printed goes into no file")
def _(programs, folder):
    base.write_ball(folder)
    body = programs.small_body()
    for words in (("inspect", body), ("inspect", "--json", body), ("--help",), ("solve", folder / "ball.toml", "-o", folder / "x.vtu")):
        with open("/dev/full", "w") as full:
            result = subprocess.run([programs.palpable, *map(str, words)], stdout=full, stderr=subprocess.PIPE, text=True,
                                    stdin=subprocess.DEVNULL, timeout=120)
        assert result.returncode == 1, (words, result)
        assert result.stderr.splitlines()[-1] == "palpable: what is printed cannot be written: No space left on device", result
    # The next file that a program opens gets the number of a closed stream.
    base.write_stereo(folder / "clip", frames=3)
    closed = {"stdin": None, "timeout": 120, "preexec_fn": lambda: [os.close(stream) for stream in (0, 1, 2)]}
    mesh = (programs.palpable, "mesh", folder / "ball.off", "-o")
    for name, options in (("open.msh", {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}), ("closed.msh", closed)):
        assert subprocess.run([*mesh, folder / name], **options).returncode == 0, name
    assert (folder / "open.msh").read_bytes() == (folder / "closed.msh").read_bytes()
    assert subprocess.run([programs.palpable, *map(str, base.live(programs, folder))], **closed).returncode == 0
    header, *rows = (folder / "out/timing.csv").read_text().splitlines()
    assert len(rows) == 3 and all(len(row.split(",")) == len(header.split(",")) for row in rows), rows
    assert json.loads((folder / "out/live.json").read_text())["frames"] == 3


@case("what a command reads is not what it writes over, whichever command it is")
def _(programs, folder):
    base.write_ball(folder)
    shutil.copy(programs.small_body(), folder / "b.palpable")
    shutil.copytree(programs.work / "ball.snapshots", folder / "b.snapshots")
    programs.succeeds("export", "b.palpable", "--to", "pxdmf", "-o", "b.pxdmf", cwd=folder)
    (folder / "pose.txt").write_text("0 0 0 0.2 0 0 0 1\n")
    (folder / "link").symlink_to("ball.off")
    shutil.copy(folder / "ball.off", folder / "cup.off")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    solve = ("solve", "ball.toml", "--obstacle", "cup.off", "--poses", "pose.txt")
    for words, output in ((solve, "ball.off"), (solve, "cup.off"), (solve, "pose.txt"), (solve, "link"), (solve, "ball.toml"),
                          (("reduce", "b.snapshots"), "b.snapshots/campaign.h5"),
                          (("import-modes", "b.pxdmf"), "b.pxdmf"), (("compare", "b.palpable"), "b.palpable"),
                          (("export", "b.palpable", "--to", "pxdmf"), "b.palpable"),
                          (("mesh", "ball.off"), "./link"), (("report", "b.palpable"), "b.palpable")):
        programs.refuses(*words, "-o", output, cwd=folder, says=[output, "is read as input"])
    programs.refuses("bench", "beam", "ball.toml", "-o", "ball.off", cwd=folder, says=["is read as input"])
    # The name of the table beside a page was not given by the user.
    (folder / "b.csv").write_text("time,force\n0,1\n")
    for words in (("report", "b.palpable"), ("compare", "b.palpable", "-o", "b.html")):
        programs.refuses(*words, cwd=folder, says=["b.csv: is somebody's", "another name"])
    assert (folder / "b.csv").read_text() == "time,force\n0,1\n" and not (folder / "b.html").exists()
    (folder / "b.csv").unlink()
    for words in (("report", "b.palpable"), ("compare", "b.palpable", "-o", "b.html"), ("report", "b.palpable")):
        programs.succeeds(*words, cwd=folder)  # its own files are replaced
    # The same holds for the file with an export's arrays.
    for kind in ("xdmf", "pxdmf"):
        arrays = folder / f"mine.{kind}.h5"
        arrays.write_text("of somebody")
        programs.refuses("export", "b.palpable", "--to", kind, "-o", f"mine.{kind}", cwd=folder,
                         says=[f"{arrays.name}: is there", "somebody's", "another"])
        assert arrays.read_text() == "of somebody" and not (folder / f"mine.{kind}").exists()
        for _ in range(2):
            programs.succeeds("export", "b.palpable", "--to", kind, "-o", f"own.{kind}", cwd=folder)
        # Arrays without their light file are somebody's, also those of the right format.
        other = folder / f"other.{kind}.h5"
        other.write_bytes((folder / f"own.{kind}.h5").read_bytes())
        programs.refuses("export", "b.palpable", "--to", kind, "-o", f"other.{kind}", cwd=folder, says=[f"is there without other.{kind}"])
        assert other.read_bytes() == (folder / f"own.{kind}.h5").read_bytes() and not (folder / f"other.{kind}").exists()
    for words in (("export", "b.palpable", "--to", "numpy"), ("export", "b.snapshots", "--to", "vtu"),
                  ("import-snapshots", ".", "--manifest", "ball.toml")):
        programs.refuses(*words, "-o", ".", cwd=folder, says=["could be destroyed"])
    assert {path: path.read_bytes() for path in before} == before
    assert not list(folder.rglob("*.part*"))


@case("a file larger than memory is named at once, by what it begins with or by its size")
def _(programs, folder):
    base.write_ball(folder)
    shutil.copytree(programs.work / "ball.snapshots", folder / "b.snapshots")
    programs.succeeds("export", programs.small_body(), "--to", "numpy", "-o", folder / "modes")
    for kind in ("stl", "ply", "obj", "off", "3ds", "msh", "inp", "vtu", "vtk", "palpable"):
        with open(folder / f"large.{kind}", "wb") as file:
            file.truncate(1 << 43)  # a sparse file
    for damaged in ("modes/vertices.npy", "b.snapshots/site_0001.h5"):
        with open(folder / damaged, "r+b") as file:
            file.truncate(1 << 43)
    zero = "line 1: a zero byte"
    for kind, says in (("stl", "no triangles are announced"), ("ply", "a PLY file begins with 'ply'"), ("obj", zero), ("off", zero),
                       ("3ds", "not a 3DS file")):
        programs.refuses("mesh", f"large.{kind}", "-o", "x.msh", cwd=folder, says=[f"large.{kind}: ", says])
    for kind, says in (("msh", zero), ("inp", zero), ("vtu", "not XML"), ("vtk", "not a legacy file of VTK")):
        (folder / "large.toml").write_text(base.BAR.replace("bar.inp", f"large.{kind}"))
        programs.refuses("bake", "large.toml", "-o", "x.palpable", cwd=folder, says=[f"large.{kind}: {says}"])
    programs.refuses("inspect", "large.palpable", cwd=folder, says=["large.palpable: not a body file"])
    # These two begin as they should, and have another size than they announce.
    says = "8796093 MB, where"
    programs.refuses("import-modes", "modes", "-o", "x.palpable", cwd=folder, says=[f"vertices.npy: {says}"])
    programs.refuses("reduce", "b.snapshots", "-o", "x.palpable", cwd=folder, says=["site_0001.h5", "truncated or damaged"])


@case("a folder without write permission is named before the work")
def _(programs, folder):
    base.write_ball(folder)
    for command in ("bake", "solve"):  # /proc accepts no files, not even from root
        programs.refuses(command, folder / "ball.toml", "-o", "/proc/x", says=["/proc/x: cannot be written: "])
    programs.refuses("mesh", folder / "ball.off", "-o", "/proc/x", says=["/proc/x: cannot be written: "])
    programs.refuses("scan", folder, "-o", "/proc/x.ply", says=["/proc/x.ply: cannot be written: "])


@case("a body that is larger than what the camera sees is said before the run")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=2)
    words = base.live(programs, folder)
    result = programs.succeeds(*words)
    assert "larger than" not in result.stderr, result.stderr
    result = programs.succeeds(*words[:-1], folder / "large", "--scale", "1000")
    warning = result.stderr.splitlines()[0]
    assert warning.startswith("warning: the body is ") and "larger than what the camera sees" in warning, result.stderr


@case("a body that stands outside of the camera's picture is reported before the run, with its position")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=2)
    words = base.live(programs, folder)
    assert "does not see" not in programs.succeeds(*words).stderr
    place = words.index("--place") + 1
    result = programs.succeeds(*words[:place], "3 0 0.5 0 0 0", *words[place + 1:-1], folder / "beside")
    warning = result.stderr.splitlines()[0]
    assert warning.startswith("warning: the camera does not see where the body stands: 3 m to the right"), result.stderr


@case("an export to a full disk says so, leaves what was there and ends in order")
def _(programs, folder):
    body = programs.small_body()
    for kind in ("xdmf", "pxdmf"):
        for before in (False, True):
            if before:
                programs.succeeds("export", body, "--to", kind, "-o", folder / f"a.{kind}")
            there = {path.name: path.read_bytes() for path in folder.iterdir()}
            for limit in (0, 500, 5_000, 60_000):
                result = on_small_disk(programs, limit, "export", body, "--to", kind, "-o", folder / f"a.{kind}")
                said = result.stderr.splitlines()
                assert result.returncode == 1 and len(said) == 1, (limit, result.returncode, result.stderr)
                assert re.match(rf"palpable: {folder}/a\.{kind}(\.h5)?: .*cannot be written.*File too large", said[0]), said
                assert {path.name: path.read_bytes() for path in folder.iterdir()} == there, limit
        for path in folder.iterdir():
            path.unlink()


@case("a body whose name is no UTF-8 leaves a summary that is JSON")
def _(programs, folder):
    base.write_stereo(folder / "clip")
    body = os.fsencode(folder) + b"/caf\xe9.palpable"
    with open(body, "wb") as file:
        file.write(programs.small_body().read_bytes())
    out = os.fsencode(folder) + b"/out \xff"
    result = subprocess.run([programs.palpable, "live", body, "--source", folder / "clip", "--place",
                             "0 0.04 0.42 0 0 0", "--out", out], capture_output=True, stdin=subprocess.DEVNULL,
                            timeout=280)
    assert result.returncode == 0 or b"EGL" in result.stderr, result.stderr
    if result.returncode != 0:
        print("SKIPPED: no OpenGL context")
        return
    with open(out + b"/live.json", "rb") as file:
        summary = json.loads(file.read().decode("utf-8"))
    assert summary["body"].endswith("caf\ufffd.palpable"), summary["body"]
    result = subprocess.run([programs.palpable, "inspect", "--json", body], capture_output=True, timeout=60)
    assert json.loads(result.stdout.decode("utf-8"))["name"] == "ball", result.stdout


@case("names with marks of XML come out of an export as they went in")
def _(programs, folder):
    import xml.etree.ElementTree as xml
    name = "a & b <c> \"d\" 'e'"
    for kind in ("xdmf", "pxdmf"):
        programs.succeeds("export", programs.small_body(), "--to", kind, "-o", folder / f"{name}.{kind}")
        tree = xml.parse(folder / f"{name}.{kind}")
        items = [item.text for item in tree.iter("DataItem")]
        assert items and all(text.startswith(f"{name}.{kind}.h5:/") for text in items), items[:3]
    programs.succeeds("import-modes", folder / f"{name}.pxdmf", "-o", folder / "again.palpable")
    for kind in ("xdmf", "pxdmf"):  # in UTF-8 there is no such name
        output = os.fsencode(folder) + b"/caf\xe9." + kind.encode()
        result = subprocess.run([programs.palpable, "export", programs.small_body(), "--to", kind, "-o", output],
                                capture_output=True, timeout=60)
        assert result.returncode == 1 and b"XML cannot hold this name" in result.stderr, result
        assert not os.path.exists(output) and not os.path.exists(output + b".h5")


if __name__ == "__main__":
    sys.exit(base.main())
