"""Episodes with a time limit: against recursion over outcomes, and against what is known."""

from __future__ import annotations

import re
from functools import cache
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import settings
from oracles.random_things import random_level
from support.each import for_each

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.horizon import best_return_within

ACTIONS = ("all", "moves", "turns")

CHEST: dict[str, Any] = {
    "version": 1,
    "size": [6, 1],
    "start": [2, 0],
    "exit": [5, 0],
    "areas": [{"at": [1, 0], "reward": 3, "ends": True}],
    "rewards": {"step": -1, "exit": 10},
}
"""One step to a small reward, three to a large one."""


def worth(level: brl.Level, steps: int, actions: str, policy: Any = None) -> float:
    """Return the best expected return, or that of a policy, by recursion over single outcomes.

    Args:
        level: the level.
        steps: the limit.
        actions: the set of actions.
        policy: a function from state and steps so far to an action; None for the best one.
    """
    turns = actions == "turns"
    mdp = level.compile().turning(level.heading) if turns else level.compile()
    first = 1 if actions == "moves" else 0

    @cache
    def value(state: int, step: int) -> float:
        if step == steps or mdp.is_terminal[state]:
            return 0.0
        taken = range(first, mdp.num_actions)
        if policy is not None:
            taken = range(chosen := first + policy(state, step), chosen + 1)
        return max(
            sum(
                chance * (reward + (0.0 if ends else level_discount * value(following, step + 1)))
                for chance, following, reward, ends in mdp.outcomes(state, action)
            )
            for action in taken
        )

    level_discount = level.discount
    return float(sum(mdp.start[state] * value(state, 0) for state in mdp.start.nonzero()[0]))


@pytest.mark.parametrize("actions", ACTIONS)
@for_each("seed", range(settings().max_examples))
def test_the_optimum_is_what_the_recursion_gives(seed: int, actions: str) -> None:
    level = brl.Level.from_fields(
        {**random_level(Random(seed), things=False), "discount": 1.0 if seed % 4 else 0.9}
    )
    for steps in (1, 2, 6):
        found = brl.solve(level, actions=actions, within=steps)
        assert found.expected_return == pytest.approx(worth(level, steps, actions), abs=1e-12)
        most = best_return_within(level, steps, actions=actions, discount=level.discount)
        assert most == pytest.approx(found.expected_return, abs=1e-12)
        assert found.policies is not None
        table = np.asarray(found.policies).reshape(steps, -1).tolist()
        followed = worth(level, steps, actions, lambda state, step, table=table: table[step][state])
        assert followed == pytest.approx(found.expected_return, abs=1e-12)
        again = brl.evaluate(level, found, actions=actions)
        assert again.within == steps
        assert again.expected_return == pytest.approx(found.expected_return, abs=1e-12)
        assert again.expected_steps == pytest.approx(found.expected_steps)
        assert again.exit_probability == pytest.approx(found.exit_probability)


@pytest.mark.parametrize("actions", ACTIONS)
@for_each("name", ["four-corners", "treasure-chests", "bat-cave", "shell-game", "gridworld-3-5"])
def test_the_best_return_is_what_the_recursion_gives(name: str, actions: str) -> None:
    level = brl.load(name)
    for steps in (0, 1, 7):
        found = best_return_within(level, steps, actions=actions, discount=level.discount)
        assert found == pytest.approx(worth(level, steps, actions))


@pytest.mark.parametrize("name", ["frozen-lake", "bat-cave", "first-key"])
def test_any_policy_within_a_limit(name: str) -> None:
    level = brl.load(name)
    policy = brl.solve(level)
    states = np.asarray(policy.policy).ravel()
    found = brl.evaluate(level, policy, within=7)
    expected = worth(level, 7, "all", lambda state, step: max(0, int(states[state])))
    assert found.expected_return == pytest.approx(expected)
    assert found.exit_probability == pytest.approx(brl.success_within(level, policy, 7))
    assert found.expected_return <= brl.solve(level, within=7).expected_return + 1e-12


def test_the_optimum_depends_on_the_time_that_is_left() -> None:
    returns = [brl.solve(CHEST, within=steps).expected_return for steps in (1, 2, 3)]
    assert returns == [3.0, 3.0, 8.0]
    found = brl.solve(CHEST, within=3)
    assert found.policies is not None
    east, west = brl.Action.EAST, brl.Action.WEST
    # At first to the east; a robot that is still at the start after a step goes west.
    assert found.policies[:2, 0, 2].tolist() == [east, west]
    assert found.policy[0, 2] == east
    assert found.expected_steps == 3.0
    assert found.method == "backward induction"


def test_the_chance_to_cross_the_frozen_lake_in_time() -> None:
    found = brl.solve("frozen-lake", within="max_steps")
    assert found.within == 100
    assert found.expected_return == pytest.approx(0.744190, abs=1e-6)
    assert found.exit_probability == pytest.approx(found.expected_return)
    stationary = brl.evaluate("frozen-lake", brl.solve("frozen-lake"), within="max_steps")
    assert stationary.expected_return < found.expected_return
    assert repr(found).endswith("discount=1 within=100>")
    # Without a limit, 14 in 17 cross it.
    assert best_return_within("frozen-lake", 100) == pytest.approx(found.expected_return)
    assert best_return_within("frozen-lake", 100_000) == pytest.approx(14 / 17)


def test_a_policy_that_never_ends_has_a_finite_worth_within_a_limit() -> None:
    level = {"version": 1, "size": [2, 1], "start": [0, 0], "exit": [1, 0]}
    stays = np.zeros((1, 2), np.int64)
    assert brl.evaluate(level, stays, within=30).expected_return == -30.0
    assert brl.evaluate(level, stays, within=30).exit_probability == 0.0


def test_simulated_episodes_follow_a_policy_by_step() -> None:
    level = brl.load("frozen-lake")
    found = brl.solve(level, within=30)
    runs = brl.simulate(level, found, 20_000, seed=1)
    assert runs.max_steps == 30
    assert runs.mean == pytest.approx(found.expected_return, abs=4 * runs.standard_error)
    assert runs.steps.mean() == pytest.approx(found.expected_steps, rel=0.02)
    by_hand = brl.evaluate(level, np.asarray(found.policies), within=30)
    assert by_hand.expected_return == pytest.approx(found.expected_return)


def test_a_policy_whose_last_steps_change_nothing_may_begin_in_another_way() -> None:
    ends = [{"at": [x, 0], "ends": True, "reward": reward} for x, reward in ((0, 1), (2, 5))]
    level = {"version": 1, "size": [3, 1], "start": [1, 0], "exit": "none", "areas": ends}
    policies = np.full((9, 1, 3), brl.Action.WEST)
    assert brl.evaluate(level, policies, within=9).expected_return == 1.0
    policies[0] = brl.Action.EAST
    assert brl.evaluate(level, policies, within=9).expected_return == 5.0
    assert brl.simulate(level, policies, 10, within=9).mean == 5.0


def test_the_part_of_a_configuration_keeps_the_steps() -> None:
    found = brl.solve("first-key", within=9)
    part = found.at(1)
    assert part.policies is not None
    assert found.policies is not None
    assert part.policies.shape == (9, *part.policy.shape)
    assert (part.policies == found.policies[:, 1]).all()


@pytest.mark.parametrize(
    ("within", "message"),
    [
        (0, "within must be a number of steps from 1 on, or 'max_steps', not 0"),
        (2.5, "within must be a number of steps from 1 on, or 'max_steps', not 2.5"),
        ("all", "within must be a number of steps from 1 on, or 'max_steps', not 'all'"),
        (True, "within must be a number of steps from 1 on, or 'max_steps', not True"),
        ("max_steps", "the level has no max_steps; give a number of steps, such as 200"),
    ],
)
def test_limits_that_are_none(within: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        brl.solve(CHEST, within=within)


def test_a_policy_of_another_limit_is_refused() -> None:
    found = brl.solve(CHEST, within=4)
    with pytest.raises(ValueError, match="episodes of 4 steps; give within=4"):
        brl.evaluate(CHEST, found, within=5)


@pytest.mark.parametrize(
    ("name", "optimum_250", "optimum_450"),
    [
        ("sixteen-rooms", 0.9064, 0.9480),
        ("sixteen-rooms-fewer-doors", 0.8992, 0.9440),
        ("labyrinth", 0.5932, 0.7740),
        ("labyrinth-flipped", 0.5932, 0.7740),
        ("labyrinth-2", 0.5932, 0.7740),
        ("standard-maze", 0.8056, 0.8920),
        ("standard-maze-2", 0.7372, 0.8540),
        ("standard-maze-3", 0.8056, 0.8920),
    ],
)
def test_test_mazes_with_the_reward_of_minigrid(
    name: str, optimum_250: float, optimum_450: float
) -> None:
    # The limit of JaxUED, and that of DCD and minimax: a maze has another optimum in each.
    for limit, optimum in ((250, optimum_250), (450, optimum_450)):
        # The exit pays 1 - 0.9 * steps / limit.
        rewards = {"step": -0.9 / limit, "exit": 1 - 0.9 / limit}
        solution = brl.solve(brl.load(name).replace(rewards=rewards), within=limit, actions="turns")
        assert solution.expected_return == pytest.approx(optimum, abs=1e-9)
