"""libpalpable.so by ctypes: the structs and functions of palpable.h and hands.h, member by member.

Only this file knows how C lays things out; tests/python/test_same_as_c.py compares it with the headers.
"""

from __future__ import annotations

import ctypes
import functools
import os
from ctypes import POINTER, Structure, c_char_p, c_double, c_int32, c_int64, c_size_t, c_void_p
from pathlib import Path

from ._errors import LibraryMissing, error_of

NO_THING = -(2**63)
HAND_CAPSULES = 26
NO_CAMERA, STEREO, COLOR_DEPTH = 0, 1, 2
GRAY8, RGB8, BGR8, RGBA8, DEPTH_F32 = 1, 2, 3, 4, 5

Pose = c_double * 16
Vector = c_double * 3


class Setup(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("camera", c_int32),
        ("width", c_int32),
        ("height", c_int32),
        ("fx", c_double),
        ("fy", c_double),
        ("cx", c_double),
        ("cy", c_double),
        ("baseline", c_double),
        ("calibration", c_char_p),
        ("follow_camera", c_int32),
        ("press_static", c_int32),
        ("nearest", c_double),
        ("farthest", c_double),
        ("threads", c_int32),
        ("full_resolution", c_int32),
    ]


class Image(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("pixels", c_void_p),
        ("width", c_int32),
        ("height", c_int32),
        ("format", c_int32),
        ("stride", c_size_t),
    ]


class Thing(Structure):
    _fields_ = [("size", c_size_t), ("id", c_int64), ("capsules", c_void_p), ("count", c_size_t), ("friction", c_double)]


class Frame(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("time", c_double),
        ("body_count", c_int32),
        ("touch_count", c_int32),
        ("camera", c_int32),
        ("wrong_pair", c_int32),
        ("world_from_camera", Pose),
        ("left_to_go", c_double),
        ("inside", c_double),
        ("answer", c_int32),
        ("passed_through", c_int32),
        ("ringing", c_double),
    ]


class Touch(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("body", c_int32),
        ("by", c_int32),
        ("point", Vector),
        ("normal", Vector),
        ("force", Vector),
        ("depth", c_double),
        ("area", c_double),
        ("assumed", c_double),
        ("unseen_for", c_double),
        ("thing", c_int64),
        ("left_out", c_int64),
    ]


class Skin(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("vertex_count", c_int32),
        ("triangle_count", c_int32),
        ("vertices", c_void_p),
        ("normals", c_void_p),
        ("von_mises", c_void_p),
        ("triangles", c_void_p),
        ("world_from_body", Pose),
        ("camera_from_body", Pose),
        ("stated_displacement_error", c_double),
        ("stated_stress_error", c_double),
        ("contact_pressure", c_void_p),
    ]


class Depth(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("width", c_int32),
        ("height", c_int32),
        ("depth", c_void_p),
        ("fx", c_double),
        ("fy", c_double),
        ("cx", c_double),
        ("cy", c_double),
    ]


# Arguments of each function that returns a palpable_status. Handles and arrays are plain addresses.
_FUNCTIONS = {
    "palpable_load_body": [c_char_p, c_double, POINTER(c_void_p)],
    "palpable_place_body": [c_void_p, c_void_p],
    "palpable_set_friction": [c_void_p, c_double],
    "palpable_set_dynamics": [c_void_p, c_int32],
    "palpable_open": [c_void_p, c_size_t, POINTER(Setup), POINTER(c_void_p)],
    "palpable_reset": [c_void_p],
    "palpable_feed_stereo": [c_void_p, POINTER(Image), POINTER(Image), c_void_p, c_double],
    "palpable_feed_depth": [c_void_p, POINTER(Image), POINTER(Image), c_void_p, c_double],
    "palpable_press_at": [c_void_p, c_void_p, c_size_t, c_double],
    "palpable_tick_at": [c_void_p, c_void_p, c_size_t, c_double, c_void_p, c_void_p],
    "palpable_get_frame": [c_void_p, POINTER(Frame)],
    "palpable_get_touch": [c_void_p, c_int32, POINTER(Touch)],
    "palpable_get_skin": [c_void_p, c_int32, POINTER(Skin)],
    "palpable_get_depth": [c_void_p, POINTER(Depth)],
    "palpable_keep_frame": [c_void_p, POINTER(c_void_p)],
    "palpable_hand_capsules": [c_int32, c_int32, c_void_p, c_void_p, c_void_p],
}
_FREES = ("palpable_free_body", "palpable_close", "palpable_free_kept_frame")


def _file() -> str:
    """The library: as PALPABLE_LIBRARY names it, beside this file, or the system's."""
    beside = Path(__file__).with_name("libpalpable.so.0")
    return os.environ.get("PALPABLE_LIBRARY") or (str(beside) if beside.exists() else "libpalpable.so.0")


@functools.lru_cache(maxsize=None)
def library() -> ctypes.CDLL:
    """The library, loaded once, with the types of its functions set. ctypes releases the GIL in every call."""
    name = _file()
    try:
        loaded = ctypes.CDLL(name)
    except OSError as reason:
        raise LibraryMissing(
            f"{name} cannot be loaded ({reason}): install the Debian package libpalpable0, "
            "or set PALPABLE_LIBRARY to the file libpalpable.so.0"
        ) from None
    for function in (*_FUNCTIONS, *_FREES, "palpable_version", "palpable_last_error"):
        if not hasattr(loaded, function):
            raise LibraryMissing(f"{name} is older than this package: it has no {function}; install a newer libpalpable0")
    for function, arguments in _FUNCTIONS.items():
        getattr(loaded, function).argtypes = arguments
        getattr(loaded, function).restype = c_int32
    for function in _FREES:
        getattr(loaded, function).argtypes = [c_void_p]
        getattr(loaded, function).restype = None
    for function in ("palpable_version", "palpable_last_error"):
        getattr(loaded, function).argtypes = []
        getattr(loaded, function).restype = c_char_p
    return loaded


def check(status: int) -> None:
    """Raises what the last call on this thread complains of, if its status is not PALPABLE_OK."""
    if status:
        raise error_of(status, library().palpable_last_error().decode(errors="replace"))


def library_version() -> str:
    """Version of libpalpable.so, such as "0.2.0"."""
    return str(library().palpable_version().decode())
