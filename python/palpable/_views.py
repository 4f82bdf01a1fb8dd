"""Arrays over the library's memory, which are valid for one frame.

`View` is a read-only ndarray. Reading one of an earlier frame raises StaleFrame, whichever way it is read. Plain arrays
that NumPy makes of it (np.asarray, memoryview) cannot be watched; for their sake the memory of a frame is kept
(palpable_keep_frame) when the next one begins while any array of it lives. So the numbers of an array never change or vanish.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ._errors import StaleFrame


class FrameMemory:
    """The memory of one frame of a session; every array over it holds a reference to it."""

    def __init__(self, owner: object) -> None:
        self.owner: object = owner  #: the session's handle, so that the session is not closed meanwhile
        self.stale = False
        self.kept = False

    def array(self, address: int, shape: tuple[int, ...], typestr: str) -> View:
        """The array at this address, without a copy; `typestr` as in np.dtype.str."""
        memory = _Memory()
        memory.frame = self
        memory.__array_interface__ = {"version": 3, "shape": shape, "typestr": typestr, "data": (address, True)}
        view = np.asarray(memory).view(View)
        view._frame = self
        return view


class _Memory:
    """NumPy's protocol for foreign memory; the array that is made from it keeps it alive, and with it the frame. A
    memoryview at the address would take 0.4 us less, but whoever took it from `view.base` could read memory that is gone.
    Without __init__, which is half as long again."""

    __slots__ = ("frame", "__array_interface__")
    frame: FrameMemory
    __array_interface__: dict[str, Any]


class View(np.ndarray[Any, Any]):
    """A read-only array over the library's memory. After the session's next frame, reset() or close() every attempt to
    read it raises StaleFrame; `.copy()` makes a plain array that lasts. Slices and reshaped views behave alike; what is
    computed from it (`skin.vertices * 1000`) is a plain array."""

    _frame: FrameMemory | None = None

    def __array_finalize__(self, source: object) -> None:
        # Its base is a view where it shares memory with one. Copies, such as view[[1, 2]], belong to no frame.
        base = self.base
        if isinstance(base, View):
            self._frame = base._frame

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        return getattr(ufunc, method)(*_plain(inputs), **_plain(options))

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        _check_all((args, kwargs))
        return _released(super().__array_function__(function, types, args, kwargs))

    def __reduce_ex__(self, protocol: Any) -> Any:
        return self.copy().__reduce_ex__(protocol)


def _check(view: View) -> None:
    if view._frame is not None and view._frame.stale:
        raise StaleFrame(
            "this array belongs to an earlier frame, or its session was reset or closed: "
            "take a new one from the session, or .copy() it before the next frame"
        )


def _check_all(value: Any) -> None:
    """Checks every view in the arguments of a NumPy function."""
    if isinstance(value, View):
        _check(value)
    elif isinstance(value, (tuple, list)):
        for item in value:
            _check_all(item)
    elif isinstance(value, dict):
        _check_all(list(value.values()))


def _plain(value: Any) -> Any:
    """The same arguments with plain arrays in place of views."""
    if isinstance(value, View):
        _check(value)
        return np.ndarray.view(value, np.ndarray)
    if isinstance(value, tuple):
        return tuple(_plain(item) for item in value)
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return value


def _released(result: Any) -> Any:
    """What a function of NumPy has returned; an array with memory of its own becomes a plain one."""
    if isinstance(result, View) and result._frame is None:
        return _ORIGINAL["view"](result, np.ndarray)
    if isinstance(result, (tuple, list)) and any(isinstance(item, View) for item in result):
        return type(result)(_released(item) for item in result)
    return result


# What tells of an array's form and not of its numbers, and what Python needs to handle the object at all.
_OF_FORM = {
    *("shape", "dtype", "ndim", "size", "nbytes", "strides", "itemsize", "flags", "__len__"),
    *("__new__", "__class__", "__doc__", "__array_finalize__", "__array_ufunc__", "__array_function__"),
    *("__array_priority__", "__class_getitem__", "__setstate__", "__reduce_ex__", "__hash__"),
}
_ORIGINAL = {name: member for name, member in vars(np.ndarray).items() if name not in _OF_FORM}


def _checked_method(member: Callable[..., Any]) -> Callable[..., Any]:
    def method(self: View, *args: Any, **options: Any) -> Any:
        _check(self)
        return _released(member(self, *args, **options))

    method.__name__, method.__doc__ = member.__name__, member.__doc__
    return method


def _checked_property(member: Any) -> property:
    def get(self: View) -> Any:
        if self._frame is not None:
            _check(self)
        return member.__get__(self)

    return property(get, member.__set__ if hasattr(member, "__set__") else None, doc=member.__doc__)


# Every method and property of ndarray, those of later versions of NumPy included, checks first.
for _name, _member in _ORIGINAL.items():
    if callable(_member):
        setattr(View, _name, _checked_method(_member))
    elif hasattr(_member, "__get__") and _name != "base":
        setattr(View, _name, _checked_property(_member))
