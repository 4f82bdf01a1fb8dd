"""Programs of examples/python: each runs as its first lines say, and ends in a picture."""
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

EXAMPLES = ROOT / "examples/python"


@pytest.fixture(autouse=True)
def needs_matplotlib():
    pytest.importorskip("matplotlib", reason="the Debian package python3-matplotlib is not installed")


def run(name, *words):
    assert f"python3 {name} " in (EXAMPLES / name).read_text().split('"""')[1]
    result = subprocess.run([sys.executable, EXAMPLES / name, *map(str, words)], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    picture = Path(words[-1])
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    import matplotlib.pyplot as plt

    pixels = plt.imread(picture)
    assert min(pixels.shape[:2]) >= 300 and np.ptp(pixels[..., :3]) > 0.5, "something is drawn"
    return result.stdout


def test_the_force_of_a_finger_grows_with_its_depth(ball, tmp_path):
    assert re.match(r"[\d.]+ N at 8 mm", run("force_over_depth.py", ball, tmp_path / "picture.png"))


def test_a_body_of_harder_rubber_is_stiffer(ball, hard_ball, tmp_path):
    said = run("compare_bodies.py", ball, hard_ball, tmp_path / "picture.png")
    soft, hard = (float(re.search(rf"{name}: (\d+) N/m", said)[1]) for name in ("ball", "hard"))
    assert hard / soft == pytest.approx(150 / 60, rel=0.02), "both are linear in Young's modulus"


def test_a_hand_of_a_file_touches(ball, tmp_path):
    said = run("hand_to_touches.py", ball, EXAMPLES / "hand.csv", tmp_path / "picture.png")
    assert int(re.match(r"(\d+) touches in 31 frames", said)[1]) > 5


def test_a_force_device_leans_on_a_body_and_holds_still(ball, tmp_path):
    said = run("force_device.py", ball, tmp_path / "picture.png")
    last, most = (float(number) for number in re.match(r"([\d.]+) N at [\d.]+ mm, ([\d.]+) N at most; 2999 ticks", said).groups())
    assert 0.5 < last < most < 2 * last, "it leans, was shaken, and does not shake any more"


def test_snapshots_become_modes_whose_error_falls(tmp_path):
    pytest.importorskip("h5py", reason="the Debian package python3-h5py is not installed")
    said = run("snapshots_to_modes.py", tmp_path / "picture.png")
    errors = [float(error) for error in re.findall(r"relative error (\S+)", said)]
    assert len(errors) == 3 and max(errors) <= 1e-5
