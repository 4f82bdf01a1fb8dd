"""From solutions in NumPy arrays, of any solver, to a body file and its error curve."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._body_file import ErrorCurve, read_body
from ._errors import WrongArgument
from ._programs import Baked, OnProgress, reduce, run_program

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


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
    """

    sites: npt.ArrayLike
    forces: npt.ArrayLike
    levels: npt.ArrayLike | None = None
    direction: Union[str, npt.ArrayLike] = "centre"
    patch: int = 2
    held: npt.ArrayLike | None = None
    young: float = 60e3
    poisson: float = 0.4


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
        self.sites = np.atleast_1d(np.asarray(parameters.sites, np.int64))
        count = len(self.sites)
        self.forces = np.broadcast_to(np.asarray(parameters.forces, float), (count,))
        levels = u.shape[1] if u.ndim == 4 else 0
        self.levels = np.arange(1, levels + 1) / levels if parameters.levels is None else np.asarray(parameters.levels, float)
        self._check()

    def _check(self) -> None:
        wanted = (len(self.sites), len(self.levels), len(self.nodes), 3)
        if self.u.shape != wanted:
            raise WrongArgument(f"u has the shape {self.u.shape}, not {wanted}: sites, levels, nodes, 3")
        if self.stress is not None and self.stress.shape != (*wanted[:3], 6):
            raise WrongArgument(f"stress has the shape {self.stress.shape}, not {(*wanted[:3], 6)}: xx yy zz xy yz zx")
        if self.cells.ndim != 2 or self.cells.shape[1] not in (4, 10):
            raise WrongArgument(f"tetrahedra have the shape {self.cells.shape}, not (E, 4) or (E, 10)")
        for name, indices in (("tetrahedra", self.cells), ("sites", self.sites)):
            if indices.size and not 0 <= indices.min() <= indices.max() < len(self.nodes):
                raise WrongArgument(f"{name} name nodes that are not among the {len(self.nodes)} of the mesh")

    def reduce(self, out: str | os.PathLike[str], progress: OnProgress = None, **options: Any) -> Reduced:
        """Makes the body file `out`.

        options  those of `palpable reduce --help`: method="pod" or "pgd", "pgd2", "cp", "hosvd", "per-site";
                 tolerance=1e-3; max_modes=8

        The body is pressed at its sites (without tables of touch), and not by Session.press().
        """
        with tempfile.TemporaryDirectory(prefix="palpable-") as folder:
            runs = Path(folder)
            self._write(runs)
            imported = ["import-snapshots", str(runs), "--manifest", str(runs / "runs.toml"), "-o", str(runs / "store")]
            run_program("palpable-bake", imported, progress)
            made = reduce(runs / "store", out, progress, **options)
        curves = read_body(out).errors
        return Reduced(made, curves["displacement"], None if self.stress is None else curves.get("stress"))

    def _write(self, folder: Path) -> None:
        """The mesh, its description, the manifest, and a file for each snapshot (docs/snapshots.md)."""
        (folder / "mesh.inp").write_text(_deck(self.nodes, self.cells, self._sets()))
        (folder / "body.toml").write_text(self._description())
        text = ['body = "body.toml"', "", "[[field]]", 'name = "displacement"']
        if self.stress is not None:
            text += ["[[field]]", 'name = "stress"']
        for s in range(len(self.sites)):
            for k, level in enumerate(self.levels):
                files = {"displacement": self.u[s, k]}
                if self.stress is not None:
                    files["stress"] = self.stress[s, k]
                for name, numbers in files.items():
                    np.save(folder / f"{name}_{s}_{k}.npy", np.ascontiguousarray(numbers, np.float64))
                named = ", ".join(f'{name} = "{name}_{s}_{k}.npy"' for name in files)
                text += ["", "[[snapshot]]", f"site = {s}", f"level = {float(level)!r}", f"files = {{{named}}}"]
                if level == 1:
                    text.append(f'force = "{float(self.forces[s])!r} N"')
        (folder / "runs.toml").write_text("\n".join(text) + "\n")

    def _sets(self) -> dict[str, Ints]:
        sets = {f"SITE{s}": np.array([node]) for s, node in enumerate(self.sites)}
        if self.parameters.held is not None:
            sets["HELD"] = np.asarray(self.parameters.held, np.int64).ravel()
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
                *("[touch]", 'tables = "none"'),
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

    u           (S, L, N, 3) m, displacement of every node, for each site and level (rest left out)
    mesh        nodes (N, 3) m, Z up; tetrahedra (E, 4) or (E, 10), indices of nodes in Abaqus's order
    parameters  Parameters, or a dict of its fields
    stress      (S, L, N, 6) Pa, Cauchy stress at the nodes, xx yy zz xy yz zx; None: the body has none

    WrongArgument names a shape that does not fit. Files of the programs are written into a temporary folder and removed.
    """
    nodes, cells = mesh
    if isinstance(parameters, dict):
        parameters = Parameters(**parameters)
    stresses = None if stress is None else np.asarray(stress, np.float64)
    return Snapshots(np.asarray(u, np.float64), stresses, np.asarray(nodes, np.float64), np.asarray(cells, np.int64), parameters, name)


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
