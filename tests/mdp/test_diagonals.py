"""Levels whose robot also moves diagonally: what plays, shows and hands them on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels import Action
from babyrobot_levels.envs.suite import SuiteEnv

OPEN: dict[str, Any] = {"version": 1, "size": [4, 3], "moves": 8}
MIXED: dict[str, Any] = {"version": 1, "kind": "suite", "levels": ["maze", "windy-gridworld-king"]}


def test_four_moves_are_no_part_of_a_digest() -> None:
    fields = {**OPEN, "moves": 4}
    assert brl.load(fields).digest == brl.load({"version": 1, "size": [4, 3]}).digest
    assert brl.load(fields).digest != brl.load(OPEN).digest


def test_data_of_a_whole_level_are_that_level() -> None:
    level = brl.load(OPEN)
    data = level.model_dump(by_alias=True, exclude_none=True, exclude={"legend"})
    again = brl.Level.from_fields(data)
    assert again.digest == level.digest
    assert brl.load({**OPEN, "heading": "E"}).to_html()


@pytest.mark.parametrize(
    ("wind", "end"),
    [
        ({}, [2, 3]),
        ({"north": 1}, [2, 2]),
        ({"east": 2}, [4, 3]),
        ({"west": 1, "south": 1}, [1, 4]),
        ({"north": 1, "east": 1}, [3, 2]),
    ],
)
def test_wind_blows_a_diagonal_move_on(wind: dict[str, int], end: list[int]) -> None:
    blowing = {"wind": {side: [each] * 6 for side, each in wind.items()}} if wind else {}
    level = brl.load({**OPEN, "size": [6, 6], "start": [1, 4], **blowing})
    env = level.make()
    env.reset(seed=1)
    assert env.step(Action.NORTH_EAST)[0].tolist() == end


def test_environments_have_nine_actions_or_eight_moves() -> None:
    for actions, count in (("all", 9), ("valid", 9), ("moves", 8), ("valid_moves", 8)):
        env = brl.load(OPEN).make(actions=actions)
        _, info = env.reset(seed=1)
        assert info["action_mask"].shape == (count,)
        observation, *_ = env.step(Action.SOUTH_EAST - (9 - count))
        assert observation.tolist() == [1, 1]
        assert env.get_wrapper_attr("get_keys_to_action")()[(ord("3"),)] == 6 - (9 - count)


@pytest.mark.parametrize(
    "use",
    [
        lambda level: level.make(actions="turns"),
        lambda level: brl.LevelVectorEnv(level, actions="turns"),
        lambda level: brl.LevelVectorEnv(levels=[level, "maze"]),
        lambda level: brl.LevelVectorEnv("maze").set_levels(level),
        lambda level: brl.rollout([level, "maze"], "random", num_steps=2),
        lambda level: brl.solve(level, actions="turns"),
        lambda level: level.to_svg(action_values=brl.solve(level).action_values),
        lambda level: SuiteEnv(MIXED).reset(options={"index": 1}),
    ],
)
def test_what_is_for_four_moves_refuses_eight(use: Callable[[brl.Level], Any]) -> None:
    with pytest.raises((brl.LevelError, ValueError), match=r"moves: 8|moves in 8"):
        use(brl.load(OPEN))


@pytest.mark.parametrize("actions", ["all", "moves"])
def test_both_engines_roll_the_same_way_and_record_masks(actions: str) -> None:
    level = brl.load({**OPEN, "walls": [{"at": [1, 1], "side": "E"}], "max_steps": 9})
    one, other = (
        brl.rollout(level, "random", 300, 20, seed=1, actions=actions, engine=engine)
        for engine in ("numpy", "compiled")
    )
    for name, told in vars(one).items():
        assert np.array_equal(told, getattr(other, name)), name
    masks = level.compile().action_mask[:, 9 - one.action_masks.shape[-1] :]
    assert one.action_masks.dtype == np.int8
    assert np.array_equal(one.action_masks, masks[one.observations])


def test_vector_environments_sample_all_that_masks_allow() -> None:
    envs = brl.LevelVectorEnv(OPEN, num_envs=1000)
    _, info = envs.reset(seed=1)
    envs.action_space.seed(1)
    assert set(envs.action_space.sample()) == set(np.flatnonzero(info["action_mask"][0])) == {
        Action.STAY, Action.EAST, Action.SOUTH, Action.SOUTH_EAST
    }  # fmt: skip


def test_policies_are_read_with_names_of_diagonals_and_drawn() -> None:
    level = brl.load(OPEN)
    solution = brl.solve(level, actions="moves")
    assert solution.action_values.shape == (3, 4, 8)
    assert brl.evaluate(level, solution).expected_return == solution.expected_return == -2
    names = np.full((3, 4), "south-east")
    names[2] = "east"
    assert brl.evaluate(level, names).values[0, 1] == -1
    assert level.to_svg(policy=names) != level.to_svg(policy=solution)


def test_files_of_model_checkers_name_actions_as_prism_takes_them() -> None:
    assert "[north_east]" in brl.export(brl.load(OPEN), format="prism").text


def test_a_play_through_diagonals_is_verified() -> None:
    world = brl.TextWorld({**OPEN, "max_steps": 9})
    world.reset(seed=1)
    assert "south-east" in world.move("up")
    world.move("south-east")
    assert all(each.is_valid for each in brl.replay(world.play))
