"""How episodes of the optimal policy end instead of reaching an exit, cause by cause."""

from __future__ import annotations

from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.endings import ending_of

HOLE: dict[str, Any] = {"size": [6, 3], "areas": [{"at": [1, 1], "color": "black", "ends": True}]}
GUARD: dict[str, Any] = {
    "size": [8, 3],
    "start": [0, 0],
    "exit": [7, 2],
    "movers": [{"name": "rex", "path": [[3, 1], [4, 1]], "back": True}],
    "hit": {"reward": -2},
}
LOOP: dict[str, Any] = {"size": [4, 1], "rewards": {"step": -1, "stay": 1}, "discount": 0.9}
ICE: dict[str, Any] = {
    "size": [4, 2],
    "areas": [{"at": [1, 1], "size": [2, 1], "color": "black", "ends": True}],
    "exit": [3, 0],
    "blocked": [{"at": [3, 1]}],
    "skid": 0.5,
}


def solved(fields: Any, **how: Any) -> Any:
    given = fields if isinstance(fields, str) else {"version": 1, **fields}
    return brl.solve(given, **how)


@pytest.mark.parametrize(
    ("fields", "how", "limit", "success", "told"),
    [
        (HOLE, {}, "", "0 %", "100 % end at [1, 1]"),
        (GUARD, {}, "", "0 %", "100 % end by a hit of `rex`"),
        (GUARD, {"actions": "turns"}, "", "0 %", "100 % end by a hit of `rex`"),
        (LOOP, {}, "", "0 %", "100 % never end"),
        (LOOP, {"within": 7}, " within 7 steps", "0 %", "100 % are cut off after 7 steps"),
        ({**LOOP, "max_steps": 9}, {}, " without a limit", "0 %", "100 % never end"),
        ("frozen-lake", {}, " without a limit", "82.4 %", "17.6 % end at [3, 1]"),
        (
            "frozen-lake",
            {"within": 100},
            " within 100 steps",
            "74.4 %",
            "18.4 % end at [3, 1], 7.15 % otherwise",
        ),
    ],
)
def test_an_ending_is_told_by_what_ends_most_episodes(
    fields: Any, how: dict[str, Any], limit: str, success: str, told: str
) -> None:
    found = ending_of(solved(fields, **how))
    assert found is not None
    assert found.told == f"reaches an exit in {success} of the episodes; {told}"
    assert found.text == f"the optimal policy{limit} {found.told}"


@pytest.mark.parametrize(
    ("fields", "how"),
    [
        ({"size": [6, 3]}, {}),
        ({"size": [6, 3], "exit": "none", "rewards": {"step": 0}}, {}),
        # The limit is so large that its episodes would take long to follow.
        ({**LOOP, "size": [2, 1]}, {"within": 1_000_000}),
    ],
    ids=["sure", "no exit", "too long"],
)
def test_nothing_is_told_of(fields: dict[str, Any], how: dict[str, Any]) -> None:
    assert ending_of(solved(fields, **how)) is None


def test_shares_are_those_of_simulated_episodes() -> None:
    level = brl.load({"version": 1, "max_steps": 40, **ICE})
    solution = brl.solve(level, within="max_steps")
    found = ending_of(solution)
    assert found is not None
    assert found.cell == (1, 1)
    episodes = brl.simulate(level, solution, 20_000, seed=1)
    assert found.success == pytest.approx(episodes.at_exit.mean(), abs=0.01)
    elsewhere = (~episodes.at_exit & ~episodes.cut).mean()
    assert found.share < elsewhere + 0.01


def test_an_ending_may_be_that_of_one_start() -> None:
    fields = {**HOLE, "start": [[0, 0], [4, 2]]}
    solution = solved(fields)
    both = ending_of(solution)
    near, far = (ending_of(solution, state) for state in (16, 0))
    assert (both and both.share, near, far and far.share) == (0.5, None, 1.0)


def test_an_ending_may_pay() -> None:
    fields = {"size": [6, 3], "areas": [{"at": [1, 1], "color": "gold", "ends": True, "reward": 5}]}
    found = ending_of(solved(fields))
    assert found is not None
    assert (found.cell, found.reward, found.goes_on) == ((1, 1), 5.0, False)
