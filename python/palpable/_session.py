"""Bodies, and sessions in which things press them: the live half, over palpable.h."""

from __future__ import annotations

import ctypes
import dataclasses
import enum
import math
import os
import struct
import threading
import weakref
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
import numpy.typing as npt

from . import _library as c
from ._errors import Broken, Closed, InUse, NotPossible, StaleFrame
from ._images import Depth, Stereo, image_of, setup_of
from ._library import check, library
from ._things import Capsules, Things, address_of, list_of_things, pose_of
from ._views import FrameMemory, View

# palpable_thing, packed: faster than an array of ctypes' structs.
_THING = struct.Struct("@NqNNd")
# palpable_touch and palpable_frame, unpacked in one call, which is faster than member by member.
_TOUCH = struct.Struct("@N2i9d4d2q")
_FRAME = struct.Struct("@Nd4i16d2d2id")
# Types of the library's arrays, as NumPy's protocol for foreign memory names them.
_FLOATS, _INTS = np.dtype(np.float32).str, np.dtype(np.int32).str

# palpable_place_body() and palpable_open() of one body must not meet.
_PLACING = threading.Lock()


class _Handle:
    """A handle of the library, freed once: by free(), or when nothing refers to it any more."""

    def __init__(self, address: int | None, free: Callable[[int | None], None]) -> None:
        self.address = address
        self.free = weakref.finalize(self, free, address)
        self.free.atexit = False  # arrays may outlive it; the process takes its memory along


class Body:
    """A baked body. It may be used by several sessions; closing it does not disturb them.

    file   a body file; palpable.bake() makes one
    scale  factor of every length, with the same material, 0.001 to 1000
    place  (4, 4) world_from_body, rotation and translation (m); None: it stands at the world's origin, Z up

    WrongFile if the file is missing or damaged.
    """

    def __init__(self, file: str | os.PathLike[str], scale: float = 1, place: npt.ArrayLike | None = None) -> None:
        address = ctypes.c_void_p()
        check(library().palpable_load_body(os.fsencode(file), scale, ctypes.byref(address)))
        self.file = os.fspath(file)
        self._handle: _Handle | None = _Handle(address.value, library().palpable_free_body)
        if place is not None:
            self.place(place)

    def place(self, world_from_body: npt.ArrayLike) -> None:
        """Sets the pose, (4, 4), in sessions that are opened later."""
        pose = pose_of(world_from_body, "world_from_body")
        with _PLACING:
            check(library().palpable_place_body(self._address(), address_of(pose)))

    def set_friction(self, coefficient: float) -> None:
        """Sets Coulomb's coefficient of friction of the skin, 0 to 10, in sessions that are opened later. Without this
        call it is that of the body file, 0 in files without one. Dry silicone rubber on skin has about 0.6."""
        with _PLACING:
            check(library().palpable_set_friction(self._address(), coefficient))

    def set_dynamics(self, on: bool) -> None:
        """Whether the body has inertia in sessions that are opened later: what is let go rings. Only a body whose file
        has vibration modes can have it, and has it without this call."""
        with _PLACING:
            check(library().palpable_set_dynamics(self._address(), int(on)))

    def close(self) -> None:
        """Frees it; a second time does nothing."""
        with _PLACING:
            if self._handle is not None:
                self._handle.free()
                self._handle = None

    def _address(self) -> int | None:
        if self._handle is None:
            raise Closed(f"the body {self.file} is closed")
        return self._handle.address

    def __enter__(self) -> Body:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


class Answer(enum.IntEnum):
    """Whether the skin gives way to everything that presses."""

    NOT_JUDGED = 0  #: before the first press, and with a camera
    REACHED = 1  #: yes: force and shape are the answer
    LATER = 2  #: not yet: press again with the same things; a skin moves by 15 mm a call at most
    NOT_REACHED = 3  #: no, and this call came no nearer: do not use force and shape


class CameraState(enum.IntEnum):
    """Whether it is known where the camera is."""

    STANDS = 0  #: it stands still
    STARTING = 1  #: it is to be followed, but no pose has been found yet
    TRACKED = 2  #: its pose was found or given
    LOST = 3  #: its pose is unknown: nothing presses


_Kind = TypeVar("_Kind", bound="_Record")


class _Record:
    """Fields that are read from the bytes of C's struct when the first of them is used: who only counts touches does not
    wait for their vectors. A thread that reads them twice, beside another one, does no harm."""

    _bytes: bytes
    #: Arrays among the fields, read one by one: where they begin in the struct, and their shape.
    _arrays: ClassVar[dict[str, tuple[int, tuple[int, ...]]]] = {}

    @classmethod
    def _of(cls: type[_Kind], got: ctypes.Structure) -> _Kind:
        record = cls.__new__(cls)
        record.__dict__["_bytes"] = bytes(got)
        return record

    @staticmethod
    def _read(got: bytes) -> dict[str, Any]:
        raise NotImplementedError

    if not TYPE_CHECKING:  # or else any name would be right

        def __getattr__(self, name: str) -> Any:
            """Called where `name` is not in __dict__."""
            values = self.__dict__
            if "_bytes" in values and name in self.__dataclass_fields__:
                if name in self._arrays:
                    values[name] = _doubles(values["_bytes"], *self._arrays[name])
                else:
                    values.update(self._read(values["_bytes"]))
                return values[name]
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")


@dataclass(frozen=True, eq=False)
class Frame(_Record):
    """The frame that was processed last."""

    time: float  #: s; NaN before the first
    touch_count: int  #: of all bodies
    answer: Answer  #: of the last press()
    left_to_go: float  #: m, how far the skins still are from their solution; up to 0.3 mm it is reached
    inside: float  #: m, how deep obstacles still are inside the skin
    passed_through: int  #: capsules that passed through a skin between the last two calls without pressing it
    ringing: float  #: J, energy of the bodies' motion around their static states; 0 without inertia
    camera: CameraState
    wrong_pair: bool  #: the images do not fit the calibration
    world_from_camera: npt.NDArray[np.float64]  #: (4, 4)

    _arrays = {"world_from_camera": (c.Frame.world_from_camera.offset, (4, 4))}

    @staticmethod
    def _read(got: bytes) -> dict[str, Any]:
        _, time, _, touch_count, camera, wrong_pair, *_, left_to_go, inside, answer, passed_through, ringing = (
            _FRAME.unpack(got)
        )
        return {
            "time": time,
            "touch_count": touch_count,
            "answer": Answer(answer),
            "left_to_go": left_to_go,
            "inside": inside,
            "passed_through": passed_through,
            "ringing": ringing,
            "camera": CameraState(camera),
            "wrong_pair": bool(wrong_pair),
        }

    def to_dict(self) -> dict[str, Any]:
        """Name -> value."""
        return _dict_of(self)


@dataclass(frozen=True, eq=False)
class Touch(_Record):
    """One contact patch; vectors in the body frame."""

    body: int  #: index of the pressed body in the session
    by: int | None  #: index of the body that presses; None: a thing, or what the camera sees
    thing: int | None  #: id of the thing that presses; None: not known
    point: npt.NDArray[np.float64]  #: (3,) m, on the deformed skin
    normal: npt.NDArray[np.float64]  #: (3,) unit, out of the body: opposite to the force, as there is no friction
    force: npt.NDArray[np.float64]  #: (3,) N, on the body
    depth: float  #: m, displacement of the skin against `normal`
    area: float | None  #: m^2, pressed area of the skin; None: unknown
    assumed: float  #: share of the force from sides which the camera does not see
    unseen_for: float  #: s since the obstacle was last measured; 0: in this frame
    left_out: int  #: contact points near what presses for which there was no room; the nearest took part

    _arrays = {name: (getattr(c.Touch, name).offset, (3,)) for name in ("point", "normal", "force")}

    @staticmethod
    def _read(got: bytes) -> dict[str, Any]:
        _, body, by, *_, depth, area, assumed, unseen_for, thing, left_out = _TOUCH.unpack(got)
        return {
            "body": body,
            "by": None if by < 0 else by,
            "thing": None if thing == c.NO_THING else thing,
            "depth": depth,
            "area": area or None,
            "assumed": assumed,
            "unseen_for": unseen_for,
            "left_out": left_out,
        }

    def to_dict(self) -> dict[str, Any]:
        """Name -> number; vectors as point_x, point_y, ...: a row of a table."""
        return _dict_of(self)


def _dict_of(record: Any) -> dict[str, Any]:
    """Fields of a dataclass, vectors of three as three numbers."""
    row: dict[str, Any] = {}
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        if isinstance(value, np.ndarray) and value.shape == (3,):
            row.update({f"{field.name}_{axis}": float(number) for axis, number in zip("xyz", value)})
        else:
            row[field.name] = value
    return row


_IN_USE = "this session is used by another thread right now; open one for each thread"
_STALE = "this belongs to an earlier frame, or its session was reset or closed: take a new one from the session"


class _Core:
    """The session's handle and the frame whose arrays are given out."""

    def __init__(self, handle: _Handle, bodies: int) -> None:
        self.handle: _Handle | None = handle
        self.bodies = bodies
        self.number = 0  # of the frame
        self.lock = threading.Lock()
        self.frame, self.touch = c.Frame(ctypes.sizeof(c.Frame)), c.Touch(ctypes.sizeof(c.Touch))  # results, used again
        self._memory: weakref.ref[FrameMemory] = weakref.ref(FrameMemory(None))  # of this frame, while an array lives
        self._kept: FrameMemory | None = None  # this frame's, if kept for one that then failed to begin
        self._skins: dict[int, c.Skin] = {}  # of this frame
        self._depth: c.Depth | None = None

    def __enter__(self) -> int | None:
        """The handle's address, for this thread alone. A class is faster than contextlib here."""
        if not self.lock.acquire(False):
            raise InUse(_IN_USE)
        if self.handle is None:
            self.lock.release()
            raise Closed("the session is closed")
        return self.handle.address

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.lock.release()

    def begin_frame(self, function: Callable[..., int], *arguments: Any) -> None:
        """Calls what begins another frame. If it fails, the present frame stays as it is."""
        with self as address:
            self._keep(address)
            status = function(address, *arguments)
            if status in (0, Broken.status):
                self._forget()
            check(status)

    def close(self) -> None:
        if self.handle is None:
            return
        with self as address:
            self._keep(address)
            self._forget()
            handle, self.handle = self.handle, None
            if handle is not None:
                handle.free()

    def array(self, number: int, address: int, shape: tuple[int, ...], typestr: str) -> View:
        """An array of frame `number`, if that is still the present one."""
        if self.number != number:  # also where the session is closed
            raise StaleFrame(_STALE)
        if not self.lock.acquire(False):  # as in __enter__, which would take a third of the time of all this
            raise InUse(_IN_USE)
        try:
            if self.number != number:  # another thread may have begun a frame meanwhile
                raise StaleFrame(_STALE)
            memory = self._memory()
            if memory is None:
                memory = FrameMemory(self.handle)
                self._memory = weakref.ref(memory)
            return memory.array(address, shape, typestr)
        finally:
            self.lock.release()

    def skin(self, address: int | None, body: int) -> c.Skin:
        if body not in self._skins:
            skin = c.Skin(ctypes.sizeof(c.Skin))
            check(library().palpable_get_skin(address, body, ctypes.byref(skin)))
            self._skins[body] = skin
        return self._skins[body]

    def depth(self, address: int | None) -> c.Depth:
        if self._depth is None:
            depth = c.Depth(ctypes.sizeof(c.Depth))
            check(library().palpable_get_depth(address, ctypes.byref(depth)))
            self._depth = depth
        return self._depth

    def _keep(self, address: int | None) -> None:
        """Keeps the memory of the present frame if an array over it lives. That array, or one that NumPy made of it,
        may be read later."""
        memory = self._memory()
        if memory is None or memory.kept:
            return
        for body in range(self.bodies):  # afterwards the library no longer says where they are
            self.skin(address, body)
        try:
            self.depth(address)
        except NotPossible:
            pass  # no camera
        kept = ctypes.c_void_p()
        check(library().palpable_keep_frame(address, ctypes.byref(kept)))
        memory.owner, memory.kept = None, True
        weakref.finalize(memory, library().palpable_free_kept_frame, kept.value).atexit = False
        self._kept = memory

    def _forget(self) -> None:
        memory = self._memory()
        if memory is not None:
            memory.stale = True
            self._memory = weakref.ref(FrameMemory(None))
        self.number += 1
        self._kept = self._depth = None
        self._skins = {}


class Skin:
    """A body's skin in one frame: V vertices, T triangles. Arrays are read-only, in the library's own memory, without a
    copy; after the next frame they raise StaleFrame."""

    def __init__(self, core: _Core, skin: c.Skin) -> None:
        self._core, self._skin, self._number = core, skin, core.number

    @property
    def vertices(self) -> npt.NDArray[np.float32]:
        """(V, 3) m, body frame, deformed."""
        return self._array(self._skin.vertices, (self._skin.vertex_count, 3), _FLOATS)

    @property
    def normals(self) -> npt.NDArray[np.float32]:
        """(V, 3) unit, outwards."""
        return self._array(self._skin.normals, (self._skin.vertex_count, 3), _FLOATS)

    @property
    def von_mises(self) -> npt.NDArray[np.float32]:
        """(V,) Pa, von Mises stress of the true stress; 0 before the first frame."""
        return self._array(self._skin.von_mises, (self._skin.vertex_count,), _FLOATS)

    @property
    def contact_pressure(self) -> npt.NDArray[np.float32] | None:
        """(V,) Pa; None before the first frame, and for a body without tables of touch."""
        if not self._skin.contact_pressure:
            return None
        return self._array(self._skin.contact_pressure, (self._skin.vertex_count,), _FLOATS)

    @property
    def triangles(self) -> npt.NDArray[np.int32]:
        """(T, 3) indices of vertices, counterclockwise from outside; the same in every frame."""
        return self._array(self._skin.triangles, (self._skin.triangle_count, 3), _INTS)

    @property
    def world_from_body(self) -> npt.NDArray[np.float64]:
        """(4, 4), a copy."""
        return _doubles(bytes(self._skin), c.Skin.world_from_body.offset, (4, 4))

    @property
    def camera_from_body(self) -> npt.NDArray[np.float64]:
        """(4, 4), a copy."""
        return _doubles(bytes(self._skin), c.Skin.camera_from_body.offset, (4, 4))

    @property
    def stated_displacement_error(self) -> float:
        """Relative error of displacement as the library estimates it; NaN: unknown, or nothing touches."""
        return float(self._skin.stated_displacement_error)

    @property
    def stated_stress_error(self) -> float:
        """Largest error of a vertex / largest stress, as the library estimates it; NaN: as above."""
        return float(self._skin.stated_stress_error)

    def _array(self, address: int, shape: tuple[int, ...], typestr: str) -> View:
        return self._core.array(self._number, address, shape, typestr)


class DepthImage:
    """The measured depth of a frame, and the pinhole camera that it belongs to."""

    def __init__(self, core: _Core, depth: c.Depth) -> None:
        self._core, self._depth, self._number = core, depth, core.number
        self.fx, self.fy, self.cx, self.cy = float(depth.fx), float(depth.fy), float(depth.cx), float(depth.cy)  #: px

    @property
    def depth(self) -> npt.NDArray[np.float32]:
        """(height, width) m, Z; NaN where unknown. Read-only, without a copy."""
        return self._core.array(self._number, self._depth.depth, (self._depth.height, self._depth.width), _FLOATS)


class Session:
    """Bodies, at most one camera, and the state from frame to frame. Use it in a `with`, or close() it.

    bodies  a Body or several, at the poses that they have now; several bodies also press each other
    camera  None: press() presses. A Stereo: feed_stereo(). A Depth: feed_depth()

    A session is used by one thread at a time; another one gets InUse. Sessions in several threads run at once.
    """

    def __init__(self, bodies: Body | Sequence[Body], camera: Stereo | Depth | None = None) -> None:
        several = [bodies] if isinstance(bodies, Body) else list(bodies)
        setup = setup_of(camera)
        address = ctypes.c_void_p()
        with _PLACING:
            handles = (ctypes.c_void_p * len(several))(*(body._address() for body in several))
            check(library().palpable_open(handles, len(several), ctypes.byref(setup), ctypes.byref(address)))
        self._core = _Core(_Handle(address.value, library().palpable_close), len(several))
        self._time = math.nan

    def press(self, things: Things, time: float | None = None) -> None:
        """Processes one frame without a camera: skins deform, without friction, until they no longer penetrate.

        things  a Hand, Capsules, an (N, 8) array of capsules (a thing with the id 0), or a list of those; [] presses
                nothing. From call to call a capsule should advance by less than its radius
        time    s, larger than that of the previous call; None: a second after it

        `frame.answer` says whether the skin has given way to everything.
        """
        rows, pressing = self._rows(things)
        if time is None:
            time = 1.0 if math.isnan(self._time) else self._time + 1
        self._core.begin_frame(library().palpable_press_at, rows, len(pressing), time)
        self._time = time

    def tick(self, things: Things, time: float) -> tuple[npt.NDArray[np.float64], bool]:
        """The forces on things alone, for a force device: may be called a thousand times a second (docs/haptics.md).

        things  as for press()
        time    s, larger than that of the previous call of press() or tick(), about a millisecond

        Returns (N, 6), of each thing: force in N and torque about the origin in N m, world frame, by the bodies on it;
        and whether these balance the body. Where they do not, a device keeps its last force. Touches, skins and frame
        stay those of the last press(), which goes on from here.
        """
        rows, pressing = self._rows(things)
        forces, reached = np.zeros((len(pressing), 6)), ctypes.c_int32()
        with self._core as session:
            check(library().palpable_tick_at(session, rows, len(pressing), time, forces.ctypes.data, ctypes.byref(reached)))
        self._time = time
        return forces, reached.value != 0

    @staticmethod
    def _rows(things: Things) -> tuple[bytes, Sequence[Capsules]]:
        """The things as an array of palpable_thing, and the memory that it points to."""
        pressing = list_of_things(things)
        rows = b"".join(_THING.pack(_THING.size, one.id, address_of(one.capsules), len(one.capsules), one._friction_of_c()) for one in pressing)
        return rows, pressing

    def feed_depth(
        self,
        depth: npt.ArrayLike,
        time: float,
        color: npt.ArrayLike | None = None,
        world_from_camera: npt.ArrayLike | None = None,
        bgr: bool = False,
    ) -> None:
        """Processes one frame of a depth camera.

        depth              (H, W) float32, Z in m; unknown where it is NaN, infinite or <= 0
        time               s, larger than that of the previous frame
        color              (H, W), (H, W, 3) or (H, W, 4) uint8 of the same view; None: there is none
        world_from_camera  (4, 4) pose of the camera, then needed with every frame; NaN first: unknown. None: it stands
                           still or is followed
        bgr                color is BGR, as OpenCV has it, not RGB
        """
        image, _depth = image_of(depth, "depth", bgr, depth=True)
        colors, _color = (None, None) if color is None else image_of(color, "color", bgr)
        pose = None if world_from_camera is None else pose_of(world_from_camera, "world_from_camera")
        of_color = None if colors is None else ctypes.byref(colors)
        place = None if pose is None else address_of(pose)
        self._core.begin_frame(library().palpable_feed_depth, ctypes.byref(image), of_color, place, time)

    def feed_stereo(
        self,
        left: npt.ArrayLike,
        right: npt.ArrayLike,
        time: float,
        world_from_camera: npt.ArrayLike | None = None,
        bgr: bool = False,
    ) -> None:
        """Processes one pair of a stereo camera.

        left, right  (H, W), (H, W, 3) or (H, W, 4) uint8

        The other arguments are those of feed_depth().
        """
        first, _left = image_of(left, "left", bgr)
        second, _right = image_of(right, "right", bgr)
        pose = None if world_from_camera is None else pose_of(world_from_camera, "world_from_camera")
        place = None if pose is None else address_of(pose)
        self._core.begin_frame(library().palpable_feed_stereo, ctypes.byref(first), ctypes.byref(second), place, time)

    @property
    def frame(self) -> Frame:
        """The frame that was processed last."""
        with self._core as session:
            got = self._core.frame
            check(library().palpable_get_frame(session, ctypes.byref(got)))
            return Frame._of(got)

    @property
    def touches(self) -> list[Touch]:
        """The touches of the frame processed last, the largest force first."""
        found = []
        with self._core as session:
            frame, got = self._core.frame, self._core.touch
            check(library().palpable_get_frame(session, ctypes.byref(frame)))
            for index in range(frame.touch_count):
                check(library().palpable_get_touch(session, index, ctypes.byref(got)))
                found.append(Touch._of(got))
        return found

    def skin(self, body: int = 0) -> Skin:
        """The skin of a body, by its index among the session's bodies; at rest before the first frame."""
        with self._core as session:
            return Skin(self._core, self._core.skin(session, body))

    @property
    def depth(self) -> DepthImage:
        """The depth of the frame processed last; NotPossible before the first one and without a camera."""
        with self._core as session:
            return DepthImage(self._core, self._core.depth(session))

    def reset(self) -> None:
        """Discards all frames: the next one counts as the first."""
        self._core.begin_frame(library().palpable_reset)
        self._time = math.nan

    def close(self) -> None:
        """Closes it; a second time does nothing. Arrays of its last frame raise StaleFrame from then on."""
        self._core.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def _doubles(got: bytes, offset: int, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
    """A read-only array over numbers in a copy of a struct; faster than np.array() of the member."""
    numbers = np.frombuffer(got, np.float64, math.prod(shape), offset)
    return numbers if len(shape) == 1 else numbers.reshape(shape)
