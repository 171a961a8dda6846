"""The page on generating levels: what it tells people to type does what it says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.places import DOCS
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.suites.batch import origin_of

PAGE = (DOCS / "generating.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def run(command: str) -> tuple[int, str]:
    done = run_here(command.split()[1:], environment(Path.cwd()))
    return done.status, done.out + done.err


def test_a_file_begins_as_it_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shown = blocks("yaml")[0]
    command = next(line for line in blocks("sh")[0].splitlines() if line.endswith("-o wet"))
    assert run(command)[0] == 0
    assert origin_of(shown) is not None
    assert Path("wet", "level-00003.yaml").read_text("utf-8").startswith(shown)


def test_the_suite_is_valid() -> None:
    assert brl.validate(blocks("yaml")[1]) == []


def test_no_field_of_a_suite_is_missing() -> None:
    table = PAGE.partition("### The fields of a suite")[2].partition("### ")[0]
    named = {name for row in re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
             for name in re.findall(r"`(\w+)`", row)}  # fmt: skip
    assert named == set(SuiteFields.model_fields)


def test_the_shipped_suites_are_told_of() -> None:
    from babyrobot_levels.library.search_path import gallery_folder

    for path in (gallery_folder() / "suites").iterdir():
        assert f"`{path.stem}`" in PAGE
