"""From solutions in NumPy arrays, of any solver, to a body file and its error curve."""

from __future__ import annotations

import itertools
import json
import os
import re
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Callable, Optional, Union

import numpy as np
import numpy.typing as npt

from ._body_file import ErrorCurve, read_body
from ._errors import ProgramFailed, WrongArgument
from ._programs import Baked, OnProgress, reduce, run_program

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_MARK = b"palpable body file"  # at the beginning of every body file

# What the programs say of the files that are written for them -> the same of the arguments.
_WORDS: tuple[tuple[str, Union[str, Callable[[re.Match[str]], str]]], ...] = (
    (r"\S*body\.toml:\d+: ", ""),
    (r"write the unit of displacement in its \[\[field\]\] \('unit', metres without it\), or a larger 'range' in \[press\] of the body",
     "is u in metres? If so, a larger `range` in the parameters"),
    (r"'sets' in \[sites\]", "sites"),
    (r"'set' in \[support\](?:: the set 'HELD')?", "held"),
    (r"\[support\] holds", "the support (held) holds"),
    (r"'force' in \[press\]", "forces"),
    (r"'stiffness' in \[\[parameter\]\]", "stiffness"),
    (r"'(\w+)' in \[(?:sites|material|press)\]", r"\1"),
    (r"are site, direction, unit and 'up' right\?", "are sites, direction and the order of u's axes right?"),
    (r"^--([\w-]+): ", lambda found: found[1].replace("-", "_") + ": "),
    (r", see palpable-bake \w+ --help$", ""),
)


@dataclass(frozen=True, eq=False)
class Parameters:
    """What was varied: S sites, each with L growing loads.

    sites      (S,) the node in the middle of each load, an index into the mesh's nodes, on the skin
    forces     (S,) N, the full load at each site, or one number for all
    levels     (L,) the loads as fractions of the full one, growing, the last one 1; None: evenly spaced, rest left out
    direction  of the loads: (3,), or "centre" (to the middle of mass), or "normal" (into the skin)
    patch      each load is spread over nodes up to this number of edges away
    held       nodes that the support holds; None: the lowest 3 % of the height
    young, poisson  of the material, for the text in the file; the numbers are those of the snapshots
    range      m, the largest movement of a node that is believed; None: a third of the mesh's largest extent
    stiffness  what else was varied: a name -> (P,) factors of the whole material's stiffness, growing, two or more, such
               as {"hardness": [0.5, 1, 2]}. The body file then has that parameter; `u` has an axis for each, in this order
    """

    sites: npt.ArrayLike
    forces: npt.ArrayLike
    levels: npt.ArrayLike | None = None
    direction: Union[str, npt.ArrayLike] = "centre"
    patch: int = 2
    held: npt.ArrayLike | None = None
    young: float = 60e3
    poisson: float = 0.4
    range: Optional[float] = None
    stiffness: dict[str, npt.ArrayLike] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Reduced:
    """A body file made from snapshots, and how its error falls with the number of modes."""

    body: Baked
    error_curve: ErrorCurve  #: of displacement
    stress_error_curve: ErrorCurve | None  #: None without stresses


class Snapshots:
    """Snapshots in arrays; snapshots() makes one. reduce() makes a body file of them."""

    def __init__(self, u: Floats, stress: Floats | None, nodes: Floats, cells: Ints, parameters: Parameters, name: str) -> None:
        self.u, self.stress, self.nodes, self.cells, self.parameters, self.name = u, stress, nodes, cells, parameters, name
        self.stiffness = {key: np.atleast_1d(_numbers(values, f"stiffness[{key!r}]")) for key, values in parameters.stiffness.items()}
        self.sites = np.atleast_1d(_indices(parameters.sites, "sites"))
        self.forces = _forces(parameters.forces, len(self.sites))
        levels = u.shape[1] if u.ndim == 4 + len(self.stiffness) else 0
        self.levels = np.arange(1, levels + 1) / levels if parameters.levels is None else _numbers(parameters.levels, "levels")
        self.held = None if parameters.held is None else _indices(parameters.held, "held").ravel()
        self._check()

    def _check(self) -> None:
        """All that can be refused without a program, by the names of the arguments."""
        nodes, cells = self.nodes, self.cells
        if nodes.ndim != 2 or nodes.shape[1] != 3 or len(nodes) < 4:
            raise WrongArgument(f"nodes of the mesh have the shape {nodes.shape}, not (N, 3)")
        if cells.ndim != 2 or cells.shape[1] not in (4, 10) or len(cells) == 0:
            raise WrongArgument(f"tetrahedra of the mesh have the shape {cells.shape}, not (E, 4) or (E, 10)")
        _check_finite(nodes, "nodes of the mesh", "node")
        extent = float(np.ptp(nodes, axis=0).max())
        if not 1e-4 <= extent <= 100:
            raise WrongArgument(f"the mesh is {extent:.3g} m large; bodies are from 0.1 mm to 100 m: nodes are in metres")
        if not 3e-3 <= extent <= 3:
            warnings.warn(f"the mesh is {extent:.3g} m large: are its nodes in metres?", stacklevel=4)
        for name, indices in (("tetrahedra", cells), ("sites", self.sites), ("held", self.held)):
            if indices is not None and indices.size and not 0 <= indices.min() <= indices.max() < len(nodes):
                raise WrongArgument(f"{name} name nodes that are not among the {len(nodes)} of the mesh, counted from 0")
        if self.held is not None and (len(self.held) == 0 or np.isin(self.sites, self.held).any()):
            raise WrongArgument("held names no node" if len(self.held) == 0 else "sites name a node that is held: a load moves nothing there")
        self._check_parameters()
        sizes = tuple(len(values) for values in self.stiffness.values())
        wanted = (len(self.sites), len(self.levels), *sizes, len(nodes))
        axes = self._axes()
        if self.u.shape != (*wanted, 3):
            raise WrongArgument(f"u has the shape {self.u.shape}, not {(*wanted, 3)}: {axes}, 3")
        _check_finite(self.u, "u", "snapshot")
        largest = float(np.abs(self.u).max())
        if largest > max(extent, self.parameters.range or 0):
            raise WrongArgument(f"u moves a node by {largest:.3g} m, more than the mesh is large ({extent:.3g} m): u is in metres")
        if self.stress is not None:
            if self.stress.shape != (*wanted, 6):
                raise WrongArgument(f"stress has the shape {self.stress.shape}, not {(*wanted, 6)}: {axes}, xx yy zz xy yz zx")
            _check_finite(self.stress, "stress", "snapshot")

    def _axes(self) -> str:
        return ", ".join(("sites", "levels", *self.stiffness, "nodes"))

    def _check_parameters(self) -> None:
        if len(set(self.sites.tolist())) != len(self.sites) or len(self.sites) == 0:
            raise WrongArgument("sites are to be different nodes, one at least")
        for name, values in self.stiffness.items():
            if name in ("", "site", "level"):
                raise WrongArgument(f"stiffness has the name {name!r}, which every body has or which is none")
            if values.ndim != 1 or len(values) < 2 or values[0] <= 0 or np.any(np.diff(values) <= 0):
                raise WrongArgument(f"stiffness[{name!r}] is {values.tolist()}: two factors or more, above 0, growing")
        if self.u.ndim != 4 + len(self.stiffness):
            raise WrongArgument(f"u has the shape {self.u.shape}, not {4 + len(self.stiffness)} axes: {self._axes()}, 3")
        levels = self.levels
        if levels.ndim != 1 or len(levels) == 0 or levels[0] <= 0 or np.any(np.diff(levels) <= 0) or levels[-1] != 1:
            raise WrongArgument(f"levels are {levels.tolist()}: fractions of the full load, growing, above 0, the last one 1")
        p = self.parameters
        if isinstance(p.direction, str):
            if p.direction not in ("centre", "normal"):
                raise WrongArgument(f"direction is {p.direction!r}, not 'centre', 'normal' or three numbers")
        elif _numbers(p.direction, "direction").shape != (3,) or not np.any(np.asarray(p.direction)):
            raise WrongArgument("direction is 'centre', 'normal' or three numbers that are not all 0")
        if not 0 <= p.patch <= 20:
            raise WrongArgument(f"patch is {p.patch}, not within 0 and 20")
        if not p.young > 0:
            raise WrongArgument(f"young is {p.young} Pa, not above 0")
        if p.range is not None and not p.range > 0:
            raise WrongArgument(f"range is {p.range} m, not above 0")
        if not 0 <= p.poisson < 0.5:
            raise WrongArgument(f"poisson is {p.poisson}, not within 0 and 0.5")

    def reduce(self, out: str | os.PathLike[str], progress: OnProgress = None, **options: Any) -> Reduced:
        """Makes the body file `out`.

        options  those of `palpable reduce --help`: method="pod" or "pgd", "pgd2", "cp", "hosvd", "per-site";
                 tolerance=1e-3; max_modes=8

        The body is pressed at its sites (without tables of touch), and not by Session.press(). As everywhere, a body file
        is replaced, unless it has tables of touch (overwrite=True), and a file of another kind is not.
        """
        _check_output(Path(out))
        with tempfile.TemporaryDirectory(prefix="palpable-") as folder:
            runs = Path(folder)
            self._write(runs)
            imported = ["import-snapshots", str(runs), "--manifest", str(runs / "runs.toml"), "-o", str(runs / "store")]
            try:
                run_program("palpable-bake", imported, progress)
                made = reduce(runs / "store", out, progress, **options)
            except ProgramFailed as failed:
                raise ProgramFailed(in_words_of_python(str(failed), runs, list(self._numbers()))) from None
        curves = read_body(out).errors
        return Reduced(made, curves["displacement"], None if self.stress is None else curves.get("stress"))

    def _write(self, folder: Path) -> None:
        """The mesh, its description, the manifest, and a file for each snapshot (docs/snapshots.md)."""
        (folder / "mesh.inp").write_text(_deck(self.nodes, self.cells, self._sets()))
        (folder / "body.toml").write_text(self._description())
        text = ['body = "body.toml"', "", "[[field]]", 'name = "displacement"']
        if self.stress is not None:
            text += ["[[field]]", 'name = "stress"']
        for number in self._numbers():
            s, k, *further = number
            fields = {"displacement": self.u[number]}
            if self.stress is not None:
                fields["stress"] = self.stress[number]
            suffix = "_".join(map(str, number))
            for name, numbers in fields.items():
                np.save(folder / f"{name}_{suffix}.npy", np.ascontiguousarray(numbers, np.float64))
            named = ", ".join(f'{name} = "{name}_{suffix}.npy"' for name in fields)
            text += ["", "[[snapshot]]", f"site = {s}", f"level = {float(self.levels[k])!r}", f"files = {{{named}}}"]
            if self.stiffness:
                values = (f"{json.dumps(name)} = {float(of[i])!r}" for (name, of), i in zip(self.stiffness.items(), further))
                text.append(f"at = {{{', '.join(values)}}}")
            if self.levels[k] == 1:
                text.append(f'force = "{float(self.forces[s])!r} N"')
        (folder / "runs.toml").write_text("\n".join(text) + "\n")

    def _numbers(self) -> Iterator[tuple[int, ...]]:
        """Indices of all snapshots: site, level, then those of the stiffness."""
        sizes = [len(self.sites), len(self.levels), *(len(values) for values in self.stiffness.values())]
        return itertools.product(*(range(size) for size in sizes))

    def _sets(self) -> dict[str, Ints]:
        sets = {f"SITE{s}": np.array([node]) for s, node in enumerate(self.sites)}
        if self.held is not None:
            sets["HELD"] = self.held
        return sets

    def _description(self) -> str:
        p = self.parameters
        direction = f'"{p.direction}"' if isinstance(p.direction, str) else str([float(x) for x in np.asarray(p.direction)])
        names = ", ".join(f'"SITE{s}"' for s in range(len(self.sites)))
        return "\n".join(
            [
                f"name = {json.dumps(self.name)}",
                *("[shape]", 'mesh = "mesh.inp"'),
                *("[material]", f'young = "{p.young!r} Pa"', f"poisson = {p.poisson!r}"),
                *("[support]", 'set = "HELD"' if p.held is not None else "below = 0.03"),
                *("[sites]", f"sets = [{names}]", f"patch = {p.patch}", f"direction = {direction}"),
                *("[press]", f'force = "{float(self.forces[0])!r} N"', f"levels = {max(2, len(self.levels))}"),
                *([] if p.range is None else [f'range = "{p.range!r} m"']),
                *("[touch]", 'tables = "none"'),
                *(line for name, values in self.stiffness.items() for line in _parameter(name, values)),
                "",
            ]
        )


def snapshots(
    u: npt.ArrayLike,
    mesh: tuple[npt.ArrayLike, npt.ArrayLike],
    parameters: Parameters | dict[str, Any],
    stress: npt.ArrayLike | None = None,
    name: str = "snapshots",
) -> Snapshots:
    """Solutions of any solver, to be reduced: snapshots(u, (nodes, tetrahedra), parameters).reduce("my.palpable").

    u           (S, L, N, 3) m, displacement of every node, for each site and level (rest left out); (S, L, P, N, 3) where
                `parameters` has a `stiffness`
    mesh        nodes (N, 3) m, Z up; tetrahedra (E, 4) or (E, 10), indices of nodes in Abaqus's order
    parameters  Parameters, or a dict of its fields
    stress      (S, L, N, 6) Pa, Cauchy stress at the nodes, xx yy zz xy yz zx; None: the body has none

    WrongArgument names the argument whose shape, numbers or size do not fit, at once. What only the program finds, such as
    a node that is held and moves, is a ProgramFailed of reduce(). Files of the programs are written into a temporary folder and removed.
    """
    try:
        nodes, cells = mesh
    except (TypeError, ValueError):
        raise WrongArgument("mesh is to be a pair: nodes (N, 3) and tetrahedra (E, 4) or (E, 10)") from None
    if isinstance(parameters, dict):
        unknown = parameters.keys() - {one.name for one in fields(Parameters)}
        if unknown:
            raise WrongArgument(f"parameters have no {', '.join(sorted(unknown))}; {', '.join(one.name for one in fields(Parameters))} are known")
        try:
            parameters = Parameters(**parameters)
        except TypeError:
            raise WrongArgument("parameters need sites and forces") from None
    stresses = None if stress is None else _numbers(stress, "stress")
    of_mesh = _numbers(nodes, "nodes of the mesh"), _indices(cells, "tetrahedra of the mesh")
    return Snapshots(_numbers(u, "u"), stresses, *of_mesh, parameters, name)


def _numbers(values: npt.ArrayLike, name: str) -> Floats:
    try:
        array = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise WrongArgument(f"{name} is no array of numbers") from None
    return array


def _indices(values: npt.ArrayLike, name: str) -> Ints:
    array = _numbers(values, name)
    if not np.array_equal(array, np.rint(array)):
        raise WrongArgument(f"{name} are to be whole numbers, indices of nodes")
    return array.astype(np.int64)


def _forces(values: npt.ArrayLike, sites: int) -> Floats:
    forces = _numbers(values, "forces")
    if forces.shape not in ((), (1,), (sites,)):
        raise WrongArgument(f"forces have the shape {forces.shape}: one number, or one for each of the {sites} sites")
    if not np.all(forces > 0) or not np.all(np.isfinite(forces)):
        raise WrongArgument(f"forces are {forces.tolist()} N, not above 0")
    return np.broadcast_to(forces, (sites,))


def _check_finite(array: Floats, name: str, each: str) -> None:
    if np.all(np.isfinite(array)):
        return
    where = np.argwhere(~np.isfinite(array))[0].tolist()
    raise WrongArgument(f"{name}[{', '.join(map(str, where))}] is {array[tuple(where)]}, no finite number")


def _check_output(out: Path) -> None:
    """palpable reduce refuses it, too, but after the import."""
    if out.is_file() and out.stat().st_size > 0:
        with open(out, "rb") as file:
            if not file.read(len(_MARK)) == _MARK:
                raise WrongArgument(f"{out} is there already and is no body file: it is somebody's and is not replaced; name another file")


def in_words_of_python(complaint: str, folder: Path, snapshots: Sequence[tuple[int, ...]]) -> str:
    """What a program says of the files in the temporary folder, in the names of the arguments.

    snapshots  indices into u of those in the manifest, in its order
    """

    def name_of_snapshot(found: re.Match[str]) -> str:
        text = (folder / "runs.toml").read_text().splitlines()[: int(found[1])]
        number = text.count("[[snapshot]]") - 1
        return f"u[{', '.join(map(str, snapshots[number]))}]: " if 0 <= number < len(snapshots) else "u: "

    complaint = re.sub(r"\S*runs\.toml:(\d+): (?:\[\[snapshot\]\]: )?", name_of_snapshot, complaint)
    complaint = re.sub(r"node (\d+) (is held by the support)", lambda found: f"node {int(found[1]) - 1} {found[2]}", complaint)
    for theirs, ours in _WORDS:
        complaint = re.sub(theirs, ours, complaint)
    return complaint.replace(f"{folder}{os.sep}", "")


def _parameter(name: str, values: Floats) -> list[str]:
    return ["[[parameter]]", f"name = {json.dumps(name)}", 'of = "body"', f"stiffness = {[float(x) for x in values]}"]


def _deck(nodes: Floats, cells: Ints, sets: dict[str, Ints]) -> str:
    """A mesh as Abaqus writes it; nodes are counted from 1."""
    lines = ["*NODE"]
    lines += [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(nodes.tolist(), 1)]
    lines.append(f"*ELEMENT, TYPE=C3D{cells.shape[1]}")
    lines += [", ".join(map(str, [n, *corners])) for n, corners in enumerate((cells + 1).tolist(), 1)]
    for name, members in sets.items():
        lines.append(f"*NSET, NSET={name}")
        lines += [_row(members[k : k + 16] + 1) for k in range(0, len(members), 16)]
    return "\n".join(lines) + "\n"


def _row(numbers: Sequence[int] | Ints) -> str:
    return ", ".join(str(int(n)) for n in numbers)
