"""What files, seeds and ids stand for stays: `tests/oracles/kept.py` recorded it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from oracles import kept
from support.sessions import environment, run_here

import babyrobot_levels as brl

RECORDED: dict[str, Any] = json.loads(kept.FILE.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def today() -> dict[str, Any]:
    return kept.kept()


@pytest.mark.parametrize("kind", RECORDED)
def test_it_is_what_it_was(kind: str, today: dict[str, Any]) -> None:
    assert today[kind] == RECORDED[kind]


@pytest.mark.parametrize("name", RECORDED["share codes"])
def test_share_codes_are_read(name: str) -> None:
    assert brl.load(RECORDED["share codes"][name]).digest == RECORDED["digests"][name]


def test_a_pack_can_be_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    variables = environment(tmp_path)
    assert run_here(["install", str(kept.FILE.with_suffix(".brlpack"))], variables).status == 0
    shown = run_here(["show", "kept/first", "--format", "json"], variables)
    assert json.loads(shown.out)["title"] == "First"


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (["--version"], 0),
        (["list"], 0),
        (["fly"], 2),
        (["list", "--wings"], 2),
        (["show", "nowhere"], 2),
        (["validate", "broken.yaml"], 1),
        (["validate", "missing.yaml"], 1),
        (["lint", "smelly.yaml"], 1),
        (["lint", "smelly.yaml", "--select", "BR999"], 2),
        (["compare", "final-maze", "default"], 1),
        (["diff", "maze", "maze"], 0),
        (["diff", "maze", "maze-changed"], 1),
        (["format", "--check", "broken.yaml"], 1),
        (["export", "frozen-lake", "--to", "frozen-lake"], 0),
        (["export", "final-maze", "--to", "sokoban", "--strict"], 1),
    ],
)
def test_exit_statuses(
    arguments: list[str], status: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken.yaml").write_text("version: 1\nstart: [9, 9]\n", encoding="utf-8")
    (tmp_path / "smelly.yaml").write_text("size: [3, 2]\nversion: 1\nskid: 0\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert run_here(arguments, environment(tmp_path)).status == status
