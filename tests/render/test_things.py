"""Things in pictures: what is shown of a configuration, and of a level as a whole."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from support.scenes import VAULT
from support.worlds import level

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.mdp.states import configuration_with
from babyrobot_levels.render.colors import contrast
from babyrobot_levels.render.frames import FramePainter, image_cells
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_layers, build_scene
from babyrobot_levels.render.scene.icons import INK, KINDS, default_color
from babyrobot_levels.render.scene.layout import CELL, Overlay, layout_of
from babyrobot_levels.render.scene.shapes import Text
from babyrobot_levels.render.scene.things import SMALL, Piece, mover_spots, moving_pieces, pieces
from babyrobot_levels.render.situation import situation_of

CELLS = 35


def names(world: Any, configuration: int | None) -> set[tuple[Any, ...]]:
    """Return the names of the pieces of a picture, those of what is held left out."""
    situation = situation_of(world, configuration)
    found = pieces(world, layout_of(world), situation)
    return {piece.name for piece in found if piece.name[0] != "held"}


def held(world: Any, configuration: int | None) -> list[bool]:
    situation = situation_of(world, configuration)
    found = pieces(world, layout_of(world), situation)
    return [bool(piece.name[2]) for piece in found if piece.name[0] == "held"]


# -- states ----------------------------------------------------------------------------------


@pytest.mark.parametrize("world", [VAULT, level(size=[7, 5])])
def test_a_state_that_the_level_does_not_have_is_refused(world: Any) -> None:
    for state in (-1, world.compile().num_states):
        with pytest.raises(ValueError, match=f"state {state} is not on the level"):
            build_scene(world, state=state)
        with pytest.raises(ValueError, match=f"state {state} is not on the level"):
            FramePainter(world).frame(state)


# -- what is shown ---------------------------------------------------------------------------


def test_an_item_lies_where_it_is_drawn_until_it_is_held() -> None:
    world = level(
        size=[4, 1], items=[{"name": "gem", "one_of": [[1, 0], [2, 0]]}], exit_needs="gem"
    )
    configurations = range(world.compile().num_configurations)
    assert [names(world, number) for number in configurations] == [
        {("item", 0, (1, 0), False), ("lock", (3, 0))},
        {("item", 0, (2, 0), False), ("lock", (3, 0))},
        set(),
    ]
    assert [held(world, number) for number in configurations] == [[False], [False], [True]]


def all_pieces(world: Any) -> Iterator[Piece]:
    layout = layout_of(world)
    # No thing has a multiple of 7 values: each has all of them in every 49th configuration.
    for number in (None, *range(0, world.compile().num_configurations, 49)):
        situation = situation_of(world, number)
        yield from pieces(world, layout, situation)
        for robot in (None, (2, 4), (5, 0)):
            for _, piece in moving_pieces(world, layout, situation, robot):
                yield piece


def test_the_same_name_means_the_same_shapes_inside_the_box() -> None:
    seen: dict[Any, Any] = {}
    for piece in all_pieces(VAULT):
        shapes = seen.setdefault(piece.name, piece.shapes)
        assert piece.shapes == shapes
    assert len(seen) > 30


@pytest.mark.slow
def test_shapes_lie_in_the_boxes_of_their_pieces() -> None:
    layout = layout_of(VAULT)
    size = round(layout.width), round(layout.height)
    blank = to_rgb(build_scene(level(size=[1, 1], exit="none")), size)
    blank[:] = 255
    seen = set()
    for piece in all_pieces(VAULT):
        if piece.name in seen:
            continue
        seen.add(piece.name)
        scene = build_scene(VAULT, robot=False)
        alone = type(scene)(scene.width, scene.height, piece.shapes)
        painted = to_rgb(alone, size)
        left, top, right, bottom = (round(edge) for edge in piece.box)
        painted[max(0, top) : bottom, max(0, left) : right] = 255
        assert (painted == blank).all(), piece.name


# -- sharing a cell --------------------------------------------------------------------------


def test_who_shares_a_cell_is_smaller_and_beside() -> None:
    layout, situation = layout_of(VAULT), situation_of(VAULT, 0)
    cell = situation.movers[0]
    alone, beside = (
        next(moving_pieces(VAULT, layout, situation, robot))[1].name[3] for robot in (None, cell)
    )
    assert alone.scale == 1
    assert beside.scale < 1
    assert (alone.x, alone.y) != (beside.x, beside.y)


def test_movers_in_one_cell_are_all_seen() -> None:
    region = {"at": [1, 0], "size": [1, 1]}
    world = level(size=[3, 1], movers=[{"within": region}] * 3)
    situation = situation_of(world, 0)
    spots = {piece.name[3] for _, piece in moving_pieces(world, layout_of(world), situation, None)}
    assert len({(spot.x, spot.y) for spot in spots}) == 3


def test_a_robot_that_has_arrived_is_smaller_and_beside_its_exit() -> None:
    first = {"name": "first", "start": [0, 0], "exit": [2, 1]}
    second = {"name": "second", "start": [2, 0], "exit": [1, 0]}
    world = level(size=[3, 2], robots=[first, second])
    spots = [
        mover_spots(world, layout_of(world), replace(situation_of(world, 0), arrived=arrived), None)
        for arrived in ((False, False), (False, True))
    ]
    assert [[spot.scale for spot in each] for each in spots] == [[1], [SMALL]]


# -- what is held ----------------------------------------------------------------------------

KEYS = [{"name": f"key-{n}", "at": [n, 0], "shape": "key"} for n in range(1, 6)]


@pytest.mark.parametrize(
    ("display", "place"),
    [
        ({}, "strip"),
        ({"compass": True}, "strip"),
        ({"side_panel": 120}, "side"),
        ({"bottom_panel": 50}, "bottom"),
        ({"side_panel": 30, "bottom_panel": 50}, "side"),
        ({"bottom_panel": 6}, "bottom"),
    ],
)
def test_what_is_held_has_its_place_in_the_picture(display: dict[str, Any], place: str) -> None:
    world = level(size=[7, 2], items=KEYS, display=display)
    layout = layout_of(world)
    assert layout.held_in == place
    squares = [piece.box for piece in pieces(world, layout, situation_of(world, 0))][-5:]
    for left, top, right, bottom in squares:
        assert 0 <= left < right <= layout.width
        assert right - left == pytest.approx(bottom - top)
        assert 0 <= top < bottom <= layout.height + 2
        if place == "side":
            assert left >= layout.left_width
        else:
            assert top >= layout.top_height - 1
    assert len({(left, top) for left, top, _, _ in squares}) == 5


def test_a_panel_of_an_overlay_shows_what_is_held() -> None:
    world = level(size=[7, 2], items=KEYS)
    beside = layout_of(world, overlay=Overlay(side_panel=["a"]))
    below = layout_of(world, overlay=Overlay(bottom_panel=["a"]))
    assert (beside.held_in, beside.strip) == ("side", 0)
    assert (below.held_in, below.strip) == ("bottom", 0)
    assert below.bottom >= 36


def test_texts_of_panels_keep_clear_of_what_is_held() -> None:
    world = level(size=[7, 2], items=KEYS)
    for overlay in (Overlay(side_panel=["word"] * 9), Overlay(bottom_panel=["word " * 60])):
        layout = layout_of(world, overlay=overlay)
        slots = layout.slots
        assert slots is not None
        lines = build_layers(world, overlay=overlay)["text"].shapes
        assert lines
        for line in lines:
            assert isinstance(line, Text)
            below = line.y <= slots.top
            beside = line.x + 0.5 * line.size * len(line.text) <= slots.left
            assert below or beside


def test_without_items_there_is_no_strip() -> None:
    world = level(size=[3, 1], movers=[{"path": [[1, 0]]}])
    assert layout_of(world).strip == layout_of(world, cells_only=True).strip == 0
    assert image_cells(world) == (3, 1)


def test_agents_see_what_is_held_in_a_row_of_its_own() -> None:
    assert image_cells(VAULT) == (7, 6)
    layout = layout_of(VAULT, cells_only=True)
    assert (layout.width, layout.height) == (7 * CELL, 6 * CELL)
    painter = FramePainter(VAULT, (7 * 12, 6 * 12))
    without, with_key = (configuration_with(VAULT, on) for on in (["plate"], ["plate", "key"]))
    first, second = (painter.frame(number * CELLS) for number in (without, with_key))
    assert (first[60:] != second[60:]).any()


# -- frames ----------------------------------------------------------------------------------


def reached(world: Any, count: int) -> list[int]:
    mdp = world.compile()
    alive = (~mdp.is_terminal).nonzero()[0]
    return [int(state) for state in np.random.default_rng(5).choice(alive, count)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "grayscale"), [(None, False), ((112, 96), False), ((84, 84), True)]
)
def test_frames_are_what_painting_everything_gives(
    size: tuple[int, int] | None, grayscale: bool
) -> None:
    painter = FramePainter(VAULT, size, grayscale)
    for state in reached(VAULT, 3):
        scene = build_scene(VAULT, state=state, heading=state % 4, cells_only=size is not None)
        expected = to_rgb(scene, (painter.width, painter.height)).astype(int)
        if grayscale:
            expected = np.rint(expected @ np.array((0.299, 0.587, 0.114)))[..., None]
        frame = painter.frame(state, heading=state % 4)
        assert np.abs(frame - expected).mean() < 0.3
    again = FramePainter(VAULT, size, grayscale).frame(state, heading=state % 4)
    assert np.array_equal(frame, again)


@pytest.mark.slow
def test_every_state_looks_different() -> None:
    world = level(
        size=[4, 1],
        items=[{"name": "key", "at": [1, 0]}],
        switches=[{"name": "lever", "at": [2, 0]}],
        movers=[{"path": [[1, 0], [2, 0], [3, 0]], "back": True}],
        hit={"ends": False},
    )
    mdp = world.compile()
    alive = (~mdp.is_terminal).nonzero()[0]
    for size in ((84, 84), (160, 80)):
        painter = FramePainter(world, size)
        frames = {
            painter.frame(int(state), heading=h).tobytes() for state in alive for h in range(4)
        }
        assert len(frames) == 4 * len(alive)


# -- colours ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", BUILTIN_THEMES)
@pytest.mark.parametrize("kind", KINDS)
def test_things_stand_out_from_their_outlines(name: str, kind: str) -> None:
    assert contrast(default_color(kind, BUILTIN_THEMES[name].colors), INK) >= 3


@pytest.mark.parametrize("name", BUILTIN_THEMES)
def test_a_switch_that_is_on_differs_in_brightness(name: str) -> None:
    world = level(
        size=[3, 1], switches=[{"name": "lever", "at": [1, 0], "color": None}], theme=name
    )
    painter = FramePainter(world, (96, 32), grayscale=True)
    off, on = (painter.frame(configuration_with(world, met) * 3) for met in ([], ["lever"]))
    # Also where the robot would cover the middle.
    rim = off[4:28, 36:60, 0].astype(int), on[4:28, 36:60, 0].astype(int)
    assert np.abs(rim[0] - rim[1]).mean() > 12
