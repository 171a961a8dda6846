"""Scenes: what of a level is in its picture, and where."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import pytest
from support.scenes import bounds
from support.worlds import level

from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.raster import polylines
from babyrobot_levels.render.scene.build import build_layers, build_scene, overlay_shapes
from babyrobot_levels.render.scene.layout import CELL, Note, Overlay, layout_of
from babyrobot_levels.render.scene.shapes import Path, Rect, Shape, Text
from babyrobot_levels.render.scene.texts import short
from babyrobot_levels.render.scene.walls import casing_shapes
from babyrobot_levels.render.situation import Pose

MARGIN = 3
"""The default theme's free space: half of its outer wall, in whole pixels."""


def corner(x: float, y: float) -> tuple[float, float]:
    return MARGIN + CELL * x, MARGIN + CELL * y


def strokes(world: Any, color: str) -> Iterator[Path]:
    for shape in build_scene(world, robot=False).shapes:
        if isinstance(shape, Path) and shape.stroke == color:
            yield shape


@pytest.mark.parametrize("size", [[1, 1], [1, 7], [7, 1], [3, 3]])
@pytest.mark.parametrize("fields", [{}, {"maze": {"seed": 3}}])
def test_all_shapes_lie_in_the_picture(size: list[int], fields: dict[str, Any]) -> None:
    ends = {"exit": "none"} if size == [1, 1] else {}
    display = {"compass": True, "side_panel": 80, "bottom_panel": 20, "coordinates": True}
    scene = build_scene(level(size=size, display=display, **ends, **fields))
    for shape in scene.shapes:
        left, top, right, bottom = bounds(shape)
        assert left >= 0, shape
        assert top >= 0, shape
        assert right <= scene.width, shape
        assert bottom <= scene.height, shape


# -- layers --------------------------------------------------------------------------------

OVERLAY = Overlay(
    values=[[1.0, None, 2.0]] * 2,
    actions=[[(Action.EAST,), (), (Action.SOUTH,)]] * 2,
    visits=[[3, 0, 1]] * 2,
    notes=[Note(1, 1, "here")],
    side_panel=["beside"],
    bottom_panel=["below"],
)


@pytest.mark.parametrize("cells_only", [False, True])
@pytest.mark.parametrize("overlay", [None, OVERLAY])
def test_layers_painted_one_over_the_other_are_the_scene(
    overlay: Overlay | None, cells_only: bool
) -> None:
    world = level(size=[3, 2], puddles=[{"at": [1, 1]}], display={"compass": True})
    told: dict[str, Any] = {"state": 4, "pose": Pose(Action.EAST), "overlay": overlay}
    layers = build_layers(world, cells_only=cells_only, **told)
    scene = build_scene(world, cells_only=cells_only, **told)
    assert tuple(layers) == (
        "base",
        "heat",
        "grid",
        "things",
        "underlay",
        "robot",
        "movers",
        "overlay",
        "text",
    )
    assert tuple(shape for layer in layers.values() for shape in layer.shapes) == scene.shapes
    sizes = {(layer.width, layer.height, layer.title) for layer in layers.values()}
    assert sizes == {(scene.width, scene.height, scene.title)}


# -- the ground ----------------------------------------------------------------------------


def texts(world: Any) -> list[str]:
    return [shape.text for shape in build_scene(world).shapes if isinstance(shape, Text)]


def test_labels_are_cut_where_they_have_no_room() -> None:
    (label,) = texts(
        level(
            size=[5, 2],
            areas=[{"at": [3, 0], "label": "far too long\nfor a cell"}],
            display={"start_text": False, "exit_text": False},
        )
    )
    assert label.endswith("…")
    assert "far too long for a cell".startswith(label[:-1])
    assert len(label) > 5


def test_blocked_cells_that_are_no_rectangle_are_one_shape() -> None:
    # As several, there would be hairlines between them wherever pixels do not fit to cells.
    world = level(size=[4, 4], blocked=[{"at": [1, 1]}, {"at": [1, 2], "size": [2, 1]}])
    color = world.resolved_theme.colors.blocked
    (block,) = [
        shape
        for shape in build_scene(world, robot=False).shapes
        if not isinstance(shape, Text) and shape.fill == color
    ]
    assert isinstance(block, Path)
    pieces = {tuple(points) for points, _ in polylines(block.commands)}
    assert len(pieces) == 2
    assert {corner(1, 1), corner(2, 2)} <= {point for piece in pieces for point in piece}
    assert corner(3, 3) in {point for piece in pieces for point in piece}


# -- arrows --------------------------------------------------------------------------------


def heads(world: Any) -> list[tuple[float, float, float, float]]:
    arrows = world.resolved_theme.colors.arrows
    shapes = build_scene(world, robot=False).shapes
    return [bounds(s) for s in shapes if isinstance(s, Path) and s.fill == arrows]


def test_a_warp_to_the_start_and_one_to_itself_stay_in_their_cell() -> None:
    ((left, top, right, bottom),) = heads(level(warps=[{"at": [1, 1], "to": "start"}]))
    assert corner(1, 1) < (left, top)
    assert (right, bottom) < corner(2, 2)
    assert heads(level(warps=[{"at": [1, 1], "to": [1, 1], "when": "leave"}])) == []


def test_winds_against_each_other_are_still() -> None:
    world = level(size=[2, 2], wind={"north": [1, 1], "south": [1, 1]})
    assert not list(strokes(world, world.resolved_theme.colors.arrows))


# -- overlays --------------------------------------------------------------------------------------

N, E, S, W = Action.NORTH, Action.EAST, Action.SOUTH, Action.WEST
Box = tuple[float, float, float, float]


def bare(*size: int) -> Any:
    """Return a level without texts of its own."""
    return level(size=list(size), display={"start_text": False, "exit_text": False})


def shapes_of(world: Any, overlay: Overlay) -> tuple[Shape, ...]:
    layers = overlay_shapes(world, overlay, layout_of(world, cells_only=True))
    return tuple(shape for layer in layers for shape in layer)


def in_each_cell(world: Any, content: Any) -> list[list[Any]]:
    return [[content] * world.size[0] for _ in range(world.size[1])]


def box_of(points: list[tuple[float, float]]) -> Box:
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def text_box(text: Text) -> Box:
    # Digits and capitals are about as high as two thirds of their size.
    width = 0.5 * text.size * len(text.text)
    left = text.x - {"start": 0, "middle": width / 2, "end": width}[text.anchor]
    return left, text.y - 0.65 * text.size, left + width, text.y


# -- values --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (-0.001, "0"),
        (-36.5833, "-36.58"),
        (999.996, "1000"),
        (99_999.7, "100k"),
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


def test_whole_values_have_no_decimals_the_others_one_form_and_none_is_not_written() -> None:
    rows = [[1.0, None, -2.25], [-0.001, 0.5, None]]
    shapes = shapes_of(level(size=[3, 2]), Overlay(values=rows))
    assert written(shapes) == {
        (0, 0): "1",
        (2, 0): "\N{MINUS SIGN}2.25",
        (0, 1): "0.00",
        (1, 1): "0.50",
    }
    shapes = shapes_of(level(size=[3, 2]), Overlay(values=rows, precision=1))
    assert {*written(shapes).values()} == {"1", "\N{MINUS SIGN}2.2", "0.0", "0.5"}


def test_walls_have_one_rim_on_both_sides_and_the_border_has_none() -> None:
    colors = {"base": "#cc5500", "walls": "#cc5500", "border": "#cc5500"}
    world = level(
        size=[3, 1], walls=[{"at": [0, 0], "side": "E"}], theme={"colors": colors}, exit=[2, 0]
    )
    [rim] = casing_shapes(world, layout_of(world))
    assert isinstance(rim, Path)
    (left, top), (right, foot) = (point for _, point in rim.commands)
    assert left == right == corner(1, 0)[0]
    assert 0 < top - corner(1, 0)[1] == corner(1, 1)[1] - foot < 2
    assert rim.stroke == "#000000"
    assert rim.width > world.resolved_theme.widths.walls


def test_puddles_beside_arrows_are_icons_in_their_cells() -> None:
    world = level(size=[3, 1], puddles=[{"at": [1, 0], "size": "large"}], exit=[2, 0])
    scene = build_scene(world, overlay=Overlay(actions=[[(E,), (E,), ()]]))
    puddle = next(
        shape for shape in scene.shapes
        if isinstance(shape, Path) and shape.fill == world.resolved_theme.colors.puddle
    )  # fmt: skip
    left, top, right, bottom = bounds(puddle)
    assert corner(1, 0) < (left, top)
    assert (right, bottom) < corner(1.5, 0.5)


def test_a_ground_like_that_of_the_level_has_no_frame() -> None:
    world = level(
        size=[3, 1],
        start=[[0, 0], [1, 0]],
        theme={"colors": {"base": "#f3ead7", "start": "#f3ead7"}},
    )
    shapes = shapes_of(world, Overlay(values=[[-2.0, -1.0, None]]))
    assert not [shape for shape in shapes if isinstance(shape, Path) and shape.fill == "#f3ead7"]


def test_nothing_is_answered_where_nobody_can_stand() -> None:
    world = level(
        size=[4, 2], exit=[3, 0], blocked=[{"at": [1, 1]}], warps=[{"at": [2, 1], "to": "start"}]
    )
    overlay = Overlay(
        values=in_each_cell(world, 5.0), actions=in_each_cell(world, (E,)), action_values=None
    )
    shapes = shapes_of(world, overlay)
    # The exit has no arrow; a value of an end is told unless it is 0.
    assert set(written(shapes)) == {(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (3, 1)}
    assert len(arrow_heads(world, overlay.actions)) == 5
    shapes = shapes_of(world, Overlay(values=in_each_cell(world, 0.0)))
    assert (3, 0) not in written(shapes)
    moves = Overlay(action_values=in_each_cell(world, (None, 1.0, 2.0, 3.0, 4.0)))
    assert len([s for s in shapes_of(world, moves) if isinstance(s, Text)]) == 5 * 4


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


# -- arrows --------------------------------------------------------------------------------


def arrow_heads(world: Any, actions: Any) -> list[Box]:
    color = world.resolved_theme.colors.arrows
    for shape in shapes_of(world, Overlay(actions=actions)):
        if isinstance(shape, Path) and shape.fill == color:
            return [box_of(points) for points, _ in polylines(shape.commands)]
    return []


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


# -- action values -------------------------------------------------------------------------


def test_where_room_is_short_decimals_are_given_up_before_size() -> None:
    def texts(overlay: Overlay) -> list[Text]:
        return [shape for shape in shapes_of(bare(2, 1), overlay) if isinstance(shape, Text)]

    numbers = [[(None, -12.34, 5.0, None, None), ()]]
    assert [text.text for text in texts(Overlay(action_values=numbers))] == [
        "\N{MINUS SIGN}12.3",
        "5",
    ]
    beside_arrows = texts(Overlay(action_values=numbers, actions=[[(E,), ()]]))
    assert [text.text for text in beside_arrows] == ["\N{MINUS SIGN}12", "5"]
    assert min(text.size for text in beside_arrows) > 6


# -- visits --------------------------------------------------------------------------------


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


def panel_lines(world: Any, **panels: Any) -> list[Text]:
    scene = build_layers(world, overlay=Overlay(**panels))["text"]
    for text in scene.shapes:
        assert isinstance(text, Text)
        box = text_box(text)
        assert 0 < box[0] < box[2] < scene.width
        assert 0 < box[1] < box[3] < scene.height
    return [text for text in scene.shapes if isinstance(text, Text)]


def test_long_lines_are_broken_and_those_without_room_are_left_out() -> None:
    world = level(display={"side_panel": 120})
    texts = [
        text.text for text in panel_lines(world, side_panel=["a line of many words", "", "end"])
    ]
    assert " ".join(texts) == "a line of many words end"
    assert len(texts) > 2
    many = panel_lines(world, side_panel=[str(number) for number in range(99)])
    assert len(many) < 12
    assert many[-1].text == "…"


@pytest.mark.parametrize("rows", [[[0.0, 0.0]], [[0.0], [0.0]], [[0.0, 0.0], [0.0]]])
def test_an_overlay_of_another_size_is_refused(rows: list[list[float]]) -> None:
    world = level(size=[2, 2])
    with pytest.raises(ValueError, match="2 rows of 2 cells"):
        build_scene(world, overlay=Overlay(values=rows))
    with pytest.raises(ValueError, match="2 rows of 2 cells"):
        build_scene(world, overlay=Overlay(actions=[[() for _ in row] for row in rows]))


def test_the_legend_of_a_large_level_is_larger() -> None:
    heights = []
    for side in (4, 12, 48):
        world = level(size=[side, side])
        layout = layout_of(world, overlay=Overlay(values=[[0.0] * side] * side))
        heights.append(layout.legend)
        assert layout.legend == pytest.approx(heights[0] * layout.times)
    assert heights[0] < heights[2]
