"""docs/python.md and docs/hands.md: every snippet and command does what the page says."""
import io
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from contextlib import redirect_stdout

import numpy as np
import palpable
import pytest
from conftest import ROOT, TOUCHED_BALL, round_ball

PYTHON = (ROOT / "docs/python.md").read_text()
HANDS = (ROOT / "docs/hands.md").read_text()
HAND = ROOT / "examples/python/hand.csv"
POST = "/usr/share/palpable/bodies/post.palpable"
# Commands that other tests run: tests/cli/packages.py installs the packages, test_types.py makes the wheel, test_examples.py
# runs the examples.
ELSEWHERE = ("apt install", "cd python &&", "python3 examples/python/")


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def my_solutions():
    """Of a column of one cube, pressed at the middle of its top: the top sinks."""
    grid = np.array([(x, y, z) for z in range(3) for y in range(3) for x in range(3)], float)
    nodes = 0.02 * grid
    cells = []
    for x in range(2):
        for y in range(2):
            for z in range(2):
                for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
                    at, walk = [x, y, z], [(x, y, z)]
                    for axis in order:
                        at[axis] += 1
                        walk.append(tuple(at))
                    cell = [i + 3 * j + 9 * k for i, j, k in walk]
                    edges = nodes[cell[1:]] - nodes[cell[0]]
                    cells.append(cell if np.linalg.det(edges) > 0 else [cell[0], cell[2], cell[1], cell[3]])
    loaded = [22, 26]
    u = np.zeros((2, 2, 27, 3))
    for site, node in enumerate(loaded):
        near = np.exp(-np.linalg.norm(nodes - nodes[node], axis=1) / 0.02)
        for k, level in enumerate((0.5, 1)):
            u[site, k, :, 2] = -0.002 * (level + 0.1 * level**2) * near * nodes[:, 2] / 0.04
    return nodes, np.array(cells), u, loaded, np.flatnonzero(nodes[:, 2] == 0)


@pytest.fixture
def folder(ball, tmp_path, monkeypatch):
    """A folder with what the pages presuppose."""
    shutil.copy(ball, tmp_path / "bunny.palpable")
    (tmp_path / "ball.off").write_text(round_ball(2))
    (tmp_path / "bunny.toml").write_text(TOUCHED_BALL.replace('"12 mm"', '"16 mm"'))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_snippets_of_the_python_page_run_one_after_the_other(folder):
    pytest.importorskip("h5py", reason="the Debian package python3-h5py is not installed")
    names, said = {"my_solutions": my_solutions}, []
    snippets = blocks(PYTHON, "python")
    assert len(snippets) >= 7
    for snippet in snippets:
        out = io.StringIO()
        try:
            with redirect_stdout(out):
                exec(compile(snippet.replace(POST, "bunny.palpable"), "docs/python.md", "exec"), names)
        except palpable.ProgramFailed as reason:
            if "EGL" not in str(reason):
                raise
        said.append(out.getvalue())
    assert re.search(r"N at \[.*\] m\n\d+ Pa", said[0]), said[0]
    assert "earlier frame" in said[3]
    distance, count = said[4].split()
    assert float(distance) == pytest.approx(0.4) and int(count) > 0, said[4]
    assert re.search(r"modes: \d\.\de-", said[6])


def test_the_first_touch_takes_ten_lines():
    (first, *_) = blocks(PYTHON, "python")
    assert len([line for line in first.splitlines() if line.strip()]) <= 10 and first.startswith("import palpable")


def test_every_command_of_the_python_page_is_run_by_some_test():
    for block in blocks(PYTHON, "sh"):
        for line in block.splitlines():
            assert line.startswith(ELSEWHERE), line
    names = {word.split("/")[-1] for block in blocks(PYTHON, "sh") for word in shlex.split(block) if word.endswith(".py")}
    assert names == {path.name for path in (ROOT / "examples/python").glob("*.py")}


def test_the_hand_of_the_page_presses_alike_in_c_and_in_python(ball, tmp_path, monkeypatch, capsys):
    from palpable._library import library

    if shutil.which("cc") is None:
        pytest.skip("cc is not installed")
    (in_c,), (in_python,) = blocks(HANDS, "c"), blocks(HANDS, "python")
    assert max(len(text.splitlines()) for text in (in_c, in_python)) <= 48
    include = tmp_path / "include"
    include.mkdir()
    (include / "palpable").symlink_to(ROOT / "src/palpable/live/capi")
    (tmp_path / "hand.c").write_text(in_c)
    name = library()._name
    words = ["cc", "-std=c11", "-Wall", "-Wextra", "-Werror", f"-I{include}", tmp_path / "hand.c", name, "-o", tmp_path / "hand"]
    if "/" not in name:
        pytest.skip("PALPABLE_LIBRARY does not name the library")
    subprocess.run([*words, f"-Wl,-rpath,{name.rpartition('/')[0]}"], check=True)
    with open(HAND) as joints:
        from_c = subprocess.run([tmp_path / "hand", ball], stdin=joints, capture_output=True, text=True, check=True).stdout
    (tmp_path / "hand.py").write_text(in_python)
    monkeypatch.setattr(sys, "argv", ["hand.py", str(ball), str(HAND)])
    runpy.run_path(str(tmp_path / "hand.py"), run_name="__main__")
    assert capsys.readouterr().out == from_c and "N down" in from_c


def test_the_table_of_joints_is_that_of_the_layouts():
    """The tip of each finger by its number in the table, moved, moves its capsules and no other finger's."""
    rows = {cells[0]: cells[1:] for line in HANDS.splitlines() if line.startswith("| ")
            for cells in [[cell.strip(" *") for cell in line.split("|")[1:-1]]]}
    assert rows["joints"] == ["26", "25", "21"]
    joints = {name: [int(number) if number != "-" else None for number in rows[name]]
              for name in ("palm", "wrist", "thumb: tip", "index: metacarpal", "index: tip")}
    for k, layout in enumerate(("openxr", "webxr", "mediapipe")):
        places = np.random.default_rng(3).uniform(-0.02, 0.02, (int(rows["joints"][k]), 3)) + [[0.0, 0, 0]]
        middle = {"openxr": (1, 12), "webxr": (0, 11), "mediapipe": (0, 9)}[layout]
        places[middle[1]] = places[middle[0]] + [0.12, 0, 0]
        before = palpable.Hand(places, layout).capsules
        for name, last in (("thumb: tip", 2), ("index: tip", 5)):
            moved = places.copy()
            moved[joints[name][k]] += 0.001
            changed = np.flatnonzero(np.any(palpable.Hand(moved, layout).capsules != before, axis=1))
            assert list(changed) == [last], (layout, name)
        for name in ("palm", "index: metacarpal"):
            assert (joints[name][k] is None) == (name == "palm" and k > 0 or name != "palm" and k == 2)
