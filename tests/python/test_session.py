"""Bodies, sessions, things that press, cameras, and how errors are reported."""
import copy
import dataclasses
import pickle

import numpy as np
import palpable
import pytest
from conftest import finger, flat_hand


def test_a_finger_is_pushed_back(session):
    session.press(finger(0.004))
    (touch,) = session.touches
    assert 0.5 < -touch.force[2] < 10 and touch.depth > 0.002
    assert np.allclose(touch.normal, -touch.force / np.linalg.norm(touch.force))
    assert session.frame.answer is palpable.Answer.REACHED and session.frame.touch_count == 1
    assert touch.to_dict()["force_z"] == touch.force[2] and "area" in touch.to_dict()
    session.press([])
    assert session.touches == []


def test_records_are_whole_whenever_they_are_read(session):
    """Their fields are read from C's struct when one is used first."""
    session.press(finger(0.004))
    (early,), frame = session.touches, session.frame
    force, again, pickled = early.force.copy(), session.touches[0], pickle.dumps(session.touches[0])
    copied = copy.deepcopy(session.touches[0])
    session.press([])
    session.close()
    for touch in (again, copied, pickle.loads(pickled)):
        assert np.array_equal(touch.force, force) and touch.by is None and touch.thing == 0 and touch.body == 0
        assert touch.to_dict()["point_z"] == early.point[2] and "depth=" in repr(touch)
    assert dataclasses.replace(again, depth=0.5).depth == 0.5
    assert frame.touch_count == 1 and frame.world_from_camera.shape == (4, 4) and frame.camera is palpable.CameraState.STANDS
    for wrong in ("forces", "__length_hint__", "_nothing"):
        assert not hasattr(again, wrong)
    with pytest.raises(AttributeError):
        early.depth = 1.0
    with pytest.raises(ValueError):
        early.force[0] = 1.0


def test_touches_carry_the_ids_of_things(session):
    left, right = finger(0.008, x=-0.02), finger(0.009, x=0.02)
    session.press([palpable.Capsules(left, id=7), palpable.Capsules(right, id=-3)], time=0.5)
    assert {touch.thing for touch in session.touches} == {7, -3}
    assert session.frame.time == 0.5
    session.press(np.vstack([left, right]))
    assert {touch.thing for touch in session.touches} == {0} and session.frame.time == 1.5
    with pytest.raises(palpable.WrongArgument, match="same id"):
        session.press([left, right])


def test_a_thing_rubs_with_its_own_coefficient_or_the_bodys(ball):
    def along(body_friction=None, **of_thing):
        body = palpable.Body(ball)
        if body_friction is not None:
            body.set_friction(body_friction)
        with palpable.Session(body) as session:
            for k in range(6):
                session.press([palpable.Capsules(finger(0.004, x=0.0001 * k), id=3, **of_thing)], time=0.1 * (k + 1))
            (touch,) = session.touches
            return np.linalg.norm(touch.force - touch.force @ touch.normal * touch.normal) / np.linalg.norm(touch.force)

    assert along() < 1e-9 and along(1, friction=0) < 1e-9
    assert along(1) > 0.01 and along(friction=1) == along(1)
    for wrong in (-1, 11, float("nan")):
        with pytest.raises(palpable.WrongArgument, match="coefficient is"):
            palpable.Body(ball).set_friction(wrong)
        with palpable.Session(palpable.Body(ball)) as session:  # -1 is PALPABLE_NO_FRICTION in C
            with pytest.raises(palpable.WrongArgument, match="friction is"):
                session.press([palpable.Capsules(finger(), id=3, friction=wrong)])


def test_ticks_give_the_forces_on_things(ball):
    with palpable.Body(ball) as body, palpable.Session(body) as ticked, palpable.Session(body) as framed:
        for k in range(40):
            things = [palpable.Capsules(finger(1e-4 * k - 1e-3), id=3), palpable.Capsules(finger(-0.05), id=4)]
            framed.press(things, time=1e-3 * k)
            forces, reached = ticked.tick(things, 1e-3 * k)
        assert reached
        assert forces.shape == (2, 6)
        [touch] = framed.touches
        assert np.allclose(forces[0, :3], -np.array(touch.force), atol=0.01 * np.linalg.norm(touch.force))
        assert not forces[1].any()
        assert not ticked.touches
        ticked.press(things, time=1)
        assert len(ticked.touches) == 1
        with pytest.raises(palpable.WrongArgument):
            ticked.tick(things, 1)


def test_nested_lists_are_capsules(session):
    session.press(finger().tolist())
    assert len(session.touches) == 1
    session.press(finger()[0])
    assert len(session.touches) == 1


@pytest.mark.parametrize("layout, count", [("openxr", 26), ("webxr", 25), ("mediapipe", 21)])
def test_a_hand_presses_by_its_joints(session, layout, count):
    hand = palpable.Hand(flat_hand(0.112, count), layout=layout)
    assert hand.capsules.shape == (26, 8) and hand.id == 1
    session.press(hand, time=0)
    assert session.touches and {touch.thing for touch in session.touches} == {1}
    assert palpable.Hand(flat_hand(0.112, count), layout=layout, side="left").id == 2


def test_radii_of_joints_are_taken(session):
    joints = flat_hand(0.112)
    thick = palpable.Hand(joints, "webxr", radii=np.full(25, 0.02), id=9)
    assert thick.id == 9 and np.count_nonzero(thick.capsules[:, 6:] == 0.02) > 20


def test_hands_that_cannot_be_are_refused():
    joints = flat_hand(0.112)
    with pytest.raises(palpable.WrongArgument, match="in metres"):
        palpable.Hand(1000 * joints, "webxr")
    with pytest.raises(palpable.WrongArgument, match=r"\(25, 3\), not \(26, 3\)"):
        palpable.Hand(joints, "openxr")
    with pytest.raises(palpable.WrongArgument, match="leap"):
        palpable.Hand(joints, "leap")
    with pytest.raises(palpable.WrongArgument, match="both"):
        palpable.Hand(joints, "webxr", side="both")
    with pytest.raises(palpable.WrongArgument, match="radi"):
        palpable.Hand(joints, "webxr", radii=np.zeros(25))


def test_several_bodies_are_pressed_at_their_places(ball, hard_ball):
    place = np.eye(4)
    place[0, 3] = 0.3
    with palpable.Session([palpable.Body(ball), palpable.Body(hard_ball, place=place)]) as session:
        session.press(np.vstack([finger(), finger(x=0.3)]))
        force = {touch.body: -touch.force[2] for touch in session.touches}
        assert force[1] > 1.5 * force[0] > 0
        assert np.array_equal(session.skin(1).world_from_body, place)
        with pytest.raises(palpable.WrongArgument, match="no body 2 among 2"):
            session.skin(2)


def test_a_body_may_be_larger(ball):
    with palpable.Body(ball, scale=2) as body, palpable.Session(body) as session:
        assert np.ptp(session.skin().vertices[:, 2]) == pytest.approx(0.2, rel=0.05)


def test_errors_have_the_text_and_the_status_of_c(ball, tmp_path):
    with pytest.raises(palpable.WrongFile, match="nowhere.palpable") as caught:
        palpable.Body(tmp_path / "nowhere.palpable")
    assert caught.value.status == 2 and isinstance(caught.value, palpable.Error)
    with pytest.raises(palpable.WrongArgument, match="scale is 0"):
        palpable.Body(ball, scale=0)
    with pytest.raises(palpable.WrongArgument, match="world_from_body"):
        palpable.Body(ball, place=np.zeros((4, 4)))
    with pytest.raises(palpable.WrongArgument, match=r"\(3,\)"):
        palpable.Body(ball, place=[0, 0, 0])
    with palpable.Session(palpable.Body(ball)) as session:
        with pytest.raises(palpable.WrongArgument, match=r"\(1, 7\)"):
            session.press(finger()[:, :7])
        session.press(finger(), time=3)
        with pytest.raises(palpable.WrongArgument, match="3 s"):
            session.press(finger(), time=3)
        with pytest.raises(palpable.NotPossible, match="camera"):
            session.depth
        with pytest.raises(palpable.NotPossible):
            session.feed_depth(np.ones((4, 4), np.float32), time=4)
    with pytest.raises(palpable.WrongArgument, match="a session has a body"):
        palpable.Session([])


def test_closing_twice_is_allowed_and_using_afterwards_is_not(ball):
    body = palpable.Body(ball)
    session = palpable.Session(body)
    body.close()
    body.close()
    session.press(finger())
    session.close()
    session.close()
    for use in (lambda: session.press(finger()), lambda: session.frame, lambda: session.touches, session.skin, session.reset):
        with pytest.raises(palpable.Closed):
            use()
    with pytest.raises(palpable.Closed):
        palpable.Session(body)


def test_reset_begins_anew(session):
    session.press(finger(), time=5)
    force = session.touches[0].force
    session.reset()
    assert session.touches == []
    session.press(finger(), time=1)
    assert np.array_equal(session.touches[0].force, force)


CAMERA = dict(width=320, height=180, fx=175, fy=175, cx=159.5, cy=89.5)


def wall(distance):
    return np.full((180, 320), distance, np.float32)


def poses():
    place = np.eye(4)
    place[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]  # Z of the body is -Y of the camera
    place[:3, 3] = 0, 0.04, 0.42
    return place


def test_depth_images_press(ball):
    with palpable.Session(palpable.Body(ball, place=poses()), palpable.Depth(**CAMERA, press_static=True)) as session:
        with pytest.raises(palpable.NotPossible):
            session.depth
        session.feed_depth(wall(0.40), time=0)
        first = session.depth
        measured = first.depth
        assert measured.shape == (180, 320) and np.nanmedian(measured) == pytest.approx(0.40, abs=1e-3) and first.fx == 175
        plain = np.asarray(measured)
        color = np.zeros((180, 320, 3), np.uint8)
        session.feed_depth(wall(0.41), time=1 / 30, color=color, bgr=True)
        with pytest.raises(palpable.StaleFrame):
            measured.max()
        assert np.nanmedian(plain) == pytest.approx(0.40, abs=1e-3)
        assert session.frame.camera is palpable.CameraState.STANDS
        with pytest.raises(palpable.NotPossible):
            session.press(finger())


def test_rows_may_lie_apart_and_pictures_may_be_views(ball):
    wide = np.random.default_rng(1).uniform(0.39, 0.41, (360, 330)).astype(np.float32)
    results = []
    for picture in (wide[::2, :320], np.ascontiguousarray(wide[::2, :320]), np.asfortranarray(wide[::2, :320]), np.ascontiguousarray(wide[::2, :320][::-1])[::-1]):
        with palpable.Session(palpable.Body(ball), palpable.Depth(**CAMERA)) as session:
            session.feed_depth(picture, time=0)
            results.append(session.depth.depth.tobytes())
            assert np.nanmedian(session.depth.depth) == pytest.approx(0.40, abs=0.02)
    assert len(set(results)) == 1


def test_pictures_of_another_kind_are_refused(ball):
    with palpable.Session(palpable.Body(ball), palpable.Depth(**CAMERA)) as session:
        with pytest.raises(palpable.WrongArgument, match="float64"):
            session.feed_depth(wall(0.4).astype(float), time=0)
        with pytest.raises(palpable.WrongArgument, match="uint16"):
            session.feed_depth((1000 * wall(0.4)).astype(np.uint16), time=0)
        with pytest.raises(palpable.WrongArgument, match=r"\(180, 320, 2\)"):
            session.feed_depth(wall(0.4), time=0, color=np.zeros((180, 320, 2), np.uint8))
        with pytest.raises(palpable.WrongArgument, match="319"):
            session.feed_depth(wall(0.4)[:, :319], time=0)


def test_stereo_pairs_give_depth(ball):
    texture = np.repeat(np.random.default_rng(2).integers(20, 220, (180, 200), np.uint8), 2, axis=1)[:, :345]
    left, right = texture[:, :320], texture[:, 25:]
    camera = palpable.Stereo(**CAMERA, baseline=0.063)
    with palpable.Session(palpable.Body(ball, place=poses()), camera) as session:
        session.feed_stereo(left, right, time=0)
        assert np.nanmedian(session.depth.depth) == pytest.approx(175 * 0.063 / 25, abs=0.01)
        gray = session.depth.depth.copy()
    with palpable.Session(palpable.Body(ball, place=poses()), camera) as session:
        session.feed_stereo(np.dstack([left] * 3), np.dstack([right] * 3), time=0)
        assert np.array_equal(gray, session.depth.depth, equal_nan=True)
