"""Monte Carlo prediction: the means are what a policy is worth, but for chance."""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from support.worlds import World

from babyrobot_levels.analysis.solver.evaluation import evaluate, simulate
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.extensions.learning.algorithms import monte_carlo
from babyrobot_levels.library.catalogue import load

# Two starts, chance in the steps and in the rewards, and a way round that comes back.
WORLD: World = {
    "version": 1,
    "size": [3, 2],
    "start": [[0, 0], [0, 1]],
    "exit": [2, 1],
    "skid": 0.3,
    "puddles": [{"at": [1, 0]}],
    "warps": [{"at": [2, 0], "to": "start", "reward": -7}],
}


def estimates(level: Any, seeds: int, **arguments: Any) -> Any:
    runs = []
    for seed in range(seeds):
        *_, sweep = monte_carlo(level, seed=seed, **arguments)
        runs.append(sweep.values)
    return np.array(runs)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level", "first_visit"),
    [("russell-norvig-4x3", True), (WORLD, False)],
    ids=["first visits", "every visit"],
)
def test_each_cell_is_worth_what_the_exact_values_say(level: Any, first_visit: bool) -> None:
    runs = estimates(level, 20, episodes=120, first_visit=first_visit, discount=0.9)
    exact = evaluate(level, "random", 0.9).values
    error = runs.std(axis=0, ddof=1) / np.sqrt(len(runs))
    visited = (runs != 0) & ~np.isnan(exact)
    # Nobody ever stands on the warp: what it would be worth, no episode can tell.
    assert visited.all(axis=0).sum() == (9 if isinstance(level, str) else 4)
    assert (visited.all(axis=0) == visited.any(axis=0)).all()
    assert (np.abs(runs.mean(axis=0) - exact) <= 4 * error)[visited[0]].all()


def test_the_start_is_worth_what_trial_runs_return() -> None:
    name = "final-maze"
    policy = solve(name)
    *_, sweep = monte_carlo(name, policy, 400)
    ((x, y),) = load(name).starts
    spread = simulate(name, policy, 400).standard_error
    assert spread > 0
    assert abs(sweep.values[y, x] - policy.expected_return) <= 4 * spread


def test_first_visits_and_every_visit_count_differently() -> None:
    first, every = (
        list(monte_carlo("frozen-lake", first_visit=first_visit, episodes=50))[-1].values
        for first_visit in (True, False)
    )
    assert (first != every).any()


def test_it_yields_after_every_so_many_episodes_and_at_the_end() -> None:
    sweeps = list(monte_carlo("frozen-lake", episodes=25, every=10))
    assert [sweep.number for sweep in sweeps] == [10, 20, 25]
    changes = [np.abs(after.values - before.values).max() for before, after in pairwise(sweeps)]
    assert [sweep.delta for sweep in sweeps[1:]] == changes
    *_, other = monte_carlo("frozen-lake", episodes=25, every=25)
    np.testing.assert_array_equal(other.values, sweeps[-1].values)


@pytest.mark.slow
def test_the_seed_decides_and_global_chance_is_left_alone() -> None:
    before = random.getstate(), np.random.get_state()[1].tolist()  # type: ignore[index]
    one, same = estimates("frozen-lake", 1), estimates("frozen-lake", 1)
    *_, other = monte_carlo("frozen-lake", seed=1)
    np.testing.assert_array_equal(one, same)
    assert (one[0] != other.values).any()
    assert before == (random.getstate(), np.random.get_state()[1].tolist())  # type: ignore[index]


def test_episodes_without_end_are_cut_off() -> None:
    level = {"version": 1, "size": [1, 1], "exit": "none", "max_steps": 9}
    (sweep,) = monte_carlo(level, episodes=2)
    assert sweep.values.tolist() == [[-9.0]]
    (unlimited,) = monte_carlo({**level, "max_steps": None}, episodes=1)
    assert unlimited.values.tolist() == [[-10_000.0]]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: monte_carlo("maze", episodes=0), "episodes"),
        (lambda: monte_carlo("maze", every=0), "every"),
        (lambda: monte_carlo("maze", discount=0), "discount"),
        (lambda: monte_carlo("maze", seed=-1), "seed must be a whole number, at least 0, not -1"),
        (lambda: monte_carlo("maze", "rando"), "random"),
    ],
)
def test_wrong_arguments_are_told_at_once(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
