"""The agent that earns a lower bound: exactly that, in episodes of the environments."""

from __future__ import annotations

import copy
from collections import defaultdict
from fractions import Fraction
from typing import Any

import pytest
from extensions.sight.by_fractions import Beliefs, Place, exact
from extensions.sight.cases import blind, levels_of, parity, slow_solver, walls

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight.policy import SightPolicy
from babyrobot_levels.extensions.sight.solve import solve_sight

Weights = dict[Place, Fraction]


def earned(agent: SightPolicy, slow: Beliefs, now: Weights, steps: int) -> Fraction:
    """Return what an agent earns within so many steps, along all episodes that can be."""
    groups: dict[Any, Weights] = defaultdict(dict)
    for place, weight in now.items():
        groups[slow.seen(place)][place] = weight
    total = Fraction(0)
    for shown, group in groups.items() if steps else ():
        acting = copy.copy(agent)
        after: Weights = defaultdict(Fraction)
        action = slow.actions[acting.act(shown)]
        for (level, state), weight in group.items():
            for chance, target, reward, over in slow.levels[level].outcomes(state, action):
                total += weight * exact(chance) * exact(reward)
                if not over:
                    after[level, target] += weight * exact(chance)
        total += slow.discount * earned(acting, slow, after, steps - 1)
    return total


@pytest.mark.slow
@pytest.mark.parametrize("sight", [blind, parity, walls])
def test_it_earns_the_lower_bound(sight: Any) -> None:
    for seed in range(12):
        levels, options = levels_of(seed), {"sight": sight, "actions": "moves"}
        slow = slow_solver(levels, options)
        found = solve_sight(levels, within=3, discount=1, beliefs=5000, **options)
        starts: Weights = {}
        for chance, belief in slow.start:
            starts |= {place: chance * weight for place, weight in belief}
        agent = found.policy()
        assert float(earned(agent, slow, starts, 3)) == pytest.approx(found.lower, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level", "options"),
    [
        ("shell-game", {"view_radius": 1}),
        pytest.param(
            "treasure-chests", {"view_radius": 1, "actions": "moves"}, marks=pytest.mark.sweep
        ),
        pytest.param("bat-cave", {"view_radius": 1}, marks=pytest.mark.sweep),
    ],
)
def test_scores_find_that_it_earns_the_lower_bound(level: str, options: dict[str, Any]) -> None:
    found = solve_sight(level, "view", gap=0.01, **options)
    scores = brl.score(
        level, found.policy(), observation="view", within=200, episodes=300, seed=1, **options
    )
    (row,) = scores
    assert row.low <= found.lower <= row.high


def test_it_goes_on_where_nothing_was_explored() -> None:
    found = solve_sight("shell-game", "view", view_radius=1, beliefs=3)
    assert not found.is_exact
    env = brl.load("shell-game").make(observation="view", view_radius=1)
    for seed in range(5):
        agent = found.policy(seed)
        agent.reset()
        observation, info = env.reset(seed=seed)
        for _ in range(200):
            action = agent.act(observation, info["action_mask"])
            observation, _, terminated, truncated, info = env.step(action)
            if terminated or truncated:
                break
        assert sum(chance for _, _, chance in agent.belief) == pytest.approx(1)


@pytest.mark.slow
def test_a_seed_draws_the_same_actions() -> None:
    found = solve_sight("shell-game", "view", view_radius=1, beliefs=3)
    options: dict[str, Any] = {"observation": "view", "view_radius": 1, "episodes": 100}
    scores = [brl.score("shell-game", found.policy(5), **options) for _ in range(2)]
    assert scores[0][0].expected_return == scores[1][0].expected_return


def test_another_environment_is_refused() -> None:
    agent = solve_sight("shell-game", "view").policy()
    observation, info = brl.load("bat-cave").make(observation="view").reset(seed=1)
    with pytest.raises(ValueError, match="no episode comes to what was observed in step 0"):
        agent.act(observation, info["action_mask"])
    with pytest.raises(ValueError, match="action_mask"):
        agent.act(observation)
