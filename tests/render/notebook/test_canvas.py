"""The canvas is drawn in few messages, and stays whole whatever happens to some of them."""

from __future__ import annotations

from dataclasses import replace

import pytest
from ipycanvas import Canvas  # type: ignore[import-untyped]
from support.canvases import Sent

import babyrobot_levels as brl
from babyrobot_levels.render.notebook import canvas as stages
from babyrobot_levels.render.notebook.canvas import LayeredCanvas
from babyrobot_levels.render.scene.build import LAYERS, build_layers
from babyrobot_levels.render.scene.layout import Overlay
from babyrobot_levels.render.scene.shapes import Rect, Scene, Text

SMALL = brl.Level(version=1, size=(3, 2))
LARGE = brl.Level.model_validate({"version": 1, "size": (40, 40), "maze": {"seed": 1}})


def ids(stage: LayeredCanvas, *names: str) -> list[str]:
    return [stage.widget[LAYERS.index(name)].model_id for name in names]


def client_ready(stage: LayeredCanvas) -> None:
    """Do what a page does that has just been opened."""
    stage.widget[-1]._handle_custom_msg({"event": "client_ready"}, [])


# -- how much is sent ------------------------------------------------------------------------


@pytest.mark.parametrize("level", [SMALL, LARGE], ids=["small", "large"])
def test_a_level_of_any_size_is_drawn_in_one_message(level: brl.Level, sent: Sent) -> None:
    stage = LayeredCanvas(build_layers(level))
    assert len(sent.drawings) == 1
    assert sent.layers == ids(stage, *LAYERS)
    # The rest says what canvases there are, and how large.
    assert len(sent.kinds) <= 42


def test_only_layers_that_differ_are_painted(sent: Sent) -> None:
    stage = LayeredCanvas(build_layers(SMALL, state=0))
    sent.clear()
    stage.paint(build_layers(SMALL, state=0))
    assert sent.kinds == []
    stage.paint(build_layers(SMALL, state=1))
    assert sent.layers == ids(stage, "robot")
    sent.clear()
    for value in (1.0, 9.0):
        sent.clear()
        values = Overlay(values=[[value, 2.0, 3.0], [4.0, 5.0, 6.0]])
        stage.paint(build_layers(SMALL, state=1, overlay=values))
    assert len(sent.drawings) == 1
    assert set(sent.layers) <= set(ids(stage, "heat", "overlay"))
    assert sent.layers


def test_frames_are_played_by_the_browser_in_one_message(sent: Sent) -> None:
    stage = LayeredCanvas(build_layers(SMALL, state=0))
    frames = [build_layers(SMALL, state=state)["robot"] for state in (0, 1, 2)]
    sent.clear()
    stage.animate([{"robot": frame} for frame in frames], 40)
    assert len(sent.drawings) == 1
    assert sent.layers == 3 * ids(stage, "robot")
    assert sent.commands("sleep") == [[40], [40]]
    sent.clear()
    stage.paint(build_layers(SMALL, state=2))
    assert sent.kinds == []


# -- what each picture is --------------------------------------------------------------------


@pytest.mark.parametrize(("columns", "rows"), [(2, 1), (8, 5), (100, 100), (1024, 1), (3, 600)])
def test_a_canvas_is_as_large_as_its_picture_but_never_too_large(columns: int, rows: int) -> None:
    level = brl.Level(version=1, size=(columns, rows))
    scenes = build_layers(level)
    widget = LayeredCanvas(scenes).widget
    width, height = scenes["base"].width, scenes["base"].height
    assert max(widget.width, widget.height) <= 2048
    scale = min(1, 2048 / max(width, height))
    assert (widget.width, widget.height) == pytest.approx((scale * width, scale * height), abs=1)


def test_another_size_is_taken_over_and_all_is_painted(sent: Sent) -> None:
    stage = LayeredCanvas(build_layers(SMALL))
    other = brl.Level(version=1, size=(5, 4))
    sent.clear()
    stage.paint(build_layers(other))
    scene = build_layers(other)["base"]
    assert (stage.widget.width, stage.widget.height) == (scene.width, scene.height)
    assert {(layer.width, layer.height) for layer in stage.widget._canvases} == {
        (scene.width, scene.height)
    }
    assert sent.layers == ids(stage, *LAYERS)


def test_what_is_hostile_is_sent_as_a_text_and_nothing_else(sent: Sent) -> None:
    text = 'x"],0],[62,["IPY_MODEL_0"]] </script>\u202e\ud800 \t  y\x00'
    ground = Rect(0, 0, 9, 9, "rebeccapurple", opacity=0.5)
    shapes = (ground, Text(1, 2, text, 10, "beige"))
    LayeredCanvas({name: Scene(9, 9, shapes if name == "text" else ()) for name in LAYERS})
    assert len(sent.drawings) == 1
    [[shown, *_]] = sent.commands("fillText")
    assert shown == 'x"],0],[62,["IPY_MODEL_0"]] </script>\u202e? y\x00'
    # ipycanvas knows neither of these names as browsers do.
    colors = [value for number, value in sent.commands("set") if number == 0]
    assert colors == ["#663399", "#f5f5dc"]


# -- what goes wrong -------------------------------------------------------------------------


class Broken(Exception):
    pass


@pytest.mark.parametrize("error", [Broken, KeyboardInterrupt])
def test_what_an_exception_left_unfinished_is_painted_the_next_time(
    error: type[BaseException], sent: Sent, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = LayeredCanvas(build_layers(SMALL, state=0))
    painted: list[Canvas] = []

    def paint(canvas: Canvas, *rest: object) -> None:
        if painted:
            raise error
        painted.append(canvas)

    with monkeypatch.context() as patch:
        patch.setattr(stages, "paint", paint)
        with pytest.raises(error):
            stage.repaint()
    # ipycanvas itself is not left holding back what anybody draws.
    sent.clear()
    Canvas().fill_rect(0, 0, 1, 1)
    assert sent.commands("fillRect") == [[0, 0, 1, 1]]
    sent.clear()
    robot = build_layers(SMALL, state=1)["robot"]
    stage.animate([{"robot": robot}], 40)
    assert set(sent.layers) == set(ids(stage, *LAYERS))
    assert sent.layers[-1:] == ids(stage, "robot")
    sent.clear()
    stage.paint(build_layers(SMALL, state=1))
    assert sent.kinds == []


def test_a_step_that_was_broken_off_is_made_good(
    sent: Sent, monkeypatch: pytest.MonkeyPatch
) -> None:
    layers = build_layers(SMALL, state=0)
    stage = LayeredCanvas(layers)

    def paint(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(stages, "paint", paint)
        with pytest.raises(KeyboardInterrupt):
            stage.animate([{"robot": build_layers(SMALL, state=1)["robot"]}], 40)
    sent.clear()
    stage.paint(layers)
    assert sent.layers == ids(stage, "robot")


def test_a_page_that_is_opened_later_is_given_the_whole_picture(sent: Sent) -> None:
    stage = LayeredCanvas(build_layers(SMALL, state=0))
    stage.animate([{"robot": build_layers(SMALL, state=2)["robot"]}], 40)
    before = sent.seen_on(stage.widget)
    sent.clear()
    client_ready(stage)
    assert len(sent.drawings) == 1
    assert sent.seen_on(stage.widget) == before


def test_every_message_says_on_which_canvas_it_draws(sent: Sent) -> None:
    """A page that was opened since the last one would fail at the first command, for good."""
    stage = LayeredCanvas(build_layers(SMALL, state=0))
    for state in (1, 2):
        stage.paint(build_layers(SMALL, state=state))
        stage.animate([{"robot": build_layers(SMALL, state=0)["robot"]}], 40)
    base = build_layers(SMALL, state=0)
    base["base"] = replace(base["base"], shapes=())
    stage.paint(base)
    client_ready(stage)
    client_ready(stage)
    assert len(sent.drawings) == 8
    assert {drawing[0][0] for drawing in sent.drawings} == {"switchCanvas"}


def test_a_closed_stage_leaves_the_layers_that_a_page_may_still_draw_on(sent: Sent) -> None:
    stage = LayeredCanvas(build_layers(SMALL))
    layers = [stage.widget[number] for number in range(len(LAYERS))]
    sent.clear()
    stage.close()
    assert stage.widget.comm is None
    assert [(layer.comm is None, layer.width, layer.height) for layer in layers] == len(LAYERS) * [
        (False, 1, 1)
    ]
    sent.clear()
    client_ready(stage)
    assert sent.kinds == []
