#!/usr/bin/env python3
"""check_pictures.py [PICTURE ...]: the pictures with which README begins show stress on a body.

Checked are the pictures and films (GIF, WebP, PNG, JPEG) above README's first section, or those named. Only the rose part
of the colour scale is counted, between the shares SHARES of color_map.glsl: blue also occurs on sleeves and books of the
synthetic desk, orange and yellow on its wood. A pixel is rose when its hue is one of the scale's there and its saturation
half of the scale's least or more, because light on a body changes the brightness. The bar of a legend is left out.

A picture needs SPOT of its area in rose, which is a round spot a thirtieth as wide as a picture of 16 x 9. A film needs
as much in a tenth of its frames. Needs Debian's python3-pil and python3-numpy; without them: SKIPPED.
"""
import os
import re
import sys
from pathlib import Path

try:
    import numpy
    from PIL import Image, ImageSequence
except ImportError as missing:
    debian = "/usr/bin/python3"  # Debian's packages are of this one
    if os.path.realpath(sys.executable) == os.path.realpath(debian) or not os.path.exists(debian):
        print(f"SKIPPED: {missing}; apt-get install python3-pil python3-numpy")
        sys.exit(0)
    os.execv(debian, [debian, *sys.argv])

ROOT = Path(__file__).resolve().parent.parent
SHADER = ROOT / "src/palpable/live/render/shaders/color_map.glsl"
SHARES = (0.2, 0.5)  # from where the colours cover the material (kOpaqueShare) to where rose turns to orange
SPOT = 0.0015        # of the picture's area
FRAMES = 0.1         # of a film's
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)[^)]*\)|<(?:img|source)[^>]*?src(?:set)?=\"([^\"\s]+)", re.IGNORECASE)


def hue_saturation(rgb):
    """Hue in degrees and saturation (0..1) of colours (... x 3, 0..1)."""
    red, green, blue = (rgb[..., k] for k in range(3))
    most, least = rgb.max(-1), rgb.min(-1)
    span = numpy.where(most > least, most - least, 1)
    hue = numpy.where(most == red, (green - blue) / span % 6,
                      numpy.where(most == green, (blue - red) / span + 2, (red - green) / span + 4))
    return 60 * hue, (most - least) / numpy.maximum(most, 1e-3)


def rose_of_scale():
    """The scale's hues (least, largest) in degrees and its least saturation between SHARES."""
    powers = re.findall(r"vec3 c\d = vec3\((.+?)\)", SHADER.read_text())[:7]  # of the first scale, the default
    factors = numpy.array([[float(number.strip().rstrip("f")) for number in power.split(",")] for power in powers])
    share = numpy.linspace(*SHARES, 31)[:, None]
    hue, saturation = hue_saturation(numpy.clip(sum(factors[k] * share**k for k in range(7)), 0, 1))
    return hue.min(), hue.max(), saturation.min()


def patches(mask):
    """Connected pixels of a mask, each patch as a list of (row, column)."""
    left = set(zip(*map(numpy.ndarray.tolist, numpy.nonzero(mask))))
    while left:
        todo, patch = [left.pop()], []
        while todo:
            y, x = todo.pop()
            patch.append((y, x))
            near = {(y + i, x + j) for i in (-1, 0, 1) for j in (-1, 0, 1)} & left
            left -= near
            todo += near
        yield patch


def is_bar(patch):
    """Whether it is a legend's: a rectangle, three times longer than wide."""
    rows, columns = zip(*patch)
    sides = sorted((max(rows) - min(rows) + 1, max(columns) - min(columns) + 1))
    return len(patch) > 0.85 * sides[0] * sides[1] and sides[1] > 3 * sides[0]


def rose_share(picture, scale):
    """The share of a picture's area that is rose, legends left out."""
    rgb = numpy.asarray(picture.convert("RGB"), float) / 255
    hue, saturation = hue_saturation(rgb)
    mask = (hue >= scale[0]) & (hue <= scale[1]) & (saturation >= scale[2] / 2) & (rgb.max(-1) >= 0.3)
    if mask.mean() < SPOT:
        return mask.mean()
    return sum(len(patch) for patch in patches(mask) if not is_bar(patch)) / mask.size


def pictures_of_readme():
    top = re.split(r"^## ", (ROOT / "README.md").read_text(), maxsplit=1, flags=re.MULTILINE)[0]
    names = [a or b for a, b in PICTURE.findall(top)]
    return [ROOT / name for name in names if not re.match(r"[a-z]+:", name) and not name.endswith(".svg")]


def main():
    named = [Path(name) for name in sys.argv[1:]]
    pictures, scale, wrong = named or pictures_of_readme(), rose_of_scale(), 0
    if not pictures:
        sys.exit("check_pictures: README.md shows no picture above its first section")
    for path in pictures:
        with Image.open(path) as picture:
            shares = [rose_share(frame, scale) for frame in ImageSequence.Iterator(picture)]
        enough = sum(share >= SPOT for share in shares)
        needed = max(1, round(FRAMES * len(shares)))
        good = enough >= needed
        wrong += not good
        print(f"{path.name}: {'stress is visible' if good else 'SHOWS NO STRESS'}: {100 * max(shares):.2f} % of the area is rose "
              f"at most; {enough} of {len(shares)} frames have {100 * SPOT:.2f} % ({needed} needed)")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
