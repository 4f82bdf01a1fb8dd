"""Type hints: the package passes mypy, and what it has at run time is what they say; programs of users are checked, too."""
import importlib.util
import re
import shutil
import subprocess
import sys
import tomllib

import palpable
import pytest
from conftest import ROOT

needs_mypy = pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="the Debian package mypy is not installed")


def mypy(*words, module="mypy", folder=ROOT / "python"):
    result = subprocess.run([sys.executable, "-m", module, *map(str, words)], cwd=folder, capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


@needs_mypy
def test_mypy_and_stubtest_agree_with_the_package(tmp_path):
    code, said = mypy("--cache-dir", tmp_path)
    assert code == 0, said
    # What is offered; private modules have ctypes' structs, of which stubtest knows no members.
    (tmp_path / "allowed").write_text(r"palpable\._.*")
    words = ("palpable", "--mypy-config-file", "pyproject.toml", "--allowlist", tmp_path / "allowed")
    code, said = mypy(*words, module="mypy.stubtest")
    assert code == 0, said


@needs_mypy
def test_wrong_uses_are_found_by_the_hints(tmp_path):
    (tmp_path / "use.py").write_text(
        "import palpable\n"
        "body = palpable.Body('x.palpable', scale=2)\n"
        "with palpable.Session(body) as session:\n"
        "    session.press([[0, 0, 0, 0, 0, 1, 0.01, 0.01]], time=0.1)\n"
        "    reveal_type(session.touches[0].force)\n"
        "    session.press(time='now', things=[])\n"
        "    session.skin().vertexes\n"
    )
    _, said = mypy("--strict", "--cache-dir", tmp_path / "cache", tmp_path / "use.py")
    assert "use.py:5: note: Revealed type is" in said and "float" in said
    assert re.findall(r"use\.py:(\d+): error", said) == ["6", "7"], said


def test_what_is_offered_has_a_docstring():
    for name in palpable.__all__:
        offered = getattr(palpable, name)
        if callable(offered) and not name.startswith("_"):
            assert offered.__doc__ and not offered.__doc__.startswith(f"{name}("), name
        for member, function in vars(offered).items() if isinstance(offered, type) else ():
            if callable(function) and not member.startswith("_") and offered.__module__.startswith("palpable"):
                assert function.__doc__ or issubclass(offered, int), f"{name}.{member}"


def test_the_version_is_that_of_the_project():
    project = re.search(r"project\(palpable VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    suffix = re.search(r"set\(PALPABLE_VERSION \$\{PROJECT_VERSION\}(\S*)\)", (ROOT / "CMakeLists.txt").read_text())
    assert palpable.__version__ == project + (suffix[1].replace("~", ".") if suffix else "")


def test_the_wheel_has_the_package_and_needs_no_network(tmp_path):
    for module in ("pip", "setuptools", "wheel"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"the Debian package python3-{module} is not installed")
    shutil.copytree(ROOT / "python", tmp_path / "python", ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
    words = ["pip", "wheel", "-q", "--no-index", "--no-build-isolation", "--no-deps", "-w", str(tmp_path), "."]
    subprocess.run([sys.executable, "-m", *words], cwd=tmp_path / "python", check=True)
    (wheel,) = tmp_path.glob("palpable-*-py3-none-any.whl")
    place = tmp_path / "place"
    shutil.unpack_archive(wheel, place, "zip")
    files = {str(file.relative_to(place)) for file in place.rglob("*") if file.is_file() and "dist-info" not in str(file)}
    assert files == {str(file.relative_to(ROOT / "python")) for file in (ROOT / "python/palpable").iterdir() if file.is_file()}
    said = subprocess.run([sys.executable, "-c", "import palpable; print(palpable.__file__)"], cwd=tmp_path, capture_output=True,
                          text=True, check=True, env={"PYTHONPATH": str(place)}).stdout
    assert said.startswith(str(place))


def test_the_package_needs_nothing_but_numpy():
    """h5py is imported where a body file is read, matplotlib by examples alone."""
    code = "import sys, palpable; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    said = subprocess.run([sys.executable, "-c", code], cwd=ROOT / "python", capture_output=True, text=True, check=True).stdout.split()
    assert not {"h5py", "matplotlib", "pandas", "scipy"} & set(said)
    with open(ROOT / "python/pyproject.toml", "rb") as file:
        assert tomllib.load(file)["project"]["dependencies"] == ["numpy"]
