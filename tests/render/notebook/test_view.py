"""The robot walks in a notebook, at his own pace, and only where somebody sees it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import pairwise

import pytest
from support.canvases import Sent

import babyrobot_levels as brl
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.render.notebook import view as views
from babyrobot_levels.render.notebook.canvas import LayeredCanvas
from babyrobot_levels.render.notebook.html import Frontend
from babyrobot_levels.render.notebook.view import LevelView
from babyrobot_levels.render.scene.build import LAYERS, build_layers
from babyrobot_levels.render.scene.layout import Overlay
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Shape
from babyrobot_levels.render.situation import Mood, Pose

LEVEL = brl.Level.model_validate({"version": 1, "size": (4, 3), "puddles": [{"at": (1, 1)}]})
EAST = Pose(brl.Action.EAST)


class Clock:
    """A clock on which time passes only while somebody waits."""

    def __init__(self) -> None:
        self.now = 100.0

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        assert seconds >= 0
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(views, "time", clock)
    return clock


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch, clock: Clock) -> Clock:
    """Have views believe that a person looks at them."""
    monkeypatch.setattr(views, "frontend", lambda: Frontend.CANVAS)
    return clock


def places(sent: Sent) -> list[float]:
    """Return how far to the right the robot's shadow is in each frame that was sent."""
    found = []
    for drawing in sent.drawings:
        is_next = False
        for name, arguments in drawing:
            if name == "ellipse" and is_next:
                found.append(arguments[0])
            is_next = name == "clear" or (is_next and name != "ellipse")
    return found


# -- walking ---------------------------------------------------------------------------------


def test_a_step_is_one_message_with_the_way_in_it(watched: Clock, sent: Sent) -> None:
    view = LevelView(LEVEL)
    _ = view.widget
    sent.clear()
    view.move(1, EAST)
    assert len(sent.kinds) == len(sent.drawings) == 1
    way = places(sent)
    assert len(way) > 5
    assert way == sorted(way)
    assert way[-1] - 64 < way[0] < way[-1]
    steps = [later - sooner for sooner, later in pairwise(way)]
    assert max(steps) == pytest.approx(min(steps), abs=0.02)
    assert 100 < sum(pause for [pause] in sent.commands("sleep")) < 250


@pytest.mark.parametrize("state", [0, 2, 5, 11])
def test_what_is_no_step_to_a_neighbour_is_a_jump(state: int, watched: Clock, sent: Sent) -> None:
    view = LevelView(LEVEL)
    _ = view.widget
    sent.clear()
    view.move(state, EAST)
    assert len(places(sent)) == 1
    assert sent.commands("sleep") == []


def test_the_speed_tells_how_long_a_step_takes(watched: Clock, sent: Sent) -> None:
    frames = []
    for speed in (1.0, 4.0, 100.0):
        view = LevelView(LEVEL, speed=speed)
        _ = view.widget
        sent.clear()
        start = watched.now
        for state in (1, 2, 3):
            view.move(state)
        # The last step may still be under way.
        assert watched.now - start == pytest.approx(2 * 0.25 / speed)
        frames.append(len(places(sent)) / 3)
    assert frames == sorted(frames, reverse=True)
    assert frames[-1] == 1


def test_the_speed_is_the_levels_if_nothing_else_is_said(watched: Clock) -> None:
    level = LEVEL.replace(display={"robot": {"speed": 5}})
    view = LevelView(level)
    view.move(1)
    view.move(2)
    assert watched.now == pytest.approx(100.05)


def test_what_is_written_can_be_read_before_the_next_is(watched: Clock, sent: Sent) -> None:
    view = LevelView(LEVEL)
    view.set_overlay(Overlay(coordinates=True))
    assert watched.now == 100
    view.set_overlay(None)
    assert watched.now == pytest.approx(100.25)
    # Walking and writing go on at the same time.
    view.move(1)
    assert watched.now == pytest.approx(100.25)


@pytest.mark.parametrize("who", [Frontend.NONE, Frontend.PROGRAM])
def test_nobody_waits_where_nobody_watches(
    who: Frontend, clock: Clock, sent: Sent, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(views, "frontend", lambda: who)
    view = LevelView(LEVEL)
    _ = view.widget
    sent.clear()
    for state in (1, 2, 3):
        view.move(state, EAST)
    for _ in range(3):
        view.set_overlay(None)
    assert clock.now == 100
    assert len(places(sent)) == 3


def test_he_slips_on_the_way_but_cheers_only_when_he_is_there(
    watched: Clock, sent: Sent, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Pose] = []

    def look(
        theme: Theme, left: float, top: float, pose: Pose, *, small: bool
    ) -> tuple[Shape, ...]:
        seen.append(pose)
        return robot_shapes(theme, left, top, pose, small=small)

    monkeypatch.setattr(views, "robot_shapes", look)
    view = LevelView(LEVEL)
    for state, mood in ((1, Mood.SLIP), (2, Mood.CHEER)):
        seen.clear()
        view.move(state, Pose(mood=mood))
        *way, end = seen
        assert end == Pose(mood=mood)
        assert {pose.facing for pose in way} == {brl.Action.EAST}
        assert {pose.mood for pose in way} == {Mood.SLIP if mood is Mood.SLIP else Mood.CALM}
        assert [pose.phase for pose in way] == sorted({pose.phase for pose in way})


# -- what is seen ----------------------------------------------------------------------------


def test_what_was_painted_bit_by_bit_is_the_picture(sent: Sent) -> None:
    other = LEVEL.replace(theme="green", start=[[3, 0]], display={"compass": True})
    overlay = Overlay(values=[[float(x * y) for x in range(4)] for y in range(3)])
    view = LevelView(LEVEL)
    _ = view.widget
    view.move(1, EAST)
    view.set_overlay(overlay)
    view.move(5)
    view.set_level(other, 6)
    view.move(7, EAST)
    whole = LayeredCanvas(build_layers(other, state=7, pose=EAST, overlay=overlay)).widget
    assert sent.seen_on(view.widget) == sent.seen_on(whole)
    assert (view.widget.width, view.widget.height) == (whole.width, whole.height)

    view.set_overlay(None)
    clean = LayeredCanvas(build_layers(other, state=7, pose=EAST)).widget
    assert sent.seen_on(view.widget) == sent.seen_on(clean) != sent.seen_on(whole)


def test_movers_glide_while_the_robot_stays(watched: Clock, sent: Sent) -> None:
    level = brl.Level.from_fields(
        {"version": 1, "size": [4, 2], "movers": [{"path": [[1, 1], [2, 1]], "back": True}]}
    )
    view = LevelView(level)
    movers = view.widget[list(LAYERS).index("movers")].model_id
    sent.clear()
    view.move(8)
    assert len(sent.drawings) == 1
    assert sent.layers.count(movers) > 5
    assert len(sent.layers) == sent.layers.count(movers) + 1
    assert 100 < sum(pause for [pause] in sent.commands("sleep")) < 250


def test_an_overlay_of_parts_follows_the_configuration(watched: Clock, sent: Sent) -> None:
    level = brl.Level.from_fields(
        {"version": 1, "size": [3, 1], "items": [{"name": "key", "at": [1, 0]}]}
    )

    def part(configuration: int | None, heading: int | None) -> Overlay:
        return Overlay(values=[[float(configuration or 0)] * 3])

    overlay = Overlay(parts=part)
    view = LevelView(level)
    _ = view.widget
    view.set_overlay(overlay)
    for state in (0, 1 + 3, 0 + 3):
        view.move(state)
        whole = LayeredCanvas(build_layers(level, state=state, overlay=overlay)).widget
        assert sent.seen_on(view.widget) == sent.seen_on(whole)
    sent.clear()
    view.move(1 + 3)
    # Only the robot has changed.
    assert len(set(sent.layers)) == 1


def test_what_is_refused_leaves_the_view_as_it_was(sent: Sent) -> None:
    view = LevelView(LEVEL)
    _ = view.widget
    view.move(1, EAST)
    before = view.mimebundle()
    sent.clear()
    for state in (-1, 12):
        with pytest.raises(ValueError, match="state"):
            view.move(state)
        with pytest.raises(ValueError, match="state"):
            view.set_level(LEVEL, state)
    with pytest.raises(ValueError, match="rows"):
        view.set_overlay(Overlay(values=[[1.0]]))
    assert sent.kinds == []
    assert view.mimebundle() == before


def test_outside_of_a_notebook_the_bundle_has_widget_picture_and_text(sent: Sent) -> None:
    view = LevelView(LEVEL)
    view.move(2)
    bundle = view.mimebundle()
    assert bundle["application/vnd.jupyter.widget-view+json"]["model_id"] == view.widget.model_id
    assert ET.fromstring(bundle["image/svg+xml"]).tag.endswith("svg")
    assert bundle["image/png"]
    assert bundle["text/plain"].splitlines()[1].index("☻") == 4 * 2 + 2


def test_closing_twice_is_fine_and_a_widget_that_was_given_away_lives_on(sent: Sent) -> None:
    view = LevelView(LEVEL)
    widget = view.widget
    view.show()
    view.close()
    view.close()
    assert widget.comm is not None
