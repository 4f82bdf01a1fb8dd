#!/usr/bin/env python3
"""docs/tutorial.md, command by command: a cube in place of the duck, a rendered desk in place of the camera, no window."""
import re
import shlex
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case

PAGE = base.ROOT / "docs" / "tutorial.md"
BOARD_POSES = [(0.4, 0.0, 0.03, 0.0, 0.40), (-0.4, 0.1, 0.05, 0.02, 0.42), (0.0, 0.5, 0.0, -0.02, 0.40),
               (0.1, -0.5, 0.06, 0.01, 0.42), (0.3, 0.3, 0.03, 0.04, 0.45), (-0.3, -0.3, 0.02, -0.03, 0.38),
               (0.35, -0.25, 0.07, 0.0, 0.43), (-0.1, 0.2, 0.0, 0.03, 0.36)]


def blocks(text):
    """(language, content) of each fenced block, in order."""
    return re.findall(r"^```(\w+)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def as_tested(words):
    """Replaces the camera by the rendered desk and the printed board by the rendered one, and removes --window."""
    other = {"/dev/video0": "desk/frames", "9x6": "7x4", "25mm": "30mm"}
    replaced = [other.get(word, word) for word in words if word != "--window"]
    if "/dev/video0" in words:  # the clip has its own calibration
        at = replaced.index("--calibration")
        del replaced[at:at + 2]
    return replaced


@case("every command of the tutorial does what the page says")
def _(programs, folder):
    base.write_stl(folder / "duck.stl", base.cube(-50, 50))
    base.write_boards(folder / "boards", BOARD_POSES)
    ran = 0
    for language, content in blocks(PAGE.read_text()):
        if language == "toml":
            name = content.splitlines()[0].lstrip("# ")
            (folder / name).write_text(content)
            continue
        assert language == "sh", language
        for line in content.strip().splitlines():
            words = shlex.split(line)
            assert words[0] == "palpable", line
            result = programs.run(*as_tested(words[1:]), cwd=folder)
            if "EGL" in result.stderr:
                print("SKIPPED: no OpenGL here: " + result.stderr.strip())
                return
            if words[1] == "cameras":
                continue  # there may be no camera
            assert result.returncode == 0, f"{line}\n{result.stdout}\n{result.stderr}"
            print(line, "|", result.stdout.strip().splitlines()[-1:] or "")
            ran += 1
    assert ran > 12, ran
    for made in ("duck.palpable", "duck.html", "duck_pictures/contact_sheet.png", "first/touch.mp4",
                 "first/pictures/000100.png", "calibration.yml", "touch.palprec", "again/touch.mp4",
                 "mine.palprec", "as_printed/live.json", "desk/truth/deformed", "duck_presses"):
        assert (folder / made).exists(), made
    assert (folder / "first/touches.jsonl").read_text(), "the duck was never touched"


if __name__ == "__main__":
    sys.exit(base.main())
