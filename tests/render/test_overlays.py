"""Overlays: values and arrows over the cells, clear of what else the picture says."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import combinations
from typing import Any

import pytest
from support.worlds import level

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.colors import contrast
from babyrobot_levels.render.raster import polylines, to_rgb
from babyrobot_levels.render.scene.build import build_layers, build_scene, overlay_shapes
from babyrobot_levels.render.scene.layout import CELL, COMPASS, layout_of
from babyrobot_levels.render.scene.overlay import Note, Overlay
from babyrobot_levels.render.scene.shapes import Path, Rect, Shape, Text
from babyrobot_levels.render.scene.texts import short

N, E, S, W = Action.NORTH, Action.EAST, Action.SOUTH, Action.WEST
EVERY = tuple(Action)
Box = tuple[float, float, float, float]


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
    left = text.x - {"start": 0, "middle": width / 2, "end": width}[text.anchor]
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
        (-12345.6, "-12345.6"),
        (99_999.7, "100k"),
        (923_000.0, "923k"),
        (999_999.0, "1M"),
        (-1.25e12, "-1.25T"),
        (3e17, "3e17"),
    ],
)
def test_values_are_written_shortly(value: float, text: str) -> None:
    assert short(value) == text


def written(shapes: Iterable[Shape]) -> dict[tuple[int, int], str]:
    return {
        (int(text.x // CELL), int(text.y // CELL)): text.text
        for text in shapes
        if isinstance(text, Text)
    }


def test_values_have_one_form_in_their_cells_and_none_is_not_written() -> None:
    rows = [[1.0, None, -2.25], [-0.001, 0.5, None]]
    shapes = shapes_of(level(size=[3, 2]), Overlay(values=rows))
    assert written(shapes) == {(0, 0): "1.00", (2, 0): "-2.25", (0, 1): "0.00", (1, 1): "0.50"}
    shapes = shapes_of(level(size=[3, 2]), Overlay(values=rows, precision=1))
    assert {*written(shapes).values()} == {"1.0", "-2.2", "0.0", "0.5"}


def test_nothing_is_answered_where_nobody_can_stand() -> None:
    world = level(
        size=[4, 2],
        exit=[3, 0],
        blocked=[{"at": [1, 1]}],
        warps=[{"at": [2, 1], "to": "start"}],
    )
    overlay = Overlay(
        values=in_each_cell(world, 5.0),
        actions=in_each_cell(world, (E,)),
        action_values=None,
    )
    shapes = shapes_of(world, overlay)
    # The exit has no arrow; a value of an end is told unless it is 0.
    assert set(written(shapes)) == {(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (3, 1)}
    assert len(heads(world, overlay.actions)) == 5
    shapes = shapes_of(world, Overlay(values=in_each_cell(world, 0.0)))
    assert (3, 0) not in written(shapes)
    moves = Overlay(action_values=in_each_cell(world, (None, 1.0, 2.0, 3.0, 4.0)))
    assert len([s for s in shapes_of(world, moves) if isinstance(s, Text)]) == 5 * 4


def test_each_value_is_readable_on_the_tile_of_its_colour() -> None:
    for theme in BUILTIN_THEMES:
        world = level(size=[3, 1], theme=theme)
        for value in (-99_999.0, -1.5e12, math.inf, -math.inf):
            heat, _, numbers, _ = overlay_shapes(
                world, Overlay(values=[[value, 1.0, None]]), layout_of(world, cells_only=True)
            )
            tiles = [shape for shape in heat if isinstance(shape, Path) and shape.fill]
            tile = next(tile for tile in tiles if box_of(points_of(tile))[:2] == (0, 0))
            first = next(shape for shape in numbers if isinstance(shape, Text | Path))
            ink = first.stroke if isinstance(first, Path) else first.fill
            assert ink is not None
            assert tile.fill is not None
            assert contrast(ink, tile.fill) >= 4.5
            box = box_of(points_of(first)) if isinstance(first, Path) else text_box(first)
            assert 0 < box[0] < box[2] < CELL


def test_tiles_of_equal_neighbours_are_one() -> None:
    world = level(size=[40, 40])
    values = [[float(y // 20) for _ in range(40)] for y in range(40)]
    heat, *_ = overlay_shapes(world, Overlay(values=values), layout_of(world, cells_only=True))
    colors = world.resolved_theme.colors
    pieces = [
        line
        for shape in heat
        if isinstance(shape, Path) and shape.fill not in (colors.start, colors.exit)
        for line, _ in polylines(shape.commands)
    ]
    assert len(pieces) == 2


def test_where_numbers_could_not_be_read_there_are_colours_alone() -> None:
    for side, count in ((30, 30 * 30), (64, 0)):
        world = level(size=[side, side])
        overlay = Overlay(values=in_each_cell(world, 3.25))
        heat, _, numbers, _ = overlay_shapes(world, overlay, layout_of(world, overlay=overlay))
        assert heat
        assert len([shape for shape in numbers if isinstance(shape, Text)]) == count


def test_a_cell_with_a_colour_keeps_a_frame_of_it() -> None:
    area = {"at": [1, 0], "size": [2, 1], "color": "#123456"}
    world = level(size=[4, 1], areas=[area])
    heat, *_ = overlay_shapes(
        world, Overlay(values=[[1.0, 2.0, 3.0, None]]), layout_of(world, cells_only=True)
    )
    (frame,) = (shape for shape in heat if isinstance(shape, Path) and shape.fill == "#123456")
    assert box_of(points_of(frame)) == (CELL, 0, 3 * CELL, CELL)
    # Nothing of it lies between its two cells, but at the edges.
    boxes = [box_of(points) for points, _ in polylines(frame.commands)]
    assert all(min(box[2] - box[0], box[3] - box[1]) == 5.5 for box in boxes)
    assert len(boxes) == 6


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([0.0, 2.5, 10.0], ["0", "10"]),
        ([-7.0, 3.0, 5.0], ["-7", "5", "0"]),
        ([4.0, 4.0, 4.0], ["4"]),
        ([-1e6, None, 1.0], ["-1M", "1"]),
    ],
)
def test_a_legend_tells_the_ends_of_the_scale(values: list[float | None], texts: list[str]) -> None:
    world = level(size=[4, 1])
    overlay = Overlay(values=[[*values, None]])
    layout = layout_of(world, overlay=overlay)
    heat, *_ = overlay_shapes(world, overlay, layout)
    legend = [shape for shape in heat if isinstance(shape, Text)]
    assert [shape.text for shape in legend][: len(texts)] == texts
    for shape in legend:
        box = text_box(shape)
        assert layout.grid_height + 2 * layout.margin < box[1] < box[3] < layout.height
    assert layout_of(world).height + 28 == layout.height
    assert layout_of(world, overlay=Overlay(actions=[[()] * 4])) == layout_of(world)


def test_infinite_values_are_drawn_with_their_signs() -> None:
    def strokes(value: float) -> list[Path]:
        world = level(size=[2, 1])
        layers = overlay_shapes(
            world, Overlay(values=[[value, None]]), layout_of(world, cells_only=True)
        )
        return [shape for shape in layers.overlay if isinstance(shape, Path)]

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
    ((left, top, right, bottom),) = heads(bare(3, 1), [[(), (action,), ()]])
    across, along = (left + right) / 2 - 1.5 * CELL, (top + bottom) / 2 - 0.5 * CELL
    assert (round(across / 10), round(along / 10)) == towards
    tips = {N: top, E: right, S: bottom, W: left}
    middle = 0.5 * CELL if action in (N, S) else 1.5 * CELL
    assert abs(tips[action] - middle) < CELL / 2 - 6


def test_there_is_an_arrow_for_each_action_and_a_ring_for_stay() -> None:
    world = bare(3, 1)
    assert len(heads(world, [[(N, E, S, W), (E,), ()]])) == 5
    assert heads(world, [[(Action.STAY,), (), ()]]) == []
    (*_, ring) = shapes_of(world, Overlay(actions=[[(Action.STAY,), (), ()]]))
    assert isinstance(ring, Path)
    assert ring.fill is None
    distances = {round(math.dist(point, (CELL / 2, CELL / 2)), 1) for point in points_of(ring)}
    assert len(distances) == 1


def test_the_more_probable_an_action_the_longer_its_arrow() -> None:
    world = bare(3, 1)
    chances = {1: 0.1, 2: 0.6, 3: 0.3, 4: 0.0}
    overlay = Overlay(actions=[[(E,), (), ()]], probabilities=[[chances, {}, {}]])
    color = world.resolved_theme.colors.arrows
    (tips,) = (
        shape
        for shape in shapes_of(world, overlay)
        if isinstance(shape, Path) and shape.fill == color
    )
    boxes = [box_of(points) for points, _ in polylines(tips.commands)]
    north, east, south = (max(abs(place - CELL / 2) for place in box) for box in boxes)
    assert north < south < east


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
    overlay = Overlay(in_each_cell(world, -123.45), in_each_cell(world, EVERY))
    layout = layout_of(world, cells_only=True)
    layers = build_layers(world, robot=False, cells_only=True, overlay=overlay)
    texts = [text_box(s) for s in layers["grid"].shapes if isinstance(s, Text)]
    texts += [text_box(s) for s in layers["text"].shapes if isinstance(s, Text)]
    numbers = [text_box(s) for s in layers["overlay"].shapes if isinstance(s, Text)]
    pieces = [
        box_of(points)
        for shape in layers["underlay"].shapes
        if isinstance(shape, Path)
        for points, _ in polylines(shape.commands)
    ]
    assert len(numbers) == 12
    # START and EXIT give way to coordinates, and these to a label; frames have their colours.
    assert len(texts) == (1 + 8 if coordinates else 1 + 3)
    assert layout.legend == 0
    for number in numbers:
        assert not any(touch(number, other) for other in (*texts, *pieces))
    for text in texts:
        assert not any(touch(piece, text) for piece in pieces)
    assert not any(touch(a, b) for a, b in combinations((*numbers, *texts), 2))


def test_numbers_lie_over_the_robot_and_arrows_below_him() -> None:
    world = level(size=[2, 1])
    overlay = Overlay([[1.5, None]], [[(E,), ()]])
    layers = build_layers(world, overlay=overlay)
    names = ("base", "heat", "grid", "underlay", "robot", "overlay")
    heat, arrows, robot, numbers = (layers[names[place]].shapes for place in (1, 3, 4, 5))
    assert all((heat, arrows, robot))
    assert any(isinstance(shape, Text) and shape.text == "1.5" for shape in numbers)
    shown = build_scene(world, overlay=overlay).shapes
    assert shown == tuple(shape for name in names for shape in layers[name].shapes)
    alone = build_scene(world, robot=False, overlay=overlay).shapes
    assert alone == tuple(shape for shape in shown if shape not in robot)


def test_the_robot_hides_neither_the_arrow_nor_the_value_of_its_cell() -> None:
    world = level(size=[2, 1])
    overlay = Overlay([[-12.25, None]], [[(N, W, S), ()]])
    layers = build_layers(world, overlay=overlay)
    (tips,) = (s for s in layers["underlay"].shapes[-1:] if isinstance(s, Path))
    arrows = [box_of(points) for points, _ in polylines(tips.commands)]
    numbers = [text_box(s) for s in layers["overlay"].shapes if isinstance(s, Text)]
    bodies = [pill_box(s) for s in layers["robot"].shapes if isinstance(s, Rect)]
    assert len(arrows) == 3
    for box in (*arrows, *numbers):
        assert not any(touch(box, body) for body in bodies)


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

    numbers = [[(None, -12.34, 5.0, None, None), ()]]
    assert [text.text for text in texts(Overlay(action_values=numbers))] == ["-12.3", "5.0"]
    beside_arrows = texts(Overlay(action_values=numbers, actions=[[(E,), ()]]))
    assert [text.text for text in beside_arrows] == ["-12", "5"]
    assert min(text.size for text in beside_arrows) > 6


def test_the_value_of_an_action_is_the_colour_of_its_side() -> None:
    world = bare(1, 2)
    values: list[list[tuple[float, ...]]] = [[(9, 1, 2, 3, 3)], [()]]
    heat, *_ = overlay_shapes(
        world, Overlay(action_values=values), layout_of(world, cells_only=True)
    )
    middle = (CELL / 2, CELL / 2)
    sides = {
        shape.fill: [points for points, _ in polylines(shape.commands)]
        for shape in heat
        if isinstance(shape, Path) and shape.fill and middle in points_of(shape)
    }
    # 3 is twice the best, to the south and to the west.
    assert sorted(map(len, sides.values())) == [1, 1, 2]


# -- visits --------------------------------------------------------------------------------


def test_the_busier_a_cell_the_stronger_its_colour() -> None:
    world = bare(4, 1)
    overlay = Overlay(visits=[[1, 200, 0, None]])
    heat, _, numbers, _ = overlay_shapes(world, overlay, layout_of(world, cells_only=True))
    color = world.resolved_theme.colors.start
    tiles = {
        box_of(points_of(s))[0]: s.fill for s in heat if isinstance(s, Path) and s.fill != color
    }
    few, many = tiles[0], tiles[CELL]
    # In the default theme, darker is more.
    assert contrast(str(few), "#000000") > contrast(str(many), "#000000")
    assert 2 * CELL not in tiles
    assert [shape.text for shape in numbers if isinstance(shape, Text)] == ["1", "200"]


@pytest.mark.parametrize("values", [False, True])
def test_counts_keep_clear_of_texts(values: bool) -> None:
    world = level(size=[3, 2], areas=[{"at": [1, 0], "size": [2, 1], "label": "a label"}])
    for coordinates in (False, True):
        overlay = Overlay(
            visits=in_each_cell(world, 12),
            values=in_each_cell(world, 1.5) if values else None,
            coordinates=coordinates,
        )
        layers = build_layers(world, robot=False, cells_only=True, overlay=overlay)
        boxes = [
            text_box(shape)
            for name in ("grid", "overlay", "text")
            for shape in layers[name].shapes
            if isinstance(shape, Text)
        ]
        assert len(boxes) >= 6 + 6 * coordinates + 6 * values + 1
        assert not any(touch(a, b) for a, b in combinations(boxes, 2))


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
    world = level(display={"side_panel": {"width": 90, "text_color": "ivory"}, "bottom_panel": 50})
    side, bottom = lines(world, side_panel=["beside"], bottom_panel=["below"])
    base = build_scene(world)
    assert (side.text, side.fill) == ("beside", "ivory")
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
