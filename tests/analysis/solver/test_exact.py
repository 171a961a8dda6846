"""Values as fractions: those of textbooks, against elimination by hand, and against floats."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_things import random_level
from support.combinations import swept

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver import exact
from babyrobot_levels.analysis.solver.optimum import TOLERANCE, solve
from babyrobot_levels.analysis.solver.results import (
    EpisodeTooLongError,
    ExactSolution,
    NotExactError,
    UndefinedReturnError,
)

LARGEST_ERROR = 1e-10
"""By which share of the largest value the solver in floating point may be wrong."""


@pytest.mark.parametrize(
    ("name", "worth", "steps", "success"),
    [
        ("frozen-lake", "14/17", "828/17", "14/17"),
        ("frozen-lake-8x8", "1", "63629/544", "1"),
        ("russell-norvig-4x3", "21763/29200", "7805/1168", "72/73"),
        ("final-maze", "-439/12", "143/6", "1"),
        ("ice-vault", "-51371/12920", "400211/12920", "1"),
        ("gridworld-3-5", "729000/40951", float("inf"), "0"),
    ],
)
def test_levels_show_their_fractions(
    name: str, worth: str, steps: str | float, success: str
) -> None:
    found = solve(name, exact=True)
    assert found.expected_return == Fraction(worth)
    assert found.expected_steps == (Fraction(steps) if isinstance(steps, str) else steps)
    assert found.exit_probability == Fraction(success)
    assert f"expected_return={worth} " in repr(found)


def test_values_of_a_textbook_cell_by_cell() -> None:
    # Russell and Norvig, figure 16.3: there, a reward is that of the state that is left.
    found = solve("russell-norvig-4x3", exact=True)
    printed = {(0, 0): 812, (1, 0): 868, (2, 0): 918, (0, 1): 762, (2, 1): 660}
    printed |= {(0, 2): 705, (1, 2): 655, (2, 2): 611, (3, 2): 388}
    for (x, y), thousandths in printed.items():
        assert round(1000 * (found.values[y, x] - Fraction(4, 100))) == thousandths


def test_numbers_are_the_decimals_of_the_file() -> None:
    level = {"version": 1, "size": [2, 1], "skid": 0.1, "rewards": {"step": -0.3, "bump": -0.7}}
    found = solve(level, exact=True)
    # A skid has nowhere else to go: it costs a step. The step onto the exit costs nothing.
    assert found.expected_return == Fraction(-3, 10) * Fraction(1, 9)
    # A third of a skid is no decimal.
    thirds = {"version": 1, "size": [3, 3], "skid": {"probability": 0.4, "to": "others"}}
    exit_chance = solve(thirds, exact=True).action_values[2, 1, 2]
    assert exit_chance.denominator % 3 == 0
    # 0.3 has the digits of a decimal, the other one all that a float has.
    assert (exact.exactly(0.3), exact.exactly(1 / 3)) == (Fraction(3, 10), Fraction(1, 3))
    assert exact.exactly(0.6666666666666667) == exact.exactly(2 / 3) == Fraction(2, 3)


MOST_STATES = 500
"""Larger levels would take most of the time."""


def _eliminated(matrix: list[list[Fraction]]) -> list[Fraction]:
    """Return the solution of a system, the right side of which is the last column."""
    size = len(matrix)
    for at in range(size):
        pivot = next(row for row in range(at, size) if matrix[row][at])
        matrix[at], matrix[pivot] = matrix[pivot], matrix[at]
        head = matrix[at][at]
        matrix[at] = [value / head for value in matrix[at]]
        for row in range(size):
            if row != at and (factor := matrix[row][at]):
                matrix[row] = [a - factor * b for a, b in zip(matrix[row], matrix[at], strict=True)]
    return [row[-1] for row in matrix]


@pytest.mark.slow
def test_the_policy_is_worth_its_values_and_no_action_is_better() -> None:
    level = brl.load("ice-vault")
    found, mdp = solve(level, exact=True), level.compile()
    values, policy = found.values.ravel(), found.policy.ravel()
    states = np.flatnonzero(~mdp.is_terminal).tolist()

    def outcomes(state: int, action: int) -> list[tuple[Fraction, Fraction, int | None]]:
        """Return probability, reward and next state; the tables hold floats of few digits."""
        return [
            (
                Fraction(float(mdp.probability[state, action, one])).limit_denominator(1000),
                Fraction(str(float(mdp.reward[state, action, one]))),
                None
                if mdp.terminal[state, action, one]
                else int(mdp.next_state[state, action, one]),
            )
            for one in np.flatnonzero(mdp.probability[state, action])
        ]

    place = {state: row for row, state in enumerate(states)}
    matrix = [[Fraction(0)] * (len(states) + 1) for _ in states]
    for state, row in place.items():
        matrix[row][row] += 1
        for chance, reward, following in outcomes(state, policy[state]):
            matrix[row][-1] += chance * reward
            if following is not None:
                matrix[row][place[following]] -= chance
    assert [values[state] for state in states] == _eliminated(matrix)
    greedy = found.greedy.reshape(len(values), -1)
    for state in states:
        for action in range(mdp.probability.shape[1]):
            ahead = sum(
                chance * (reward + (0 if following is None else values[following]))
                for chance, reward, following in outcomes(state, action)
            )
            assert ahead <= values[state]
            assert greedy[state, action] == (ahead == values[state])


def _agree(fields: dict[str, Any], **how: Any) -> bool:
    """Check that the solver in floating point is right; return whether there was something."""
    try:
        if brl.load(fields).compile().num_states > MOST_STATES:
            return False
        floats = solve(fields, **how)
    except (UndefinedReturnError, EpisodeTooLongError, brl.LevelError):
        return False
    found = solve(fields, exact=True, **how)
    pairs = list(zip(floats.values.ravel().tolist(), found.values.ravel().tolist(), strict=True))
    finite = [(a, b) for a, b in pairs if isinstance(b, Fraction)]
    assert all(a == b or a != a for a, b in pairs if not isinstance(b, Fraction))
    scale = max((abs(float(b)) for _, b in finite), default=0.0)
    assert all(abs(a - b) <= LARGEST_ERROR * max(1.0, scale) for a, b in finite)
    # What is optimal in fractions is so for floats, which also take what loses next to nothing.
    assert not (found.greedy & ~floats.greedy).any()
    assert all(lost <= TOLERANCE * max(1.0, scale) for lost in _lost(found, floats))
    return bool(finite)


def _lost(exact: ExactSolution, floats: brl.Solution) -> list[float]:
    """Return what is lost by each action that is optimal for floats, and not in fractions."""
    only = floats.greedy & ~exact.greedy
    best = np.broadcast_to(exact.values[..., None], only.shape)
    return [
        float(most - value)
        for most, value in zip(best[only], exact.action_values[only], strict=True)
    ]


def _exit_or_pit(exit_reward: int, pit_reward: int) -> tuple[brl.Solution, ExactSolution]:
    """Solve a level with an exit and a pit that is nearer, in floating point and in fractions."""
    fields = {
        "version": 1,
        **{"size": [4, 1], "start": [1, 0], "exit": [3, 0]},
        "areas": [{"at": [0, 0], "ends": True, "reward": pit_reward}],
        "rewards": {"step": 0, "exit": exit_reward},
    }
    return solve(fields), solve(fields, exact=True)


def test_policies_differ_where_less_than_the_tolerance_is_lost() -> None:
    # The pit pays less by a share of 1e-10: a tie for floats, though not for their policy.
    floats, found = _exit_or_pit(10**10, 10**10 - 1)
    assert _lost(found, floats) == [1.0]
    assert (floats.policy == found.policy).all()
    # By a share of 1e-13, which is within rounding, their policy may take the pit for the best.
    floats, found = _exit_or_pit(10**13, 10**13 - 1)
    assert _lost(found, floats) == [1.0]
    assert found.policy[0, 1] == brl.Action.EAST
    assert floats.policy[0, 1] in (brl.Action.EAST, brl.Action.WEST)
    # A difference above the tolerance is none for either.
    floats, found = _exit_or_pit(10**10, 10**10 - 100)
    assert (floats.greedy == found.greedy).all()
    assert (floats.policy == found.policy).all()


SMALL = ("frozen-lake", "russell-norvig-4x3", "gridworld-3-5", "puddle-test", "first-key")
OTHERS = sorted({info.name for info in brl.levels()} - {*SMALL, "random-maze"})


@pytest.mark.parametrize("name", swept(SMALL, OTHERS))
def test_policies_of_the_gallery_are_the_same(name: str) -> None:
    level = brl.load(name)
    if level.has_random_maze or level.compile().num_states > MOST_STATES:
        return
    for actions in ("all",) if level.robots or level.moves == 8 else ("all", "turns"):
        floats, found = (solve(level, actions=actions, exact=exact) for exact in (False, True))
        assert (floats.greedy == found.greedy).all()
        taken = floats.policy[floats.policy >= 0]
        of_these = found.greedy[floats.policy >= 0]
        assert of_these[np.arange(len(taken)), taken].all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed", [*range(2), *(pytest.param(s, marks=pytest.mark.sweep) for s in range(2, 50))]
)
def test_floats_are_right_to_rounding(seed: int) -> None:
    random, checked = Random(seed), 0
    for number in range(10):
        fields = random_level(random)
        how = ({}, {"discount": 0.95}, {"actions": "turns"}, {"actions": "moves"})[number % 4]
        checked += _agree(fields, **how)
    assert checked >= 3


@pytest.mark.slow
def test_what_cannot_be_told_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(NotExactError, match="up to 3,000 states, not 4,095"):
        solve({"version": 1, "size": [64, 64]}, exact=True)
    digits = {"version": 1, "size": [2, 2], "skid": 0.123456789, "rewards": {"step": -1.23456789}}
    with pytest.raises(NotExactError, match="fewer decimals"):
        solve(digits, exact=True)
    with pytest.raises(ValueError, match="leave `within` out"):
        solve("maze", within=5, exact=True)  # type: ignore[call-overload]
    monkeypatch.setitem(__import__("sys").modules, "flint", None)
    with pytest.raises(NotExactError, match="install the extra `exact`"):
        solve("maze", exact=True)
