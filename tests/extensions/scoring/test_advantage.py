"""The mean positive advantage of a policy: against its definition, step by step."""

from __future__ import annotations

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.policies import read_policy, space_of
from babyrobot_levels.extensions.scoring.advantage import mean_positive_advantage


def defined(level: brl.Level, policies: list[np.ndarray], discount: float) -> float:
    """Return it from values by step and a simulation of all states at once, in plain loops."""
    mdp = level.compile()
    limit, going = len(policies), np.flatnonzero(~mdp.is_terminal).tolist()
    values = np.zeros((limit + 1, mdp.num_states))
    gains = np.zeros((limit, mdp.num_states))
    for step in reversed(range(limit)):
        for state in going:
            q = np.zeros(mdp.num_actions)
            for action in range(mdp.num_actions):
                for chance, after, reward, ends in mdp.outcomes(state, action):
                    later = 0.0 if ends else discount * values[step + 1, after]
                    q[action] += chance * (reward + later)
            own = policies[step][state]
            values[step, state] = own @ q
            gains[step, state] = own @ np.maximum(q - own @ q, 0)
    mass, total, steps = mdp.start.copy(), 0.0, 0.0
    for step in range(limit):
        total, steps = total + mass @ gains[step], steps + mass[going].sum()
        before, mass = mass, np.zeros_like(mass)
        for state in going:
            for action, weight in enumerate(policies[step][state]):
                for chance, after, _, ends in mdp.outcomes(state, action):
                    mass[after] += 0.0 if ends else before[state] * weight * chance
    return float(total / steps)


@pytest.mark.parametrize("discount", [1.0, 0.9])
@pytest.mark.parametrize("name", ["frozen-lake", "shell-game", "first-key"])
def test_it_is_as_defined(name: str, discount: float) -> None:
    level = brl.load(name)
    space = space_of(level, "all")
    even = read_policy("random", space)
    found = mean_positive_advantage(space, "random", discount, 12)
    assert found > 0
    assert found == pytest.approx(defined(level, [even] * 12, discount))


def test_a_policy_may_change_with_the_step() -> None:
    level = brl.load("frozen-lake")
    space = space_of(level, "all")
    even = read_policy("random", space)
    best = brl.solve(level).policy
    greedy = read_policy(best, space)
    each = [even, even, greedy, even, greedy, greedy]
    found = mean_positive_advantage(space, np.reshape(each, (6, *space.mdp.shape, 5)), 0.9, 6)
    assert found == pytest.approx(defined(level, each, 0.9))


def test_a_long_limit_comes_near_to_none() -> None:
    for name in ("frozen-lake", "first-key"):
        space = space_of(brl.load(name), "moves")
        endless = mean_positive_advantage(space, "random", 0.95, None)
        assert mean_positive_advantage(space, "random", 0.95, 50_000) == pytest.approx(endless)


def test_rounds_that_repeat_are_summed_up() -> None:
    # Nothing ends the episode, and each step has the same advantages as the one before.
    fields = {"version": 1, "size": [3, 1], "exit": "none", "rewards": {"step": -1, "bump": -3}}
    space = space_of(brl.load(fields), "moves")
    long = mean_positive_advantage(space, "uniform", 1.0, 1_000_000)
    assert long == pytest.approx(mean_positive_advantage(space, "uniform", 1.0, 20_000), rel=1e-3)
    assert 0 < long < 1


def test_a_policy_without_a_choice_has_none() -> None:
    level = brl.load("final-maze")
    space = space_of(level, "all")
    policy = brl.solve(level).policy
    assert mean_positive_advantage(space, policy, 1.0, 200) == 0.0
    assert mean_positive_advantage(space, policy, 1.0, None) == pytest.approx(0, abs=1e-12)


def test_it_is_unknown_where_episodes_never_end() -> None:
    fields = {"version": 1, "size": [2, 1], "exit": "none"}
    space = space_of(brl.load(fields), "all")
    assert np.isnan(mean_positive_advantage(space, "random", 1.0, None))
