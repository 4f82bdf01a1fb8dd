#!/usr/bin/env python3
"""What a live run writes, and what not: one case, one test, as in programs.py. `--list` names the cases."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case


def without_out(programs, folder, *more):
    words = list(base.live(programs, folder, *more))
    at = words.index("--out")
    del words[at:at + 2]
    return words


@case("live without --out plays, writes nothing and says at the end what happened")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    before = sorted(folder.rglob("*"))
    # No window and no files: nothing is drawn, so it needs no OpenGL and no display.
    result = programs.succeeds(*without_out(programs, folder), cwd=folder)
    assert "3 frames in" in result.stdout and "touch.mp4" not in result.stdout, result.stdout
    assert "live" in result.stderr and "100 %" in result.stderr, result.stderr
    assert sorted(folder.rglob("*")) == before, "something was written"
    for option in ("--pictures", "--meshes", "--no-masks", "--no-depth", "--overwrite"):
        programs.refuses(*without_out(programs, folder, option), says=[option, "--out"])
    words = without_out(programs, folder)
    words[words.index("--source") + 1] = "synthetic"
    programs.refuses(*words, cwd=folder, says=["synthetic", "--out"])
    assert sorted(folder.rglob("*")) == before, "something was written"


@case("live without --out shows itself in a window and writes nothing")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    before = sorted(folder.rglob("*"))
    result = base.on_screen(programs, *without_out(programs, folder, "--window"))
    if result is None:
        return
    assert result.returncode == 0, result.stderr
    assert "3 frames in" in result.stdout, result.stdout
    assert sorted(folder.rglob("*")) == before, "something was written"


if __name__ == "__main__":
    sys.exit(base.main())
