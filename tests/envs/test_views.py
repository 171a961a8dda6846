"""Views: which cells the robot sees, by cases drawn by hand and by laws, and what planes show."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from random import Random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.random_things import random_level
from support.each import for_each
from support.playing import FEATURES, level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import make_batch_observer, make_observer
from babyrobot_levels.envs.observations.base import Extent, Observation, Observer
from babyrobot_levels.envs.observations.views import VIEW_PLANES
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.grid import BIT

View = NDArray[np.uint8]
PLANE = {name: number for number, name in enumerate(VIEW_PLANES)}
SIDES = ("up", "right", "down", "left")
ARROWS = {(0, -1): "N", (1, 0): "E", (0, 1): "S", (-1, 0): "W"}


def observer_of(level: Level, headings: int = 1, **options: Any) -> Observer:
    extent = Extent(level.size, headings=headings, has_boxes=bool(level.boxes or level.targets))
    return make_observer(level, Observation("view", **options), extent)


def view_of(
    level: Level, configuration: int = 0, radius: int = 3, heading: int | None = None, **kwargs: Any
) -> View:
    """Return the view from the first start."""
    (x, y), (width, height) = level.starts[0], level.size
    headings = 1 if heading is None else 4
    state = (configuration * headings + (heading or 0)) * width * height + y * width + x
    view: View = observer_of(level, headings, view_radius=radius, **kwargs).at(state)()
    return view


def shown(view: View, *planes: str) -> list[str]:
    """Draw a view: `.` for a cell that is seen, `#` where it has one of the planes."""
    seen = view[..., PLANE["visible"]] == 1
    marked = view[..., [PLANE[name] for name in planes]].any(axis=2)
    drawn = np.where(marked, "#", np.where(seen, ".", " "))
    return ["".join(row).rstrip() for row in drawn.tolist()]


# -- what hides other cells ------------------------------------------------------------------


def test_a_line_passes_the_end_of_a_wall_but_not_a_corner_of_two() -> None:
    end = {"version": 1, "size": [2, 2], "walls": [{"at": [0, 0], "side": "E"}]}
    assert shown(view_of(brl.load(end), radius=1)) == ["", " .", " .."]
    corner = {**end, "walls": [{"at": [0, 0], "side": "E"}, {"at": [0, 0], "side": "S"}]}
    assert shown(view_of(brl.load(corner), radius=1)) == ["", " .", ""]
    across = {**end, "walls": [{"at": [0, 0], "side": "E"}, {"at": [0, 1], "side": "E"}]}
    assert shown(view_of(brl.load(across), radius=1)) == ["", " .", " ."]


def test_glass_hides_nothing_and_is_a_wall_before_a_blocked_cell() -> None:
    glass = [{"at": [0, 0], "side": "E", "pass": 0.5}]
    level = {"version": 1, "size": [2, 2], "walls": glass, "exit": [1, 1]}
    assert shown(view_of(brl.load(level), radius=1)) == ["", " ..", " .."]
    blocked = brl.load({**level, "blocked": [{"at": [1, 0]}]})
    assert shown(view_of(blocked, radius=1), "blocked") == ["", " .", " .."]


DOOR = {
    "version": 1,
    "size": [4, 1],
    "items": [{"name": "key", "at": [0, 0]}],
    "start": [1, 0],
    "doors": [{"at": [1, 0], "side": "E", "needs": "key"}],
}


def test_doors_hide_while_they_are_closed() -> None:
    level = brl.load(DOOR)
    closed, opened = (view_of(level, number, radius=2) for number in range(2))
    assert level.configuration(1).doors == (False,)
    assert shown(closed)[2] == " .."
    assert shown(opened)[2] == " ...."
    assert [closed[2, 2, PLANE[f"{what}-right"]] for what in ("open", "door")] == [0, 1]
    assert [opened[2, 2, PLANE[f"{what}-right"]] for what in ("open", "door")] == [1, 0]
    assert shown(closed, "key")[2] == " #."
    assert shown(opened, "key")[2] == " ...."


def test_seeing_through_shows_everything() -> None:
    level = brl.load(DOOR)
    view = view_of(level, radius=2, see_through=True)
    assert shown(view, "blocked") == ["#####", "#####", "#....", "#####", "#####"]
    doors = [view[2, :, PLANE[f"door-{side}"]].tolist() for side in ("left", "right")]
    assert doors == [[0, 0, 0, 1, 0], [0, 0, 1, 0, 0]]
    assert view[..., PLANE["exit"]].tolist()[2] == [0, 0, 0, 0, 1]


# -- planes ----------------------------------------------------------------------------------


@cache
def everything() -> Level:
    """Return a level with something for every plane, all of it in one row around the start."""
    return brl.load(
        {
            "version": 1,
            "size": [15, 2],
            "start": [7, 1],
            "exit": [14, 0],
            "exit_needs": "gem",
            "puddles": [{"at": [0, 0]}, {"at": [1, 0], "size": "large"}],
            "areas": [{"at": [2, 0], "reward": -5}, {"at": [3, 0], "ends": True}],
            "warps": [{"at": [4, 0], "to": [0, 1]}],
            "items": [
                {"name": "gold", "shape": "key", "at": [5, 0]},
                {"name": "coin", "at": [6, 0]},
                {"name": "gem", "at": [7, 0]},
                {"name": "trophy", "at": [8, 0]},
                {"name": "box", "at": [9, 0]},
            ],
            "switches": [{"name": "off", "at": [10, 0]}, {"name": "on", "at": [11, 0], "on": True}],
            "movers": [{"path": [[12, 0]]}],
            "doors": [{"at": [13, 0], "side": "W", "needs": "gem"}],
            "blocked": [{"at": [13, 1]}],
        }
    )


def test_each_plane_shows_what_its_name_says() -> None:
    level = everything()
    mdp = level.compile()
    start = mdp.configuration(int(mdp.start.argmax()))
    view = view_of(level, start, radius=7, see_through=True)[6]
    names = ["puddle-small", "puddle-large", "ground", "ends", "warp"]
    names += ["key", "coin", "gem", "star", "box", "switch-off", "switch-on", "mover"]
    assert [np.flatnonzero(view[:, PLANE[name]]).tolist() for name in names] == [
        [column] for column in range(13)
    ]
    assert np.flatnonzero(view[:, PLANE["door-right"]]).tolist() == [12]
    assert np.flatnonzero(view[:, PLANE["door-left"]]).tolist() == [13]
    assert np.flatnonzero(view[:, PLANE["exit-locked"]]).tolist() == [14]
    assert not view[:, PLANE["exit"]].any()
    named = {*names, "visible", "exit-locked", "door-left", "door-right", "open-left", "open-right"}
    others = [name for name in VIEW_PLANES if name not in {*named, "open-down"}]
    assert not view[:, [PLANE[name] for name in others]].any()


def test_what_is_held_is_known_everywhere_and_lies_nowhere() -> None:
    level = everything()
    mdp = level.compile()
    state = int(mdp.next_state[int(mdp.start.argmax()), brl.Action.NORTH, 0])
    assert level.configuration(mdp.configuration(state)).held == ("gem",)
    view = observer_of(level, view_radius=7).at(state)()
    held = {
        name for name in VIEW_PLANES if name.startswith("held-") and view[..., PLANE[name]].any()
    }
    assert held == {"held-gem"}
    assert view[..., PLANE["held-gem"]].all()
    assert not view[..., PLANE["gem"]].any()
    assert view[..., PLANE["exit"]].sum() == 1
    assert not view[..., PLANE["exit-locked"]].any()


def test_only_the_drawn_exit_is_shown() -> None:
    level = brl.load(
        {"version": 1, "size": [3, 1], "start": [1, 0], "exit_one_of": [[0, 0], [2, 0]]}
    )
    assert [shown(view_of(level, number, radius=1), "exit")[1] for number in range(2)] == [
        "#..",
        "..#",
    ]


def test_all_levels_share_the_planes() -> None:
    spaces = {
        str(brl.LevelEnv(level_named(name), observation="view").observation_space)
        for name in FEATURES
    }
    assert spaces == {f"Box(0, 1, (7, 7, {len(VIEW_PLANES)}), uint8)"}
    assert len(set(VIEW_PLANES)) == len(VIEW_PLANES)
    assert brl.LevelEnv("maze").view_planes == VIEW_PLANES


# -- turning ---------------------------------------------------------------------------------


def turned(fields: dict[str, Any]) -> dict[str, Any]:
    """Turn a level so that its east is up: cells, sides and sizes."""
    width, height = fields["size"]

    def cell(at: list[int]) -> list[int]:
        return [at[1], width - 1 - at[0]]

    side = {"E": "N", "N": "W", "W": "S", "S": "E"}
    return {
        **fields,
        "size": [height, width],
        "start": cell(fields["start"]),
        "exit": cell(fields["exit"]),
        "walls": [{"at": cell(w["at"]), "side": side[w["side"]]} for w in fields["walls"]],
        "doors": [{**d, "at": cell(d["at"]), "side": side[d["side"]]} for d in fields["doors"]],
        "items": [{**i, "at": cell(i["at"])} for i in fields["items"]],
        "blocked": [{"at": cell(b["at"])} for b in fields["blocked"]],
    }


def test_a_turned_robot_sees_what_it_would_in_a_turned_level() -> None:
    fields: dict[str, Any] = {
        "version": 1,
        "size": [5, 4],
        "start": [1, 2],
        "exit": [4, 0],
        "walls": [{"at": [2, 1], "side": "N"}, {"at": [0, 2], "side": "E"}],
        "doors": [{"at": [2, 2], "side": "S", "needs": "key"}],
        "items": [{"name": "key", "at": [4, 3]}, {"name": "coin", "at": [1, 0]}],
        "blocked": [{"at": [3, 1]}],
    }
    original = brl.load(fields)
    for heading in (1, 2, 3):
        fields = turned(fields)
        for configuration in range(4):
            expected = view_of(brl.load(fields), configuration, radius=4)
            view = view_of(original, configuration, radius=4, heading=heading)
            assert np.array_equal(view, expected), (heading, configuration)


# -- laws ------------------------------------------------------------------------------------


def sees(level: Level, configuration: int, here: tuple[int, int], there: tuple[int, int]) -> bool:
    """Follow the line from cell to cell in fractions, over sides that hide nothing."""
    grid = level.grid_at(configuration)
    (x, y), (to_x, to_y) = here, there
    dx, dy = to_x - x, to_y - y

    def passes(one: tuple[int, int], other: tuple[int, int]) -> bool:
        cell = one[1] * grid.width + one[0]
        side = ARROWS[other[0] - one[0], other[1] - one[1]]
        return not grid.wall_bits[cell] & BIT[side] or (cell, side) in grid.glass

    def clear(cell: tuple[int, int]) -> bool:
        return cell in (here, there) or not grid.blocked[cell[1], cell[0]]

    times: dict[Fraction, set[str]] = {}
    for count, name in ((abs(dx), "x"), (abs(dy), "y")):
        for index in range(count):
            times.setdefault(Fraction(2 * index + 1, 2 * count), set()).add(name)
    step_x, step_y = (dx > 0) - (dx < 0), (dy > 0) - (dy < 0)
    for _, names in sorted(times.items()):
        target = x + step_x * ("x" in names), y + step_y * ("y" in names)
        ways = (
            [[target]] if len(names) == 1 else [[(target[0], y), target], [(x, target[1]), target]]
        )
        if not any(
            all(
                passes(one, two) and clear(two)
                for one, two in zip([(x, y), *way], way, strict=False)
            )
            for way in ways
        ):
            return False
        x, y = target
    return True


@pytest.mark.slow
@for_each("seed", range(20))
def test_lines_are_those_of_the_reference_and_the_same_from_both_ends(seed: int) -> None:
    random = Random(seed)
    level = brl.Level.from_fields(random_level(random))
    (width, height), mdp, radius = level.size, level.compile(), 5
    observer = observer_of(level, view_radius=radius)
    configuration = random.randrange(mdp.num_configurations)
    cells = [(x, y) for y in range(height) for x in range(width)]
    free = [cell for cell in cells if not level.grid().blocked[cell[1], cell[0]]]
    seen: dict[tuple[Any, Any], bool] = {}
    for x, y in free:
        view = observer.at(configuration * mdp.cells + y * width + x)()
        outside = np.ones(view.shape[:2], bool)
        for to_x, to_y in cells:
            row, column = to_y - y + radius, to_x - x + radius
            outside[row, column] = False
            seen[(x, y), (to_x, to_y)] = bool(view[row, column, PLANE["visible"]])
        held = [number for name, number in PLANE.items() if name.startswith("held-")]
        hidden = np.delete(view, held, axis=2)[outside | (view[..., PLANE["visible"]] == 0)]
        assert not hidden.any()
    for (one, other), is_seen in seen.items():
        assert is_seen == sees(level, configuration, one, other), (one, other)
        assert (other, one) not in seen or seen[other, one] == is_seen


@pytest.mark.slow
@for_each("seed", range(15))
def test_open_sides_are_those_of_the_walls_and_items_are_where_they_lie(seed: int) -> None:
    level = brl.Level.from_fields(random_level(Random(seed)))
    mdp, extent = level.compile(), Extent.of([level])
    walls = make_observer(level, Observation("walls"), extent)
    view = make_observer(level, Observation("view", view_radius=6, see_through=True), extent)
    for state in np.linspace(0, mdp.num_states - 1, 20).astype(int).tolist():
        seen, (x, y) = view.at(state)(), mdp.cell(state)
        now = level.configuration(mdp.configuration(state))
        assert (
            seen[6, 6, [PLANE[f"open-{side}"] for side in SIDES]].tolist()
            == walls.at(state)()[2:6].tolist()
        )
        lying = np.zeros((13, 13), int)
        for at in filter(None, now.items):
            lying[at[1] - y + 6, at[0] - x + 6] += 1
        kinds = [PLANE[shape] for shape in ("key", "coin", "gem", "star", "box")]
        assert np.array_equal(seen[..., kinds].sum(axis=2), lying)
        movers = {(at_x - x + 6, at_y - y + 6) for at_x, at_y in now.movers}
        rows, columns = seen[..., PLANE["mover"]].nonzero()
        assert set(zip(columns.tolist(), rows.tolist(), strict=True)) == movers


# -- arguments and tables --------------------------------------------------------------------


@pytest.mark.parametrize("radius", [1, 15])
def test_the_radius_is_the_number_of_cells_in_each_direction(radius: int) -> None:
    env = brl.LevelEnv("final-maze", observation="view", view_radius=radius)
    observation, _ = env.reset(seed=1)
    side = 2 * radius + 1
    assert observation.shape == (side, side, len(VIEW_PLANES))
    assert observation in env.observation_space


@pytest.mark.parametrize("radius", [0, 16, 2.5, "3", True, -1])
def test_other_radii_are_refused(radius: Any) -> None:
    with pytest.raises(ValueError, match="view_radius must be a whole number from 1 to 15"):
        brl.LevelEnv("maze", observation="view", view_radius=radius)


@pytest.mark.parametrize("given", [{"view_radius": 3}, {"see_through": True}])
def test_options_of_views_need_views(given: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="view_radius and see_through need observation='view'"):
        brl.LevelEnv("maze", **given)


def test_a_level_that_is_added_leaves_the_views_of_others() -> None:
    levels = [level_named("things of all kinds"), brl.load("final-maze")]
    table = make_batch_observer(Observation("view", view_radius=2), Extent.of(levels), 1)
    offset = np.cumsum([0, *(level.compile().num_states for level in levels)])
    table.grow(offset[:2])
    table.write(0, levels[0])
    first = table.gather(np.array([5]))
    table.grow(offset)
    table.write(1, levels[1])
    assert np.array_equal(table.gather(np.array([5])), first)


def test_a_table_forgets_the_views_of_a_level_that_is_replaced() -> None:
    table = make_batch_observer(Observation("view", view_radius=1), Extent((2, 2)), 1)
    table.grow(np.array([0, 4]))
    for side in ("E", "S"):
        level = brl.load({"version": 1, "size": [2, 2], "walls": [{"at": [0, 0], "side": side}]})
        table.write(0, level)
        assert np.array_equal(table.gather(np.array([0]))[0], view_of(level, radius=1))


def test_a_table_that_is_too_large_is_refused() -> None:
    table = make_batch_observer(Observation("view", view_radius=15), Extent((2, 2)), 1)
    with pytest.raises(ValueError, match=r"8,000,000 states with view_radius=15 take 26\.9 GiB"):
        table.grow(np.array([0, 8_000_000]))
