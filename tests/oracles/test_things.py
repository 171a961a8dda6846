"""Things that change during an episode: a slow reference, checked by hand, against the tables."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from oracles.random_things import (
    Fields,
    add_diagonals,
    add_draws,
    add_gusts,
    add_weights,
    random_level,
)
from oracles.things_reference import (
    EAST,
    FORWARD,
    LEFT,
    NORTH,
    RIGHT,
    STAY,
    WEST,
    Cell,
    Configuration,
    Outcome,
    Reference,
    TurningReference,
)
from support.each import for_each
from support.worlds import World, level_of, with_walls_for_maze, worlds

import babyrobot_levels as brl

Row = tuple[float, Configuration, Cell, float, bool]
"""Probability, configuration, cell, reward and the end: an outcome, before states are numbered."""

KEY_AND_DOOR: dict[str, Any] = {
    "size": [3, 1],
    "start": [1, 0],
    "items": [{"name": "key", "at": [0, 0]}],
    "doors": [{"at": [1, 0], "side": "E", "needs": "key"}],
}


def reference(**fields: Any) -> Reference:
    return Reference({"version": 1, **fields})


def rows(level: Reference, configuration: Configuration, cell: Cell, action: int) -> list[Row]:
    """Return the outcomes of an action in words of the level."""
    outcomes = level.outcomes(level.state((configuration, cell)), action)
    return [
        (probability, *level.pair(state), reward, over)
        for probability, state, reward, over in outcomes
    ]


def beginnings(level: Reference) -> dict[tuple[Configuration, Cell], float]:
    return {level.pair(state): probability for state, probability in level.start.items()}


# The reference, checked by hand.


def test_a_door_is_a_wall_until_its_key_is_held() -> None:
    level = reference(**KEY_AND_DOOR, rewards={"bump": -5})
    assert rows(level, (0,), (1, 0), EAST) == [(1, (0,), (1, 0), -5, False)]
    assert level.allowed(level.state(((0,), (1, 0)))) == {STAY, WEST}
    assert rows(level, (0,), (1, 0), WEST) == [(1, (1,), (0, 0), -1, False)]
    assert rows(level, (1,), (1, 0), EAST) == [(1, (1,), (2, 0), 0, True)]
    assert level.allowed(level.state(((1,), (1, 0)))) == {STAY, EAST, WEST}


def test_a_closed_door_is_a_wall_for_skids() -> None:
    level = reference(**KEY_AND_DOOR, skid=0.25)
    # The only other open side is that to the west, so the robot does not skid through the door.
    assert rows(level, (0,), (1, 0), WEST) == [
        (0.25, (0,), (1, 0), -1, False),
        (0.75, (1,), (0, 0), -1, False),
    ]
    assert rows(level, (1,), (1, 0), WEST) == [
        (0.75, (1,), (0, 0), -1, False),
        (0.25, (1,), (2, 0), 0, True),
    ]


def test_an_item_gives_its_reward_once() -> None:
    level = reference(size=[3, 1], items=[{"name": "coin", "at": [1, 0], "reward": 5}])
    assert rows(level, (0,), (0, 0), EAST) == [(1, (1,), (1, 0), 5, False)]
    assert rows(level, (1,), (1, 0), STAY) == [(1, (1,), (1, 0), -1, False)]
    assert rows(level, (1,), (0, 0), EAST) == [(1, (1,), (1, 0), -1, False)]


def test_a_switch_flips_at_each_arrival() -> None:
    level = reference(size=[3, 1], switches=[{"name": "lever", "at": [1, 0]}])
    assert rows(level, (0,), (0, 0), EAST) == [(1, (1,), (1, 0), -1, False)]
    assert rows(level, (1,), (1, 0), STAY) == [(1, (1,), (1, 0), -1, False)]
    assert rows(level, (1,), (1, 0), NORTH) == [(1, (1,), (1, 0), -1, False)]
    assert rows(level, (1,), (0, 0), EAST) == [(1, (0,), (1, 0), -1, False)]


@pytest.mark.parametrize("on", [False, True])
def test_a_switch_that_flips_once_stays_flipped(on: bool) -> None:
    switch = {"name": "lever", "at": [1, 0], "once": True, "on": on}
    level = reference(size=[3, 1], switches=[switch])
    before, after = (int(on),), (int(not on),)
    assert beginnings(level) == {(before, (0, 0)): 1}
    assert rows(level, before, (0, 0), EAST) == [(1, after, (1, 0), -1, False)]
    assert rows(level, after, (0, 0), EAST) == [(1, after, (1, 0), -1, False)]


def test_a_door_with_unless_is_closed_while_the_switch_is_on() -> None:
    level = reference(
        size=[3, 1],
        start=[1, 0],
        switches=[{"name": "lever", "at": [0, 0]}],
        doors=[{"at": [2, 0], "side": "W", "unless": ["lever"]}],
    )
    assert rows(level, (0,), (1, 0), EAST) == [(1, (0,), (2, 0), 0, True)]
    assert rows(level, (0,), (1, 0), WEST) == [(1, (1,), (0, 0), -1, False)]
    assert rows(level, (1,), (1, 0), EAST) == [(1, (1,), (1, 0), -1, False)]


NEEDY_EXIT: dict[str, Any] = {
    "size": [3, 1],
    "exit": [1, 0],
    "exit_needs": "gem",
    "items": [{"name": "gem", "at": [2, 0]}],
}


def test_an_exit_is_a_plain_cell_until_its_needs_are_met() -> None:
    level = reference(**NEEDY_EXIT, rewards={"exit": 10})
    assert rows(level, (0,), (0, 0), EAST) == [(1, (0,), (1, 0), -1, False)]
    assert rows(level, (0,), (1, 0), EAST) == [(1, (1,), (2, 0), -1, False)]
    assert rows(level, (1,), (2, 0), WEST) == [(1, (1,), (1, 0), 10, True)]
    assert not level.is_terminal(level.state(((0,), (1, 0))))
    assert level.is_terminal(level.state(((1,), (1, 0))))


def test_an_exit_whose_needs_are_not_met_counts_for_distances() -> None:
    level = reference(**NEEDY_EXIT, rewards={"closer": 3, "farther": -4})
    assert rows(level, (0,), (0, 0), EAST) == [(1, (0,), (1, 0), 3, False)]
    assert rows(level, (0,), (1, 0), EAST) == [(1, (1,), (2, 0), -4, False)]


def test_an_area_ends_the_episode_on_an_exit_whose_needs_are_not_met() -> None:
    areas = [{"at": [1, 0], "ends": True, "reward": 3}]
    level = reference(**NEEDY_EXIT, areas=areas, rewards={"exit": 10})
    assert rows(level, (0,), (0, 0), EAST) == [(1, (0,), (1, 0), 3, True)]
    assert level.configurations == [(0,)]


def test_one_of_the_exits_is_drawn() -> None:
    level = reference(
        size=[3, 1],
        start=[1, 0],
        exit_one_of=[[0, 0], [2, 0]],
        rewards={"closer": 1, "farther": -2},
    )
    assert beginnings(level) == {((0,), (1, 0)): 0.5, ((1,), (1, 0)): 0.5}
    assert rows(level, (0,), (1, 0), WEST) == [(1, (0,), (0, 0), 0, True)]
    assert rows(level, (0,), (1, 0), EAST) == [(1, (0,), (2, 0), -2, False)]
    assert rows(level, (0,), (2, 0), WEST) == [(1, (0,), (1, 0), 1, False)]
    assert rows(level, (1,), (1, 0), EAST) == [(1, (1,), (2, 0), 0, True)]


GUARD: dict[str, Any] = {
    "size": [4, 1],
    "start": [[0, 0], [1, 0]],
    "movers": [{"name": "guard", "path": [[2, 0], [1, 0]]}],
    "rewards": {"step": -0.5},
}


def test_a_robot_that_meets_a_mover_is_hit() -> None:
    level = reference(**GUARD)
    assert rows(level, (0,), (0, 0), STAY) == [(1, (1,), (0, 0), -0.5, False)]
    assert rows(level, (0,), (0, 0), EAST) == [(1, (1,), (1, 0), -1, True)]
    assert rows(level, (0,), (1, 0), STAY) == [(1, (1,), (1, 0), -1, True)]
    # The guard leaves the cell that the robot enters.
    assert rows(level, (1,), (0, 0), EAST) == [(1, (0,), (1, 0), -0.5, False)]


def test_a_robot_that_changes_places_with_a_mover_is_hit() -> None:
    level = reference(**GUARD)
    assert rows(level, (0,), (1, 0), EAST) == [(1, (1,), (2, 0), -1, True)]
    # Pairs that are only reached by being hit absorb, and their configuration is numbered.
    assert level.configurations == [(0,), (1,)]
    assert rows(level, (1,), (2, 0), EAST) == [(1, (1,), (2, 0), 0, True)]


def test_a_hit_that_does_not_end_the_episode_gives_its_reward() -> None:
    level = reference(size=[3, 1], movers=[{"path": [[1, 0]]}], hit={"reward": -10, "ends": False})
    assert rows(level, (0,), (0, 0), EAST) == [(1, (0,), (1, 0), -10, False)]
    assert rows(level, (0,), (1, 0), STAY) == [(1, (0,), (1, 0), -10, False)]
    assert rows(level, (0,), (1, 0), EAST) == [(1, (0,), (2, 0), 0, True)]


def test_a_robot_that_is_hit_on_an_exit_gets_the_reward_of_the_hit_and_is_done() -> None:
    level = reference(size=[3, 1], movers=[{"path": [[2, 0]]}], hit={"reward": -10, "ends": False})
    assert rows(level, (0,), (1, 0), EAST) == [(1, (0,), (2, 0), -10, True)]


def test_an_item_is_taken_in_a_step_that_hits() -> None:
    level = reference(
        size=[3, 1],
        items=[{"name": "coin", "at": [1, 0], "reward": 5}],
        movers=[{"path": [[1, 0]]}],
        hit={"ends": False},
        rewards={"step": -0.5},
    )
    assert rows(level, (0, 0), (0, 0), EAST) == [(1, (1, 0), (1, 0), -1, False)]


def test_a_path_there_and_back_does_not_repeat_its_ends() -> None:
    def cells(path: list[list[int]], back: bool) -> list[Cell]:
        level = reference(size=[3, 2], start=[0, 1], movers=[{"path": path, "back": back}])
        return level.mover_cells[0]

    row = [[0, 0], [1, 0], [2, 0]]
    assert cells(row, back=True) == [(0, 0), (1, 0), (2, 0), (1, 0)]
    assert cells(row[:2], back=True) == [(0, 0), (1, 0)]
    assert cells(row[:1], back=True) == [(0, 0)]
    assert cells([[0, 0], [1, 0], [1, 0]], back=False) == [(0, 0), (1, 0), (1, 0)]


def test_a_random_mover_stays_or_takes_an_open_side_of_its_region() -> None:
    level = reference(
        size=[3, 2],
        start=[0, 1],
        walls=[{"at": [1, 0], "side": "E", "pass": 0.5}],
        movers=[{"within": {"at": [0, 0], "size": [3, 1]}, "start": [1, 0]}],
    )
    assert level.configurations == [(0,), (1,)]
    assert rows(level, (1,), (0, 1), STAY) == [
        (0.5, (0,), (0, 1), -1, False),
        (0.5, (1,), (0, 1), -1, False),
    ]


def test_a_mover_finds_a_door_closed_in_the_step_that_opens_it() -> None:
    level = reference(
        size=[3, 2],
        start=[0, 1],
        items=[{"name": "key", "at": [1, 1]}],
        doors=[{"at": [0, 0], "side": "E", "needs": "key"}],
        movers=[{"within": {"at": [0, 0], "size": [2, 1]}, "start": [0, 0]}],
    )
    assert rows(level, (0, 0), (0, 1), EAST) == [(1, (1, 0), (1, 1), -1, False)]
    assert rows(level, (1, 0), (1, 1), STAY) == [
        (0.5, (1, 0), (1, 1), -1, False),
        (0.5, (1, 1), (1, 1), -1, False),
    ]


@pytest.mark.parametrize(("warp_reward", "expected"), [({}, 5), ({"reward": 2}, 2)])
def test_a_warp_onto_an_item_takes_it(warp_reward: dict[str, int], expected: int) -> None:
    level = reference(
        size=[5, 1],
        warps=[{"at": [1, 0], "to": [3, 0], **warp_reward}],
        items=[{"name": "coin", "at": [3, 0], "reward": 5}],
    )
    assert rows(level, (0,), (0, 0), EAST) == [(1, (1,), (3, 0), expected, False)]


def test_a_warp_to_a_start_arrives_there() -> None:
    level = reference(
        size=[2, 3],
        start=[[0, 0], [1, 1]],
        exit=[0, 2],
        warps=[{"at": [1, 0], "to": "start"}],
        items=[{"name": "coin", "at": [1, 1], "reward": 5}],
    )
    assert beginnings(level) == {((0,), (0, 0)): 0.5, ((1,), (1, 1)): 0.5}
    assert rows(level, (0,), (0, 0), EAST) == [
        (0.5, (0,), (0, 0), -1, False),
        (0.5, (1,), (1, 1), 5, False),
    ]


@pytest.mark.parametrize(
    "warp", [{"at": [0, 0], "to": [0, 0], "when": "leave"}, {"at": [1, 0], "to": [0, 0]}]
)
def test_a_warp_back_to_the_same_cell_arrives_there(warp: dict[str, Any]) -> None:
    level = reference(size=[3, 1], warps=[warp], switches=[{"name": "lever", "at": [0, 0]}])
    assert rows(level, (0,), (0, 0), EAST) == [(1, (1,), (0, 0), -1, False)]
    assert rows(level, (0,), (0, 0), STAY) == [(1, (0,), (0, 0), -1, False)]


def test_an_item_that_the_robot_flies_over_is_not_taken() -> None:
    level = reference(size=[4, 1], wind={"east": [1]}, items=[{"name": "coin", "at": [1, 0]}])
    assert rows(level, (0,), (0, 0), EAST) == [(1, (0,), (2, 0), -1, False)]
    # A move that is refused is blown to the east as well, but only by one cell.
    assert rows(level, (0,), (0, 0), NORTH) == [(1, (1,), (1, 0), -1, False)]


def test_wind_stops_at_a_closed_door() -> None:
    level = reference(
        size=[4, 1],
        wind={"east": [1]},
        items=[{"name": "key", "at": [1, 0]}],
        doors=[{"at": [1, 0], "side": "E", "needs": "key"}],
    )
    assert rows(level, (0,), (0, 0), EAST) == [(1, (1,), (1, 0), -1, False)]
    assert rows(level, (1,), (1, 0), EAST) == [(1, (1,), (3, 0), 0, True)]


def test_a_refused_move_that_the_wind_takes_to_an_item_gives_its_reward() -> None:
    level = reference(
        size=[1, 3],
        wind={"south": [1]},
        items=[{"name": "coin", "at": [0, 1], "reward": 5}],
        rewards={"bump": -3},
    )
    assert rows(level, (0,), (0, 0), EAST) == [(1, (1,), (0, 1), 5, False)]


GLASS: dict[str, Any] = {
    "size": [3, 1],
    "start": [1, 0],
    "walls": [{"at": [1, 0], "side": "E", "pass": 0.25}],
}


def test_a_robot_that_bounces_into_a_mover_is_hit_and_pays_for_the_bounce() -> None:
    level = reference(**GLASS, movers=[{"path": [[0, 0]]}], hit={"reward": -10})
    assert rows(level, (0,), (1, 0), EAST) == [
        (0.75, (0,), (0, 0), -11, True),
        (0.25, (0,), (2, 0), 0, True),
    ]


def test_a_robot_that_bounces_onto_an_item_takes_it_and_pays_for_the_bounce() -> None:
    level = reference(**GLASS, items=[{"name": "coin", "at": [0, 0], "reward": 5}])
    assert rows(level, (0,), (1, 0), EAST) == [
        (0.25, (0,), (2, 0), 0, True),
        (0.75, (1,), (0, 0), 4, False),
    ]


def test_a_closed_door_behind_the_robot_stops_a_bounce() -> None:
    level = reference(
        **GLASS,
        items=[{"name": "key", "at": [0, 0]}],
        doors=[{"at": [0, 0], "side": "E", "needs": "key"}],
    )
    assert rows(level, (0,), (1, 0), EAST) == [
        (0.75, (0,), (1, 0), -2, False),
        (0.25, (0,), (2, 0), 0, True),
    ]


# Turning.


def test_turning_stays_with_another_heading() -> None:
    turning = TurningReference(reference(**KEY_AND_DOOR, rewards={"stay": -0.25}), "E")
    assert turning.num_states == 24
    # The robot stands on the middle one of three cells and looks to the east, where the door is.
    assert turning.start == {1 * 3 + 1: 1.0}
    assert turning.outcomes(4, LEFT) == [(1, 0 * 3 + 1, -0.25, False)]
    assert turning.outcomes(4, RIGHT) == [(1, 2 * 3 + 1, -0.25, False)]
    assert turning.outcomes(4, FORWARD) == [(1, 4, -1, False)]
    assert turning.allowed(4) == {LEFT, RIGHT}
    # To the west lies the key.
    assert turning.outcomes(3 * 3 + 1, FORWARD) == [(1, (1 * 4 + 3) * 3 + 0, -1, False)]
    assert turning.allowed(3 * 3 + 1) == {LEFT, RIGHT, FORWARD}


def test_forward_keeps_the_heading_whatever_chance_does() -> None:
    turning = TurningReference(
        reference(start=[1, 1], skid={"probability": 0.5, "to": "sides"}), "S"
    )
    # The cell in the middle of nine is left to the west, the east and the south.
    assert turning.outcomes(2 * 9 + 4, FORWARD) == [
        (0.25, 2 * 9 + 3, -1, False),
        (0.25, 2 * 9 + 5, -1, False),
        (0.5, 2 * 9 + 7, -1, False),
    ]


def test_movers_move_while_the_robot_turns() -> None:
    turning = TurningReference(reference(**GUARD), "E")
    assert turning.outcomes(1 * 4 + 0, LEFT) == [(1, (1 * 4 + 0) * 4 + 0, -0.5, False)]
    assert turning.outcomes(1 * 4 + 1, RIGHT) == [(1, (1 * 4 + 2) * 4 + 1, -1, True)]


# Random levels.


@pytest.mark.slow
def test_most_random_levels_have_several_configurations() -> None:
    levels = [Reference(random_level(Random(seed))) for seed in range(40)]
    assert sum(len(level.configurations) > 1 for level in levels) >= 32
    assert sum(len(level.configurations) > 8 for level in levels) >= 10


# The compiled tables.


def assert_same_outcomes(found: list[Outcome], expected: list[Outcome], where: object) -> None:
    assert [tuple(each)[1:] for each in found] == [each[1:] for each in expected], where
    for ours, theirs in zip(found, expected, strict=True):
        assert ours[0] == pytest.approx(theirs[0], abs=1e-12), where


def assert_same_tables(mdp: Any, level: Reference | TurningReference, actions: int) -> None:
    """Compare every entry of the tables, their numbering and what is told by state."""
    assert mdp.cells == level.num_cells
    assert mdp.configurations.dtype == np.int16
    assert mdp.configurations.shape == (len(level.configurations), len(level.radices))
    assert [tuple(each) for each in mdp.configurations.tolist()] == level.configurations
    assert mdp.num_states == level.num_states
    start = {state: float(mdp.start[state]) for state in np.flatnonzero(mdp.start).tolist()}
    assert start == pytest.approx(level.start, abs=1e-12)
    states = range(level.num_states)
    assert mdp.is_terminal.tolist() == [level.is_terminal(state) for state in states]
    assert mdp.action_mask.tolist() == [
        [int(action in level.allowed(state)) for action in range(actions)] for state in states
    ]
    for state in states:
        for action in range(actions):
            found, expected = mdp.outcomes(state, action), level.outcomes(state, action)
            assert_same_outcomes(found, expected, where=(state, action))


def compare(seed: int, things: bool = True, *, turning: bool = False) -> None:
    fields = random_level(Random(seed), things)
    level, mdp = Reference(fields), brl.Level.from_fields(fields).compile()
    try:
        if turning:
            assert_same_tables(mdp.turning("E"), TurningReference(level, "E"), actions=3)
        else:
            assert_same_tables(mdp, level, actions=5)
    except Exception as error:
        error.add_note(f"the level: {fields}")
        raise


@pytest.mark.slow
@for_each("seed", range(settings().max_examples))
def test_tables_of_random_levels_are_those_of_the_reference(seed: int) -> None:
    compare(seed)


@given(worlds())
def test_tables_of_worlds_are_those_of_the_reference(world: World) -> None:
    level = Reference(with_walls_for_maze(world))
    assert_same_tables(level_of(world).compile(), level, actions=5)


@pytest.mark.slow
@for_each("seed", range(settings().max_examples // 2))
def test_turning_tables_of_random_levels_are_those_of_the_reference(seed: int) -> None:
    compare(seed, turning=True)


@for_each("seed", range(settings().max_examples // 2))
def test_turning_tables_of_levels_without_things_are_those_of_the_reference(seed: int) -> None:
    compare(seed, things=False, turning=True)


def compare_chances(add: Callable[[Random, Fields], None], seed: int) -> None:
    random = Random(seed)
    fields = random_level(random, things=random.random() < 0.7)
    add(random, fields)
    level, expected = brl.Level.from_fields(fields), Reference(fields)
    states, actions = range(expected.num_states), range(1 + len(expected.moves))
    rows = (expected.outcomes(state, action) for state in states for action in actions)
    if expected.radices and max(map(len, rows)) > 64:
        with pytest.raises(brl.LevelError, match="outcomes"):
            level.compile()
    else:
        assert_same_tables(level.compile(), expected, actions=len(actions))


CHANCES = [add_weights, add_gusts, add_diagonals, add_draws]


@pytest.mark.slow
@pytest.mark.parametrize("add", CHANCES)
@for_each("seed", range(settings().max_examples // 2))
def test_more_chances_are_those_of_the_reference(
    add: Callable[[Random, Fields], None], seed: int
) -> None:
    compare_chances(add, seed)


@pytest.mark.sweep
@pytest.mark.parametrize("add", CHANCES)
def test_more_chances_in_many_levels_are_those_of_the_reference(
    add: Callable[[Random, Fields], None],
) -> None:
    for seed in range(1000, 1300):
        compare_chances(add, seed)


@pytest.mark.sweep
@pytest.mark.parametrize("block", range(2))
def test_tables_of_many_random_levels_are_those_of_the_reference(block: int) -> None:
    for seed in range(1000 + 500 * block, 1500 + 500 * block):
        compare(seed)


@pytest.mark.sweep
@for_each("seed", range(1000, 1400))
def test_turning_tables_of_many_random_levels_are_those_of_the_reference(seed: int) -> None:
    compare(seed, turning=True)
