"""Metrics: against counts by hand and by brute force, and a difficulty that grows as it should."""

from __future__ import annotations

import itertools
import math
from collections import deque
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.worlds import World, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.analysis import metrics, paths
from babyrobot_levels.language.metric_names import (
    BOXES,
    MISTAKES,
    NEEDS,
    PATHS,
    PUSHES,
    SHAPE,
    SOLVED,
    THINGS,
)
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp import graph

NAMES = (*SHAPE, *PATHS, *SOLVED)


def drawn(text: str, **fields: Any) -> Level:
    """Return a level from a drawing."""
    return brl.load({"version": 1, "map": text, **fields})


# -- by brute force --------------------------------------------------------------------------


def ahead_of(level: Level) -> list[set[int]]:
    """Return for each state the other states to which one step can lead, read off the tables."""
    mdp = level.compile()
    return [
        set()
        if mdp.is_terminal[state]
        else {there for action in range(5) for _, there, _, _ in mdp.outcomes(state, action)}
        - {state}
        for state in range(mdp.num_states)
    ]


def states_of(level: Level, cells: tuple[tuple[int, int], ...]) -> list[int]:
    return [y * level.size[0] + x for x, y in cells]


def steps_from(level: Level, start: int) -> dict[int, int]:
    ahead, found, waiting = ahead_of(level), {start: 0}, deque([start])
    while waiting:
        state = waiting.popleft()
        for other in ahead[state]:
            if other not in found:
                found[other] = found[state] + 1
                waiting.append(other)
    return found


def fewest_turns(level: Level, start: int, length: int) -> int:
    """Return the fewest turns of all walks of that length to an exit, by trying them all."""
    ahead, width, exits = ahead_of(level), level.size[0], set(states_of(level, level.exits))
    poses: dict[tuple[int, Any], int] = {(start, None): 0}
    for _ in range(length):
        found: dict[tuple[int, Any], int] = {}
        for (state, way), turns in poses.items():
            for other in ahead[state]:
                new = (other % width - state % width, other // width - state // width)
                count = turns + (way not in (None, new))
                found[other, new] = min(count, found.get((other, new), count))
        poses = found
    return min(turns for (state, _), turns in poses.items() if state in exits)


def check_shape_and_paths(level: Level) -> None:
    found, grid = brl.metrics(level), level.grid()
    open_sides, free = grid.open.sum(axis=2), ~grid.blocked
    assert found.cells == free.sum()
    assert found.dead_ends == (open_sides[free] == 1).sum()
    assert found.corridors == (open_sides[free] == 2).sum()
    assert found.junctions == (open_sides[free] >= 3).sum()
    # Take away one side of each loop in turn: what is left is a forest.
    above = list(range(grid.width * grid.height))

    def root(cell: int) -> int:
        return cell if above[cell] == cell else root(above[cell])

    loops = 0
    for y, x, (side, step) in itertools.product(
        range(grid.height), range(grid.width), ((1, 1), (2, grid.width))
    ):
        if grid.open[y, x, side]:
            first, second = root(y * grid.width + x), root(y * grid.width + x + step)
            loops += first == second
            above[second] = first
    assert found.loops == loops

    starts, exits = states_of(level, level.starts), states_of(level, level.exits)
    ways = [steps_from(level, start) for start in starts]
    assert found.reachable == pytest.approx(len(set().union(*ways)) / found.cells)
    nearest = [min((way[end] for end in exits if end in way), default=None) for way in ways]
    if None in nearest:
        assert (found.path_length, found.turns, found.path) == (None, None, ())
        assert found.difficulty is None
        return
    lengths = [length for length in nearest if length is not None]
    assert found.path_length == max(lengths)
    path = states_of(level, found.path)
    assert path[0] == starts[lengths.index(max(lengths))]
    assert path[-1] in exits
    assert len(path) == found.path_length + 1
    ahead = ahead_of(level)
    assert all(second in ahead[first] for first, second in itertools.pairwise(path))
    assert found.turns == fewest_turns(level, path[0], found.path_length)


@given(world=worlds(5), only_walls=st.booleans())
def test_any_level_is_counted_right(world: World, only_walls: bool) -> None:
    # Levels with nothing but walls need no tables.
    for field in ("warps", "wind", "areas", "skid", "puddle_types") if only_walls else ():
        world.pop(field, None)
    check_shape_and_paths(level_of(world))


@given(world=worlds(5), only_walls=st.booleans(), poses=st.integers(1, 4))
@pytest.mark.slow
def test_large_levels_are_counted_alike(world: World, only_walls: bool, poses: int) -> None:
    for field in ("warps", "wind", "areas", "skid", "puddle_types") if only_walls else ():
        world.pop(field, None)
    level = level_of(world)
    small, large = (brl.metrics(level.replace()) for _ in range(2))
    expected = small.to_dict(solve=False), small.path
    with (
        patch.object(graph, "MANY", 0),
        patch.object(metrics, "MANY", 0),
        patch.multiple(paths, MANY=0, MANY_POSES=poses),
    ):
        assert (large.to_dict(solve=False), large.path) == expected


# -- by hand ---------------------------------------------------------------------------------

HOUSE = """\
+---+---+---+---+---+
| S     |       |###|
+   +---+   +   +---+
|       :       |   |
+   +---+---+---+   +
| o             | E |
+---+---+---+- -+   +
|                   |
+---+---+---+---+---+
"""


def test_a_house_is_counted_by_hand() -> None:
    found = brl.metrics(
        drawn(
            HOUSE,
            walls=[
                {"at": [1, 1], "side": "E", "pass": 0.5},
                {"at": [3, 2], "side": "S", "pass": 0.1},
            ],
        )
    )
    assert (found.cells, found.dead_ends, found.corridors, found.junctions) == (19, 5, 13, 1)
    assert found.loops == 1
    # The cell behind the exit cannot be reached: the episode is over before.
    assert found.reachable == 18 / 19
    # Down, right, through the last pane, right, and up to the exit.
    assert (found.path_length, found.turns) == (8, 4)
    assert found.path == (
        *((0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (3, 2)),
        *((3, 3), (4, 3), (4, 2)),
    )


def test_the_final_maze_is_counted_by_hand() -> None:
    found = brl.metrics("final-maze")
    assert (found.path_length, found.dead_ends, found.junctions) == (17, 4, 5)
    assert found.loops == 2
    assert brl.metrics("maze").loops == 0


def test_of_all_shortest_walks_the_straightest_counts() -> None:
    found = brl.metrics({"version": 1, "size": [4, 4]})
    assert (found.path_length, found.turns) == (6, 1)
    assert found.path in (
        ((0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (3, 3)),
        ((0, 0), (0, 1), (0, 2), (0, 3), (1, 3), (2, 3), (3, 3)),
    )
    assert found.path == brl.metrics({"version": 1, "size": [4, 4]}).path


def test_of_several_starts_the_farthest_counts_and_of_exits_the_nearest() -> None:
    fields = {"version": 1, "size": [9, 1], "start": [[2, 0], [4, 0]], "exit": [[0, 0], [8, 0]]}
    assert brl.metrics(fields).path_length == 4
    assert brl.metrics(fields).path[0] == (4, 0)


def test_walls_can_cut_off_the_exit_from_one_start() -> None:
    fields = {
        "version": 1,
        "size": [4, 1],
        "start": [[0, 0], [2, 0]],
        "walls": [{"at": [1, 0], "side": "E"}],
    }
    found = brl.metrics(fields)
    assert (found.path_length, found.turns, found.path) == (None, None, ())
    assert found.difficulty is None
    assert found.reachable == 1
    assert brl.metrics({**fields, "start": [0, 0]}).reachable == 0.5


def test_without_an_exit_there_is_no_path_but_all_else() -> None:
    found = brl.metrics("treasure-chests")
    assert (found.path_length, found.turns, found.difficulty) == (None, None, None)
    assert found.best_return == brl.solve("treasure-chests").expected_return


# -- what it is worth ------------------------------------------------------------------------


# No exit; a discount; several starts.
@pytest.mark.parametrize("name", ["treasure-chests", "gridworld-3-5", "gridworld-4-1"])
def test_returns_are_those_of_the_solver(name: str) -> None:
    found, best, at_random = brl.metrics(name), brl.solve(name), brl.evaluate(name, "random")
    assert (found.best_return, found.best_steps) == (best.expected_return, best.expected_steps)
    assert (found.random_return, found.random_steps) == (
        at_random.expected_return,
        at_random.expected_steps,
    )


def test_what_has_no_value_is_none() -> None:
    # There and back for ever: +1, -1, +1, …
    level = brl.load(
        {
            "version": 1,
            "size": [2, 1],
            "exit": "none",
            "areas": [{"at": [0, 0], "reward": 1}],
            "rewards": {"stay": -5, "bump": -5},
        }
    )
    with pytest.raises(brl.UndefinedReturnError):
        brl.solve(level)
    found = brl.metrics(level)
    assert (found.best_return, found.best_steps, found.wet_share) == (None, None, None)
    assert (found.random_return, found.random_steps) == (-math.inf, math.inf)


def test_episodes_that_are_too_long_to_tell_are_none() -> None:
    level = brl.load(
        {
            "version": 1,
            "size": [60, 2],
            "exit": [59, 0],
            "skid": {"probability": 0.99, "to": "sides"},
            # Beside the way, each cell leads back to the start.
            "warps": [{"at": [x, 1], "to": "start"} for x in range(60)],
        }
    )
    found = brl.metrics(level)
    assert found.path_length == 59
    assert found.random_return is None
    assert found.difficulty is None


def test_the_wet_share_is_that_of_the_best_way() -> None:
    fields: World = {"version": 1, "size": [4, 1]}
    assert brl.metrics(fields).wet_share == 0
    fields["puddles"] = [{"at": [1, 0]}]
    assert brl.metrics(fields).wet_share == 0.25
    fields["puddles"] = [{"at": [x, 0]} for x in range(4)]
    assert brl.metrics(fields).wet_share == 1
    # From all starts, one cell of five.
    both = {"version": 1, "size": [5, 1], "start": [[0, 0], [4, 0]], "exit": [2, 0]}
    assert brl.metrics({**both, "puddles": [{"at": [3, 0]}]}).wet_share == 1 / 5
    # Where there is a way around, the best one is dry.
    fields = {"version": 1, "size": [4, 2], "exit": [3, 0]}
    fields["puddles"] = [{"at": [1, 0], "size": "large"}, {"at": [2, 0], "size": "large"}]
    assert brl.metrics(fields).wet_share == 0


# -- difficulty ------------------------------------------------------------------------------


def difficulty(level: Any) -> float:
    found = brl.metrics(level).difficulty
    assert found is not None
    return found


def test_difficulty_is_what_it_is_defined_to_be() -> None:
    best, at_random = brl.solve("final-maze"), brl.evaluate("final-maze", "random")
    assert difficulty("final-maze") == pytest.approx(
        math.log2(at_random.expected_steps / 17) + math.log2(best.expected_steps / 17)
    )
    # Falling through the ice, the robot begins anew.
    best, at_random = brl.solve("frozen-lake"), brl.evaluate("frozen-lake", "random")
    assert difficulty("frozen-lake") == pytest.approx(
        math.log2(at_random.expected_steps / at_random.exit_probability / 6)
        + math.log2(best.expected_steps / best.exit_probability / 6)
    )


def test_one_step_with_no_choice_has_difficulty_one_for_staying() -> None:
    # The random policy stays every other time.
    assert difficulty({"version": 1, "size": [2, 1]}) == pytest.approx(1)


def lane(**fields: Any) -> World:
    return {"version": 1, "size": [6, 1], **fields}


def wet(count: int) -> list[World]:
    return [{"at": [x, 0]} for x in range(1, 1 + count)]


def alley(depth: int) -> World:
    """Return a straight way with a dead end of so many cells beside it."""
    blocked = [{"at": [x, 1], "size": [1, 5]} for x in (0, 2, 3, 4)]
    blocked += [{"at": [1, 1 + depth], "size": [1, 5 - depth]}] if depth < 5 else []
    return {"version": 1, "size": [5, 6], "exit": [4, 0], "blocked": blocked}


def holes(*columns: int) -> World:
    """Return a slippery way with holes beside it."""
    areas = [{"at": [x, 1], "ends": True} for x in columns]
    skid = {"probability": 0.2, "to": "sides"}
    return {"version": 1, "size": [5, 2], "exit": [4, 0], "skid": skid, "areas": areas}


def slippery(probability: float, rule: str) -> World:
    skid = {"probability": probability, "to": rule}
    return {"version": 1, "size": [5, 5], "skid": skid}


@pytest.mark.parametrize(
    "levels",
    [
        [{"version": 1, "size": [width, 1]} for width in range(2, 12)],
        [alley(depth) for depth in range(6)],
        [lane(puddles=wet(count)) for count in range(5)],
        [lane(puddles=wet(2), puddle_types={"small": {"skid": q}}) for q in (0, 0.1, 0.3, 0.5)],
        [slippery(q, "open") for q in (0.0, 0.1, 0.3, 0.5)],
        [slippery(q, "sides") for q in (0.0, 0.1, 0.3, 0.5)],
        [slippery(q, "others") for q in (0.0, 0.1, 0.3, 0.5)],
        [lane(walls=[{"at": [2, 0], "side": "E", "pass": q}]) for q in (1.0, 0.7, 0.3, 0.1)],
        [holes(), holes(2), holes(2, 3), holes(1, 2, 3)],
    ],
    ids=["way", "alley", "wet", "slick", "open", "sides", "others", "glass", "holes"],
)
def test_what_gets_in_the_way_makes_it_more_difficult(levels: list[World]) -> None:
    found = [difficulty(level) for level in levels]
    assert all(second > first + 1e-9 for first, second in itertools.pairwise(found))


def test_an_exit_farther_down_the_same_way_is_more_difficult() -> None:
    maze = brl.load({"version": 1, "size": [7, 7], "maze": {"seed": 1}})
    found = [difficulty(maze.replace(exit=list(cell))) for cell in brl.metrics(maze).path[1:]]
    assert all(second > first + 1e-9 for first, second in itertools.pairwise(found))


def test_difficulty_does_not_depend_on_looks_or_on_the_scale_of_rewards() -> None:
    level = brl.load("final-maze")
    larger = level.replace(
        rewards={"step": -2},
        puddle_types={"small": {"reward": -4, "skid": 0.4}, "large": {"reward": -8, "skid": 0.6}},
    )
    assert difficulty(larger) == pytest.approx(difficulty(level))
    assert difficulty(level.replace(theme="green", title="Another")) == difficulty(level)


def test_where_the_random_policy_may_be_caught_for_ever_it_is_infinite() -> None:
    # A warp leads into a cell that nothing leaves.
    caught = {
        "version": 1,
        "size": [4, 2],
        "exit": [2, 0],
        "walls": [{"at": [2, 0], "side": "E", "length": 2}, {"at": [3, 0], "side": "S"}],
        "warps": [{"at": [0, 1], "to": [3, 1]}],
    }
    assert difficulty(caught) == math.inf


def test_where_the_random_policy_never_reaches_an_exit_it_is_infinite() -> None:
    # North, the wind blows it past the exit; by a move against a wall, it goes one cell.
    blown = {"version": 1, "size": [1, 3], "start": [0, 2], "exit": [0, 1], "wind": {"north": [1]}}
    assert brl.metrics(blown).success == 1
    assert difficulty(blown) == math.inf


# -- things ----------------------------------------------------------------------------------


def locked(**fields: Any) -> Level:
    """Return a level whose exit is behind a door: the key is to the west, the coin to the south."""
    level = {
        "version": 1,
        "size": [4, 2],
        "start": [1, 0],
        "exit": [3, 0],
        "items": [{"name": "key", "at": [0, 0]}, {"name": "coin", "at": [1, 1], "reward": 1}],
        "doors": [{"at": [1, 0], "side": "E", "needs": "key"}],
        "walls": [{"at": [1, 1], "side": "E"}],
    }
    return brl.load({**level, **fields})


def test_things_are_counted_and_the_path_leads_by_the_key() -> None:
    found = brl.metrics(locked())
    counted = {name: getattr(found, name) for name in THINGS}
    # The key can be held without the coin, and the other way round.
    assert counted == {
        "items": 2,
        "doors": 1,
        "switches": 0,
        "movers": 0,
        "configurations": 4,
        "detour": 2,
    }
    assert found.path == ((1, 0), (0, 0), (1, 0), (2, 0), (3, 0))
    assert (found.path_length, found.turns, found.reachable) == (4, 1, 1.0)
    assert list(found.to_dict()) == [*SHAPE, *PATHS, *THINGS, *SOLVED, *NEEDS]
    assert list(found.to_dict(solve=False)) == [*SHAPE, *PATHS, *THINGS]
    # The coin is worth no step: the optimal path is the shortest one.
    assert (found.best_return, found.best_steps) == (-3, 4)
    # Without a door there is no detour; of a door that never opens, no path.
    assert brl.metrics(locked(doors=[])).detour == 0
    assert brl.metrics(locked(doors=[], exit_needs="key")).detour == 2
    shut = locked(doors=[{"at": [1, 0], "side": "E", "needs": "key", "unless": "key"}])
    assert (brl.metrics(shut).path_length, brl.metrics(shut).detour) == (None, None)
    assert brl.metrics(shut).reachable == 4 / 8


def test_levels_without_things_tell_nothing_about_them() -> None:
    found = brl.metrics("final-maze")
    assert list(found.to_dict()) == list(NAMES)
    assert (found.items, found.configurations, found.detour) == (0, 1, 0)


def test_waiting_for_a_guard_takes_a_step_and_is_no_turn() -> None:
    # The guard blocks the corridor for one more step, and then steps aside.
    level = {
        "version": 1,
        "size": [3, 2],
        "exit": [2, 0],
        "blocked": [{"at": [0, 1]}, {"at": [2, 1]}],
        "movers": [{"path": [[1, 0], [1, 0], [1, 1], [1, 1]]}],
        "hit": {"reward": -9},
    }
    found = brl.metrics(level)
    assert found.path == ((0, 0), (0, 0), (1, 0), (2, 0))
    assert (found.path_length, found.turns, found.best_steps, found.detour) == (3, 0, 3, 1)


def test_the_trajectory_of_the_optimal_policy_takes_things() -> None:
    # The only puddle lies under the key.
    level = locked(puddles=[{"at": [0, 0]}])
    found = brl.metrics(level)
    assert found.wet_share == pytest.approx(1 / 5)


def boxed(**fields: Any) -> brl.Level:
    return brl.load({"version": 1, "size": [4, 2], "boxes": [{"at": [2, 0]}], **fields})


def test_of_ways_that_end_as_soon_the_one_with_the_fewest_pushes_counts() -> None:
    around = {"exit": [3, 1], "rewards": {"step": -1}}
    for fields in (around, {**around, "boxes": [{"at": [1, 0]}]}):
        found = brl.metrics(boxed(**fields))
        assert (found.best_steps, found.pushes) == (4, 0)
    found = brl.metrics(boxed(targets=[{"at": [3, 0]}]))
    assert (found.best_steps, found.pushes) == (2, 1)
    assert [*found.to_dict()] == [*SHAPE, *PATHS, *THINGS, *BOXES, *PUSHES, *SOLVED, *NEEDS]
    assert not {*PUSHES} & {*found.to_dict(solve=False)}
    assert brl.metrics("final-maze").pushes == 0


def test_a_skid_that_pushes_a_box_counts() -> None:
    skidding = {
        "size": [3, 4],
        "start": [0, 1],
        "exit": [2, 1],
        "boxes": [{"at": [0, 2]}, {"at": [1, 2]}],
        "skid": 0.3,
    }
    counting = boxed(**skidding, rewards={"step": 0, "exit": 0, "push": 1})
    found = brl.metrics(boxed(**skidding))
    assert found.solution is not None
    expected = brl.evaluate(counting, found.solution).expected_return
    assert 0 < expected == pytest.approx(found.pushes)


def test_a_policy_that_may_never_end_has_no_pushes() -> None:
    found = brl.metrics(boxed(targets=[{"at": [0, 1]}]))
    assert found.pushes is None
    assert found.why_none("pushes") == "the optimal policy may never end"


# -- how it is asked -------------------------------------------------------------------------


def test_a_maze_without_a_seed_has_no_metrics_yet() -> None:
    with pytest.raises(brl.LevelError, match="with_maze_seed"):
        brl.metrics("random-maze")
    assert brl.metrics(brl.load("random-maze").with_maze_seed(3)).path_length is not None


def test_shape_and_ways_ask_for_no_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(level: Level) -> None:
        raise AssertionError("compiled")

    monkeypatch.setattr(Level, "compile", refuse)
    found = brl.metrics("final-maze")
    assert found.path_length == 17
    assert found.to_dict(solve=False) == {name: getattr(found, name) for name in SHAPE + PATHS}
    with pytest.raises(AssertionError, match="compiled"):
        _ = found.difficulty


def test_each_is_worked_out_once(monkeypatch: pytest.MonkeyPatch) -> None:
    found = brl.metrics("final-maze")
    difficult, path = found.difficulty, found.path
    monkeypatch.setattr("babyrobot_levels.analysis.metrics.solve", None)
    monkeypatch.setattr("babyrobot_levels.analysis.metrics.straightest_path", None)
    assert (found.difficulty, found.path) == (difficult, path)
    assert found.wet_share == pytest.approx(4 / 18)


# -- what is needed --------------------------------------------------------------------------


def rooms(*doors: World, **fields: Any) -> Level:
    """Return a corridor of rooms: a lever, a key and a coin on its first cells, the exit at last.

    The key lies behind a door that the lever opens.
    """
    level = {
        "version": 1,
        "size": [6, 1],
        "start": [0, 0],
        "exit": [5, 0],
        "switches": [{"name": "lever", "at": [1, 0]}],
        "items": [{"name": "key", "at": [3, 0]}, {"name": "coin", "at": [4, 0], "reward": 1}],
        "doors": [{"at": [2, 0], "side": "E", "needs": "lever"}, *doors],
    }
    return brl.load({**level, **fields})


def test_what_is_needed_and_in_which_order() -> None:
    found = brl.metrics(rooms())
    assert (found.needs, found.dependencies) == (("lever",), 1)
    locked_exit = brl.metrics(rooms(exit_needs="key"))
    assert (locked_exit.needs, locked_exit.dependencies) == (("key", "lever"), 2)
    # Two keys in one room need nothing of each other.
    both = brl.metrics(rooms(doors=[], exit_needs=["key", "coin"]))
    assert (both.needs, both.dependencies) == (("coin", "key"), 1)
    bare = brl.metrics(rooms(doors=[]))
    assert (bare.needs, bare.dependencies) == ((), 0)


def test_what_is_needed_from_one_of_several_starts_is_needed() -> None:
    found = brl.metrics(rooms(start=[[0, 0], [3, 0]]))
    assert (found.needs, found.dependencies) == (("lever",), 1)


def test_a_switch_that_closes_the_way_is_not_needed() -> None:
    found = brl.metrics(rooms(doors=[{"at": [2, 0], "side": "E", "unless": "lever"}], start=[2, 0]))
    assert found.needs == ()
    # It can be passed only by flipping it, and it is on at first.
    flipped = rooms(
        doors=[{"at": [2, 0], "side": "E", "unless": "lever"}],
        switches=[{"name": "lever", "at": [1, 0], "on": True}],
    )
    assert brl.metrics(flipped).needs == ("lever",)


def test_without_a_path_nothing_is_known_to_be_needed() -> None:
    shut = brl.metrics(rooms({"at": [4, 0], "side": "E", "needs": "key", "unless": "key"}))
    assert (shut.path_length, shut.needs, shut.dependencies) == (None, None, None)


def test_where_too_many_states_could_occur_it_is_not_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise brl.LevelError(message="too many states")

    monkeypatch.setattr("babyrobot_levels.analysis.hardness.compile_things", refuse)
    found = brl.metrics(rooms())
    assert (found.needs, found.dependencies) == (None, None)
    assert "too many states" in found.why_none("needs")


def test_success_is_that_of_the_optimal_policy() -> None:
    assert brl.metrics("frozen-lake").success == brl.solve("frozen-lake").exit_probability
    assert brl.metrics("final-maze").success == 1
    assert brl.metrics("treasure-chests").success is None


@pytest.mark.parametrize(("hole", "exit_"), [(0, 2), (2, 0)])
def test_of_two_ends_that_are_as_good_and_as_near_the_exit_counts(hole: int, exit_: int) -> None:
    fields = {"version": 1, "size": [3, 1], "start": [1, 0], "exit": [exit_, 0]}
    level = brl.load({**fields, "areas": [{"at": [hole, 0], "ends": True}]})
    assert brl.metrics(level).success == 1
    assert brl.solve(level).policy[0, 1] == (brl.Action.EAST if exit_ == 2 else brl.Action.WEST)


def test_with_an_infinite_return_it_may_lead_to_an_exit_or_not() -> None:
    endless = brl.metrics({"version": 1, "size": [2, 1], "rewards": {"stay": 1}})
    assert endless.success is None
    assert endless.why_none("success") == "the optimal return is infinite"


def test_states_are_those_that_occur() -> None:
    # The cell behind the exit never does.
    assert brl.metrics({"version": 1, "size": [4, 1], "exit": [2, 0]}).states == 3
    # While the lever is off, the robot is before the door.
    assert brl.metrics(rooms(items=[])).states == 3 + 6


# -- mistakes --------------------------------------------------------------------------------


def test_where_the_optimum_is_lost_and_where_something_is_decided() -> None:
    # To the west of the start is a hole; the cell after the start leads back to it.
    level = {"version": 1, "size": [4, 1], "start": [1, 0], "areas": [{"at": [0, 0], "ends": True}]}
    level["exit"] = [3, 0]
    found = brl.metrics({**level, "rewards": {"exit": 5}})
    assert (found.irreversible, found.decisions) == (1 / 4, 1)
    # Without the hole, all mistakes can be mended.
    bare = brl.metrics({**level, "areas": []})
    assert (bare.irreversible, bare.decisions) == (0, 1)
    # If all ways are as good, nothing is decided.
    assert brl.metrics({"version": 1, "size": [2, 2]}).decisions == 0


def test_a_room_without_a_way_back_is_lost_with_all_that_is_done_there() -> None:
    level = {
        "version": 1,
        "size": [3, 2],
        "start": [0, 0],
        "exit": [2, 0],
        "warps": [{"at": [0, 1], "to": [1, 1]}],
        "walls": [{"at": [1, 0], "side": "S", "length": 2}],
    }
    found = brl.metrics(level)
    # The warp's own cell is never one of a state, and leads back into the room.
    assert (found.states, found.irreversible, found.decisions) == (5, 2 / 5, 1)
    # A mistake costs for ever.
    assert found.fragility == math.inf


def test_fragility_is_what_one_mistake_in_ten_steps_costs() -> None:
    # A mistake is to stay, every other time: a step more, which happens with probability 1/20.
    level = {"version": 1, "size": [2, 1], "rewards": {"stay": -4}}
    assert brl.metrics(level).fragility == pytest.approx(4 / 19)


def test_of_all_optimal_policies_the_least_fragile_counts() -> None:
    # Two ways of two steps lead to the exit, one of them beside a hole that costs 9.
    hole = {"at": [2, 0], "ends": True, "reward": -9}
    level = {"version": 1, "size": [3, 2], "exit": [1, 1], "areas": [hole]}
    level["blocked"] = [{"at": [2, 1]}]
    at_random = brl.load(level).compile().action_mask.reshape(2, 3, 5).astype(float)
    at_random[:] = at_random / at_random.sum(axis=2, keepdims=True).clip(1)
    losses = []
    for policy in ([[2, 3, 0], [2, 0, 0]], [[3, 3, 0], [2, 0, 0]]):
        erring = 0.9 * np.eye(5)[policy] + 0.1 * at_random
        losses.append(-1 - brl.evaluate(level, erring).expected_return)
    assert losses[1] < losses[0] - 0.01
    assert brl.metrics(level).fragility == pytest.approx(losses[1])


def test_a_hit_that_the_optimum_takes_is_no_mistake() -> None:
    # The only way on is through the guard.
    found = brl.metrics({"version": 1, "size": [3, 1], "movers": [{"path": [[1, 0]]}]})
    assert (found.best_return, found.decisions, found.irreversible) == (-1, 0, 0)


def test_things_of_no_use_are_distractors() -> None:
    assert brl.metrics(locked()).distractors == 1
    # Now the coin is worth its two steps; what cannot be had distracts nobody.
    rich = locked(items=[{"name": "coin", "at": [1, 1], "reward": 9}], doors=[])
    assert brl.metrics(rich).distractors == 0
    shut = [{"name": "gem", "at": [3, 1]}]
    walls = [{"at": [1, 1], "side": "E"}, {"at": [3, 0], "side": "S"}]
    assert brl.metrics(locked(items=shut, doors=[], walls=walls)).distractors == 1
    walls = [{"at": [2, 1], "side": "E"}, {"at": [3, 0], "side": "S"}]
    assert brl.metrics(locked(items=shut, doors=[], walls=walls)).distractors == 0
    # Of two keys one is enough, and the first one stays.
    keys = [{"name": name, "at": at} for name, at in (("key", [0, 0]), ("spare", [0, 1]))]
    either = locked(items=keys, doors=[{"at": [1, 0], "side": "E", "needs": "key"}])
    assert brl.metrics(either).distractors == 1


def test_without_a_finite_optimum_mistakes_have_no_price() -> None:
    endless = brl.metrics({"version": 1, "size": [2, 1], "rewards": {"stay": 1}})
    assert endless.best_return == math.inf
    for name in (*MISTAKES, "distractors"):
        assert getattr(endless, name) is None
        assert endless.why_none(name) == "the optimal return is infinite"
