"""Palpable from Python: virtual rubber that real things press. docs/python.md begins with ten lines."""

from ._body_file import Axis, BodyFile, ErrorCurve, Field, read_body
from ._errors import (
    Broken,
    Closed,
    Error,
    InUse,
    LibraryMissing,
    NoMemory,
    NotPossible,
    ProgramFailed,
    StaleFrame,
    WrongArgument,
    WrongFile,
)
from ._images import Depth, Stereo
from ._library import library_version
from ._programs import Baked, Clip, Progress, Run, Score, bake, live, reduce, score, synth
from ._session import Answer, Body, CameraState, DepthImage, Frame, Session, Skin, Touch
from ._snapshots import Parameters, Reduced, Snapshots, snapshots
from ._things import Capsules, Hand
from ._version import __version__

__all__ = [
    "Answer",
    "Axis",
    "Baked",
    "Body",
    "BodyFile",
    "Broken",
    "CameraState",
    "Capsules",
    "Clip",
    "Closed",
    "Depth",
    "DepthImage",
    "Error",
    "ErrorCurve",
    "Field",
    "Frame",
    "Hand",
    "InUse",
    "LibraryMissing",
    "NoMemory",
    "NotPossible",
    "Parameters",
    "ProgramFailed",
    "Progress",
    "Reduced",
    "Run",
    "Score",
    "Session",
    "Skin",
    "Snapshots",
    "StaleFrame",
    "Stereo",
    "Touch",
    "WrongArgument",
    "WrongFile",
    "__version__",
    "bake",
    "library_version",
    "live",
    "read_body",
    "reduce",
    "score",
    "snapshots",
    "synth",
]
