"""Threads: a session belongs to one at a time, several sessions run at once, and nothing crashes meanwhile."""
import gc
import threading
import time

import numpy as np
import palpable
import pytest
from conftest import finger


def many_capsules(count=3000):
    """A call that takes milliseconds."""
    x = np.linspace(-0.03, 0.03, count)
    return np.vstack([finger(0.003, x=each) for each in x])


def in_thread(work):
    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    return thread


def test_two_sessions_in_two_threads_run_at_once(ball):
    """While one call of the first session lasts, the second one finishes many: the GIL is released."""
    body = palpable.Body(ball)
    slow, fast = palpable.Session(body), palpable.Session(body)
    capsules, ends, most, done = many_capsules(), [], 0, threading.Event()

    def press_often():
        while not done.is_set():
            fast.press(finger(0.004))
            ends.append(time.perf_counter())

    thread = in_thread(press_often)
    for k in range(50):
        begin = time.perf_counter()
        slow.press(capsules if k % 2 else capsules + [[0, 0, -0.001, 0, 0, -0.001, 0, 0]])
        end = time.perf_counter()
        most = max(most, sum(begin < each < end for each in list(ends)))
        if most >= 10:
            break
    done.set()
    thread.join(60)
    print(f"{most} calls in one thread while one lasted in the other")
    assert most >= 10


def test_a_session_in_use_by_another_thread_is_refused(ball):
    session = palpable.Session(palpable.Body(ball))
    capsules, refused, stop = many_capsules(), [], threading.Event()

    def meddle():
        while not stop.is_set():
            for use in (lambda: session.press([]), lambda: session.touches, session.skin, session.close):
                try:
                    if session._core.lock.locked():  # never close an idle one
                        use()
                except palpable.InUse as error:
                    refused.append(error)
                except palpable.Closed:
                    return

    thread = in_thread(meddle)
    for _ in range(200):
        try:
            session.press(capsules)
        except palpable.InUse:
            pass  # the other thread had it
        except palpable.Closed:
            break
        if len(refused) > 10:
            break
    stop.set()
    thread.join(60)
    assert refused and "another thread" in str(refused[0])


def test_garbage_is_collected_during_a_press(ball, hostile_threads):
    """Sessions, bodies and arrays in circles of references vanish while another thread presses."""
    body = palpable.Body(ball)
    main, done, made = palpable.Session(body), threading.Event(), []

    def make_garbage():
        while not done.is_set():
            session = palpable.Session(palpable.Body(ball))
            session.press(finger())
            circle = [session, session.skin().vertices, np.asarray(session.skin().normals)]
            circle.append(circle)
            session.press(finger(0.005))
            del session, circle
            gc.collect()
            made.append(1)

    thread = in_thread(make_garbage)
    arrays, end = [], time.monotonic() + 3
    while time.monotonic() < end:
        main.press(finger(0.004))
        plain = np.asarray(main.skin().vertices)
        assert all(np.array_equal(array, copy) for array, copy in arrays)
        arrays = arrays[-5:] + [(plain, plain.copy())]
    done.set()
    thread.join(60)
    assert not thread.is_alive() and made


def test_arrays_that_another_thread_still_reads_stay_whole(ball, hostile_threads):
    session, given, done, wrong, right = palpable.Session(palpable.Body(ball)), [], threading.Event(), [], []

    def read():
        while not done.is_set():
            for plain, total in list(given):
                (right if float(plain.sum()) == total else wrong).append(total)

    thread = in_thread(read)
    for k in range(1000):
        session.press(finger(0.003 + 0.000003 * k))
        plain = np.asarray(session.skin().vertices)
        given[:] = given[-3:] + [(plain, float(plain.sum()))]
    done.set()
    thread.join(60)
    assert not thread.is_alive() and right and not wrong


@pytest.mark.parametrize("where", ["session", "array"])
def test_what_is_never_closed_is_freed_with_its_last_reference(ball, where):
    body = palpable.Body(ball)
    handle = []
    session = palpable.Session(body)
    session.press(finger())
    handle = session._core.handle.free
    array = session.skin().vertices
    del session
    gc.collect()
    assert handle.alive
    del array
    gc.collect()
    assert not handle.alive
