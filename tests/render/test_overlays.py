"""Overlays: values and arrows over the cells, clear of what else the picture says."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import pytest

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.raster import polylines, to_rgb
from babyrobot_levels.render.scene.build import build_layers, build_scene
from babyrobot_levels.render.scene.layout import CELL, COMPASS, layout_of
from babyrobot_levels.render.scene.number_labels import short
from babyrobot_levels.render.scene.overlay import Note, Overlay
from babyrobot_levels.render.scene.overlay_shapes import overlay_shapes
from babyrobot_levels.render.scene.shapes import Path, Rect, Shape, Text
from babyrobot_levels.render.scene.texts import coordinate_texts, end_texts, label_shapes

N, E, S, W = Action.NORTH, Action.EAST, Action.SOUTH, Action.WEST
EVERY = tuple(Action)
Box = tuple[float, float, float, float]


def level(**fields: Any) -> Any:
    return Level.from_fields({"version": 1, **fields})


def bare(*size: int) -> Any:
    """Return a level without texts of its own."""
    return level(size=list(size), display={"start_text": False, "exit_text": False})


def shapes_of(world: Any, overlay: Overlay) -> tuple[Shape, ...]:
    layers = overlay_shapes(world, overlay, layout_of(world, cells_only=True))
    return tuple(shape for layer in layers for shape in layer)


def in_each_cell(world: Any, content: Any) -> list[list[Any]]:
    return [[content] * world.size[0] for _ in range(world.size[1])]


def points_of(path: Path) -> list[tuple[float, float]]:
    return [point for line, _ in polylines(path.commands) for point in line]


def box_of(points: list[tuple[float, float]]) -> Box:
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def text_box(text: Text) -> Box:
    # Digits and capitals are about as high as two thirds of their size.
    width = 0.5 * text.size * len(text.text)
    left = text.x - (width / 2 if text.anchor == "middle" else 0)
    return left, text.y - 0.65 * text.size, left + width, text.y


def pill_box(rect: Rect) -> Box:
    return rect.x, rect.y, rect.x + rect.width, rect.y + rect.height


def touch(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


# -- values --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (-0.001, "0"),
        (-13.0, "-13"),
        (0.5, "0.5"),
        (-36.5833, "-36.58"),
        (999.994, "999.99"),
        (999.996, "1000"),
        (-12345.6, "-12346"),
        (99_999.7, "1.0e5"),
        (123_456.0, "1.2e5"),
        (-1.5e12, "-1.5e12"),
    ],
)
def test_values_are_written_shortly(value: float, text: str) -> None:
    assert short(value) == text


def test_values_are_written_in_their_cells_and_none_is_not() -> None:
    rows = [[1.0, None, -2.25], [None, 0.0, None]]
    shapes = shapes_of(level(size=[3, 2]), Overlay(values=rows))
    found = {
        (int(text.x // CELL), int(text.y // CELL)): text.text
        for text in shapes
        if isinstance(text, Text)
    }
    assert found == {(0, 0): "1", (2, 0): "-2.25", (1, 1): "0"}


def test_each_value_lies_on_a_ground_of_its_own_in_the_colours_for_texts() -> None:
    world = level(size=[2, 1])
    colors = world.resolved_theme.colors
    for value in (-99_999.0, -1.5e12, math.inf):
        ground, text = shapes_of(world, Overlay(values=[[None, value]]))
        assert isinstance(ground, Rect)
        assert ground.fill == colors.text_bg
        assert CELL < ground.x < ground.x + ground.width < 2 * CELL
        if isinstance(text, Text):
            box = text_box(text)
            assert text.fill == colors.text_fg
        else:
            assert isinstance(text, Path)
            box = box_of(points_of(text))
            assert text.stroke == colors.text_fg
        assert ground.x < box[0] < box[2] < ground.x + ground.width
        assert ground.y < box[1] < box[3] < ground.y + ground.height


def test_infinite_values_are_drawn_with_their_signs() -> None:
    def strokes(value: float) -> list[Path]:
        shapes = shapes_of(level(size=[2, 1]), Overlay(values=[[value, None]]))
        assert not any(isinstance(shape, Text) for shape in shapes)
        return [shape for shape in shapes if isinstance(shape, Path)]

    (endless,) = strokes(math.inf)
    below, sign = strokes(-math.inf)
    assert len(points_of(below)) == len(points_of(endless))
    assert box_of(points_of(sign))[2] < box_of(points_of(below))[0]


# -- arrows --------------------------------------------------------------------------------


def heads(world: Any, actions: Any) -> list[Box]:
    color = world.resolved_theme.colors.arrows
    for shape in shapes_of(world, Overlay(actions=actions)):
        if isinstance(shape, Path) and shape.fill == color:
            return [box_of(points) for points, _ in polylines(shape.commands)]
    return []


@pytest.mark.parametrize(
    ("action", "towards"), [(N, (0, -1)), (E, (1, 0)), (S, (0, 1)), (W, (-1, 0))]
)
def test_an_arrow_points_to_its_side(action: Action, towards: tuple[int, int]) -> None:
    ((left, top, right, bottom),) = heads(bare(2, 1), [[(), (action,)]])
    across, along = (left + right) / 2 - 1.5 * CELL, (top + bottom) / 2 - 0.5 * CELL
    assert (round(across / 10), round(along / 10)) == towards
    tips = {N: top, E: right, S: bottom, W: left}
    middle = 0.5 * CELL if action in (N, S) else 1.5 * CELL
    assert abs(tips[action] - middle) < CELL / 2 - 6


def test_there_is_an_arrow_for_each_action_and_a_ring_for_stay() -> None:
    world = bare(2, 1)
    assert len(heads(world, [[(N, E, S, W), (E,)]])) == 5
    assert heads(world, [[(Action.STAY,), ()]]) == []
    (*_, ring) = shapes_of(world, Overlay(actions=[[(Action.STAY,), ()]]))
    assert isinstance(ring, Path)
    assert ring.fill is None
    distances = {round(math.dist(point, (CELL / 2, CELL / 2)), 1) for point in points_of(ring)}
    assert len(distances) == 1


def test_where_nothing_is_to_be_done_nothing_is_drawn() -> None:
    assert shapes_of(bare(2, 1), Overlay(actions=[[(), ()]])) == ()
    assert shapes_of(level(size=[2, 1]), Overlay()) == ()


@pytest.mark.parametrize("theme", BUILTIN_THEMES)
def test_arrows_stand_out_from_every_ground(theme: str) -> None:
    areas = [{"at": [1, 0], "color": "white"}, {"at": [2, 0], "color": "black"}]
    puddles = [{"at": [3, 0], "size": "large"}]
    world = level(size=[5, 1], theme=theme, areas=areas, puddles=puddles)
    overlay = Overlay(actions=[[(N, E, S, W)] * 4 + [()]])

    def gray(shown: Overlay | None) -> Any:
        scene = build_scene(world, robot=False, cells_only=True, overlay=shown)
        return to_rgb(scene).mean(axis=2)

    before, after = gray(None), gray(overlay)
    side = int(CELL)
    for x in range(4):
        cell = (slice(None), slice(x * side, (x + 1) * side))
        changes = abs(after[cell] - before[cell])
        # More than a hundred pixels of the cell's 4096 are clearly lighter or darker.
        assert (changes > 60).sum() > 100


# -- together ------------------------------------------------------------------------------


@pytest.mark.parametrize("coordinates", [False, True])
def test_overlays_and_texts_do_not_touch(coordinates: bool) -> None:
    world = level(
        size=[4, 3],
        start=[[0, 0], [2, 2]],
        areas=[{"at": [0, 1], "size": [4, 1], "label": "a label of some length"}],
        display={"coordinates": coordinates},
    )
    layout = layout_of(world, cells_only=True)
    texts = [text_box(text) for text in end_texts(world, layout)]
    texts += [pill_box(s) for s in label_shapes(world, layout) if isinstance(s, Rect)]
    texts += [text_box(t) for t in coordinate_texts(world, layout) if isinstance(t, Text)]
    values, actions = in_each_cell(world, -123.45), in_each_cell(world, EVERY)
    values[2][3], actions[2][3] = None, ()
    shapes = shapes_of(world, Overlay(values, actions))
    pills = [pill_box(s) for s in shapes if isinstance(s, Rect)]
    pieces = [
        box_of(points)
        for shape in shapes
        if isinstance(shape, Path)
        for points, _ in polylines(shape.commands)
    ]
    assert len(pills) == 11
    for pill in pills:
        assert not any(touch(pill, text) for text in texts)
        assert not any(touch(pill, piece) for piece in pieces)
    for text in texts:
        assert not any(touch(piece, text) for piece in pieces)
    assert not any(touch(a, b) for a, b in combinations(pills, 2))


def test_numbers_lie_over_the_robot_and_arrows_below_him() -> None:
    world = level(size=[2, 1])
    overlay = Overlay([[1.5, None]], [[(E,), ()]])
    layers = build_layers(world, overlay=overlay)
    plain = build_scene(world).shapes
    arrows, robot, numbers = (layers[name].shapes for name in ("underlay", "robot", "overlay"))
    shown = build_scene(world, overlay=overlay).shapes
    assert shown == (*plain[: -len(robot)], *arrows, *robot, *numbers)
    assert arrows
    assert any(isinstance(shape, Text) and shape.text == "1.5" for shape in numbers)
    alone = build_scene(world, robot=False, overlay=overlay).shapes
    assert alone == (*plain[: -len(robot)], *arrows, *numbers)


# -- action values -------------------------------------------------------------------------


def test_values_of_moves_stand_at_their_sides_and_the_best_are_bold() -> None:
    shapes = shapes_of(bare(1, 2), Overlay(action_values=[[(9, 1, 2, 3, 3)], [()]]))
    texts = {shape.text: shape for shape in shapes if isinstance(shape, Text)}
    # For stay there is no room.
    assert set(texts) == {"1", "2", "3"}
    assert [texts[text].bold for text in "12"] == [False, False]
    north, east = texts["1"], texts["2"]
    south, west = sorted((s for s in shapes if isinstance(s, Text) and s.text == "3"), key=at_top)
    assert north.y < east.y < south.y
    assert west.x < north.x == south.x < east.x
    assert west.y == east.y


def at_top(text: Text) -> float:
    return -text.y


def test_where_room_is_short_decimals_are_given_up_before_size() -> None:
    def texts(overlay: Overlay) -> list[Text]:
        return [shape for shape in shapes_of(bare(2, 1), overlay) if isinstance(shape, Text)]

    numbers = [[(None, -12.34, -12.34, None, None), ()]]
    north, east = texts(Overlay(action_values=numbers))
    assert (north.text, east.text) == ("-12.34", "-12.3")
    beside_arrows = texts(Overlay(action_values=numbers, actions=[[(E,), ()]]))
    assert [text.text for text in beside_arrows] == ["-12.34", "-12"]
    assert min(text.size for text in beside_arrows) > 6


# -- visits --------------------------------------------------------------------------------


def test_the_busier_a_cell_the_stronger_its_colour() -> None:
    world = bare(4, 1)
    overlay = Overlay(visits=[[1, 200, 0, None]])
    heat, numbers, _ = overlay_shapes(world, overlay, layout_of(world, cells_only=True))
    few, many = (shape for shape in heat if isinstance(shape, Rect))
    assert few.opacity < many.opacity
    assert few.x < CELL < many.x
    assert [shape.text for shape in numbers if isinstance(shape, Text)] == ["1", "200"]


def test_heat_and_counts_keep_clear_of_texts() -> None:
    world = level(size=[3, 2], areas=[{"at": [1, 0], "size": [2, 1], "label": "a label"}])
    layout = layout_of(world, cells_only=True)
    texts = [text_box(text) for text in end_texts(world, layout)]
    texts += [pill_box(s) for s in label_shapes(world, layout) if isinstance(s, Rect)]
    for coordinates in (False, True):
        overlay = Overlay(visits=in_each_cell(world, 12), coordinates=coordinates)
        shapes = shapes_of(world, overlay)
        boxes = [pill_box(shape) for shape in shapes if isinstance(shape, Rect)]
        written = [text_box(t) for t in shapes if isinstance(t, Text) and "," in t.text]
        assert len(boxes) == 12
        assert len(written) == 6 * coordinates
        counts = [box for box in boxes if box[2] - box[0] < CELL / 2]
        assert len(counts) == 6
        assert not any(touch(box, text) for box in boxes + written for text in texts)
        assert not any(touch(box, text) for box in counts for text in written)


def test_coordinates_that_the_level_shows_are_not_written_twice() -> None:
    world = level(size=[2, 1], display={"coordinates": True})
    assert shapes_of(world, Overlay(coordinates=True)) == ()


# -- notes and panels ----------------------------------------------------------------------


@pytest.mark.parametrize("text", ["short", "a note that is as long as two cells", "word " * 40])
@pytest.mark.parametrize("x", [0, 0.5, 2])
def test_a_note_stays_on_the_grid(text: str, x: float) -> None:
    world = level(size=[3, 2])
    ground, written = shapes_of(world, Overlay(notes=[Note(x, 1, text)]))
    assert isinstance(ground, Rect)
    assert isinstance(written, Text)
    assert ground.x >= 0
    assert ground.x + ground.width <= 3 * CELL
    assert CELL < ground.y < ground.y + ground.height < 2 * CELL
    assert ground.x < text_box(written)[0] < text_box(written)[2] < ground.x + ground.width


def test_a_note_has_the_theme_s_colour_or_its_own() -> None:
    world = level(size=[3, 2])
    notes = [Note(0, 0, "a"), Note(1, 0, "b", "gold"), Note(2, 0, " ")]
    texts = [s for s in shapes_of(world, Overlay(notes=notes)) if isinstance(s, Text)]
    assert [text.fill for text in texts] == [world.resolved_theme.colors.text_fg, "gold"]


def lines(world: Any, **panels: Any) -> list[Text]:
    scene = build_layers(world, overlay=Overlay(**panels))["text"]
    for text in scene.shapes:
        assert isinstance(text, Text)
        box = text_box(text)
        assert 0 < box[0] < box[2] < scene.width
        assert 0 < box[1] < box[3] < scene.height
    return [text for text in scene.shapes if isinstance(text, Text)]


def test_lines_are_written_into_the_panels_in_their_colours() -> None:
    world = level(display={"side_panel": {"width": 90, "text_color": "gold"}, "bottom_panel": 50})
    side, bottom = lines(world, side_panel=["beside"], bottom_panel=["below"])
    base = build_scene(world)
    assert (side.text, side.fill) == ("beside", "gold")
    assert side.x > 198
    assert (bottom.text, bottom.fill) == ("below", world.resolved_theme.colors.text_fg)
    assert bottom.y > 198
    assert build_scene(world, overlay=Overlay(side_panel=["beside"])).width == base.width


def test_long_lines_are_broken_and_those_without_room_are_left_out() -> None:
    world = level(display={"side_panel": 120})
    texts = [text.text for text in lines(world, side_panel=["a line of many words", "", "end"])]
    assert " ".join(texts) == "a line of many words end"
    assert len(texts) > 2
    many = lines(world, side_panel=[str(number) for number in range(99)])
    assert len(many) < 12
    assert many[-1].text == "…"


def test_a_level_without_panels_is_given_those_that_are_written_into() -> None:
    world = level()
    plain = build_scene(world)
    scene = build_scene(world, overlay=Overlay(side_panel=["a"], bottom_panel=["b", "c"]))
    assert scene.width > plain.width + 100
    assert scene.height > plain.height + 30
    ground = world.resolved_theme.colors.text_bg
    panels = [s for s in scene.shapes if isinstance(s, Rect) and s.fill == ground]
    assert {(panel.x, panel.y) for panel in panels} == {(198, 0), (0, 198)}
    assert [text.text for text in lines(world, bottom_panel=["word " * 30])][-1] != "…"
    cells = build_scene(world, cells_only=True, overlay=Overlay(side_panel=["a"]))
    assert cells == build_scene(world, cells_only=True)


def test_lines_begin_below_the_compass() -> None:
    world = level(display={"compass": True})
    (line,) = lines(world, side_panel=["a"])
    assert line.y > COMPASS


@pytest.mark.parametrize("rows", [[[0.0, 0.0]], [[0.0], [0.0]], [[0.0, 0.0], [0.0]]])
def test_an_overlay_of_another_size_is_refused(rows: list[list[float]]) -> None:
    world = level(size=[2, 2])
    with pytest.raises(ValueError, match="2 rows of 2 cells"):
        build_scene(world, overlay=Overlay(values=rows))
    with pytest.raises(ValueError, match="2 rows of 2 cells"):
        build_scene(world, overlay=Overlay(actions=[[() for _ in row] for row in rows]))
