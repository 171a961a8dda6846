"""The page on plays: its examples run, and what it shows is what comes out."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from support.places import DOCS
from support.sessions import FILES, environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.language.json_schema import SCHEMAS

TEXT = (DOCS / "plays.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(FILES / "plays", "plays")


def told(line: str) -> str:
    return run_here(line.split(), environment(Path.cwd())).out


def test_numbers_behind_an_expression_are_its_value() -> None:
    count = 0
    for block in blocks("python"):
        names: dict[str, Any] = {}
        exec(block, names)
        lines = re.findall(r"^(\S.*\S)  # (-?\d[\d.]*|True)(?=[…\n])", block, re.M)
        for expression, shown in lines:
            count += 1
            value = eval(expression, names)
            if shown == "True":
                assert value is True, expression
                continue
            # Digits that are not shown are cut off.
            assert abs(value - float(shown)) < 10.0 ** -len(shown.partition(".")[2]), expression
    assert count == 8
    assert Path("class.csv").exists()
    # The plays of the example are those of the table.
    assert brl.read_plays("ada.brlplay") == brl.read_plays("plays/ada.brlplay")


def test_the_outputs_are_those_of_the_commands() -> None:
    episode, table = blocks("text")
    assert told("replay plays/ada.brlplay --episode 1") == episode
    files = " ".join(f"plays/{name}.brlplay" for name in ("ada", "ben", "eve", "zoe"))
    assert told(f"score {files} --level frozen-lake") == table


def test_all_fields_of_a_line_are_described() -> None:
    described = TEXT.partition("## The format")[2]
    for name in SCHEMAS["play"]()["properties"]:
        assert f"`{name}`" in described, name
