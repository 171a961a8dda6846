"""The environment of several robots that one agent moves, and the films of it."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import babyrobot_levels as brl

PASSING = "passing-place"
PADS = "two-pads"
SLIPPERY = {
    "version": 1,
    "size": [4, 3],
    "robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [0, 2]}],
    "items": [{"name": "coin", "one_of": [[1, 1], [2, 1]], "reward": 3}],
    "movers": [{"within": {"at": [1, 0], "size": [2, 1]}}],
    "hit": {"ends": False},
    "skid": 0.3,
}


@pytest.mark.slow
def test_an_id_makes_it_and_gymnasium_finds_no_fault() -> None:
    for level in (PASSING, PADS, SLIPPERY):
        env = gymnasium.make("babyrobot/Level-v0", level=level)
        assert isinstance(env.unwrapped, brl.TeamEnv)
        check_env(env.unwrapped, skip_render_check=True)
        assert brl.load(level).make().action_space == gymnasium.spaces.MultiDiscrete([5, 5])


def test_an_observation_tells_where_all_are() -> None:
    env = brl.load(PASSING).make()
    assert env.observation_space == gymnasium.spaces.MultiDiscrete([5, 2, 5, 2, 2, 2])
    row, info = env.reset(seed=1)
    assert row.tolist() == [0, 0, 4, 0, 0, 0]
    assert [mask.tolist() for mask in info["action_mask"]] == [[1, 0, 1, 0, 0], [1, 0, 0, 0, 1]]
    assert info["rewards"].tolist() == [0, 0]
    row, reward, terminated, truncated, info = env.step(np.array([2, 0]))
    assert row.tolist() == [1, 0, 4, 0, 0, 0]
    assert (reward, terminated, truncated) == (-2.0, False, False)
    assert info["rewards"].tolist() == [-1, -1]


def test_one_that_has_arrived_can_only_stay_and_gets_nothing() -> None:
    env = brl.load(PASSING).make()
    env.reset(seed=1)
    for actions in ([0, 4], [2, 4], [2, 3], [2, 0], [2, 0]):
        row, _, terminated, _, info = env.step(actions)
    assert row.tolist() == [4, 0, 2, 1, 1, 0]
    assert info["rewards"].tolist() == [0, -1]
    assert info["action_mask"][0].tolist() == [1, 0, 0, 0, 0]
    assert not terminated
    for action in (1, 4, 4):
        row, _, terminated, _, info = env.step([4, action])
        assert info["rewards"][0] == 0
    assert (row.tolist(), terminated) == ([4, 0, 0, 0, 1, 1], True)


@pytest.mark.parametrize(
    "action", [3, [0, 5], [1], [0, 1, 2], "north", None, [0.5, 1.0], [np.float32(1), 1], [True, 1]]
)
def test_what_is_no_action_is_named(action: Any) -> None:
    env = brl.TeamEnv(PASSING)
    env.reset(seed=0)
    with pytest.raises(gymnasium.error.InvalidAction, match="0 to 4 for each of the 2 robots"):
        env.step(action)


def test_samples_are_allowed_actions() -> None:
    env = brl.TeamEnv(PADS)
    env.action_space.seed(3)
    for seed in range(5):
        _, info = env.reset(seed=seed)
        for _ in range(30):
            actions = env.action_space.sample()
            masks = zip(info["action_mask"], actions, strict=True)
            assert all(mask[action] for mask, action in masks)
            *_, terminated, _, info = env.step(actions)
            if terminated:
                break


@pytest.mark.slow
def test_episodes_are_those_of_the_tables() -> None:
    """The same seed gives the same episode; outcomes are as likely as the tables say."""
    level = brl.load(SLIPPERY)
    mdp = level.compile()
    env = brl.TeamEnv(level, observation="index")
    episodes = []
    for _ in range(2):
        rng, rows = np.random.default_rng(5), []
        state, _ = env.reset(seed=11)
        for _ in range(200):
            actions = rng.integers(5, size=2)
            joint = int(mdp.joint_action(actions))
            after, reward, terminated, _, info = env.step(actions)
            assert mdp.shares is not None
            outcomes = [
                (*outcome[1:], *share)
                for outcome, share in zip(
                    mdp.outcomes(state, joint), mdp.shares[state, joint].tolist(), strict=False
                )
            ]
            assert (after, reward, terminated, *info["rewards"].tolist()) in outcomes
            rows.append((int(after), reward))
            state = env.reset()[0] if terminated else after
        episodes.append(rows)
    assert episodes[0] == episodes[1]


def test_a_level_with_one_robot_and_one_with_several_are_told_apart() -> None:
    with pytest.raises(ValueError, match="one robot"):
        brl.TeamEnv("final-maze")
    for refused in (
        lambda: brl.LevelEnv(PASSING),
        lambda: brl.LevelVectorEnv(PASSING),
        lambda: brl.rollout(PASSING, "random"),
        lambda: brl.solve(PASSING, sight="view"),
    ):
        with pytest.raises(brl.LevelError, match=r"2 robots.*only for levels with one"):
            refused()
    vector = gymnasium.make_vec(
        "babyrobot/Level-v0", num_envs=3, vectorization_mode="sync", level=PASSING
    )
    assert vector.reset(seed=1)[0].shape == (3, 6)


def test_the_optimum_is_followed_in_a_film_and_shown_in_pictures() -> None:
    level = brl.load(PASSING)
    solution = level.solve()
    assert (solution.expected_return, solution.expected_steps) == (-9, 6)
    assert brl.evaluate(level, solution).expected_return == -9
    parts = level.compile().robot_actions(solution.policy)
    assert (parts[solution.policy < 0] == -1).all()
    assert (parts >= 0).all(axis=-1).sum() == (solution.policy >= 0).sum()
    assert level.to_gif(policy=solution)[:3] == b"GIF"
    env = brl.TeamEnv(level, observation="index", render_mode="rgb_array")
    state, _ = env.reset(seed=0)
    frames, total, over = [env.render()], 0.0, False
    while not over:
        actions = level.compile().robot_actions(solution.policy.ravel()[state])
        state, reward, over, _, _ = env.step(actions)
        total += float(reward)
        frames.append(env.render())
    assert total == -9
    assert len(frames) == 7
    assert all((one != other).any() for one, other in pairwise(frames))


def test_positions_are_those_of_all_robots_beside_other_observations_too() -> None:
    env = brl.TeamEnv(PASSING, observation=("index", "position"))
    observation, _ = env.reset(seed=1)
    assert observation["position"].tolist() == [0, 0, 4, 0, 0, 0]
    assert observation in env.observation_space
    moved = env.step([2, 4])[0]["position"]
    assert moved.tolist() == [1, 0, 3, 0, 0, 0]


def test_options_that_a_team_does_not_have_are_refused() -> None:
    env = brl.TeamEnv(PASSING)
    with pytest.raises(ValueError, match="no option 'strat'; known options: none"):
        env.reset(options={"strat": [0, 0]})
    with pytest.raises(ValueError, match="no option `start`"):
        env.reset(options={"start": [0, 0]})
