"""Pictures of a camera as the C interface takes them: NumPy arrays, whose row strides are respected."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _library as c
from ._errors import WrongArgument
from ._things import address_of


@dataclass(frozen=True)
class Stereo:
    """A stereo camera for a Session.

    width, height   px, of each image; 0: the size in the calibration file
    fx, fy, cx, cy  px, of a rectified eye
    baseline        m, between rectified eyes
    calibration     a calibration file in place of the numbers: OpenCV YAML of a rig (raw pairs) or of rectified pairs,
                    or a ZED's SN*.conf
    follow_camera   the camera moves, and its pose is found from the images
    press_static    everything that the camera sees presses from the first frame on, not only what came later
    nearest         m, the smallest depth that is searched; 0: 0.12
    farthest        m, larger depths count as unknown; 0: 20
    threads         for matching, up to 64; 0: 2. Does not change any result
    full_resolution matches at full resolution, which takes 6 times as long
    """

    width: int = 0
    height: int = 0
    fx: float = 0
    fy: float = 0
    cx: float = 0
    cy: float = 0
    baseline: float = 0
    calibration: str | None = None
    follow_camera: bool = False
    press_static: bool = False
    nearest: float = 0
    farthest: float = 0
    threads: int = 0
    full_resolution: bool = False


@dataclass(frozen=True)
class Depth:
    """A depth camera for a Session.

    width, height   px; 0: the size in the calibration file
    fx, fy, cx, cy  px, of the depth image
    calibration     a text file `fx fy cx cy width height` in place of the numbers
    follow_camera   the camera moves, and its pose is found from the images; needs colour images
    press_static    everything that the camera sees presses from the first frame on, not only what came later
    farthest        m, larger depths count as unknown; 0: 20
    """

    width: int = 0
    height: int = 0
    fx: float = 0
    fy: float = 0
    cx: float = 0
    cy: float = 0
    calibration: str | None = None
    follow_camera: bool = False
    press_static: bool = False
    farthest: float = 0


def setup_of(camera: Stereo | Depth | None) -> c.Setup:
    setup = c.Setup(ctypes.sizeof(c.Setup))
    if camera is None:
        return setup
    setup.camera = c.STEREO if isinstance(camera, Stereo) else c.COLOR_DEPTH
    for name, value in vars(camera).items():
        if name == "calibration":
            value = None if value is None else str(value).encode()
        setattr(setup, name, value)
    return setup


def image_of(pixels: npt.ArrayLike, name: str, bgr: bool, depth: bool = False) -> tuple[c.Image, npt.NDArray[Any]]:
    """C's image, and the array whose memory it names, which has to live during the call. Only where pixels of a row do
    not follow one another, or rows do not go downwards, is the picture copied."""
    array = np.asarray(pixels)
    wanted = np.dtype(np.float32 if depth else np.uint8)
    if array.dtype != wanted:
        raise WrongArgument(f"{name} has numbers of type {array.dtype}, not {wanted}" + (" (m)" if depth else ""))
    channels = array.shape[2] if array.ndim == 3 else 1
    if array.ndim not in (2, 3) or channels not in (1, 3, 4) or (depth and array.ndim != 2):
        raise WrongArgument(f"{name} has the shape {array.shape}, not " + ("(H, W)" if depth else "(H, W), (H, W, 3) or (H, W, 4)"))
    pixel = wanted.itemsize * channels
    inside = array.strides[1] == pixel and (array.ndim == 2 or array.strides[2] == wanted.itemsize)
    if not inside or array.strides[0] < array.shape[1] * pixel:
        array = np.ascontiguousarray(array)
    if depth:
        format_ = c.DEPTH_F32
    else:
        format_ = {1: c.GRAY8, 3: c.BGR8 if bgr else c.RGB8, 4: c.RGBA8}[channels]
    height, width = array.shape[:2]
    return c.Image(ctypes.sizeof(c.Image), address_of(array), width, height, format_, array.strides[0]), array
