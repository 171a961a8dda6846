"""The best return within a number of steps: wrong calls, and very many steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.horizon import best_return_within
from babyrobot_levels.analysis.solver.policies import space_of


def test_an_infinite_return_is_finite_within_a_limit() -> None:
    # From A to A' and back takes 5 steps and gives 10.
    assert brl.solve("gridworld-3-5", discount=1.0).expected_return == float("inf")
    assert best_return_within(brl.load("gridworld-3-5").replace(start=[1, 0]), 1000) == 2000


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("default", -1), "steps must be 0 or more, not -1"),
        (("random-maze", 5), "seed"),
        (("no-such-level", 5), "no-such-level"),
    ],
)
def test_wrong_arguments(given: tuple[str, int], message: str) -> None:
    with pytest.raises((ValueError, LookupError), match=message):
        best_return_within(*given)
    with pytest.raises(ValueError, match="actions"):
        best_return_within("default", 5, actions="jumps")


ENDLESS: dict[str, Any] = {"version": 1, "size": [5, 5], "exit": "none", "rewards": {"step": -1}}
SKID = {"probability": 0.3, "to": "others"}
AREAS = [{"at": [2, 2], "reward": 3}, {"at": [4, 4], "reward": 4}]
# Worth going to only if more than 2,000 steps are left.
FAR: dict[str, Any] = {"size": [3, 1], "start": [0, 0], "areas": []}
FAR["areas"] = [{"at": [1, 0], "reward": -2000}, {"at": [2, 0], "reward": 1}]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fields", "per_step"),
    [
        ({}, -1.0),
        ({"areas": AREAS}, 4.0),
        ({"skid": SKID, "areas": AREAS}, 4.0),
        ({"exit": [4, 4], "rewards": {"step": 0.5}}, 0.5),
        ({**FAR, "rewards": {"step": 0}}, 1.0),
    ],
)
def test_what_repeats_is_added_up_at_once(fields: dict[str, Any], per_step: float) -> None:
    level = brl.Level.from_fields({**ENDLESS, **fields})
    space, steps = space_of(level, "all"), 6_000
    model = space.model()
    values = np.zeros(model.size)
    for _ in range(steps):
        values = model.action_values(values, 1.0).max(axis=1)
    expected = space.at_start(model, values)
    assert best_return_within(level, steps) == pytest.approx(expected, rel=1e-10)
    found = brl.solve(level, within=steps)
    assert found.iterations < steps
    assert found.expected_return == pytest.approx(expected, rel=1e-10)
    assert brl.evaluate(level, found).expected_return == pytest.approx(expected, rel=1e-9)
    most = best_return_within(level, 90_000_000)
    assert most == pytest.approx(90_000_000 * per_step, rel=1e-4)


def test_cycles_of_several_steps_are_added_up_at_once() -> None:
    level = brl.load("gridworld-3-5").replace(start=[1, 0])
    assert best_return_within(level, 90_000_000) == 180_000_000
    assert best_return_within(level, 90_000_001) == 180_000_010


def test_small_gains_are_not_lost_in_many_steps() -> None:
    # Two bumps of the same value but for little: the better one, each time.
    rewards = {"step": -1, "stay": -1, "bump": -1 + 5e-5}
    found = brl.solve({**ENDLESS, "size": [2, 1], "rewards": rewards}, within=100_000)
    assert found.expected_return == pytest.approx(-99995, abs=1e-5)
    followed = brl.evaluate(found.level, found).expected_return
    assert followed == pytest.approx(found.expected_return, abs=1e-5)


@pytest.mark.slow
def test_what_does_not_repeat_has_a_bound_of_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("babyrobot_levels.analysis.solver.horizon.MAX_WORK", 10**9)
    level = brl.Level.from_fields({**ENDLESS, "discount": 0.999999, "skid": SKID})
    with pytest.raises(brl.EpisodeTooLongError, match="within 50,000,000 steps takes too long"):
        best_return_within(level, 50_000_000, discount=0.999999)
    with pytest.raises(brl.EpisodeTooLongError, match="takes too long"):
        brl.evaluate(level, "random", within=50_000_000)
    with pytest.raises(brl.EpisodeTooLongError, match="within 50,000,000 steps is too large"):
        brl.solve(level, within=50_000_000)
