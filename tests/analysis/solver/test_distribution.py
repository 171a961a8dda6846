"""The distribution of a policy's return: against recursion, exact averages and simulation."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver import distribution


def recursive(level: brl.Level, steps: int, discount: float) -> dict[float, float]:
    """Return the distribution for the random policy, one outcome after the other."""
    mdp = level.compile()
    found: defaultdict[float, float] = defaultdict(float)

    def follow(state: int, left: int, chance: float, total: float, factor: float) -> None:
        if not left:
            found[round(total, 9)] += chance
            return
        possible = mdp.action_mask[state].nonzero()[0]
        for action in possible:
            for probability, following, reward, ends in mdp.outcomes(state, int(action)):
                follow(
                    following,
                    0 if ends else left - 1,
                    chance * probability / len(possible),
                    total + factor * reward,
                    factor * discount,
                )

    for state in mdp.start.nonzero()[0]:
        follow(int(state), steps, float(mdp.start[state]), 0.0, 1.0)
    return dict(found)


@pytest.mark.parametrize("discount", [1.0, 0.9])
@pytest.mark.parametrize("name", ["four-corners", "shell-game"])
def test_it_is_what_the_recursion_gives(name: str, discount: float) -> None:
    level = brl.load(name)
    expected = recursive(level, 5, discount)
    found = brl.return_distribution(level, "random", 5, discount=discount)
    assert found.episodes == 0
    assert found.values == pytest.approx(sorted(expected), abs=1e-9)
    assert found.probabilities == pytest.approx([expected[each] for each in sorted(expected)])


@pytest.mark.parametrize("name", ["final-maze", "treasure-chests"])
def test_its_mean_is_the_exact_average(name: str) -> None:
    solution = brl.solve(name)
    found = brl.return_distribution(name, solution)
    assert found.episodes == 0
    assert found.mean == pytest.approx(solution.expected_return, abs=1e-9)
    assert found.probabilities.sum() == pytest.approx(1.0)


@pytest.mark.parametrize(("name", "policy"), [("frozen-lake", "best"), ("bat-cave", "random")])
def test_episodes_that_are_truncated_count_with_what_they_have(name: str, policy: str) -> None:
    level = brl.load(name)
    steps = 12
    taken = "random" if policy == "random" else brl.solve(level)
    found = brl.return_distribution(level, taken, steps)
    exact = brl.evaluate(level, taken, within=steps).expected_return
    assert found.mean == pytest.approx(exact)


def test_the_frozen_lake_is_crossed_or_not() -> None:
    found = brl.return_distribution("frozen-lake", brl.solve("frozen-lake"))
    assert found.values.tolist() == [0.0, 1.0]
    assert found.probabilities[1] == pytest.approx(
        brl.success_within("frozen-lake", brl.solve("frozen-lake"))
    )
    chance = found.probabilities[1]
    assert found.standard_deviation == pytest.approx((chance * (1 - chance)) ** 0.5)


@pytest.mark.parametrize("policy", ["random", "by step"])
@pytest.mark.parametrize("name", ["first-key", "puddles", "frozen-lake"])
def test_counted_returns_are_those_that_are_followed(
    name: str, policy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken = policy if policy == "random" else brl.solve(name, within=15)
    counted = brl.return_distribution(name, taken, 15)
    monkeypatch.setattr(distribution, "MAX_PRODUCTS", -1)
    followed = brl.return_distribution(name, taken, 15)
    assert counted.episodes == followed.episodes == 0
    assert counted.values == pytest.approx(followed.values)
    assert counted.probabilities == pytest.approx(followed.probabilities)


@pytest.mark.slow
def test_many_steps_of_chance_are_still_exact_as_far_as_memory_allows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    level = brl.load_suite("bench-hard").split("test")[0]
    found = brl.return_distribution(level, "random")
    assert found.episodes == 0
    exact = brl.evaluate(level, "random", within="max_steps")
    assert found.mean == pytest.approx(exact.expected_return)
    monkeypatch.setattr(distribution, "MAX_AT_ONCE", 10_000)
    monkeypatch.setattr(distribution, "EPISODES", 100)
    assert brl.return_distribution(level, "random").episodes == 100


@pytest.mark.slow
def test_where_returns_are_too_many_episodes_are_simulated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distribution, "EPISODES", 1000)
    found = brl.return_distribution("gridworld-3-5", "random")
    assert found.episodes == 1000
    exact = brl.evaluate("gridworld-3-5", "random", within=1000).expected_return
    assert found.mean == pytest.approx(exact, abs=0.6)
    again = brl.return_distribution("gridworld-3-5", "random")
    assert np.array_equal(found.values, again.values)


def test_quantiles_are_returns_that_are_possible() -> None:
    found = brl.return_distribution("frozen-lake", brl.solve("frozen-lake"))
    lost = found.probabilities[0]
    assert found.quantiles(np.array([0.0, lost / 2, lost, lost + 0.01, 1.0])).tolist() == [
        0.0,
        0.0,
        0.0,
        1.0,
        1.0,
    ]


def test_no_steps_are_no_episode() -> None:
    with pytest.raises(ValueError, match="within must be a number of steps from 1 on"):
        brl.return_distribution("default", "random", 0)


@pytest.mark.parametrize("share", [0.01, 0.25, 0.5, 1.0])
def test_the_cvar_is_the_largest_value_of_its_dual(share: float) -> None:
    level = brl.load("four-corners")
    expected = recursive(level, 6, 0.9)
    values, chances = np.array([*expected]), np.array([*expected.values()])
    # Rockafellar and Uryasev: the maximum over v of v - E[max(v - return, 0)] / share.
    best = max(v - chances @ np.maximum(v - values, 0) / share for v in values)
    found = brl.return_distribution(level, "random", 6, discount=0.9)
    assert found.cvar(share) == pytest.approx(best, abs=1e-9)


def test_a_share_of_episodes_is_more_than_none() -> None:
    found = brl.return_distribution("four-corners", "random", 5)
    for share in (0.0, 1.5, float("nan")):
        with pytest.raises(ValueError, match=r"^share must be above 0"):
            found.cvar(share)
