"""What presses: hands by the joints of a tracker, and capsules."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Union

import numpy as np
import numpy.typing as npt

from ._errors import WrongArgument
from ._library import HAND_CAPSULES, check, library

_LAYOUTS = {"openxr": (1, 26), "webxr": (2, 25), "mediapipe": (3, 21)}
_SIDES = {"left": 1, "right": 2}
_IDS = {"right": 1, "left": 2}


class Capsules:
    """Capsules that belong together, such as a tool.

    capsules  (N, 8): ax ay az bx by bz radius_a radius_b, m, world frame. A capsule is the union of the balls with
              centres on the segment from a to b, whose radius changes linearly; one ball where a equals b.
    id        a name for it, the same from call to call; touches carry it
    friction  Coulomb's coefficient between it and the skins, 0 (none) to 10; None: that of each body
    """

    __slots__ = ("capsules", "id", "friction")

    def __init__(self, capsules: npt.ArrayLike, id: int = 0, friction: float | None = None) -> None:
        self.capsules = rows_of_8(capsules)
        self.id = id
        self.friction = friction

    def _friction_of_c(self) -> float:
        """palpable_thing::friction, where 0 is that of the body and -1 none. WrongArgument unless it is 0 or more: C takes
        -1 as none, and refuses what is above 10."""
        if self.friction is None:
            return 0.0
        if not self.friction >= 0:
            raise WrongArgument(f"friction is {self.friction}, not within 0 and 10")
        return self.friction if self.friction != 0 else -1.0


class Hand(Capsules):
    """A hand, from the joints that a tracker gives.

    joints  (26, 3) OpenXR (XrHandJointEXT), (25, 3) WebXR (XRHandJoint) or (21, 3) MediaPipe, in the tracker's order;
            m, world frame
    layout  "openxr", "webxr" or "mediapipe"
    side    "right" or "left"
    radii   (joints,) m, from each joint to the skin; None: those of a mean hand of the same length
    id      a name for it; None: 1 for a right hand, 2 for a left one
    friction  as of Capsules

    `capsules` is what presses, (26, 8). WrongArgument if a joint is no number, or if the hand is not 80 to 300 mm
    long, as when joints are in mm. docs/hands.md has the table of joints.
    """

    __slots__ = ()

    def __init__(
        self,
        joints: npt.ArrayLike,
        layout: str = "openxr",
        side: str = "right",
        radii: npt.ArrayLike | None = None,
        id: int | None = None,
        friction: float | None = None,
    ) -> None:
        if layout not in _LAYOUTS:
            raise WrongArgument(f"layout is {layout!r}, not one of {', '.join(_LAYOUTS)}")
        if side not in _SIDES:
            raise WrongArgument(f"side is {side!r}, not left or right")
        number, count = _LAYOUTS[layout]
        places = _of_shape(joints, (count, 3), "joints")
        of_joints = None if radii is None else _of_shape(radii, (count,), "radii")
        found = np.empty((HAND_CAPSULES, 8))
        check(
            library().palpable_hand_capsules(
                number, _SIDES[side], address_of(places), None if of_joints is None else address_of(of_joints), address_of(found)
            )
        )
        super().__init__(found, _IDS[side] if id is None else id, friction)


#: One thing: a Hand, Capsules, or an (N, 8) array, which is Capsules with the id 0.
Thing = Union[Capsules, npt.ArrayLike]
#: One thing or a list of things; an empty list presses nothing.
Things = Union[Thing, Sequence[Thing]]


def list_of_things(things: Things) -> list[Capsules]:
    """The things of one call. An array, or nested lists of numbers, is one thing."""
    if isinstance(things, Capsules):
        return [things]
    if isinstance(things, np.ndarray):
        return [Capsules(things)]
    if isinstance(things, (list, tuple)):
        if any(isinstance(one, Capsules) or np.ndim(one) == 2 for one in things):
            return [one if isinstance(one, Capsules) else Capsules(one) for one in things]
        if not things:
            return []
    return [Capsules(things)]  # type: ignore[arg-type]


def rows_of_8(capsules: npt.ArrayLike) -> npt.NDArray[np.float64]:
    array = np.ascontiguousarray(capsules, np.float64)
    if array.ndim == 1 and array.size in (0, 8):
        array = array.reshape(-1, 8)
    if array.ndim != 2 or array.shape[1] != 8:
        raise WrongArgument(f"capsules have the shape {array.shape}, not (N, 8): ax ay az bx by bz radius_a radius_b")
    return array


def address_of(array: npt.NDArray[np.generic]) -> int:
    address: int = array.__array_interface__["data"][0]
    return address


def _of_shape(values: npt.ArrayLike, shape: tuple[int, ...], name: str) -> npt.NDArray[np.float64]:
    array = np.ascontiguousarray(values, np.float64)
    if array.shape != shape:
        raise WrongArgument(f"{name} have the shape {array.shape}, not {shape}")
    return array


def pose_of(values: npt.ArrayLike, name: str) -> npt.NDArray[np.float64]:
    """(4, 4) or 16 numbers, row by row, as 16 contiguous doubles."""
    array = np.ascontiguousarray(values, np.float64)
    if array.size != 16:
        raise WrongArgument(f"{name} has the shape {array.shape}, not (4, 4)")
    return array
