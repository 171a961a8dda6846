"""What the guides say of steps, infos and resets, sentence by sentence, in real environments."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from support.claims import says

import babyrobot_levels as brl
from babyrobot_levels.mdp.tables import GLASS, REFUSED

HALL: dict[str, Any] = {"version": 1, "size": [3, 1]}
"""Two steps to the east."""

ROUGH: dict[str, Any] = {
    "version": 1,
    "size": [5, 4],
    "start": [[0, 0], [0, 3]],
    "exit": "none",
    "skid": {"probability": 0.4, "to": "sides"},
    "wind": {"south": [0, 1, 0, 0, 0], "west": [0, 0, 1, 0]},
    "walls": [{"at": [2, 0], "side": "E", "pass": 0.5, "length": 2}, {"at": [1, 2], "side": "N"}],
    "warps": [{"at": [4, 1], "to": "start"}, {"at": [0, 2], "to": [4, 3], "when": "leave"}],
}

BUSY: dict[str, Any] = {
    "version": 1,
    "size": [4, 2],
    "items": [{"name": "gem", "at": [3, 0]}, {"name": "key", "at": [1, 0]}],
    "movers": [{"path": [[2, 0], [2, 1]]}],
    "hit": {"ends": False},
}


def walk(env: Any, steps: int = 3000) -> Any:
    """Yield the state, the action, the result and the next state of random steps."""
    rng = np.random.default_rng(1)
    env.reset(seed=1)
    for _ in range(steps):
        before, action = env.unwrapped.state, int(rng.integers(5))
        result = env.step(action)
        yield before, action, result, env.unwrapped.state
        if result[2] or result[3]:
            env.reset()


def test_target_reached_and_skidded_follow_from_the_tables() -> None:
    says(
        "environments",
        "| `target_reached` | bool: the robot is where the action leads without chance, and no "
        "wall refused it; False at reset |",
        "| `skidded` | bool: chance took the robot somewhere else; False at reset. Bouncing off "
        "glass does not count |",
    )
    level = brl.load(ROUGH)
    mdp = level.compile()
    env = level.make(actions="all", max_episode_steps=60)
    starts = np.flatnonzero(mdp.start)
    seen = set()
    for before, action, (*_, info), after in walk(env):
        target = mdp.intended_next_state[before, action]
        there = after == target or (target >= mdp.num_states and after in starts)
        obstruction = mdp.obstruction[before, action]
        assert info["target_reached"] == (there and obstruction != REFUSED)
        assert info["skidded"] == (not there and obstruction != GLASS)
        seen.add((int(obstruction), bool(there)))
    assert len(seen) == 6
    info = env.reset()[1]
    assert not info["target_reached"]
    assert not info["skidded"]


def test_infos_have_the_same_keys_at_reset_and_step() -> None:
    says(
        "environments",
        "`reset` and `step` return the same keys:",
        "| `action_mask` | int8 `[actions]`: 1 for each allowed action |",
        "| `held` | bool `[items]`: which items the robot holds, in the order of the level file; "
        "only for levels with items |",
        "| `hit` | bool: a mover hit the robot in this step; only for levels with movers |",
        "| `maze_seed` | int: the seed of the maze, for levels with `maze: {seed: random}` |",
        "| `level_index` | int: the number of the level, for suites |",
        "| `item_names` | tuple of str: the names of its items, in the order of `held` |",
    )
    more = {
        "final-maze": set(),
        "random-maze": {"maze_seed"},
        "bat-cave": {"hit"},
        "first-key": {"held"},
    }
    common = {"action_mask", "target_reached", "skidded"}
    for name, keys in more.items():
        env = brl.load(name).make()
        assert {*env.reset(seed=1)[1]} == {*env.step(0)[4]} == common | keys
    env = gymnasium.make("babyrobot/Suite-v0", suite="small-mazes")
    assert {*env.reset(seed=1)[1]} == common | {"level_index"}
    env = brl.load(BUSY).make()
    env.reset(seed=1)
    assert env.get_wrapper_attr("item_names") == ("gem", "key")
    assert env.step(brl.Action.EAST)[4]["held"].tolist() == [False, True]
    assert env.step(brl.Action.EAST)[4]["hit"]  # the mover comes back
    assert not env.step(brl.Action.EAST)[4]["hit"]


def test_in_a_suite_there_is_room_for_all_levels() -> None:
    says(
        "environments",
        "In a suite, `held` has room for the most items, and `hit` is there if any level can have "
        "movers.",
    )
    levels = [brl.load(HALL), brl.load(BUSY)]
    _, info = brl.LevelVectorEnv(levels=levels).reset(seed=1)
    assert info["held"].tolist() == [[False, False]] * 2
    assert info["hit"].tolist() == [False, False]
    assert info["level_index"].tolist() == [0, 1]


def test_actions_that_are_not_allowed_are_refused() -> None:
    says(
        "environments",
        "An action that is not allowed is no error: the move is refused.",
        'In a terminal state only stay is allowed (with `"turns"`, left and right; with `"moves"` '
        'and `"valid_moves"`, nothing: `sample()` gives 0).',
    )
    windy = brl.load({**HALL, "size": [3, 2], "wind": {"east": [1, 0]}})
    env = windy.make()
    _, info = env.reset(seed=1)
    assert not info["action_mask"][brl.Action.NORTH]
    assert env.step(brl.Action.NORTH)[0].tolist() == [1, 0]  # the wind still pushes
    allowed = {"valid": [0], "all": [0], "moves": [], "valid_moves": [], "turns": [0, 1]}
    for actions, expected in allowed.items():
        env = brl.load({"version": 1, "size": [2, 1]}).make(actions=actions)
        env.reset(seed=1)
        forward = {"valid": 2, "all": 2, "turns": 2}.get(actions, 1)
        *_, terminated, _, info = env.step(forward)
        assert terminated
        assert np.flatnonzero(info["action_mask"]).tolist() == expected
        if actions == "valid_moves":
            assert env.action_space.sample() == 0


def test_a_refused_reset_leaves_the_episode() -> None:
    says(
        "environments",
        "Other options, and a `start` from which no episode goes on, raise `ValueError`; the "
        "current episode goes on.",
        "| `start` | all | `[x, y]`: starts in that cell.",
    )
    env = brl.load(HALL).make()
    env.reset(seed=1)
    env.step(brl.Action.EAST)
    for options in ({"start": [2, 0]}, {"strat": [0, 0]}, {"start": [9, 9]}):
        with pytest.raises(ValueError, match=r"start|strat"):
            env.reset(options=options)
    assert env.step(brl.Action.EAST)[2]
    assert env.reset(options={"start": [1, 0]})[0].tolist() == [1, 0]


def test_a_limit_truncates_and_what_ends_terminates() -> None:
    says(
        "environments",
        "- Termination: the robot reaches an exit whose `exit_needs` are met, or a cell with "
        "`ends: true`; or a mover hits it, unless the level says `hit: {ends: false}`.",
        "- Truncation: Gymnasium's `TimeLimit` ends the episode after the level's `max_steps`, if "
        "any, or after the argument `max_episode_steps` (-1 for none).",
    )
    level = brl.load({**HALL, "max_steps": 2})

    def ends(steps: int, **limit: int) -> list[tuple[bool, bool]]:
        env = level.make(**limit)
        env.reset(seed=1)
        return [env.step(brl.Action.STAY)[2:4] for _ in range(steps)]

    assert ends(2) == [(False, False), (False, True)]
    assert ends(1, max_episode_steps=1) == [(False, True)]
    assert not any(truncated for _, truncated in ends(99, max_episode_steps=-1))
    # Who arrives with the last step has both.
    env = level.make()
    env.reset(seed=1)
    assert [env.step(brl.Action.EAST)[2:4] for _ in range(2)] == [(False, False), (True, True)]


# -- vector environments -------------------------------------------------------------------


def hall(mode: str, **fields: Any) -> brl.LevelVectorEnv:
    envs = brl.LevelVectorEnv({**HALL, **fields}, num_envs=2, autoreset_mode=mode)
    envs.reset(seed=1)
    return envs


def test_next_step_resets_in_the_next_step_and_ignores_its_action() -> None:
    says(
        "vector",
        "| `NEXT_STEP` | the next step resets the environment and ignores its action; the reward "
        "is 0 |",
        "All other entries of `info`, `level_index` and `action_mask` among them, are of the "
        "episode that the returned observation is in.",
    )
    envs = hall("NextStep", rewards={"step": -3})
    envs.step([2, 0])
    observed, rewards, terminated, _, info = envs.step([2, 0])
    assert (observed[0].tolist(), rewards.tolist()) == ([2, 0], [0, -3])
    assert terminated.tolist() == [True, False]
    assert info["action_mask"][0].tolist() == [1, 0, 0, 0, 0]
    assert info["target_reached"].tolist() == [True, True]
    observed, rewards, terminated, _, info = envs.step([2, 2])
    assert (observed.tolist(), rewards.tolist()) == ([[0, 0], [1, 0]], [0, -3])
    assert not terminated.any()
    assert info["action_mask"][0].tolist() == [1, 0, 1, 0, 0]
    assert info["target_reached"].tolist() == [False, True]


def test_same_step_tells_the_end_in_final_entries_and_the_rest_of_the_next_episode() -> None:
    says(
        "vector",
        '| `SAME_STEP` | the same step resets the environment. `info["final_obs"]` and '
        '`info["final_info"]` have the end of the episode |',
        "In `SAME_STEP` mode, Gymnasium's `final_obs` is an array of objects.",
        '| `info["_" + key]` | bool `[num_envs]`: in which environments the value holds |',
        'So with `SAME_STEP`, where an episode is over, `info["level_index"]` is the level of '
        'the next one, and `info["final_info"]["level_index"]` that in which the action was '
        "taken; in JAX, `level_index` is the latter.",
    )
    levels = [brl.load({**HALL, "size": [2 + number, 1]}) for number in range(3)]
    envs = brl.LevelVectorEnv(
        levels=levels, draw_levels=True, num_envs=8, autoreset_mode="SameStep", actions="all"
    )
    _, info = envs.reset(seed=1)
    others = 0
    for _ in range(20):
        before = info["level_index"]
        observed, _, terminated, _, info = envs.step(np.full(8, 2))
        if not terminated.any():
            continue
        assert info["final_obs"].dtype == object
        assert info["_final_info"].tolist() == info["_final_obs"].tolist() == terminated.tolist()
        assert (observed[terminated] == 0).all()
        assert not info["target_reached"][terminated].any()
        for number in np.flatnonzero(terminated):
            assert info["final_info"]["level_index"][number] == before[number]
            assert info["final_obs"][number].tolist() == [before[number] + 1, 0]
            assert info["final_info"]["target_reached"][number]
        # What is returned is of the level that has begun.
        assert info["level_index"].tolist() == [
            levels.index(each) for each in envs.get_attr("level")
        ]
        others += int((info["level_index"] != before).sum())
    assert others > 5


def test_disabled_waits_for_a_reset_of_what_is_over() -> None:
    says(
        "vector",
        '| `DISABLED` | call `reset(options={"reset_mask": terminated \\| truncated})`; a step '
        "raises `ResetNeeded` before that |",
    )
    envs = hall("Disabled")
    envs.step([2, 0])
    observed, _, terminated, truncated, _ = envs.step([2, 0])
    assert observed.tolist() == [[2, 0], [0, 0]]
    with pytest.raises(gymnasium.error.ResetNeeded):
        envs.step([0, 0])
    observed, _ = envs.reset(options={"reset_mask": terminated | truncated})
    assert observed.tolist() == [[0, 0], [0, 0]]
    envs.step([0, 0])


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_values_are_those_of_single_environments_also_where_a_limit_ends(mode: str) -> None:
    says(
        "vector",
        "The values are those of Gymnasium's `SyncVectorEnv` of single environments.",
        "| terminated, truncated | bool `[num_envs]` |",
        "| rewards | float64 `[num_envs]` |",
    )
    fields = {**BUSY, "max_steps": 3}
    envs = brl.LevelVectorEnv(fields, num_envs=2, autoreset_mode=mode)
    level = brl.load(fields)
    others = SyncVectorEnv([level.make] * 2, autoreset_mode=AutoresetMode(mode))
    assert_same(envs.reset(seed=[1, 2]), others.reset(seed=[1, 2]))
    for _ in range(9):
        assert_same(envs.step([2, 3]), others.step([2, 3]))


def assert_same(ours: Any, theirs: Any) -> None:
    if isinstance(ours, dict):
        assert {*ours} == {*theirs}
        ours, theirs = [*ours.values()], [theirs[key] for key in ours]
    if isinstance(ours, list | tuple):
        for one, other in zip(ours, theirs, strict=True):
            assert_same(one, other)
    elif ours.dtype == object:
        assert str(ours) == str(theirs)
    else:
        assert ours.dtype == theirs.dtype
        assert np.array_equal(ours, theirs)


def test_actions_beyond_the_space_change_nothing() -> None:
    says(
        "vector",
        "Actions that are not whole numbers of the space raise `gymnasium.error.InvalidAction`; "
        "the environments then stay as they are.",
        "`envs.action_masks()` returns the current masks, and `action_space.sample(mask)` takes "
        "them.",
        '`reset(options={"start": [x, y]})` starts in that cell, in all environments or in those '
        "of a `reset_mask`.",
    )
    envs = hall("Disabled")
    envs.step([2, 0])
    for actions in ([5, 0], [-1, 0], [0.5, 0]):
        with pytest.raises(gymnasium.error.InvalidAction):
            envs.step(actions)
    assert envs.step([0, 0])[0].tolist() == [[1, 0], [0, 0]]
    assert envs.action_masks().tolist() == [[1, 0, 1, 0, 1], [1, 0, 1, 0, 0]]
    assert envs.action_space.contains(envs.action_space.sample(envs.action_masks()))
    mask = np.array([False, True])
    assert envs.reset(options={"start": [1, 0], "reset_mask": mask})[0].tolist() == [[1, 0]] * 2
