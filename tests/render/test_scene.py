"""Scenes: what of a level is in its picture, and where."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
from support.worlds import level

from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.raster import polylines
from babyrobot_levels.render.scene.build import build_layers, build_scene
from babyrobot_levels.render.scene.layout import CELL, COMPASS
from babyrobot_levels.render.scene.overlay import Note, Overlay
from babyrobot_levels.render.scene.shapes import Ellipse, Path, Rect, Shape, Text
from babyrobot_levels.render.situation import Pose
from babyrobot_levels.text.errors import LevelError

MARGIN = 3
"""The default theme's free space: half of its outer wall, in whole pixels."""


def corner(x: float, y: float) -> tuple[float, float]:
    return MARGIN + CELL * x, MARGIN + CELL * y


def bounds(shape: Shape) -> tuple[float, float, float, float]:
    match shape:
        case Rect():
            return shape.x, shape.y, shape.x + shape.width, shape.y + shape.height
        case Ellipse():
            x, y, rx, ry = shape.x, shape.y, shape.rx, shape.ry
            return x - rx, y - ry, x + rx, y + ry
        case Path():
            points = [point for line, _ in polylines(shape.commands) for point in line]
            half = shape.width / 2 if shape.stroke else 0
            xs, ys = [x for x, _ in points], [y for _, y in points]
            return min(xs) - half, min(ys) - half, max(xs) + half, max(ys) + half
        case Text():
            width = 0.7 * shape.size * len(shape.text)
            left = shape.x - {"start": 0, "middle": width / 2, "end": width}[shape.anchor]
            return left, shape.y - shape.size, left + width, shape.y


def strokes(world: Any, color: str) -> Iterator[Path]:
    for shape in build_scene(world, robot=False).shapes:
        if isinstance(shape, Path) and shape.stroke == color:
            yield shape


def lines(path: Path) -> set[tuple[tuple[float, float], ...]]:
    return {tuple(points) for points, _ in polylines(path.commands)}


def test_a_cell_is_64_pixels_and_the_outer_wall_has_room() -> None:
    scene = build_scene(level(size=[8, 5]))
    assert (scene.width, scene.height) == (8 * 64 + 6, 5 * 64 + 6)
    bare = build_scene(level(size=[8, 5]), cells_only=True)
    assert (bare.width, bare.height) == (8 * 64, 5 * 64)


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


def test_a_random_maze_must_have_grown() -> None:
    with pytest.raises(LevelError):
        build_scene(level(maze={"seed": "random"}))


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


def test_what_changes_has_a_layer_of_its_own() -> None:
    world = level(size=[3, 2])
    panels = Overlay(side_panel=["a"], bottom_panel=["b"])
    before = build_layers(world, state=1, overlay=panels)
    moved = build_layers(world, state=2, pose=Pose(Action.EAST), overlay=panels)
    noted = build_layers(world, state=1, overlay=replace(panels, notes=[Note(1, 1, "a")]))
    assert {name for name in before if before[name] != moved[name]} == {"robot"}
    assert {name for name in before if before[name] != noted[name]} == {"text"}
    told, changed = (
        build_layers(world, state=1, overlay=replace(OVERLAY, values=[[value, 2, 3], [4, 5, 6]]))
        for value in (1.0, 7.0)
    )
    assert {name for name in told if told[name] != changed[name]} == {"heat", "overlay"}
    assert build_layers(world, robot=False)["robot"].shapes == ()


# -- the robot -----------------------------------------------------------------------------


def robot(**options: Any) -> tuple[float, float] | None:
    """Return the cell that the robot is in."""
    world = options.pop("world", level(size=[4, 3], start=[[2, 1], [0, 0]]))
    base = build_scene(world, robot=False).shapes
    added = [shape for shape in build_scene(world, **options).shapes if shape not in base]
    if not added:
        return None
    boxes = [bounds(shape) for shape in added]
    left, top = min(box[0] for box in boxes), min(box[1] for box in boxes)
    return (left - MARGIN) // CELL, (top - MARGIN) // CELL


def test_the_robot_stands_where_the_state_says_else_on_the_first_start() -> None:
    assert robot() == (2, 1)
    assert robot(state=7) == (3, 1)
    assert robot(state=0) == (0, 0)
    assert robot(robot=False) is None


def test_a_level_can_hide_the_robot_until_a_state_is_asked_for() -> None:
    hidden = level(size=[4, 3], display={"robot": {"show": False}})
    assert robot(world=hidden) is None
    assert robot(world=hidden, state=5) == (1, 1)


@pytest.mark.parametrize("state", [-1, 12])
def test_states_off_the_level_are_refused(state: int) -> None:
    with pytest.raises(ValueError, match="not on the level"):
        build_scene(level(size=[4, 3]), state=state)


# -- the ground ----------------------------------------------------------------------------


def texts(world: Any) -> list[str]:
    return [shape.text for shape in build_scene(world).shapes if isinstance(shape, Text)]


def test_starts_and_exits_say_so_unless_told_not_to() -> None:
    ends = {"start": [[0, 0], [1, 0]], "exit": [[2, 2], [2, 0]]}
    assert sorted(texts(level(**ends))) == ["EXIT", "EXIT", "START", "START"]
    assert texts(level(**ends, display={"start_text": False, "exit_text": False})) == []


def test_coordinates_are_shown_in_free_cells_when_asked_for() -> None:
    world = level(size=[2, 2], blocked=[{"at": [1, 0]}], display={"coordinates": True})
    assert set(texts(world)) == {"0,0", "0,1", "1,1", "START", "EXIT"}


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


def test_blocked_cells_are_one_shape_without_lines_inside() -> None:
    world = level(size=[4, 4], blocked=[{"at": [1, 1], "size": [2, 2]}])
    colors = world.resolved_theme.colors
    shapes = build_scene(world, robot=False).shapes
    assert Rect(*corner(1, 1), 2 * CELL, 2 * CELL, colors.blocked) in shapes
    (grid_lines,) = strokes(world, colors.lines)
    for points in lines(grid_lines):
        for x, y in points:
            inside = all(MARGIN + CELL < place < MARGIN + 3 * CELL for place in (x, y))
            assert not inside


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


def test_puddles_differ_by_cell_and_not_by_level() -> None:
    def outlines(**fields: Any) -> dict[tuple[int, int], list[tuple[float, float]]]:
        world = level(size=[5, 5], **fields)
        found = {}
        for shape in build_scene(world, robot=False).shapes:
            water = world.resolved_theme.colors.puddle
            if isinstance(shape, Path) and shape.fill == water:
                ((points, _),) = polylines(shape.commands)
                x, y = int(points[0][0] // CELL), int(points[0][1] // CELL)
                middle_x, middle_y = corner(x + 0.5, y + 0.5)
                found[x, y] = [(px - middle_x, py - middle_y) for px, py in points]
        return found

    cells = [[1, 1], [2, 1], [3, 3]]
    first = outlines(puddles=[{"at": cell, "size": "large"} for cell in cells])
    again = outlines(puddles=[{"at": [3, 3], "size": "large"}], maze={"seed": 4})
    assert first[3, 3] == again[3, 3]
    assert math.dist(first[1, 1][0], first[2, 1][0]) > 1
    for outline in first.values():
        assert max(abs(value) for point in outline for value in point) < CELL / 2 - 2


# -- walls ---------------------------------------------------------------------------------


def test_walls_in_a_row_are_one_line() -> None:
    world = level(size=[4, 3], walls=[{"at": [0, 0], "side": "S", "length": 3}])
    theme = world.resolved_theme
    (inner,) = (p for p in strokes(world, theme.colors.walls) if p.width == theme.widths.walls)
    assert lines(inner) == {(corner(0, 1), corner(3, 1))}


def test_a_wall_can_have_a_look_of_its_own() -> None:
    world = level(
        size=[4, 3],
        walls=[
            {"at": [0, 0], "side": "S", "length": 3},
            {"at": [1, 1], "side": "N", "color": "crimson", "width": 9, "fit": True},
            {"at": [3, 0], "side": "E", "color": "gold"},
        ],
        openings=[{"at": [0, 0], "side": "S"}],
    )
    theme = world.resolved_theme
    (own,) = strokes(world, "crimson")
    assert (own.width, own.cap) == (9, "butt")
    assert lines(own) == {(corner(1, 1), corner(2, 1))}
    (plain,) = (p for p in strokes(world, theme.colors.walls) if p.width == theme.widths.walls)
    assert lines(plain) == {(corner(2, 1), corner(3, 1))}
    assert plain.cap == "round"
    (outer,) = strokes(world, "gold")
    assert outer.width == theme.widths.border
    assert lines(outer) == {(corner(4, 0), corner(4, 1))}


def test_glass_looks_unlike_other_walls() -> None:
    def around(probability: float) -> list[Path]:
        wall = {"at": [1, 0], "side": "E", "pass": probability}
        base = set(build_scene(level(), robot=False).shapes)
        shapes = build_scene(level(walls=[wall]), robot=False).shapes
        return [shape for shape in shapes if shape not in base and isinstance(shape, Path)]

    solid, glass = around(0), around(0.5)
    assert {lines(path).pop() for path in solid + glass} == {(corner(2, 0), corner(2, 1))}
    # Light between two edges in the colour of walls.
    (wall,) = solid
    edge, *light = sorted(glass, key=lambda path: -path.width)
    assert edge.stroke == wall.stroke
    assert edge.width > wall.width
    assert len(light) > 0
    assert wall.stroke not in {path.stroke for path in light}
    assert light[0].width > edge.width / 2


# -- arrows --------------------------------------------------------------------------------


def heads(world: Any) -> list[tuple[float, float, float, float]]:
    arrows = world.resolved_theme.colors.arrows
    shapes = build_scene(world, robot=False).shapes
    return [bounds(s) for s in shapes if isinstance(s, Path) and s.fill == arrows]


def test_a_warp_points_at_where_it_leads() -> None:
    ((left, top, right, bottom),) = heads(level(size=[5, 5], warps=[{"at": [3, 0], "to": [1, 3]}]))
    assert corner(1, 3)[0] < left < right < corner(2, 4)[0]
    assert corner(1, 3)[1] < top < bottom < corner(2, 4)[1]


def test_a_warp_to_the_start_and_one_to_itself_stay_in_their_cell() -> None:
    ((left, top, right, bottom),) = heads(level(warps=[{"at": [1, 1], "to": "start"}]))
    assert corner(1, 1) < (left, top)
    assert (right, bottom) < corner(2, 2)
    assert heads(level(warps=[{"at": [1, 1], "to": [1, 1], "when": "leave"}])) == []


def test_wind_is_as_many_chevrons_as_it_pushes_cells_at_most_three() -> None:
    world = level(size=[6, 2], start=[0, 1], exit=[5, 1], wind={"north": [0, 1, 2, 9, 1, 0]})
    (path,) = strokes(world, world.resolved_theme.colors.arrows)
    columns = [int(points[1][0] // CELL) for points, _ in polylines(path.commands)]
    assert [columns.count(x) for x in range(6)] == [0, 2, 4, 6, 2, 0]
    for points, _ in polylines(path.commands):
        assert points[1][1] < points[0][1] == pytest.approx(points[2][1])


def test_winds_against_each_other_are_still() -> None:
    world = level(size=[2, 2], wind={"north": [1, 1], "south": [1, 1]})
    assert not list(strokes(world, world.resolved_theme.colors.arrows))


# -- beside the grid -----------------------------------------------------------------------


def test_panels_take_their_room_and_the_theme_s_colour_or_their_own() -> None:
    display = {"side_panel": 120, "bottom_panel": {"width": 50, "color": "navy"}}
    world = level(display=display)
    scene = build_scene(world)
    ground = world.resolved_theme.colors.text_bg
    assert (scene.width, scene.height) == (198 + 120, 198 + 50)
    assert Rect(198, 0, 120, 198, ground) in scene.shapes
    assert Rect(0, 198, 318, 50, "navy") in scene.shapes


def test_a_compass_has_room_with_and_without_a_panel() -> None:
    assert build_scene(level(display={"compass": True})).width == 198 + COMPASS
    both = level(display={"compass": True, "side_panel": 200})
    assert build_scene(both).width == 198 + 200
    assert {"N", "E", "S", "W"} <= set(texts(both))
