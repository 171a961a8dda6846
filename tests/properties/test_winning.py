"""Exits are worth reaching: in levels that are generated, and how often at best in any level."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracles.random_things import random_level
from support.worlds import level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.analysis.endings import ending_of, exit_chances
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.generation import search
from babyrobot_levels.generation.search import UnsatisfiableError
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.states import exit_states
from babyrobot_levels.suites.suite import load_suite

pytestmark = pytest.mark.slow

untimed = settings(
    max_examples=min(settings().max_examples, 40),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


@st.composite
def conditions(draw: st.DrawFn) -> dict[str, Any]:
    """Return the fields of a suite: all that can be drawn, and whatever it pays."""
    sides = st.integers(5, 8)
    keys = draw(st.integers(0, 2))
    guards = draw(st.integers(0, 2))
    hits = {"reward": st.sampled_from([-1.0, -8.0, -50.0, 2.0]), "ends": st.booleans()}
    hit = {"hit": draw(st.fixed_dictionaries(hits))} if guards and draw(st.booleans()) else {}
    return {
        "version": 1,
        "kind": "suite",
        "count": 1,
        "seed": draw(st.integers(0, 10**6)),
        "size": [draw(sides), draw(sides)],
        "maze": {"algorithm": ["depth-first", "wilson"], "loops": draw(st.sampled_from([0, 0.6]))},
        "start": draw(st.sampled_from(["corner", "random", "farthest"])),
        "exit": draw(st.sampled_from(["corner", "random", "farthest"])),
        "puddles": draw(st.integers(0, 6)),
        "wind": draw(st.integers(0, 2)),
        "keys": keys,
        "doors": keys + draw(st.integers(0, min(1, keys))),
        "coins": draw(st.integers(0, 2)),
        "guards": guards,
        "rewards": draw(st.just({}) | rewards()),
        "discount": draw(st.sampled_from([1.0, 1.0, 0.9, 0.99])),
        **hit,
    }


def rewards() -> st.SearchStrategy[dict[str, float]]:
    """Return rewards by which it is best to win, or not, or in some of the levels."""
    costs = st.sampled_from([-20.0, -5.0, -1.0, -0.1, 0.0, 0.5])
    return st.fixed_dictionaries(
        {"step": st.sampled_from([-5.0, -1.0, -0.1, 0.0])},
        optional={
            "exit": st.sampled_from([-3.0, 0.0, 1.0, 20.0]),
            **dict.fromkeys(("bump", "stay", "closer", "farther"), costs),
        },
    )


@pytest.fixture(scope="module")
def fewer_tries() -> Iterator[None]:
    """Candidates are given up sooner: many conditions cannot be met."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "MOST_TRIES", 300)
        patch.setattr(search, "MOST_SOLVED", 40)
        yield


@pytest.mark.sweep
@untimed
@given(conditions())
@pytest.mark.usefixtures("fewer_tries")
def test_the_optimal_policy_of_a_generated_level_surely_reaches_the_exit(
    fields: dict[str, Any],
) -> None:
    try:
        level = load_suite(fields)[0]
    except UnsatisfiableError:
        assume(False)
    again = brl.loads(level.to_yaml())
    assert again.digest == level.digest
    assert ("hit" in again.to_dict()) == bool(again.movers)
    solution = solve(again)
    assert solution.exit_probability == pytest.approx(1, abs=1e-9)
    assert ending_of(solution) is None
    # The policy is one of the best, and wins by a computation of its own.
    chances = swept_chances(again, solution)[0]
    assert chances[again.compile().start > 0] == pytest.approx(1, abs=1e-6)


def swept_chances(level: Level, solution: brl.Solution) -> NDArray[np.float64]:
    """Return how likely an exit is reached from each state: by the policy, and by the best one."""
    mdp = level.compile()
    is_exit = exit_states(level, mdp)[mdp.next_state] & mdp.terminal
    policy = solution.policy.ravel()
    rows, chosen = np.arange(mdp.num_states), np.maximum(policy, 0)
    values = np.zeros((2, len(policy)))
    for _ in range(3000):
        ahead = [
            (mdp.probability * np.where(mdp.terminal, is_exit, each[mdp.next_state])).sum(axis=2)
            for each in values
        ]
        after = np.stack([ahead[0][rows, chosen], ahead[1].max(axis=1)])
        after[:, mdp.is_terminal] = 0
        if np.abs(after - values).max() < 1e-13:
            break
        values = after
    return values


def level_with_things(seed: int) -> Level:
    return level_of(random_level(Random(seed)))


@untimed
@given(worlds().map(level_of) | st.integers(0, 10**9).map(level_with_things))
def test_the_chances_of_an_exit_are_those_of_repeated_sweeps(level: Level) -> None:
    assume(level.exits)
    try:
        solution = solve(level)
        starts, own, best = exit_chances(solution)
    except (EpisodeTooLongError, UndefinedReturnError):
        assume(False)
    values = swept_chances(level, solution)
    assert own == pytest.approx(values[0][starts], abs=1e-6)
    assert best == pytest.approx(values[1][starts], abs=1e-6)
    assert (own <= best + 1e-9).all()
    for start, success in zip(starts, own, strict=True):
        ending = ending_of(solution, int(start))
        if ending is None:
            assert success == pytest.approx(1, abs=1e-6)
        else:
            assert ending.success == pytest.approx(success, abs=1e-6)
            assert 0 < ending.share <= 1 - ending.success + 1e-9
