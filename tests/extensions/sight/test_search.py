"""Bounds close, stop when they are told to, and are the same each time."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest
from extensions.sight.cases import blind, walls

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight import TooLargeError, model, solve_sight

Bounds = list[tuple[int, float, float]]


def rounds(*args: Any, **options: Any) -> Bounds:
    """Return the beliefs and both bounds after each round."""
    found: Bounds = []
    solve_sight(*args, progress=lambda *bounds: found.append(bounds), **options)
    return found


@pytest.mark.slow
def test_bounds_close_from_round_to_round() -> None:
    found = rounds("ice-rink", blind, discount=0.9, beliefs=1000)
    beliefs, lower, upper = zip(*found, strict=True)
    assert beliefs[0] == 0
    assert beliefs[-1] == 1000
    assert all(b > a for a, b in pairwise(beliefs))
    assert all(b >= a - 1e-9 for a, b in pairwise(lower))
    assert all(b <= a + 1e-9 for a, b in pairwise(upper))
    assert upper[-1] - lower[-1] < (upper[0] - lower[0]) / 3


@pytest.mark.slow
def test_bounds_are_the_same_each_time() -> None:
    options: dict[str, Any] = {"discount": 0.9, "beliefs": 300}
    assert rounds("ice-rink", walls, **options) == rounds("ice-rink", walls, **options)


def test_the_search_stops_at_a_gap_at_beliefs_and_in_time() -> None:
    wide = solve_sight("ice-rink", blind, discount=0.9, gap=0.5)
    assert 0.05 < wide.gap <= 0.5
    few = solve_sight("ice-rink", blind, discount=0.9, beliefs=10)
    assert few.beliefs == 10
    assert not few.is_exact
    assert not few.is_closed
    assert few.upper > wide.upper
    assert solve_sight("ice-rink", blind, seconds=0).beliefs == 0


def test_a_limit_of_steps_is_the_most_that_is_visited() -> None:
    for within in (1, 2):
        found = solve_sight("ice-rink", blind, discount=1, within=within, beliefs=50)
        assert found._search.found.visits.sum() == pytest.approx(within)


def test_an_interrupt_ends_it() -> None:
    def interrupt(*bounds: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve_sight("ice-rink", blind, progress=interrupt)


def test_what_is_infinite() -> None:
    closed = {"version": 1, "size": [2, 1], "walls": [{"at": [0, 0], "side": "E"}]}
    found = solve_sight({**closed, "rewards": {"step": -1}}, "view")
    assert (found.lower, found.upper, found.full) == (-math.inf,) * 3
    assert found.is_exact
    assert found.cost == (0, 0)
    found = solve_sight({**closed, "rewards": {"step": 1}}, "view")
    assert (found.lower, found.upper) == (math.inf,) * 2


@pytest.mark.beside("scoring")
def test_one_who_does_not_know_the_level() -> None:
    sides = [[0, 0], [2, 0]]
    levels = [
        {"version": 1, "size": [3, 1], "start": [1, 0], "exit": at, "rewards": {"step": -1}}
        for at in sides
    ]
    found = solve_sight(levels, "position")
    # As likely as not, it goes the wrong way, and comes back: two steps more.
    assert (found.full, found.lower, found.upper) == pytest.approx((0, -1, -1))
    assert solve_sight(levels, "view").cost == (0, 0)
    found = solve_sight(levels, "position", weights=[3, 1])
    assert found.upper == pytest.approx(-0.5)
    assert solve_sight(levels, "position", weights=[1, 0]).upper == 0
    (score, other) = brl.score(levels, found.policy(), within=10, episodes=100)
    assert (score.expected_return, other.expected_return) == (0, -2)


def test_levels_of_several_discounts_and_limits() -> None:
    level = {"version": 1, "size": [3, 1], "rewards": {"exit": 1, "step": 0}}
    levels = [{**level, "discount": rate, "max_steps": n} for rate, n in ((1, 5), (0.5, 9))]
    assert solve_sight(levels, "position").upper == pytest.approx((1 + 0.5) / 2)
    with pytest.raises(ValueError, match="several max_steps"):
        solve_sight(levels, "position", within="max_steps")
    with pytest.raises(ValueError, match="there are no levels"):
        solve_sight([], "position")


def test_a_suite_counts_its_weights() -> None:
    suite = brl.load_suite("small-mazes")[:3]
    found = solve_sight(suite, "view", actions="moves")
    best = [brl.solve(level, actions="moves").expected_return for level in suite]
    assert found.full == pytest.approx(sum(best) / 3)
    assert found.lower <= found.upper <= found.full


def test_too_many_states_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(brl.EpisodeTooLongError, match="10,000,000 steps are too many"):
        solve_sight("ice-rink", "view", within=10_000_000)
    monkeypatch.setattr(model, "MAX_OUTCOMES", 100)
    with pytest.raises(TooLargeError, match="more than 100 outcomes"):
        solve_sight("ice-rink", "view")
