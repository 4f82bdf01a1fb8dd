"""Memory and time over many frames."""
import ctypes
import gc

import numpy as np
import palpable
from conftest import finger

PARTS, FRAMES_OF_PART = 8, 1500


def resident():
    """Bytes that the process has in memory, without what malloc keeps free for later.

    Of smaps_rollup, which counts pages: the numbers of statm are sums that each processor keeps for itself and adds now and then.
    """
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    with open("/proc/self/smaps_rollup") as lines:
        return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("Rss:"))


def test_twelve_thousand_frames_take_no_more_memory(ball):
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

    sizes = []
    for _ in range(PARTS):
        frames(FRAMES_OF_PART)
        sizes.append(resident())
    # What leaks grows in each part. The allocator keeps a body's 4 MB or gives them back, by turns: so parts are compared
    # with the last but one. What it keeps for later it has taken after some parts: so only the last ones count.
    growth = float(np.median(np.subtract(sizes[2:], sizes[:-2])[-3:]))
    print(f"{growth / 1e3:.0f} kB more in {2 * FRAMES_OF_PART} frames, of {[size // 1000 for size in sizes]} kB")
    assert growth < 200_000
