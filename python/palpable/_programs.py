"""The programs `palpable` and `palpable-bake`, started as processes of their own: bake, synth, live, score."""

from __future__ import annotations

import dataclasses
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

from ._errors import ProgramFailed

# "solving sites           40 %  12 s left  2 stopped early"
_PROGRESS = re.compile(r"(?P<task>.*\S) +(?P<percent>\d+) %(?:  (?P<rest>.*))?$")

File = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Progress:
    """A line that a program printed while it worked, a few seconds apart."""

    text: str  #: the whole line
    task: str | None = None  #: such as "solving sites"; None: a remark
    fraction: float | None = None  #: 0 to 1 of this task


#: True prints the program's lines on stderr, a function is called with each, None is silent.
OnProgress = Union[bool, None, Callable[[Progress], None]]


def _to_dict(record: Any) -> dict[str, Any]:
    """One flat row: a dataclass's fields, then its facts, those of inner objects as outer.inner. Lists stay lists."""
    row = {f.name: getattr(record, f.name) for f in dataclasses.fields(record) if f.name != "facts"}

    def add(prefix: str, facts: dict[str, Any]) -> None:
        for name, value in facts.items():
            if isinstance(value, dict):
                add(f"{prefix}{name}.", value)
            else:
                row.setdefault(f"{prefix}{name}", value)

    add("", record.facts)
    return {name: str(value) if isinstance(value, Path) else value for name, value in row.items()}


@dataclass(frozen=True)
class Baked:
    """A body file that was made. `facts` is all that the program says of it (`palpable bake --json`)."""

    file: Path
    name: str
    vertices: int
    triangles: int
    sites: int
    levels: int
    displacement_modes: int
    stress_modes: int
    displacement_error: float  #: relative L2 error of the reduction, over all snapshots together
    stress_error: float
    seconds: float
    facts: dict[str, Any] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Everything as one flat row, for pandas.DataFrame([...])."""
        return _to_dict(self)


@dataclass(frozen=True)
class Clip:
    """A film of the synthetic desk, with its truth."""

    folder: Path
    sequence: str
    body: str
    frames: int
    seed: int
    facts: dict[str, Any] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Everything as one flat row, for pandas.DataFrame([...])."""
        return _to_dict(self)


@dataclass(frozen=True)
class Run:
    """A run of `palpable live`. `facts` is its summary, live.json."""

    folder: Path
    frames: int
    frames_touching: int
    facts: dict[str, Any] = field(repr=False)

    def touches(self) -> list[dict[str, Any]]:
        """Lines of touches.jsonl: for each frame its touches (docs/benchmark_files.md)."""
        return [json.loads(line) for line in (self.folder / "touches.jsonl").read_text().splitlines()]

    def to_dict(self) -> dict[str, Any]:
        """Everything as one flat row, for pandas.DataFrame([...])."""
        return _to_dict(self)


@dataclass(frozen=True)
class Score:
    """How good a run is (docs/benchmark.md has each figure). None: truth or run lack it."""

    film: str
    frames: int
    displacement_error: dict[str, float] | None  #: relative: median, p90
    von_mises_error: dict[str, float] | None
    force_error: dict[str, float] | None
    touch_recall: float | None
    touch_precision: float | None
    facts: dict[str, Any] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Everything as one flat row, for pandas.DataFrame([...])."""
        return _to_dict(self)


def run_program(program: str, words: list[str], progress: OnProgress = None) -> dict[str, Any]:
    """Runs a program with --json and returns what it says. ProgramFailed with its error line if it fails."""
    path = shutil.which(program)
    if path is None:
        raise ProgramFailed(f"the program {program} is not in PATH: install the Debian package {program}")
    last = ""
    with tempfile.TemporaryFile("w+", encoding="utf-8") as output:
        process = subprocess.Popen(
            [path, *words, "--json"],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
        )
        try:
            assert process.stderr is not None
            for line in process.stderr:
                last = line.rstrip() or last
                _report(line.rstrip(), progress)
            process.wait()
        finally:
            if process.poll() is None:  # Ctrl-C, or the function of the caller raised
                process.terminate()
                process.wait()
        if process.returncode != 0:
            what = f"ended with the code {process.returncode}" if process.returncode > 0 else f"was ended by signal {-process.returncode}"
            raise ProgramFailed(last.removeprefix("palpable: ") or f"{program} {what}")
        output.seek(0)
        facts: dict[str, Any] = json.loads(output.read())
        return facts


def _report(line: str, progress: OnProgress) -> None:
    if progress is True:
        print(line, file=sys.stderr, flush=True)
    elif callable(progress):
        found = _PROGRESS.match(line)
        if found:
            progress(Progress(line, found["task"], int(found["percent"]) / 100))
        else:
            progress(Progress(line))


def words_of(options: dict[str, Any]) -> list[str]:
    """Options as words: method="pod", max_modes=8, volume=True -> --method pod --max-modes 8 --volume."""
    words = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        words.append("--" + name.replace("_", "-"))
        if value is not True:
            words += [str(one) for one in value] if isinstance(value, (list, tuple)) else [str(value)]
    return words


def baked(facts: dict[str, Any], folder: Path | None = None) -> Baked:
    fields = {f.name: facts.get(f.name) for f in dataclasses.fields(Baked) if f.name not in ("file", "facts")}
    return Baked(file=(folder or Path()) / facts["file"], facts=facts, **fields)  # type: ignore[arg-type]


def bake(description: File, out: File | None = None, progress: OnProgress = None, **options: Any) -> Baked:
    """Bakes a body: finite elements, then the reduced model. Minutes for a bunny, a second for a coarse ball.

    description  a .toml file (docs/body.md)
    out          the body file; None: beside the description, NAME.palpable
    progress     True: lines on stderr; a function: called with a Progress for each
    options      those of `palpable bake --help`, such as held_out=True, threads=2, no_touch=True

    A bake that was stopped goes on where it was when it is called again. ProgramFailed with the program's error line.
    """
    file = Path(description).with_suffix(".palpable") if out is None else Path(out)
    return baked(run_program("palpable-bake", ["bake", os.fspath(description), "-o", str(file), *words_of(options)], progress))


def reduce(snapshots: File, out: File, progress: OnProgress = None, **options: Any) -> Baked:
    """Makes a body file from a folder of snapshots that bake() or snapshots() has left.

    options  those of `palpable reduce --help`, such as method="pod", tolerance=1e-3, max_modes=8
    """
    return baked(run_program("palpable-bake", ["reduce", os.fspath(snapshots), "-o", os.fspath(out), *words_of(options)], progress))


def synth(sequence: str, out: File, body: File | None = None, progress: OnProgress = None, **options: Any) -> Clip:
    """Films a sequence of the synthetic desk: stereo images, calibration, truth. Needs OpenGL, no screen.

    sequence  such as "press" or "two-hands"; `palpable synth --help` lists them
    options   such as frames=120, seed=3
    """
    facts = run_program("palpable", ["synth", sequence, "-o", os.fspath(out), *words_of({"body": body, **options})], progress)
    return Clip(Path(out), facts["sequence"], facts["body"], facts["frames"], facts["seed"], facts)


def live(body: File, source: File, out: File, progress: OnProgress = None, **options: Any) -> Run:
    """Lets what a source shows press a body, and writes the results into the folder `out`.

    body     a body file or a scene file
    source   a folder of pictures, a film, a recording, a camera, or "synthetic" (docs/recordings.md)
    options  those of `palpable live --help`, such as write="data", overwrite=True, place="0 0.1 0.6 0 40 0"
    """
    words = ["live", os.fspath(body), "--source", os.fspath(source), "--out", os.fspath(out), *words_of(options)]
    facts = run_program("palpable", words, progress)
    return Run(Path(out), facts["frames"], facts["frames_touching"], facts)


def score(truth: File, result: File, body: File | None = None, progress: OnProgress = None) -> Score:
    """Compares a run with the truth of what it saw.

    truth   the folder truth/ of a Clip
    result  the folder of a Run
    """
    facts = run_program("palpable", ["score", os.fspath(truth), os.fspath(result), *words_of({"body": body})], progress)
    fields = {f.name: facts.get(f.name) for f in dataclasses.fields(Score) if f.name != "facts"}
    return Score(facts=facts, **fields)  # type: ignore[arg-type]
