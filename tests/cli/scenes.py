#!/usr/bin/env python3
"""Several bodies on one desk: the text of a scene, and clip, loop and score, which name each body."""
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case


def body(name, file, more=""):
    return f'[[body]]\nname = "{name}"\nfile = "{file}"\n{more}'


def scene(folder, *bodies, name="desk.toml"):
    path = folder / name
    path.write_text("".join(bodies))
    return path


def two_balls(programs, folder):
    """One ball of 100 mm, and one of half that size 90 mm to the right of it, in another colour."""
    ball = programs.small_body()
    return scene(folder, body("large", ball),
                 body("small", ball, 'beside = "large"\nscale = 0.5\nat = ["90 mm", "0 mm", "0 mm"]\n'
                                     "color = [200, 120, 80]\n"))


@case("what a scene cannot mean is refused with its file, line and key")
def _(programs, folder):
    ball = programs.small_body()
    (folder / "frames").mkdir()
    source = ("--source", folder / "frames", "--place", "0 0.04 0.42 0 0 0", "--out", folder / "out")
    for text, says in ((body("a", ball, "colour = [1, 2, 3]\n"), ["desk.toml:4", "'colour'", "'color'"]),
                       (body("a", ball) + body("a", ball), ["desk.toml", "'a'"]),
                       (body("a", ball, 'beside = "b"\n'), ["desk.toml", "beside", "'b'"]),
                       (body("a", "none.palpable", 'description = "body.toml"\n'),
                        ["none.palpable", "'a'", "palpable bake", "body.toml"]),
                       ("[camera]\n", ["desk.toml"])):
        programs.refuses("live", scene(folder, text), *source, says=says)
    two = scene(folder, body("a", ball), body("b", ball, 'beside = "a"\nat = ["60 mm", "0 mm", "0 mm"]\n'))
    base.write_stereo(folder / "clip")
    for words in (("live", two, "--source", folder / "clip", *source[2:]),
                  ("synth", "press", "--scene", two, "--frames", "70", "-o", folder / "film")):
        result = programs.run(*words)
        if "EGL" in result.stderr:
            continue
        assert result.returncode == 1 and "'a'" in result.stderr and "'b'" in result.stderr, (words, result.stderr)
    programs.refuses("live", ball, two, *source, says=["desk.toml"])
    programs.refuses("live", two, *source, "--scale", "2", says=["--scale"])


@case("a scene file holds options of live, the command line overrides them, and --print-config prints it again")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    options = 'source = "clip"\nplace = [0, 0.04, 0.42, 0, 0, 0]\npaint = "displacement"\nforces = true\nout = "out"\n'
    file = scene(folder, options, body("ball", programs.small_body()))
    (folder / "elsewhere").mkdir()
    programs.succeeds("live", file, cwd=folder / "elsewhere")  # paths are from the file's folder
    plain = json.loads((folder / "out/live.json").read_text())
    assert plain["frames"] == 3, plain
    programs.succeeds("live", file, "--out", folder / "other", "--place", "0 0.04 0.5 0 0 0", "--frames", 2)
    other = json.loads((folder / "other/live.json").read_text())
    assert other["frames"] == 2 and other["bodies"][0]["camera_from_body"][11] == 0.5, other["bodies"]
    # What is printed is a scene file that amounts to the same.
    printed = programs.succeeds("live", file, "--opaque", "--colors", "viridis", "--print-config", cwd=folder).stdout
    for line in ('paint = "displacement"', "forces = true", "opaque = true", 'colors = "viridis"', f'source = "{folder / "clip"}"', 'name = "ball"'):
        assert line in printed.splitlines(), printed
    again = scene(folder, printed, name="again.toml")
    assert programs.succeeds("live", again, "--print-config", cwd=folder).stdout == printed
    programs.succeeds("live", again, "--overwrite", cwd=folder)
    repeated = json.loads((folder / "out/live.json").read_text())
    assert repeated["bodies"][0]["camera_from_body"] == plain["bodies"][0]["camera_from_body"], repeated["bodies"]
    # A call with a body file amounts to a scene file, too.
    printed = programs.succeeds("live", programs.small_body(), "--source", folder / "clip", "--scale", "0.5", "--print-config").stdout
    assert "scale = 0.5" in printed and printed.count("[[body]]") == 1, printed
    for more, says in (('piant = "none"\n', ["desk.toml:1", "'piant'", "'paint'"]), ('paint = "red"\n', ["desk.toml:1", "red"]),
                       ("frames = 0\n", ["desk.toml:1", "--frames"]), ('anchor = "plane"\n', ["desk.toml", "'anchor'", "exclude"]),
                       ("forces = 1\n", ["desk.toml:1", "forces", "true or false"]), ("source = 1979-05-27\n", ["desk.toml:1"])):
        base_text = options if not more.startswith(("source", "forces", "paint")) else ""
        programs.refuses("live", scene(folder, more + base_text, body("ball", programs.small_body())), says=says)


@case("two bodies are filmed, played and scored, each by its name")
def _(programs, folder):
    desk, clip, out = two_balls(programs, folder), folder / "clip", folder / "out"
    result = programs.run("synth", "press", "--scene", desk, "--frames", "110", "--seed", "3", "-o", clip)
    if result.returncode != 0 and "EGL" in result.stderr:
        print("SKIPPED: no OpenGL here: " + result.stderr.strip())
        return
    assert result.returncode == 0, result.stderr
    for name in ("large", "small"):
        assert (clip / "truth/bodies" / name / "contact.jsonl").exists()
    programs.succeeds("live", desk, "--source", clip / "frames", "--write", "+meshes", "--out", out)
    summary = json.loads((out / "live.json").read_text())
    assert [one["name"] for one in summary["bodies"]] == ["large", "small"], summary["bodies"]
    assert [one["scale"] for one in summary["bodies"]] == [1, 0.5], summary["bodies"]
    touched = [json.loads(line) for line in (out / "touches.jsonl").read_text().splitlines()]
    assert touched and all(line["body"] == "large" for line in touched), "the hand presses the first body"
    poses = [json.loads(line) for line in (out / "pose.jsonl").read_text().splitlines()]
    assert {line["body"] for line in poses} == {"large", "small"}
    for name in ("large", "small"):
        assert (out / "meshes" / name / "rest.ply").exists()
    score = json.loads(programs.succeeds("score", clip / "truth", out, "--json").stdout)
    large, small = score["bodies"]["large"], score["bodies"]["small"]
    assert large["frames_touching"] > 0 and large["touch_recall"] > 0.8, large
    assert small["frames_touching"] == 0 and not small["touch_false_discovery_5mm"], small
    # A repetition gives the same result.
    programs.succeeds("live", desk, "--source", clip / "frames", "--write", "+meshes", "--out", folder / "again")
    for file in ("touches.jsonl", "pose.jsonl"):
        assert (out / file).read_bytes() == (folder / "again" / file).read_bytes(), file


if __name__ == "__main__":
    sys.exit(base.main())
