"""Body files as NumPy arrays, under the names of docs/body_file.md. Needs python3-h5py."""

from __future__ import annotations

import ctypes
import json
import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import Error
from ._library import check, library

Array = npt.NDArray[Any]


@dataclass(frozen=True, eq=False)
class Axis:
    """A parameter of a body: site, level, or another one."""

    name: str
    samples: npt.NDArray[np.float64]  #: (n,)
    functions: npt.NDArray[np.float64]  #: (m, n), G_i at the samples


@dataclass(frozen=True, eq=False)
class Field:
    """Displacement or stress: the sum over modes of F_i(X) G_i(site) G_i(level) ..."""

    modes: npt.NDArray[np.float32]  #: (m, V, 3) m, or (m, V, 6) Pa: xx yy zz xy yz zx
    axes: list[Axis]  #: site, level, then others

    def at(self, *samples: int) -> npt.NDArray[np.float64]:
        """The field at one sample of each axis, such as at(3, -1): site 3 under full load. (V, 3) or (V, 6)."""
        if len(samples) != len(self.axes):
            raise ValueError(f"{len(samples)} samples for the axes {', '.join(axis.name for axis in self.axes)}")
        weights = np.prod([axis.functions[:, k] for axis, k in zip(self.axes, samples)], axis=0)
        return np.tensordot(weights, self.modes, 1)


@dataclass(frozen=True, eq=False)
class ErrorCurve:
    """Error of a reduction against the number of modes."""

    modes: npt.NDArray[np.int32]  #: (q,) increasing
    pooled: npt.NDArray[np.float64]  #: (q,) relative L2 error of all snapshots together
    snapshots: npt.NDArray[np.float32]  #: (q, K) of each snapshot against its own norm


@dataclass(frozen=True, eq=False)
class BodyFile:
    """What a body file holds. V vertices, T triangles, S sites, L levels (rest included); body frame, m, Z up."""

    name: str
    material: str
    method: str
    vertices: npt.NDArray[np.float64]  #: (V, 3) m, at rest
    triangles: npt.NDArray[np.int32]  #: (T, 3) counter-clockwise from outside
    fixed: npt.NDArray[np.bool_]  #: (V,) held by the support
    displacement: Field
    stress: Field
    site_vertex: npt.NDArray[np.int32]  #: (S,) middle of each patch
    site_direction: npt.NDArray[np.float64]  #: (S, 3) of the load
    site_full_load: npt.NDArray[np.float64]  #: (S,) N, load at level 1
    site_press_depth: npt.NDArray[np.float64]  #: (S, L) m
    errors: dict[str, ErrorCurve]  #: "displacement", "stress", "von_mises", where they are known
    error: dict[str, float]  #: attributes of /error, such as displacement_pooled
    parameters: dict[str, npt.NDArray[np.float64]]  #: samples of further parameters
    provenance: dict[str, Any]  #: where each number comes from
    tables: dict[str, Array] = field(repr=False)  #: datasets of /touch, such as "compliance/basis", as they are stored


def read_body(file: str | os.PathLike[str]) -> BodyFile:
    """Reads a body file. The library checks it first: WrongFile if it is missing, damaged or of another layout."""
    h5py = _h5py()
    _check_file(file)
    with h5py.File(file, "r") as root:
        surface, sites = root["surface"], root["sites"]
        count = len(surface["vertices"])
        parameters = root.get("parameters", {})
        return BodyFile(
            name=_text(root.attrs["name"]),
            material=_text(root.attrs["material"]),
            method=_text(root.attrs.get("method", b"")),
            vertices=surface["vertices"][:],
            triangles=surface["triangles"][:],
            fixed=surface["fixed"][:].ravel() != 0,
            displacement=_field(root["displacement"], count),
            stress=_field(root["stress"], count),
            site_vertex=sites["vertex"][:].ravel(),
            site_direction=sites["direction"][:],
            site_full_load=sites["full_load"][:].ravel(),
            site_press_depth=sites["press_depth"][:],
            errors=_curves(root.get("error", {})),
            error={name: float(value) for name, value in root["error"].attrs.items()} if "error" in root else {},
            parameters={_text(one.attrs["name"]): one["samples"][:].ravel() for one in _groups(parameters)},
            provenance=json.loads(_text(root["provenance"].attrs.get("json", b"{}"))),
            tables=_tables(root.get("touch")),
        )


def _h5py() -> Any:
    try:
        import h5py  # type: ignore[import]
    except ImportError:
        raise Error("reading body files needs h5py: install the Debian package python3-h5py") from None
    return h5py


def _check_file(file: str | os.PathLike[str]) -> None:
    """HDF5 crashes on some damaged files; the library compares the checksum before."""
    body = ctypes.c_void_p()
    check(library().palpable_load_body(os.fsencode(file), 1, ctypes.byref(body)))
    library().palpable_free_body(body)


def _text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def _groups(parent: Any) -> list[Any]:
    """Its numbered groups, in order."""
    return [parent[name] for name in sorted((name for name in parent if name.isdigit()), key=int)]


def _field(group: Any, vertices: int) -> Field:
    if "modes" in group:
        modes = group["modes"][:]
    else:
        modes = group["modes_float16"][:].astype(np.float32) * group["mode_scale"][:].astype(np.float32)
    axes = []
    for k in range(int(group.attrs["axes"])):
        axis = group[f"axis_{k}"]
        axes.append(Axis(_text(axis.attrs["name"]), axis["samples"][:].ravel(), axis["functions"][:]))
    components = modes.shape[1] // vertices if vertices else 1
    return Field(modes.reshape(len(modes), vertices, components), axes)


def _curves(error: Any) -> dict[str, ErrorCurve]:
    found = {}
    for name in ("displacement", "stress", "von_mises"):
        if f"{name}_course" in error:
            course = error[f"{name}_course"]
            found[name] = ErrorCurve(course["modes"][:].ravel(), course["pooled"][:].ravel(), course["snapshots"][:])
    return found


def _tables(touch: Any) -> dict[str, Array]:
    tables: dict[str, Array] = {}
    if touch is not None:
        touch.visititems(lambda name, item: tables.__setitem__(name, item[:]) if hasattr(item, "shape") else None)
    return tables
