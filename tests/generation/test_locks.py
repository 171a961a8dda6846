"""Keys, doors, coins and guards in generated levels: always solvable, and each door separates."""

from __future__ import annotations

from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.generation.candidates import Maker
from babyrobot_levels.generation.search import UnsatisfiableError
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.compiler import compile_mdp
from babyrobot_levels.suites.suite import Suite, load_suite

FIELDS: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "name": "locked",
    "count": 8,
    "size": {"min": [5, 5], "max": [7, 7]},
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 0.5}},
    "exit": "farthest",
    "keys": {"min": 1, "max": 3},
    "coins": {"max": 2},
    "guards": {"max": 1},
}


@pytest.fixture(scope="module")
def locked() -> Suite:
    return load_suite(FIELDS)


def fewest_steps(level: Level) -> int | None:
    """Return the fewest steps to the exit without being hit, None where there is no way."""
    # A level that was changed by `model_copy` keeps the tables that it had.
    mdp = compile_mdp(level, level.grid())
    steps = {int(state): 0 for state in np.flatnonzero(mdp.start)}
    queue = deque(steps)
    exits = set(level.exits)
    while queue:
        state = queue.popleft()
        if mdp.is_terminal[state]:
            if mdp.cell(state) in exits:
                return steps[state]
            continue
        for action in range(mdp.num_actions):
            for _, following, _, terminal in mdp.outcomes(state, action):
                if terminal and not mdp.is_terminal[following]:
                    continue  # A hit.
                if following not in steps:
                    steps[following] = steps[state] + 1
                    queue.append(following)
    return None


@pytest.mark.slow
def test_every_level_can_be_solved_and_needs_every_key(locked: Suite) -> None:
    for level in locked:
        assert fewest_steps(level) is not None, level.name
        keys = [item for item in level.items if item.picture == "key"]
        assert 1 <= len(keys) <= 3
        for key in keys:
            # A key that lies out of reach is as good as none.
            others = tuple(item for item in level.items if item is not key)
            doors = tuple(
                door.model_copy(update={"needs": ("never",)}) if key.name in door.keys else door
                for door in level.doors
            )
            assert (
                fewest_steps(level.model_copy(update={"items": others, "doors": doors})) is None
            ), level.name


@pytest.mark.slow
def test_every_door_separates_the_maze(locked: Suite) -> None:
    for level in locked:
        for door in level.doors:
            wall = {"at": list(door.at), "side": door.side}
            walls = [*level.to_dict().get("walls", []), wall]
            closed = level.replace(walls=walls, doors=None, items=None, movers=None)
            grid, start = closed.grid(), level.starts[0]
            seen = {start[1] * grid.width + start[0]}
            queue = deque(seen)
            while queue:
                cell = queue.popleft()
                for side, bit in (("N", 1), ("E", 2), ("S", 4), ("W", 8)):
                    other = grid.neighbour(cell, side) if grid.open_bits[cell] & bit else None
                    if other is not None and other not in seen:
                        seen.add(other)
                        queue.append(other)
            assert len(seen) < grid.width * grid.height, level.name


@pytest.mark.slow
def test_the_detour_is_that_of_the_shortest_way() -> None:
    suite = load_suite({**FIELDS, "count": 5, "detour": {"min": 8, "max": 14}})
    for level in suite:
        plain = level.replace(doors=None, items=None, movers=None)
        ahead, straight = fewest_steps(level), fewest_steps(plain)
        assert ahead is not None
        assert straight is not None
        assert 8 <= ahead - straight <= 14


@pytest.mark.slow
def test_more_doors_than_keys_share_keys() -> None:
    suite = load_suite({**FIELDS, "count": 4, "keys": 2, "doors": 4})
    for level in suite:
        assert len(level.doors) == 4
        assert {name for door in level.doors for name in door.keys} == {"gold-key", "red-key"}
        assert fewest_steps(level) is not None


@pytest.mark.slow
def test_things_lie_apart_and_off_start_and_exit(locked: Suite) -> None:
    for level in locked:
        cells = [item.at for item in level.items]
        assert len({*cells, *level.starts, *level.exits}) == len(cells) + 2
        for mover in level.movers:
            assert not {*mover.phases} & {*level.starts, *level.exits}


def test_levels_without_things_are_what_they_were() -> None:
    plain = {name: FIELDS[name] for name in FIELDS if name not in ("keys", "coins", "guards")}
    assert load_suite({**plain, "keys": 0})[3].digest == load_suite(plain)[3].digest


@pytest.mark.slow
def test_a_hit_is_worse_than_the_way_and_changes_no_layout() -> None:
    suite = load_suite({**FIELDS, "size": [8, 6], "keys": 0, "coins": 0, "guards": 1, "count": 5})
    for level in suite:
        assert level.hit.reward == -100
        assert brl.solve(level).exit_probability == 1
        # With a hit that costs less than the way, the optimum is to walk into the guard.
        assert brl.solve(level.replace(hit={"reward": -1})).exit_probability == 0
    assert [level.maze.seed for level in suite if level.maze is not None] == [
        210896483931586,
        169307706175570,
        82155366809662,
        165421636636716,
        14143807719623,
    ]


@pytest.mark.sweep
def test_what_a_hit_costs_can_be_given() -> None:
    fields = {**FIELDS, "size": [8, 6], "keys": 0, "coins": 0, "guards": 1, "count": 12}
    for hit in ({"reward": -7.0}, {"ends": False}, {"reward": -2.0, "ends": False}):
        for level in load_suite({**fields, "hit": hit}):
            assert level.to_dict()["hit"] == hit
            assert brl.solve(level).exit_probability == 1
    levels = [load_suite({**fields, "hit": {"reward": cost}})[:] for cost in (-100.0, -7.0)]
    # Where the default and a lower cost both make it best to win, the level is the same.
    same = [
        one.starts == two.starts and one.maze == two.maze for one, two in zip(*levels, strict=True)
    ]
    assert any(same)
    assert not all(same)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("fields", "is_plain"),
    [
        ({}, True),
        ({"rewards": {"step": -0.1, "bump": -1.0}}, True),
        ({"discount": 0.9, "puddles": 0}, True),
        ({"discount": 0.9, "puddles": 0, "rewards": {"step": 0.0, "exit": 1.0}}, True),
        ({"discount": 0.9}, False),
        ({"discount": 0.5}, False),
        ({"rewards": {"step": 0.0, "exit": 1.0}}, False),
        ({"rewards": {"stay": 0.0, "exit": 12.0}}, False),
    ],
)
def test_winning_is_best_whatever_is_paid(fields: dict[str, Any], is_plain: bool) -> None:
    suite = load_suite(
        {"version": 1, "kind": "suite", "size": [6, 6], "count": 12, "puddles": 2, **fields}
    )
    assert isinstance(suite.fields, SuiteFields)
    maker = Maker(suite.fields, "level-{index}")
    firsts = [maker.draw(number, 0) for number in range(12)]
    for number, first in enumerate(firsts):
        assert first.is_surely_won == is_plain
        is_best = brl.solve(first.level).exit_probability == 1
        assert is_best or not is_plain
        # Only levels that are lost are drawn anew.
        assert (suite[number].digest == first.level.digest) == (is_best and first.is_playable)
        assert brl.solve(suite[number]).exit_probability == 1


@pytest.mark.slow
def test_a_drawn_level_keeps_its_things() -> None:
    suite = load_suite({**FIELDS, "start": "farthest", "keys": 1, "guards": 1, "count": 5})
    for level in suite:
        again = brl.loads(level.to_yaml())
        assert again.digest == level.digest
        assert len(again.doors) == len(again.items[:1]) == len(again.movers) == 1


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"doors": 2}, "doors need keys, and a level may have none"),
        ({"keys": 3, "doors": 2}, "2 doors are too few for 3 keys"),
        ({"keys": 9}, "a level has at most 8 keys"),
        ({"coins": 11}, "a level has at most 10 coins"),
        ({"hit": {"reward": -9}}, "without guards nothing hits the robot"),
        ({"detour": 4}, "without keys, guards and wind no way is a detour"),
        ({"keys": 4, "coins": 6, "size": [3, 3]}, "has only 7 cells besides start and exit"),
    ],
)
def test_what_cannot_be_is_an_error(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(brl.LevelError, match=message):
        load_suite({"version": 1, "kind": "suite", "count": 3, **fields})


@pytest.mark.sweep
def test_too_little_room_is_said() -> None:
    small = {"size": [4, 4], "exit": "farthest", "guards": 4}
    suite = load_suite({"version": 1, "kind": "suite", "count": 1, **small})
    with pytest.raises(UnsatisfiableError, match="was there room for all keys, doors, coins"):
        suite[0]


@pytest.mark.parametrize(
    "options",
    [
        "--key",
        "--key --coins 3",
        "--coins 2 --maze-seed 7",
        "--key --maze-seed 7 --loops 0.5",
        "--key --template drawing --puddles 2",
        "--key --size 4x9",
        "--key --size 9x1",
    ],
)
def test_new_levels_with_things_can_be_solved(
    options: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ["new-level", "first", *options.split()]
    assert run_here(command, environment(tmp_path)).status == 0
    level = load(tmp_path / "levels" / "first.yaml")
    assert fewest_steps(level) is not None
    if "--key" in options:
        never = [door.model_copy(update={"needs": ("never",)}) for door in level.doors]
        assert fewest_steps(level.model_copy(update={"doors": tuple(never)})) is None
