"""Completion in shells: what is offered, how it is written, and how little it loads."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from support.sessions import USER, environment, run_here

from babyrobot_levels.cli import completion
from babyrobot_levels.cli.commands import COMMANDS

HEAVY = {"numpy", "pydantic", "typer", "yaml", "rich", "gymnasium"}


def offered(line: str, **variables: str) -> list[str]:
    """Return what bash is offered at the end of a line, in the current folder."""
    words = line.split() if line[-1] != " " else [*line.split(), ""]
    asked = {
        completion.VARIABLE: "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)
    }  # fmt: skip
    result = run_here([], environment(Path.cwd(), **asked, **variables))
    assert (result.err, result.status) == ("", 0)
    return result.out.split()


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("babyrobot sh", ["share", "sheet", "show"]),
        ("babyrobot --v", ["--version"]),
        ("babyrobot show frozen-lake-8", ["frozen-lake-8x8", "frozen-lake-8x8-dry"]),
        ("babyrobot show small-", ["small-corridor", "small-mazes"]),
        ("babyrobot play small-", ["small-corridor"]),
        ("babyrobot diff maze frozen-lake-d", ["frozen-lake-dry"]),
        ("babyrobot generate lo", ["locked-mazes", "long-ways"]),
        ("babyrobot preview maze --the", ["--theme"]),
        ("babyrobot preview maze --theme bl", ["black_orange", "blue_green"]),
        ("babyrobot preview maze --theme = bl", ["black_orange", "blue_green"]),
        ("babyrobot show maze --format ", ["csv", "json", "text"]),
        ("babyrobot import x --from so", ["sokoban"]),
        ("babyrobot lint --select BR50", [f"BR50{number}" for number in range(1, 10)]),
        ("babyrobot rule unreachable-c", ["unreachable-cells"]),
        ("babyrobot list --tag sutton", ["sutton-barto"]),
        ("babyrobot generate --algorithm b", ["binary-tree"]),
        ("babyrobot schema t", ["theme"]),
        # Files are the shell's own.
        ("babyrobot validate le", []),
        ("babyrobot preview maze --seed ", []),
        ("babyrobot unknown ", []),
    ],
)  # fmt: skip
def test_what_is_offered(line: str, found: list[str]) -> None:
    assert offered(line) == found


@pytest.mark.usefixtures("here")
def test_own_levels_and_packs_are_offered() -> None:
    Path("levels").mkdir()
    Path("levels", "My maze.yaml").write_text("version: 1\n", encoding="utf-8")
    Path("levels", "my-suite.yaml").write_text("version: 1\nkind: suite\n", encoding="utf-8")
    assert offered("babyrobot play my") == ["my-maze"]
    assert offered("babyrobot show my") == ["my-maze", "my-suite"]
    # What cannot be read is named as a level, and ends nothing.
    Path("levels", "my-link.yaml").symlink_to("nowhere")
    assert offered("babyrobot play my") == ["my-link", "my-maze"]
    found = offered("babyrobot uninstall ", XDG_DATA_HOME=str(USER))
    assert found
    levels = offered(f"babyrobot play {found[0]}/", XDG_DATA_HOME=str(USER))
    assert levels
    assert levels[0].startswith(f"{found[0]}/")


def test_all_that_takes_words_completes_them() -> None:
    table = json.loads(completion.TABLE.read_text("utf-8"))
    assert [*table["commands"]] == [*COMMANDS]
    kinds = {*table["words"], "level", "levels", "suite", "pack", ""}
    for takes in table["commands"].values():
        assert all(not isinstance(each, str) or each in kinds for each in takes.values())
        assert isinstance(takes.get("--format", []), list)
        assert takes.get("--theme", "theme") == "theme"


@pytest.mark.parametrize(
    ("shell", "variables", "text"),
    [
        ("zsh", {}, "_arguments '*: :((\"three-gems\"))'\n"),
        ("fish", {"_TYPER_COMPLETE_FISH_ACTION": "get-args"}, "three-gems\n"),
    ],
)
def test_other_shells(tmp_path: Path, shell: str, variables: dict[str, Any], text: str) -> None:
    def asked(line: str) -> str:
        variable = {completion.VARIABLE: f"complete_{shell}", "_TYPER_COMPLETE_ARGS": line}
        return run_here([], environment(tmp_path, **variable, **variables)).out

    assert asked("babyrobot play three") == text
    assert asked("babyrobot validate ") == ("_files\n" if shell == "zsh" else "\n")


def test_an_open_quote_is_no_error(tmp_path: Path) -> None:
    variables = {completion.VARIABLE: "complete_zsh", "_TYPER_COMPLETE_ARGS": "babyrobot play 'thr"}
    assert "three-gems" in run_here([], environment(tmp_path, **variables)).out


def test_completing_imports_nothing_heavy(tmp_path: Path) -> None:
    variables = {"COMP_WORDS": "babyrobot show fro", "COMP_CWORD": "2"}
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "babyrobot_levels"],
        env=environment(tmp_path, **{completion.VARIABLE: "complete_bash"}, **variables),
        capture_output=True,
        text=True,
        check=True,
    )
    assert "frozen-lake" in done.stdout
    imported = set(re.findall(r"^import time:.*\| +(\w+)", done.stderr, re.MULTILINE))
    assert "babyrobot_levels" in imported
    assert imported & HEAVY == set()
