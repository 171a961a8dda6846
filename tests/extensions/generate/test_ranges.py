"""Ranges of `babyrobot generate`: keys, coins, wind."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.library.catalogue import load


def lines(level: brl.Level) -> int:
    if level.wind is None:
        return 0
    pushes = (getattr(level.wind, side) or () for side in ("north", "east", "south", "west"))
    return sum(map(sum, pushes))


@pytest.mark.slow
def test_the_command_takes_ranges(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    command = "generate --count 4 --size 6x6 --keys 1..2 --coins 2 --detour 4.. -o out"
    assert run_here(command.split(), environment(tmp_path)).status == 0
    files = sorted((tmp_path / "out").glob("*.yaml"))
    assert len(files) == 4
    for file in files:
        level = load(file)
        assert sum(item.picture == "coin" for item in level.items) == 2
        assert brl.solve(level).expected_steps < np.inf


def test_the_command_takes_a_range(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    command = "generate --count 4 --size 6x6 --wind 1..2 -o out"
    assert run_here(command.split(), environment(tmp_path)).status == 0
    files = sorted((tmp_path / "out").glob("*.yaml"))
    assert {lines(brl.load(file)) for file in files} <= {1, 2}
    assert "--wind 1..2" in files[0].read_text("utf-8")
