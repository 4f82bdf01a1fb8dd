"""What tests of the Python package share: bodies that are baked once, and how skipped tests are named."""
import fcntl
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import palpable
import pytest

# Loaded into this process by now (run.py --sanitized); programs that tests start do without it.
os.environ.pop("LD_PRELOAD", None)

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests/cli"))
from installed import round_ball  # noqa: E402
from programs import TOUCHED_BALL  # noqa: E402


def work():
    """A folder that tests share, and that stays from run to run."""
    folder = Path(os.environ.get("PALPABLE_WORK", "/tmp/palpable-python-tests"))
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def baked(name, edge, young="60 kPa"):
    """A ball 100 mm high that may be touched anywhere, baked once for all test files."""
    folder = work() / name
    folder.mkdir(exist_ok=True)
    file, program = folder / f"{name}.palpable", shutil.which("palpable-bake")
    if program is None:
        pytest.skip("palpable-bake is not in PATH")
    with open(folder / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not file.exists() or file.stat().st_mtime < Path(program).stat().st_mtime:
            (folder / "ball.off").write_text(round_ball())
            text = TOUCHED_BALL.replace('"12 mm"', f'"{edge}"').replace("60 kPa", young).replace('"ball"', f'"{name}"')
            (folder / f"{name}.toml").write_text(text)
            subprocess.run([program, "-q", "bake", folder / f"{name}.toml", "-o", file], check=True, capture_output=True)
    return file


@pytest.fixture(scope="session")
def ball():
    """A coarse ball."""
    return baked("ball", "14 mm")


@pytest.fixture(scope="session")
def hard_ball():
    return baked("hard", "14 mm", "150 kPa")


@pytest.fixture
def session(ball):
    with palpable.Body(ball) as body, palpable.Session(body) as opened:
        yield opened


def finger(depth=0.004, x=0.0, y=0.0):
    """One capsule of 8 mm, so deep in the top of the ball."""
    z = 0.1 + 0.008 - depth
    return np.array([[x, y, z, x, y, z + 0.06, 0.008, 0.008]])


def flat_hand(height, count=25):
    """WebXR's joints of a right hand flat above the ball, palm down: X towards the fingers, Y to the thumb."""
    joints = np.zeros((25, 3))
    joints[0] = -0.09, 0, 0
    for k in range(4):
        joints[1 + k] = -0.07 + 0.03 * k, 0.03 + 0.01 * k, 0
    for f in range(4):
        for k, way in enumerate((-0.078, 0, 0.048, 0.078, 0.0965)):
            joints[5 + 5 * f + k] = way, 0.025 - 0.02 * f, 0
    joints[:, 2] = height
    if count == 26:  # OpenXR begins with the palm
        return np.vstack([(joints[10] + joints[11])[None] / 2, joints])
    if count == 21:  # MediaPipe has no metacarpals of the fingers
        return np.delete(joints, [5, 10, 15, 20], axis=0)
    return joints


@pytest.fixture
def hostile_threads(monkeypatch):
    """Python switches threads as often as it can."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(interval)


def pytest_terminal_summary(terminalreporter):
    """Lines as tools/run_tests.py reads them."""
    for report in terminalreporter.stats.get("skipped", []):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        print(f"SKIPPED: {reason.removeprefix('Skipped: ')} (in '{report.nodeid.split('::')[-1]}')")


def pytest_sessionfinish(session, exitstatus):
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if exitstatus == 0 and reporter.stats.get("skipped") and not reporter.stats.get("passed"):
        session.exitstatus = 77
