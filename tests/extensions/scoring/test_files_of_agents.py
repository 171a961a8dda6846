"""Agents in files are scored as what they were saved from."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.agents.agents import load_policy

NAMES = ["frozen-lake", "first-key"]


@pytest.mark.slow
def test_policies_come_back(tmp_path: Path) -> None:
    policies: dict[str, Any] = {name: brl.solve(name).policy for name in NAMES}
    np.save(tmp_path / "one.npy", policies["frozen-lake"])
    np.savez(tmp_path / "all.npz", **policies)
    lists = {name: policy.tolist() for name, policy in policies.items()}
    (tmp_path / "all.json").write_text(json.dumps(lists))
    (tmp_path / "one.json").write_text(json.dumps(lists["frozen-lake"]))
    expected = brl.score(NAMES, policies)
    for name in ("all.npz", "all.json"):
        assert [*brl.score(NAMES, load_policy(tmp_path / name))] == [*expected]
    for name in ("one.npy", "one.json"):
        assert brl.score(NAMES[0], load_policy(tmp_path / name))[0] == expected[0]


def test_a_model_is_not_loaded_without_trust(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "model.zip", "w") as archive:
        archive.writestr("data", b'{"policy_class": {"__module__": "os"}}')
    model = str(tmp_path / "model.zip")
    result = run_here(["score", model, "maze"], environment(tmp_path))
    assert result.status == 2
    assert "loading a model can run any code" in result.err
    trusted = run_here(["score", model, "maze", "--trust"], environment(tmp_path))
    assert "is not a model" in trusted.err
