"""What goes wrong: `Error` and its kinds. The text is that of the C library or of the program."""

from __future__ import annotations


class Error(Exception):
    """Something that palpable could not do; its text is one line for people."""

    #: The palpable_status of the C function that failed, None where no C function did.
    status: int | None = None


class WrongArgument(Error, ValueError):
    """A value that cannot be: NaN, a radius of 0, a time that does not grow, a picture of another size."""

    status = 1


class WrongFile(Error):
    """A file that is missing, not readable, damaged or of another layout."""

    status = 2


class NotPossible(Error):
    """What this body or this session cannot do, such as pressing a session that has a camera."""

    status = 3


class NoMemory(Error, MemoryError):
    """There is not enough memory."""

    status = 4


class Broken(Error):
    """A bug of the library. The session can only be reset or closed."""

    status = 5


class Closed(Error):
    """A session or body was used after close()."""


class InUse(Error):
    """A session was used by two threads at once. Each thread may use a session of its own."""


class StaleFrame(Error):
    """An array of an earlier frame was read. `.copy()` before the next frame keeps the numbers."""


class LibraryMissing(Error, ImportError):
    """libpalpable.so.0 was not found, or it is older than this package."""


class ProgramFailed(Error):
    """A program of palpable is missing, or it ended with an error; the text is its last line."""


_BY_STATUS = {kind.status: kind for kind in (WrongArgument, WrongFile, NotPossible, NoMemory, Broken)}


def error_of(status: int, text: str) -> Error:
    """The exception for a palpable_status that is not PALPABLE_OK."""
    error = _BY_STATUS.get(status, Error)(text)
    error.status = status
    return error
