"""The examples of the document about formats run, and its tables are complete."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from gymnasium.envs.registration import registry
from support.places import DOCS
from support.sessions import environment, run_here

from babyrobot_levels.cli.convert import ExportFormat
from babyrobot_levels.convert.babyrobot.reading import _PLAYING, KEYWORDS

TEXT = (DOCS / "converting.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_the_examples_run(number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if "MiniGrid-" in BLOCKS[number]:
        pytest.importorskip("minigrid", reason="the package minigrid is not installed")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(BLOCKS[number], "docs/converting.md", "exec"), names)
    registry.pop("BabyRobot-v0", None)


def test_there_are_examples() -> None:
    assert len(BLOCKS) == 5


def test_the_table_has_all_formats() -> None:
    rows = re.findall(r"^\| (`.*?`) \|", TEXT, re.MULTILINE)
    names = [name for row in rows for name in re.findall(r"`([a-z-]+)`", row)]
    assert names[: len(ExportFormat)] == list(ExportFormat)


def test_the_keywords_are_all_explained() -> None:
    explained = set(re.findall(r"`(\w+)`", TEXT))
    assert KEYWORDS - set(_PLAYING) <= explained


def test_the_sessions_with_minigrid_show_what_is_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("minigrid", reason="the package minigrid is not installed")
    monkeypatch.chdir(tmp_path)
    section = TEXT[TEXT.index("## MiniGrid\n") : TEXT.index("## Tiled\n")]
    for block in re.findall(r"^```console\n(.*?)^```$", section, re.MULTILINE | re.DOTALL):
        printed: list[str] = []
        for line in block.splitlines():
            if line.startswith("$ babyrobot "):
                result = run_here(shlex.split(line)[2:], environment(tmp_path))
                printed += [*result.err.splitlines(), *result.out.splitlines()]
            elif line not in ("", "…"):
                assert line in printed


def test_the_session_shows_what_is_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    call = ["export", "final-maze", "--to", "sokoban", "--strict"]
    printed = run_here(call, environment(tmp_path)).err.splitlines()
    shown = re.findall(r"^error: .*$", TEXT, re.MULTILINE)
    assert len(shown) == 3
    assert set(shown) <= set(printed)
