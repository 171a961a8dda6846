"""The extensions of the package: each has a manifest, which says what there is of it."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest
from support.places import ROOT
from support.sessions import run_here
from support.subprocesses import python

import babyrobot_levels as brl
from babyrobot_levels.cli.commands import COMMANDS, function_of
from babyrobot_levels.registry.entries import all_built_in

FOLDER = ROOT / "babyrobot_levels" / "extensions"
BUILT_IN = {each.name: each.extension for each in all_built_in(brl.__version__) if each.extension}


def test_each_folder_has_a_manifest_and_tests() -> None:
    assert [*BUILT_IN] == sorted(path.parent.name for path in FOLDER.glob("*/__init__.py"))
    assert {*BUILT_IN} == {path.name for path in (ROOT / "tests" / "extensions").glob("[a-z]*")}


@pytest.mark.parametrize("name", BUILT_IN)
def test_its_commands_are_those_of_the_command_line_and_are_in_its_folder(name: str) -> None:
    place = f"babyrobot_levels.extensions.{name}."
    of_it = {each: command for each, command in COMMANDS.items() if command.place.startswith(place)}
    assert of_it == BUILT_IN[name].commands
    assert all(callable(function_of(command)) for command in of_it)


def test_what_they_import_of_one_another_is_what_they_need() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (alone,) = (
        each
        for each in settings["tool"]["importlinter"]["contracts"]
        if each["name"] == "Each extension stands alone"
    )
    assert alone["ignore_imports"] == [
        f"babyrobot_levels.extensions.{name}.** -> babyrobot_levels.extensions.{other}.**"
        for name, extension in BUILT_IN.items()
        for other in extension.needs
    ]


@pytest.mark.sweep
def test_without_the_others_their_tests_pass(tmp_path: Path) -> None:
    done = python(ROOT / "scripts" / "alone.py", "expect", cwd=tmp_path, timeout=120)
    assert done.stdout.splitlines()[0] == "expect, with no other"
    assert done.stdout.splitlines()[-1] == "each of them stands alone"


@pytest.mark.slow
def test_without_the_others_these_are_gone(tmp_path: Path) -> None:
    code = """
from alone import delete_others
delete_others("robots")
from babyrobot_levels.cli.commands import COMMANDS
import babyrobot_levels.extensions.robots.plans
print("export" in COMMANDS, "score" in COMMANDS)
import babyrobot_levels.extensions.scoring.score
"""
    done = python("-c", code, cwd=tmp_path, path=ROOT / "scripts")
    assert done.stdout == "True False\n"
    assert "No module named 'babyrobot_levels.extensions.scoring'" in done.stderr


def test_they_are_listed() -> None:
    done = run_here(["list", "--extensions", "--format", "json"], {})
    rows = {row["name"]: row for row in json.loads(done.out)}
    for name, extension in BUILT_IN.items():
        assert rows[name] == {
            "name": name,
            "from": f"babyrobot-levels {brl.__version__}",
            "summary": extension.summary,
            "adds": {"commands": [*extension.commands]} if extension.commands else {},
            "fault": None,
        }
