"""Bounds of the returns that episodes can have, which confidence intervals need."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.extensions.scoring import results


def returns_of(level: brl.Level, steps: int, discount: float) -> list[float]:
    """Return the returns of all episodes there can be."""
    mdp, found = level.compile(), list[float]()

    def go(state: int, step: int, total: float) -> None:
        if step == steps or mdp.is_terminal[state]:
            found.append(total)
            return
        for action in range(mdp.num_actions):
            for _, after, reward, terminal in mdp.outcomes(state, action):
                now = total + discount**step * reward
                go(after, steps if terminal else step + 1, now)

    go(int(np.argmax(mdp.start)), 0, 0.0)
    return found


@pytest.mark.parametrize("rewards", [{"step": -1}, {"step": 1, "exit": -9}, {"step": 0, "bump": 2}])
@pytest.mark.parametrize("discount", [1.0, 0.9])
def test_extremes_are_those_of_all_episodes(
    rewards: Any, discount: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    puddle = {"at": [1, 0], "size": "large"}
    level = brl.load({"version": 1, "size": [3, 1], "puddles": [puddle], "rewards": rewards})
    space, every = space_of(level, "all"), returns_of(level, 5, discount)
    found = results.extremes(space, 5, discount)
    assert found == pytest.approx((min(every), max(every)))
    # Where it would take long, the extremes are outside of these.
    monkeypatch.setattr(results, "_MOST_SWEEPS", 2)
    low, high = results.extremes(space, 5, discount)
    assert low <= min(every) + 1e-9
    assert high >= max(every) - 1e-9
