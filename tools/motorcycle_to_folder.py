#!/usr/bin/env python3
"""Lays out the Middlebury motorcycle pair as a folder for `palpable live --source`.

Debian's python3-skimage brings the pair and its true disparity (741 x 500 px; D. Scharstein et al.,
GCPR 2014). Written are left/ right/ rectified.yml and, for tests, truth/disparity.png: 16 bit,
1/256 px, 0 where unknown. Needs no package but Python's own.

    tools/motorcycle_to_folder.py OUT [DATA]
"""
import array
import ast
import pathlib
import shutil
import struct
import sys
import zipfile
import zlib

DEBIAN = "/usr/lib/python3/dist-packages/skimage/data"

# As published with the pair, at a quarter of the original size.
RECTIFIED = """%YAML:1.0
---
width: 741
height: 500
fx: 994.978
fy: 994.978
cx: 311.193
cy: 254.877
baseline_m: 0.193001
doffs_px: 31.086
"""


def read_npz(path):
    """The only float32 array of an .npz: (width, height, values)."""
    with zipfile.ZipFile(path) as archive:
        data = archive.read(archive.namelist()[0])
    header_size = struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:10 + header_size].decode("latin1"))
    if header["descr"] != "<f4" or header["fortran_order"]:
        sys.exit(f"{path}: expected rows of little-endian float32, found {header}")
    height, width = header["shape"]
    values = array.array("f", data[10 + header_size:])
    if sys.byteorder == "big":
        values.byteswap()
    return width, height, values


def write_png16(path, width, height, values):
    """Writes a grey PNG of 16 bits."""
    rows = bytearray()
    for y in range(height):
        row = array.array("H", values[y * width:(y + 1) * width])
        if sys.byteorder == "little":
            row.byteswap()  # PNG is big-endian
        rows += b"\0" + row.tobytes()

    def chunk(kind, content):
        crc = zlib.crc32(kind + content)
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", crc)

    path.write_bytes(b"\x89PNG\r\n\x1a\n"
                     + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(bytes(rows), 6)) + chunk(b"IEND", b""))


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    out = pathlib.Path(sys.argv[1])
    data = pathlib.Path(sys.argv[2] if len(sys.argv) == 3 else DEBIAN)
    if not (data / "motorcycle_left.png").exists():
        sys.exit(f"{data} has no motorcycle_left.png: install Debian's python3-skimage")
    for folder in ("left", "right", "truth"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    shutil.copyfile(data / "motorcycle_left.png", out / "left" / "000000.png")
    shutil.copyfile(data / "motorcycle_right.png", out / "right" / "000000.png")
    (out / "rectified.yml").write_text(RECTIFIED)
    width, height, disparity = read_npz(data / "motorcycle_disp.npz")
    steps = [round(256 * d) if 0 < d < 255.9 else 0 for d in disparity]  # inf means unknown
    write_png16(out / "truth" / "disparity.png", width, height, steps)


if __name__ == "__main__":
    main()
