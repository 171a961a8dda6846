"""Rows with too many outcomes are refused whatever else there is in the level."""

from __future__ import annotations

from typing import Any

import pytest

import babyrobot_levels as brl

STARTS = [[x, y] for y in range(7) for x in range(10)]
LOST: dict[str, Any] = {
    "version": 1,
    "size": [10, 8],
    "start": STARTS,
    "exit": [9, 7],
    "warps": [{"at": [0, 7], "to": "start"}],
}


@pytest.mark.parametrize(
    "things",
    [
        {"boxes": [{"at": [5, 7]}]},
        {"items": [{"name": "key", "at": [5, 7]}]},
        {"switches": [{"name": "lever", "at": [5, 7]}]},
    ],
)
def test_among_things_they_are_refused(things: dict[str, Any]) -> None:
    with pytest.raises(brl.LevelError, match=r"BR405.*a warp leads to one of 70 starts"):
        brl.load({**LOST, **things}).compile()


def test_without_things_they_are_allowed() -> None:
    assert brl.load(LOST).compile().probability.shape == (80, 5, 70)
