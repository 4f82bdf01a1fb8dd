#!/usr/bin/env python3
"""with_wall_clip.py PROGRAM [WORDS...]: runs the program; {clip} among the words is replaced by a folder of
stereo pairs of a wall 0.441 m away. Its scene.toml places a body of 0.1 m so that the wall penetrates and
presses it."""
import subprocess
import sys
import tempfile
from pathlib import Path

from programs import write_stereo

SCENE = "press_static = true\ncamera_from_body = [1, 0, 0, 0,  0, 0, -1, 0.04,  0, 1, 0, 0.42,  0, 0, 0, 1]\n"


def main():
    words = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        if "{clip}" in words:
            clip = write_stereo(Path(folder) / "clip")
            (clip / "scene.toml").write_text(SCENE)
            words = [str(clip) if word == "{clip}" else word for word in words]
        return subprocess.run(words).returncode


if __name__ == "__main__":
    sys.exit(main())
