"""Arrays over the library's memory: no copy, and never another frame's numbers."""
import copy
import gc
import operator
import pickle
import weakref

import numpy as np
import palpable
import pytest
from conftest import finger

ARRAYS = ("vertices", "normals", "von_mises", "contact_pressure", "triangles")

# Ways to read an array v; w is a plain array of its shape.
READS = {
    "an index": lambda v, w: v[0],
    "a mask": lambda v, w: v[w > 0],
    "iteration": lambda v, w: next(iter(v)),
    "a sum": lambda v, w: v + 1,
    "a reflected sum": lambda v, w: 1 + v,
    "a sum with a plain array": lambda v, w: w + v,
    "a sum into a plain array": lambda v, w: operator.iadd(w.copy(), v),
    "a comparison": lambda v, w: v == w,
    "a matrix product": lambda v, w: w.T @ v,
    "a ufunc": lambda v, w: np.sqrt(v),
    "a reduction": lambda v, w: np.add.reduce(v),
    "a function": lambda v, w: np.mean(v),
    "a function of a list": lambda v, w: np.concatenate([w, v]),
    "a function with a keyword": lambda v, w: np.interp(x=0.5, xp=[0, 1, 2], fp=v[:3]),
    "where": lambda v, w: np.where(w > 0, v, 0),
    "a norm": lambda v, w: np.linalg.norm(v),
    "a method": lambda v, w: v.max(),
    "a property": lambda v, w: v.T,
    "a flat iterator": lambda v, w: next(v.flat),
    "text": lambda v, w: str(v),
    "repr": lambda v, w: repr(v),
    "format": lambda v, w: f"{v}",
    "copy": lambda v, w: v.copy(),
    "copy.copy": lambda v, w: copy.copy(v),
    "copy.deepcopy": lambda v, w: copy.deepcopy(v),
    "pickle": lambda v, w: pickle.dumps(v),
    "a list": lambda v, w: v.tolist(),
    "a list by Python": lambda v, w: list(v),
    "an item": lambda v, w: v.item(0),
    "bytes": lambda v, w: v.tobytes(),
    "another type": lambda v, w: v.astype(float),
    "another view": lambda v, w: v.view(np.ndarray),
    "the buffer": lambda v, w: v.data,
    "the address": lambda v, w: v.ctypes.data,
    "membership": lambda v, w: 1.0 in v,
    "a slice that was taken before": None,
}


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_are_the_librarys_memory_without_a_copy_and_cannot_be_written(session, name):
    session.press(finger())
    skin = session.skin()
    array = getattr(skin, name)
    assert array.ctypes.data == getattr(skin._skin, name) == getattr(session.skin(), name).ctypes.data
    assert not array.flags.writeable
    with pytest.raises(ValueError):
        array[0] = 1
    with pytest.raises(ValueError):
        array.flags.writeable = True


@pytest.mark.parametrize("way", READS)
@pytest.mark.parametrize("end", ["press", "reset", "close"])
def test_whoever_reads_a_stale_array_is_told(session, way, end):
    session.press(finger())
    array = session.skin().vertices[:, 2]
    sliced = array[2:5]
    plain = array.copy()
    read = READS[way] or (lambda v, w: sliced[0])
    read(array, plain)
    session.press(finger(0.005)) if end == "press" else getattr(session, end)()
    with pytest.raises(palpable.StaleFrame):
        read(array, plain)
    assert array.shape == plain.shape and array.dtype == plain.dtype and len(array) == len(plain)


def test_every_method_and_property_of_ndarray_checks_the_frame(session):
    """Also those that a later version of NumPy brings."""
    from palpable._views import _OF_FORM, View

    for name in vars(np.ndarray):
        if name not in _OF_FORM and name != "base":
            assert name in vars(View), name


def test_what_is_computed_from_an_array_is_a_plain_array_that_lasts(session):
    session.press(finger())
    v = session.skin().vertices
    made = [v * 2, v.copy(), v[[1, 2]], v[v > 0.05], np.concatenate([v, v]), v.astype(float), np.sort(v), np.tile(v, 2), v.mean(axis=0),
            pickle.loads(pickle.dumps(v)), copy.deepcopy(v)]
    before = [array.copy() for array in made]
    session.press(finger(0.006))
    for array, old in zip(made, before):
        assert type(array) is np.ndarray
        assert np.array_equal(array, old)


def test_plain_arrays_and_buffers_keep_their_own_frame_at_its_address(session):
    session.press(finger())
    view = session.skin().vertices
    plain, buffer, bare = np.asarray(view), memoryview(view), np.array(view, copy=False, subok=False)
    expected, address = view.copy(), plain.ctypes.data
    for depth in (0.005, 0.006, 0.007):
        session.press(finger(depth))
    assert plain.ctypes.data == address != session.skin().vertices.ctypes.data
    session.close()
    gc.collect()
    assert np.array_equal(plain, expected) and np.array_equal(bare, expected)
    assert np.frombuffer(buffer.cast("B"), np.float32).tobytes() == expected.tobytes()
    del view, bare
    gc.collect()
    assert np.array_equal(plain, expected)


def test_arrays_keep_a_session_alive_that_has_no_other_reference(ball):
    opened = palpable.Session(palpable.Body(ball))
    opened.press(finger())
    v = opened.skin().vertices
    expected = v.copy()
    gone = weakref.ref(opened)
    del opened
    gc.collect()
    assert gone() is None
    assert np.array_equal(v, expected)


def test_a_skin_of_an_earlier_frame_gives_no_arrays(session):
    session.press(finger())
    skin = session.skin()
    session.press(finger(0.005))
    for name in ARRAYS:
        with pytest.raises(palpable.StaleFrame):
            getattr(skin, name)


def test_a_frame_stays_valid_when_the_next_one_is_refused(session):
    session.press(finger())
    skin = session.skin()
    v = skin.vertices
    expected = v.copy()
    for _ in range(3):
        with pytest.raises(palpable.WrongArgument):
            session.press(finger() * np.nan)
        assert np.array_equal(v, expected) and np.array_equal(session.skin().vertices, expected)
        assert session.skin().normals.shape == expected.shape
    del v
    gc.collect()
    assert np.array_equal(skin.vertices, expected)  # the memory is kept, although no array was left
    session.press(finger(0.005))
    with pytest.raises(palpable.StaleFrame):
        skin.vertices


def test_no_memory_is_kept_where_no_array_is_left(session, monkeypatch):
    session.press(finger())
    kept = []
    keep = session._core._keep
    monkeypatch.setattr(session._core, "_keep", lambda address: (keep(address), kept.append(bool(session._core._kept))))
    skin = session.skin()
    skin.vertices.max()
    session.press(finger(0.005))
    held = session.skin().vertices
    session.press(finger(0.006))
    assert kept == [False, True]
    assert len(held) == len(session.skin().vertices)


def test_before_the_first_frame_the_skin_is_at_rest(session):
    skin = session.skin()
    assert skin.von_mises.max() == 0 and skin.contact_pressure is None
    assert np.isnan(skin.stated_stress_error) and np.isnan(session.frame.time)
    rest = skin.vertices.copy()
    session.press(finger(0.004))
    assert np.abs(session.skin().vertices - rest).max() > 0.002
    assert session.skin().contact_pressure.max() > 0
