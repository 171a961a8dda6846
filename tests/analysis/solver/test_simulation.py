"""Trial runs beside exact values, and what is likely within a number of steps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.chains import world

from babyrobot_levels.analysis.solver.evaluation import evaluate, simulate, success_within
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.catalogue import load

LAKE = "frozen-lake"


@pytest.mark.parametrize(
    ("name", "policy", "discount"),
    [
        ("final-maze", "optimal", 1.0),
        ("glasshouse", "random", 0.99),
        ("four-corners", "uniform", 1.0),
        (LAKE, "optimal", 0.99),
        ("night-watch", "random", 0.95),
        ("shell-game", "optimal", 1.0),
    ],
)
def test_means_are_what_evaluate_expects(name: str, policy: str, discount: float) -> None:
    given = solve(name, discount) if policy == "optimal" else policy
    expected = evaluate(name, given, discount)
    runs = simulate(name, given, 4000, seed=1, discount=discount, within=100_000)
    assert runs.truncated == 0
    assert abs(runs.mean - expected.expected_return) <= 4 * runs.standard_error + 1e-9
    spread = runs.steps.std() / math.sqrt(runs.steps.size)
    assert abs(runs.steps.mean() - expected.expected_steps) <= 4 * spread + 1e-9
    chance = expected.exit_probability
    assert abs(runs.exit_rate - chance) <= 4 * math.sqrt(chance * (1 - chance) / 4000) + 1e-9


def test_the_same_seed_gives_the_same_episodes() -> None:
    one, two, other = (simulate("final-maze", "random", 50, seed) for seed in (7, 7, 8))
    assert one.returns.tolist() == two.returns.tolist()
    assert one.returns.tolist() != other.returns.tolist()
    state = str(np.random.get_state())
    simulate("final-maze", "random", 5)
    assert str(np.random.get_state()) == state


def test_episodes_are_cut_at_the_limit() -> None:
    level = world(rows=["S  E"])
    assert simulate(level, "random", 100, within=2).truncated == 100
    # Who arrives with the last step has arrived.
    east = np.full((1, 4), 2)
    runs = simulate(level, east, 10, within=3)
    assert (runs.truncated, runs.exit_rate, runs.mean, runs.standard_error) == (0, 1.0, -2.0, 0.0)
    assert (runs.steps == 3).all()
    runs = simulate({**level, "max_steps": 2}, east, 10)
    assert (runs.max_steps, runs.truncated, runs.exit_rate) == (2, 10, 0.0)
    assert runs.cut.all()
    assert simulate({**level, "max_steps": 2}, east, 10, within=3).truncated == 0
    assert simulate(level, east).max_steps == 10_000
    assert math.isnan(simulate(level, east, 1).standard_error)
    assert "truncated=10" in repr(runs)
    with pytest.raises(ValueError, match="seed must be a whole number, at least 0"):
        simulate(level, east, seed="a")  # type: ignore[arg-type]
    for wrong in ({"episodes": 0}, {"within": 0}):
        with pytest.raises(ValueError, match=r"at least 1|from 1 on"):
            simulate(level, east, **wrong)  # type: ignore[arg-type]


def test_success_within_grows_to_the_probability_of_an_exit() -> None:
    solution = solve(LAKE)
    chances = [success_within(LAKE, solution, steps) for steps in (0, 5, 6, 50, 500, 10**9)]
    assert chances[:2] == [0, 0]
    assert chances == sorted(chances)
    assert chances[-1] == pytest.approx(solution.exit_probability, abs=1e-12)
    with pytest.raises(ValueError, match="steps must be a whole number, at least 0, not -1"):
        success_within(LAKE, solution, -1)
    with pytest.raises(ValueError, match="give the number of steps"):
        success_within(load("final-maze").replace(max_steps=None), "random")
