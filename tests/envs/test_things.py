"""Episodes in levels with things: what is taken, opened, switched and met, and turning."""

from __future__ import annotations

import re
from collections import Counter
from random import Random
from typing import Any

import gymnasium
import numpy as np
import pytest
from oracles.random_things import random_level
from oracles.things_reference import Reference
from support.each import for_each

import babyrobot_levels as brl
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.mdp.actions import Action, Turn

STAY, NORTH, EAST, SOUTH, WEST, *_ = Action
LEFT, RIGHT, FORWARD = Turn


def env_of(*, actions: str = "all", observation: str = "position", **fields: Any) -> LevelEnv:
    return LevelEnv({"version": 1, **fields}, actions=actions, observation=observation)


def walked(env: LevelEnv, actions: list[int], *keys: str) -> list[tuple[Any, ...]]:
    """Take actions, and note the cell, the reward, whether it is over, and values of the info."""
    told = []
    for action in actions:
        observation, reward, terminated, _, info = env.step(action)
        values = (np.asarray(info[key]).tolist() for key in keys)
        told.append((*observation[:2].tolist(), reward, terminated, *values))
    return told


# -- items, doors, switches and movers -------------------------------------------------------


def test_a_key_opens_a_door_and_the_mask_says_so() -> None:
    env = env_of(
        size=[3, 1],
        start=[1, 0],
        items=[{"name": "key", "at": [0, 0], "reward": 5}],
        doors=[{"at": [1, 0], "side": "E", "needs": "key"}],
    )
    _, info = env.reset()
    assert info["held"].tolist() == [False]
    assert info["action_mask"].tolist() == [1, 0, 0, 0, 1]
    assert walked(env, [EAST, WEST], "held") == [
        (1, 0, -1, False, [False]),
        (0, 0, 5, False, [True]),
    ]
    env.step(EAST)
    assert env.action_masks().tolist() == [1, 0, 1, 0, 1]
    assert walked(env, [EAST], "held", "target_reached") == [(2, 0, 0, True, [True], True)]
    assert env.reset()[1]["held"].tolist() == [False]


def test_an_exit_ends_the_episode_only_when_its_needs_are_met() -> None:
    fields: dict[str, Any] = {"size": [3, 1], "start": [1, 0], "exit": [2, 0], "exit_needs": "coin"}
    env = env_of(items=[{"name": "coin", "at": [0, 0]}], **fields)
    env.reset()
    assert walked(env, [EAST, WEST, WEST, EAST, EAST]) == [
        (2, 0, -1, False),
        (1, 0, -1, False),
        (0, 0, -1, False),
        (1, 0, -1, False),
        (2, 0, 0, True),
    ]


def test_a_switch_flips_at_each_arrival() -> None:
    env = env_of(
        size=[2, 2],
        exit="none",
        switches=[{"name": "lever", "at": [1, 0]}],
        doors=[{"at": [1, 0], "side": "S", "needs": "lever"}],
    )
    _, info = env.reset()
    assert "held" not in info
    assert "hit" not in info
    masks = []
    for action in (EAST, WEST, EAST):
        observation, *_, info = env.step(action)
        masks.append((observation.tolist(), info["action_mask"][SOUTH].item()))
    assert masks == [([1, 0, 1], 1), ([0, 0, 1], 1), ([1, 0, 0], 0)]


@pytest.mark.parametrize("ends", [False, True])
def test_a_hit_is_told_and_ends_the_episode_if_it_is_to(ends: bool) -> None:
    env = env_of(
        size=[3, 1],
        exit="none",
        movers=[{"path": [[1, 0], [2, 0]], "back": True}],
        hit={"reward": -7, "ends": ends},
    )
    _, info = env.reset()
    assert info["hit"] is False
    # The mover is at 2, then at 1 again: it meets the robot there.
    assert walked(env, [EAST], "hit") == [(1, 0, -1, False, False)]
    assert walked(env, [STAY], "hit") == [(1, 0, -7, ends, True)]
    env.reset()
    env.step(EAST)
    # Both change places.
    assert walked(env, [EAST], "hit") == [(2, 0, -7, ends, True)]


@pytest.mark.slow
@for_each("seed", range(15))
def test_hits_and_what_is_held_are_those_of_the_reference(seed: int) -> None:
    random = Random(seed)
    fields = random_level(random)
    level, reference = brl.Level.from_fields(fields), Reference(fields)
    env = LevelEnv(level, actions="all", observation="position")
    mdp, names = level.compile(), [item.name for item in level.items]

    def pair(state: int) -> Any:
        values = mdp.configurations[mdp.configuration(state)].tolist()
        return tuple(values), mdp.cell(state)

    env.reset(seed=seed)
    for _ in range(60):
        before = env._state
        observation, _, terminated, _, info = env.step(random.randrange(5))
        now = pair(env._state)
        assert observation.tolist() == [*now[1], *now[0]]
        if level.movers:
            assert info["hit"] == reference.is_hit(pair(before), now)
        if level.items:
            values = now[0][level.things().items]
            counts = [len(item.places) for item in level.items]
            assert env.item_names == tuple(names)
            assert info["held"].tolist() == [
                n == value for n, value in zip(counts, values, strict=True)
            ]
        if terminated:
            env.reset()


# -- starts ----------------------------------------------------------------------------------

DRAWN: dict[str, Any] = {
    "size": [4, 2],
    "start": [1, 0],
    "exit_one_of": [[0, 0], [3, 0]],
    "items": [{"name": "coin", "one_of": [[2, 0], [0, 1]]}],
}


def test_a_reset_draws_what_is_drawn_evenly() -> None:
    env = env_of(**DRAWN)
    env.reset(seed=1)
    drawn = Counter(tuple(env.reset()[0].tolist()) for _ in range(4000))
    assert set(drawn) == {(1, 0, 0, 0), (1, 0, 0, 1), (1, 0, 1, 0), (1, 0, 1, 1)}
    assert all(800 < count < 1200 for count in drawn.values())


def drawn_at(env: LevelEnv, start: list[int]) -> set[tuple[int, ...]]:
    """Return what is observed at 200 resets to a start."""
    env.reset(seed=1)
    return {tuple(env.reset(options={"start": start})[0].tolist()) for _ in range(200)}


def test_a_given_start_draws_how_things_lie_and_takes_the_item_there() -> None:
    found = drawn_at(env_of(**DRAWN), [2, 0])
    assert found == {(2, 0, 0, 1), (2, 0, 0, 2), (2, 0, 1, 1), (2, 0, 1, 2)}


def test_a_given_start_may_be_an_exit_that_is_not_drawn() -> None:
    assert drawn_at(env_of(**DRAWN), [0, 0]) == {(0, 0, 1, 0), (0, 0, 1, 1)}


def test_a_start_that_no_episode_reaches_is_refused() -> None:
    fields: dict[str, Any] = {
        "size": [3, 1],
        "start": [1, 0],
        "items": [{"name": "key", "at": [0, 0]}],
        "doors": [{"at": [1, 0], "side": "E", "needs": "key"}],
        "exit": "none",
    }
    env = env_of(**fields)
    env.reset()
    with pytest.raises(ValueError, match=re.escape("no episode comes to the start [2, 0]")):
        env.reset(options={"start": [2, 0]})
    # The episode goes on.
    assert walked(env, [WEST], "held") == [(0, 0, -1, False, [True])]


@pytest.mark.parametrize("cell", [[2, 0], [1, 1]])
def test_a_start_at_which_the_episode_would_be_over_is_refused(cell: list[int]) -> None:
    env = env_of(
        size=[3, 2], exit=[2, 0], blocked=[{"at": [1, 1]}], items=[{"name": "key", "at": [0, 1]}]
    )
    with pytest.raises(ValueError, match="the episode would be over"):
        env.reset(options={"start": cell})


def test_a_switch_under_a_given_start_is_not_flipped() -> None:
    env = env_of(size=[3, 1], switches=[{"name": "lever", "at": [1, 0]}])
    observation, _ = env.reset(options={"start": [1, 0]})
    assert observation.tolist() == [1, 0, 0]


def test_a_refused_start_in_a_random_maze_leaves_the_maze_as_it_was() -> None:
    env = env_of(
        size=[3, 3],
        exit="none",
        maze={"seed": "random"},
        items=[{"name": "key", "at": [1, 1]}],
        movers=[{"within": {"at": [0, 1]}}],
    )
    env.reset(options={"maze_seed": 5})
    # Where the mover always stands, no episode goes on.
    with pytest.raises(ValueError, match="no episode comes to the start"):
        env.reset(options={"maze_seed": 6, "start": [0, 1]})
    assert env.level.maze is not None
    assert env.level.maze.seed == 5
    observation, info = env.reset(options={"maze_seed": 6, "start": [1, 1]})
    assert (observation.tolist(), info["held"].tolist()) == ([1, 1, 1, 0], [True])


# -- turning ---------------------------------------------------------------------------------


def test_a_robot_that_turns_goes_where_it_looks() -> None:
    env = env_of(actions="turns", size=[3, 2], start=[0, 1], heading="N")
    observation, info = env.reset()
    assert observation.tolist() == [0, 1, 0]
    assert info["action_mask"].tolist() == [1, 1, 1]
    seen = []
    for action in (LEFT, FORWARD, RIGHT, RIGHT, FORWARD, FORWARD):
        observation, reward, terminated, _, info = env.step(action)
        seen.append((*observation.tolist(), reward, terminated, info["target_reached"]))
    assert seen == [
        (0, 1, 3, -1, False, True),
        (0, 1, 3, -1, False, False),
        (0, 1, 0, -1, False, True),
        (0, 1, 1, -1, False, True),
        (1, 1, 1, -1, False, True),
        (2, 1, 1, 0, True, True),
    ]
    assert info["action_mask"].tolist() == [1, 1, 0]


def test_a_turn_gives_the_reward_of_staying_and_takes_time() -> None:
    env = env_of(
        actions="turns",
        size=[2, 1],
        exit="none",
        rewards={"stay": -3},
        movers=[{"path": [[0, 0], [1, 0]], "back": True}],
        hit={"reward": -9, "ends": False},
    )
    env.reset()
    rewards = [env.step(action)[1] for action in (LEFT, LEFT, RIGHT)]
    assert rewards == [-3, -9, -3]


def test_a_skid_leaves_the_heading() -> None:
    env = env_of(
        actions="turns",
        size=[3, 3],
        start=[1, 1],
        exit="none",
        heading="S",
        skid={"probability": 1, "to": "sides"},
    )
    env.reset(seed=3)
    for _ in range(30):
        observation, *_ = env.step(FORWARD)
        assert observation[2] == 2
        env.reset(options={"start": [1, 1]})


def test_a_given_start_of_a_robot_that_turns_has_the_levels_heading() -> None:
    found = drawn_at(env_of(actions="turns", heading="W", **DRAWN), [2, 0])
    assert found == {(2, 0, 0, 1, 3), (2, 0, 0, 2, 3), (2, 0, 1, 1, 3), (2, 0, 1, 2, 3)}


def test_turning_has_the_tables_of_turning() -> None:
    level = brl.load({"version": 1, "size": [2, 2], "items": [{"name": "key", "at": [1, 0]}]})
    env = LevelEnv(level, actions="turns", observation="index")
    assert level.compile().turning("E").to_toy_text() == env.P
    assert np.array_equal(env.initial_state_distrib, level.compile().turning("E").start)
    assert env.observation_space == gymnasium.spaces.Discrete(2 * 4 * 4)
    assert env.reset()[0] == 4


def test_keys_of_the_keyboard_turn() -> None:
    env = env_of(actions="turns")
    keys = env.get_keys_to_action()
    assert {chr(key): action for (key,), action in keys.items() if key < 128} == {
        "a": LEFT,
        "d": RIGHT,
        "w": FORWARD,
    }
    assert len(keys) == 6
