"""Memory and time over many frames."""
import ctypes
import gc

import numpy as np
import palpable
from conftest import finger

FRAMES = 10_000


def resident():
    """Bytes that the process has in memory, without what malloc keeps free for later."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    with open("/proc/self/statm") as numbers:
        return int(numbers.read().split()[1]) * 4096


def test_ten_thousand_frames_take_no_more_memory(ball):
    """With arrays held over frames, sessions opened, closed twice, dropped, and refused calls among them."""
    body = palpable.Body(ball)
    fingers = [finger(0.003 + 0.0001 * k) for k in range(10)]
    session, held = palpable.Session(body), []

    def frames(count):
        nonlocal session, held
        for k in range(count):
            session.press(fingers[k % 10])
            session.touches, session.frame
            skin = session.skin()
            held = [skin.vertices, np.asarray(skin.von_mises)] if k % 3 == 0 else held[:1]
            if k % 50 == 0:
                session.close()
                session.close()
                session = palpable.Session(body)
            if k % 50 == 25:
                session = palpable.Session(palpable.Body(ball) if k % 500 == 25 else body)
            if k % 7 == 0:
                try:
                    session.press(fingers[0] * np.nan)
                except palpable.WrongArgument:
                    pass

    frames(2000)
    before = resident()
    frames(FRAMES)
    growth = resident() - before
    print(f"{growth / 1e3:.0f} kB more after {FRAMES} frames")
    assert growth < 2_000_000
