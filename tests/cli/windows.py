#!/usr/bin/env python3
"""The windows of live and view, operated by mouse and keys on a virtual screen; one case is one test, as in programs.py.
`--list` names the cases."""
import json
import shutil
import sys
import time
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base
from screen import BUTTON_PRESS, BUTTON_RELEASE, ESCAPE, LEFT, MOTION, Screen, wait_for

base.CASES.clear()
case = base.case


@contextmanager
def shown(programs, here, *words):
    """(screen, window, process) of a program whose window shows a picture; nothing without a screen."""
    here.mkdir(parents=True, exist_ok=True)
    with Screen() as screen:
        if screen.missing:
            print("SKIPPED: " + screen.missing)
            yield None
            return
        program = screen.start(programs.palpable, *words, cwd=here)
        try:
            window = screen.window()
            wait_for("a picture", lambda: screen.lit_share(window) > 0.8)
            yield screen, window, program
        finally:
            program.kill()
            program.wait()


def settled(screen, window):
    """The window's pixels after they have not changed for a while."""
    last = [screen.pixels(window), 0]

    def is_still():
        now = screen.pixels(window)
        last[:] = [now, last[1] + 1 if now == last[0] else 0]
        return last[1] >= 15  # 0.3 s and more
    wait_for("a picture that stays", is_still)
    return last[0]


def changed_by(screen, window, what, do):
    """The window's pixels after `do` has changed them and they are constant: an intermediate state may be half drawn."""
    before = screen.pixels(window)
    do()
    wait_for(what, lambda: screen.pixels(window) != before)
    return settled(screen, window)


def enlarge(screen, window):
    """Enlarges the window so that the panel's letters have 15 px."""
    screen.resize(window, 1280, 720)
    wait_for("the larger picture", lambda: screen.lit_share(window) > 0.8)


def share_apart(one, other):
    """The share of two windows' bytes that differ by more than 16."""
    return sum(abs(a - b) > 16 for a, b in zip(one, other)) / len(one)


def colors(screen, window):
    """Rows of (r, g, b), as base.png_rows."""
    data, width = screen.pixels(window), screen.attributes(window).width
    at = [(data[i + 2], data[i + 1], data[i]) for i in range(0, len(data), 4)]
    return [at[i:i + width] for i in range(0, len(at), width)]


@case("the window of live is paused, stepped, switched and kept by keys, and goes on by a click on its panel")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=4)
    here = folder / "here"
    with shown(programs, here, *base.live(programs, folder, "--window", "--paused")) as given:
        if given is None:
            return
        screen, window, program = given
        type_key = lambda key: (lambda: screen.type(window, key))
        camera = changed_by(screen, window, "no panel", type_key("t"))
        views = [changed_by(screen, window, f"view {key}", type_key(key)) for key in "2345"]
        assert len(set(views + [camera])) == 5, "two views look the same"
        assert changed_by(screen, window, "the camera's view again", type_key("1")) == camera
        changed_by(screen, window, "another view", type_key("2"))
        assert changed_by(screen, window, "the start", type_key("r")) == camera
        changed_by(screen, window, "no legend", type_key("l"))
        assert changed_by(screen, window, "the legend", type_key("l")) == camera

        # The saved picture is the one shown, without the panel; here it has the window's size, so that it is bit-identical.
        seen = colors(screen, window)
        screen.type(window, "p")
        kept = here / "ball_live_1.png"
        wait_for("a kept picture", lambda: kept.exists() and kept.stat().st_size > 0)
        panel = changed_by(screen, window, "the panel", type_key("t"))
        assert [list(row) for row in base.png_rows(kept)] == seen
        screen.type(window, "p")
        second = here / "ball_live_2.png"
        wait_for("a second picture", lambda: second.exists() and second.stat().st_size > 0)
        assert second.read_bytes() == kept.read_bytes(), "the panel is in the picture"

        # The run waits until the next frame is requested. The caption contains the time.
        assert program.poll() is None
        changed_by(screen, window, "the next frame", type_key("s"))
        changed_by(screen, window, "the keys", type_key("h"))
        enlarge(screen, window)
        button = (57, 69)  # "Go on", in letters of 15 px
        screen.mouse(window, (MOTION, *button), (BUTTON_PRESS, *button, LEFT), (BUTTON_RELEASE, *button, LEFT))
        assert program.wait(timeout=60) == 0, "it does not go on"
    touches = (folder / "out/touches.jsonl").read_bytes()
    shutil.rmtree(folder / "out")
    programs.succeeds(*base.live(programs, folder))
    assert (folder / "out/touches.jsonl").read_bytes() == touches


def click(screen, window, x, y):
    screen.mouse(window, (MOTION, x, y), (BUTTON_PRESS, x, y, LEFT), (BUTTON_RELEASE, x, y, LEFT))


def places(folder):
    """For each frame the body's 16 numbers in the camera frame."""
    return [json.loads(line)["camera_from_body"] for line in (folder / "out/pose.jsonl").read_text().splitlines()]


@case("a click puts the body on the surface that is seen there, one beside all depth says so, and the run begins anew")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=12)
    with shown(programs, folder, *base.live(programs, folder, "--window", "--paused")) as given:
        if given is None:
            return
        screen, window, program = given
        enlarge(screen, window)
        changed_by(screen, window, "no panel", lambda: screen.type(window, "t"))
        # Without the key a click has no effect; with it the next frame shows the body there.
        before = settled(screen, window)
        click(screen, window, 900, 300)
        screen.type(window, "a")
        assert settled(screen, window) == before
        changed_by(screen, window, "the body elsewhere", lambda: click(screen, window, 900, 300))
        # The matcher has no depth at the left margin: after a click there the next frame comes, and the body stays.
        screen.type(window, "a")
        changed_by(screen, window, "a frame", lambda: click(screen, window, 4, 300))
        screen.type(window, ESCAPE)  # ends the placing, not the program; otherwise it continues until a valid click
        changed_by(screen, window, "the beginning", lambda: screen.type(window, "e"))
        screen.type(window, ESCAPE)
        assert program.wait(timeout=60) == 0
    first, placed, still, anew = places(folder)
    # The wall is 0.441 m away and faces the camera; one pixel of the picture is 4 px of the window.
    where = [placed[at] for at in (3, 7, 11)]
    meant = [((900 + 0.5) / 4 - 0.5 - 159.5) / 175 * 0.441, ((300 + 0.5) / 4 - 0.5 - 89.5) / 175 * 0.441, 0.441]
    assert all(abs(a - b) < 0.01 for a, b in zip(where, meant)), (where, meant)
    assert placed[10] < -0.99, placed  # its Z points out of the wall
    # The pose of a fixed camera is tracked to a millimetre.
    assert all(abs(a - b) < 1e-3 for a, b in zip(placed, still)), (placed, still)
    assert anew == first


@case("a run that begins anew puts the body where its start has put it: on a free place, or at the pixel")
def _(programs, folder):
    base.write_desk(folder / "desk", frames=6)
    for at in ((), ("--at-pixel", "90,130")):
        words = ("live", programs.small_body(), "--source", folder / "desk", "--anchor", "plane", *at, "--window", "--paused",
                 "--out", folder / "out", "--overwrite")
        with shown(programs, folder, *words) as given:
            if given is None:
                return
            screen, window, program = given
            enlarge(screen, window)
            changed_by(screen, window, "no panel", lambda: screen.type(window, "t"))
            changed_by(screen, window, "a frame", lambda: screen.type(window, "s"))  # the caption contains the time
            changed_by(screen, window, "the beginning", lambda: screen.type(window, "e"))
            screen.type(window, ESCAPE)
            assert program.wait(timeout=60) == 0
        first, *_, anew = places(folder)
        assert len(places(folder)) == 3
        # The start uses the median of all frames' planes, the restart the plane of one frame.
        assert all(abs(a - b) < 0.02 for a, b in zip(first, anew)), (at, first, anew)
        if at:
            x, y, z = (anew[k] for k in (3, 7, 11))
            assert abs(175 * x / z + 159.5 - 90) < 2 and abs(175 * y / z + 89.5 - 130) < 2, anew


# The panel as it was approved, without the line with the run's speed.
PANEL = Path(__file__).parent.parent / "data/live_panel.png"
PANEL_SIZE = (224, 612)
PANEL_FROM = 30  # px from the top


@case("the panel of live looks as it did")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=2)
    with shown(programs, folder, *base.live(programs, folder, "--window", "--paused")) as given:
        if given is None:
            return
        screen, window, program = given
        enlarge(screen, window)
        settled(screen, window)
        width, height = PANEL_SIZE
        now = [row[:width] for row in colors(screen, window)[PANEL_FROM:height]]
        screen.type(window, ESCAPE)
        assert program.wait(timeout=60) == 0
    (folder / "panel.png").write_bytes(base.png_of_rows(now))
    then = base.png_rows(PANEL)
    assert (len(then), len(then[0])) == (len(now), len(now[0]))
    # Letters and buttons have soft edges, which another Mesa may round by some grey levels; a shift by one pixel changes the
    # edges of all letters, 4 % of the panel.
    apart = [max(abs(a - b) for a, b in zip(one, other)) > 48 for one, other in zip(sum(now, []), sum(then, []))]
    assert sum(apart) / len(apart) < 0.005, f"{sum(apart)} px of the panel are others: {folder / 'panel.png'}"


@case("the panel of live chooses which component is painted, while one is")
def _(programs, folder):
    base.write_nearing_wall(folder / "clip", frames=14)
    with shown(programs, folder, *base.live(programs, folder, "--window", "--paused", "--press-static")) as given:
        if given is None:
            return
        screen, window, program = given
        enlarge(screen, window)
        for _ in range(10):
            # The caption contains the time.
            changed_by(screen, window, "the next frame", lambda: screen.type(window, "s"))

        def picture():
            """The window without its panel."""
            screen.type(window, "t")
            seen = settled(screen, window)
            changed_by(screen, window, "the panel", lambda: screen.type(window, "t"))
            return seen
        seen = [picture()]
        for place in ((19, 347), (19, 477)):  # "component", and the first one below "Component"
            changed_by(screen, window, "a switch", lambda: click(screen, window, *place))
            seen.append(picture())
        assert len(set(seen)) == 3, "stress, zz and xx"
        # A restarted session keeps the painted quantity, also in its first frame.
        changed_by(screen, window, "the beginning", lambda: screen.type(window, "e"))
        anew = picture()
        changed_by(screen, window, "the start", lambda: screen.type(window, "r"))
        assert picture() != anew
        screen.type(window, ESCAPE)
        assert program.wait(timeout=60) == 0


@case("a recording begins and ends while live runs, by a key and by the panel, and replays to the same states")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=40)
    here = folder / "here"
    words = base.live(programs, folder, "--window", "--paused", "--record", folder / "first.palprec")
    with shown(programs, here, *words) as given:
        if given is None:
            return
        screen, window, program = given
        enlarge(screen, window)

        def step():
            # The caption contains the time.
            changed_by(screen, window, "the next frame", lambda: screen.type(window, "s"))
        step()
        step()
        changed_by(screen, window, "the end of the first", lambda: screen.type(window, "v"))
        step()
        record = (112, 147)
        changed_by(screen, window, "a recording", lambda: click(screen, window, *record))
        for _ in range(3):
            step()
        found = list(here.glob("ball_*.palprec"))
        assert len(found) == 1, found
        changed_by(screen, window, "the end of the second", lambda: click(screen, window, *record))
        step()
        # A change that begins a session ends the recording of the previous one.
        time.sleep(1.1)  # its name contains the second
        screen.type(window, "v")
        step()
        step()
        changed_by(screen, window, "a new beginning", lambda: screen.type(window, "e"))
        step()
        screen.type(window, ESCAPE)
        assert program.wait(timeout=60) == 0
    third = [file for file in here.glob("ball_*.palprec") if file not in found]
    assert len(third) == 1, third
    for file, states in ((folder / "first.palprec", 3), (found[0], 3), (third[0], 2)):
        assert f"{states} of {states} states of the live run: equal" in programs.succeeds("replay", file).stdout


@case("a paused window of live is closed by Escape, and without a window nothing is paused")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=3)
    with shown(programs, folder, *base.live(programs, folder, "--window", "--paused")) as given:
        if given is None:
            return
        screen, window, program = given
        screen.type(window, ESCAPE)
        assert program.wait(timeout=60) == 0
    programs.refuses(*base.live(programs, folder, "--paused"), says=["--paused", "--window"])


@case("a paused window of a camera holds its picture, and the run goes on behind it")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=240)  # 8 s at a camera's rate
    with shown(programs, folder, *base.live(programs, folder, "--window", "--paused", "--paced")) as given:
        if given is None:
            return
        screen, window, program = given
        held = settled(screen, window)
        stepped = changed_by(screen, window, "a newer frame", lambda: screen.type(window, "s"))
        assert stepped != held
        screen.type(window, ESCAPE)
        assert program.wait(timeout=60) == 0
    # More than the two that were shown.
    assert json.loads((folder / "out/live.json").read_text())["frames"] > 2


@case("live without a display says so, and how to do without a window")
def _(programs, folder):
    base.write_stereo(folder / "clip", frames=2)
    programs.refuses(*base.live(programs, folder, "--window"), says=["cannot open a window", "DISPLAY", "--no-window"])


@case("the mouse presses a body anywhere as a finger does, and one without tables of touch at its sites")
def _(programs, folder):
    anywhere = programs.baked_ball(programs.work / "touched", base.TOUCHED_BALL)
    for body, presses_anywhere in ((anywhere, True), (programs.small_body(), False)):
        with shown(programs, folder, "view", body) as given:
            if given is None:
                return
            screen, window, program = given
            changed_by(screen, window, "no panel", lambda: screen.type(window, "t"))
            rest = changed_by(screen, window, "no help", lambda: screen.type(window, "h"))
            pressed = []
            # Two positions nearest to the same site: a finger presses at both, a press at a site is the same.
            for place in ((600, 300), (612, 300)):
                # Dragged so far that the full press is reached at once.
                far = (place[0], place[1] + 300)
                screen.mouse(window, (MOTION, *place), (BUTTON_PRESS, *place, LEFT), (MOTION, *far))
                wait_for("a press", lambda: screen.pixels(window) != rest)
                pressed.append(settled(screen, window))
                screen.mouse(window, (BUTTON_RELEASE, *far, LEFT))
                wait_for("the body at rest", lambda: screen.pixels(window) == rest)
            assert (pressed[0] != pressed[1]) == presses_anywhere, body
            # At rest all fields are 0, and the body has its material's colour; pressed, each field looks different.
            screen.mouse(window, (MOTION, *place), (BUTTON_PRESS, *place, LEFT), (MOTION, *far))
            wait_for("a press", lambda: screen.pixels(window) != rest)
            stress = settled(screen, window)
            for field in ("pressure", "a component", "contact", "displacement", "the material"):
                changed_by(screen, window, field, lambda: screen.type(window, "f"))
            assert share_apart(settled(screen, window), stress) > 0.05
            changed_by(screen, window, "stress", lambda: screen.type(window, "f"))
            # The contact of a held finger is computed again for each picture; the changes are too small to be visible.
            assert share_apart(settled(screen, window), stress) < 0.01
            screen.mouse(window, (BUTTON_RELEASE, *far, LEFT))
            screen.type(window, ESCAPE)
            assert program.wait(timeout=60) == 0


@case("a slider on the panel settles a body's parameter anew")
def _(programs, folder):
    soft = programs.baked_ball(programs.work / "sliding", base.BALL + base.UPPER_HALF)
    base.write_stereo(folder / "clip", frames=12)
    # The panel shows the file's name in one line, whatever its folder.
    far = folder / "a folder whose name is longer than a line of the panel"
    far.mkdir()
    words = list(base.live(programs, folder, "--window", "--paused", "--record", far / "a.palprec"))
    words[1] = soft
    with shown(programs, folder, *words) as given:
        if given is None:
            return
        screen, window, program = given
        enlarge(screen, window)
        settled(screen, window)
        left, right = (80, 639), (260, 639)  # below its name, beyond the slider's end
        screen.mouse(window, (MOTION, *left), (BUTTON_PRESS, *left, LEFT))
        changed_by(screen, window, "a dragged slider", lambda: screen.mouse(window, (MOTION, *right)))
        changed_by(screen, window, "the next frame", lambda: screen.mouse(window, (BUTTON_RELEASE, *right, LEFT)))
        screen.type(window, "v")
        changed_by(screen, window, "the next frame", lambda: screen.type(window, "s"))
        screen.type(window, ESCAPE)
        assert program.wait(timeout=60) == 0
    recorded, = folder.glob("ball_*.palprec")
    assert b'"set":["upper=2"]' in recorded.read_bytes().replace(b" ", b"")
    assert "1 of 1 states of the live run: equal" in programs.succeeds("replay", recorded).stdout


if __name__ == "__main__":
    sys.exit(base.main())
