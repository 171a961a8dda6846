"""Agents as tables: each form of agent does in a table what it does in scores."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.plays import forged, record, recorded

import babyrobot_levels as brl


def east_or_south(position: Any) -> int:
    return 2 if position[0] < 3 else 3


def test_a_table_has_the_axes_of_the_level_and_the_actions() -> None:
    level = brl.load("first-key")
    shape = level.compile().shape
    assert brl.policy_table(level, "random", actions="moves").shape == (*shape, 4)
    turning = brl.policy_table(level, "random", actions="turns")
    assert turning.shape == (shape[0], 4, *shape[1:], 3)


def test_a_mapping_has_a_policy_for_each_level() -> None:
    best = {name: brl.solve(name) for name in ("frozen-lake", "maze")}
    table = brl.policy_table("maze", best)
    assert (table.argmax(axis=-1) == np.maximum(best["maze"].policy, 0)).all()
    with pytest.raises(ValueError, match="no policy for the level 'puddles'"):
        brl.policy_table("puddles", best)


def test_recorded_episodes_are_the_shares_of_their_actions(tmp_path: Path) -> None:
    record(tmp_path / "a.brlplay", "frozen-lake", "moves", episodes=9)
    plays = brl.read_plays(tmp_path / "a.brlplay")
    table = brl.policy_table("frozen-lake", plays).reshape(16, 5)
    steps = [(s, a + 1) for play in plays for s, a in zip(play.states, play.actions, strict=False)]
    for state in range(16):
        taken = [action for where, action in steps if where == state]
        if not taken:
            assert np.isnan(table[state]).all()
            continue
        counts = np.bincount(taken, minlength=5)
        assert table[state] == pytest.approx(counts / counts.sum())


def test_episodes_that_cannot_count_are_refused(tmp_path: Path) -> None:
    play = recorded(tmp_path, "frozen-lake")
    for wrong, level, told in (
        (play, "maze", "episode 1: it is one of another level"),
        (forged(play, states=[*play.states[:-1], 99]), "frozen-lake", "episode 1: "),
        (recorded(tmp_path, "frozen-lake", "turns", 1), "frozen-lake", "its robot turns"),
    ):
        with pytest.raises(ValueError, match=told):
            brl.policy_table(level, [wrong])


def test_what_is_no_table_is_refused() -> None:
    class Memory:
        def reset(self) -> None: ...
        def act(self, observation: Any, mask: Any) -> int:
            return 0

    with pytest.raises(TypeError, match="an agent with memory"):
        brl.policy_table("maze", Memory())
    with pytest.raises(ValueError, match="changes with the step"):
        brl.policy_table("frozen-lake", brl.solve("frozen-lake", within=100))
