"""Many levels at once are worth what each is alone."""

from __future__ import annotations

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.horizon import best_returns_within, worth_within
from babyrobot_levels.analysis.solver.policies import read_policy, space_of

NAMES = ("frozen-lake", "first-key", "gridworld-3-5", "treasure-chests", "final-maze", "shell-game")


@pytest.mark.parametrize("actions", ["all", "moves", "turns"])
def test_each_level_is_worth_what_it_is_alone(actions: str) -> None:
    levels = [brl.load(name) for name in NAMES]
    limits, discounts = [7, 30, 7, 200, 30, 1], [level.discount for level in levels]
    spaces = [space_of(level, actions) for level in levels]
    best = best_returns_within(spaces, limits, discounts)
    policies = [read_policy("random", space) for space in spaces]
    worth = worth_within(spaces, limits, discounts, policies)
    for number, (level, limit) in enumerate(zip(levels, limits, strict=True)):
        alone = brl.solve(level, actions=actions, within=limit)
        assert best[number] == pytest.approx(alone.expected_return, abs=1e-12)
        by_chance = brl.evaluate(level, "random", actions=actions, within=limit)
        assert worth.returns[number] == pytest.approx(by_chance.expected_return)
        assert worth.success[number] == pytest.approx(by_chance.exit_probability)
        assert worth.steps[number] == pytest.approx(by_chance.expected_steps)


def test_more_states_than_are_solved_together(monkeypatch: pytest.MonkeyPatch) -> None:
    spaces = [space_of(brl.load(name), "all") for name in NAMES]
    ones, limits = [1.0] * len(NAMES), [50] * len(NAMES)
    together = best_returns_within(spaces, limits, ones)
    monkeypatch.setattr("babyrobot_levels.analysis.solver.horizon.MAX_STATES", 30)
    assert np.allclose(best_returns_within(spaces, limits, ones), together, atol=1e-12)
