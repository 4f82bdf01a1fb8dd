#!/usr/bin/env python3
"""What Python adds to the time of a frame, beside the same calls of C through bare ctypes, in one run.

    PYTHONPATH=python PALPABLE_LIBRARY=build/release/lib/libpalpable.so.0 /usr/bin/python3 bench/python_cost.py BODY [--calls N]

Presses the body's top by a finger of radius 8 mm and reads touches, their forces and a skin with three arrays. Prints medians and the
quickest tenth. The bar is 50 us; the physical limit is the time of the calls themselves, a few us.
"""
import argparse
import ctypes
import time

import numpy as np
import palpable
from palpable import _library as c


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("body")
    parser.add_argument("--calls", type=int, default=2000)
    words = parser.parse_args()
    library, session = c.library(), palpable.Session(palpable.Body(words.body))
    top = session.skin().vertices
    x, y, z = top[top[:, 2].argmax()].astype(float)
    capsules = np.array([[x, y, z + 0.004, x, y, z + 0.064, 0.008, 0.008]])
    address = session._core.handle.address
    thing = c.Thing(ctypes.sizeof(c.Thing), 0, capsules.ctypes.data, 1)
    frame, touch, skin = (kind(ctypes.sizeof(kind)) for kind in (c.Frame, c.Touch, c.Skin))
    reference = [ctypes.byref(each) for each in (thing, frame, touch, skin)]

    def bare(k):
        library.palpable_press_at(address, reference[0], 1, k)
        library.palpable_get_frame(address, reference[1])
        library.palpable_get_touch(address, 0, reference[2])
        library.palpable_get_skin(address, 0, reference[3])

    def whole(k):
        session.press(capsules, k)
        for touch in session.touches:
            touch.force
        got = session.skin()
        return got.vertices, got.normals, got.von_mises

    def seconds(call, k):
        start = time.perf_counter()
        call(k)
        return time.perf_counter() - start

    # One after the other, so that both see the same machine.
    taken = np.array([(seconds(bare, 2 * k), seconds(whole, 2 * k + 1)) for k in range(1, words.calls)])
    for name, quantile in (("quickest tenth", 10), ("median", 50)):
        of_c, of_python = 1e6 * np.percentile(taken, quantile, axis=0)
        print(f"{name}: C {of_c:.0f} us, Python {of_python:.0f} us: {of_python - of_c:.0f} us more, {of_python / of_c:.2f} of it")


if __name__ == "__main__":
    main()
