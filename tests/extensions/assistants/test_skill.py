"""The page for assistants: complete, short, and true."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import yaml
from support.places import ROOT
from support.sessions import babyrobot

import babyrobot_levels as brl
from babyrobot_levels.language.drawing import RESERVED
from babyrobot_levels.language.fields import LevelFields, Role, fields_with
from babyrobot_levels.language.metric_names import METRICS

TEXT = brl.skill()
(LEVEL,) = re.findall(r"<!-- file: (\S+) -->\n```yaml\n(.*?)```", TEXT, re.S)
COMMANDS = [
    line
    for block in re.findall(r"```sh\n(.*?)```", TEXT, re.S)
    for line in block.splitlines()
    if line
]


@pytest.fixture
def _there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = Path(LEVEL[0])
    path.parent.mkdir()
    path.write_text(LEVEL[1], "utf-8")


@pytest.mark.beside("expect", "generate")
@pytest.mark.usefixtures("_there")
@pytest.mark.parametrize("line", COMMANDS)
def test_every_command_runs(line: str) -> None:
    program, *arguments = shlex.split(line, comments=True)
    assert program == "babyrobot"
    assert babyrobot(*arguments, status=0).out or "-o" in arguments


def test_all_that_the_loop_needs_is_shown() -> None:
    shown = {line.split()[1] for line in COMMANDS}
    assert {"lint", "expect", "rule", "format", "solve", "show", "preview", "generate"} <= shown


def test_what_the_example_expects_is_true() -> None:
    level = brl.loads(LEVEL[1])
    assert level.expect is not None
    assert len(level.expect.stated) >= 5
    assert brl.lint(LEVEL[1]) == []


def test_it_is_a_skill() -> None:
    _, front, page = TEXT.split("---\n", 2)
    told = yaml.safe_load(front)
    assert list(told) == ["name", "description"]
    assert re.fullmatch(r"[a-z0-9-]{1,64}", told["name"])
    assert len(told["description"]) <= 1024
    assert page.startswith("\n# ")


def test_it_is_short() -> None:
    assert len(TEXT.splitlines()) < 260
    assert len(TEXT.encode()) < 21_000


def test_it_names_all_fields_metrics_marks_and_rules_of_play() -> None:
    rows = set(re.findall(r"^\| `(\w+)` \|", TEXT, re.M))
    fields = {*LevelFields.model_fields} - {*fields_with(Role.LOOK)}
    assert {*fields, *METRICS} <= rows
    marks = "".join(re.findall(r"^\| (`.*) \| an? ", TEXT, re.M))
    assert RESERVED - {" ", "+"} <= {*marks}
    told = set(re.findall(r"^- (BR\d+) ", TEXT, re.M))
    left = {rule.code for rule in brl.rule() if rule.code[:3] == "BR5"} - told
    assert all(brl.rule(code).name.endswith("-without-effect") for code in left)
    for code in re.findall(r"BR\d+", TEXT):
        assert brl.rule(code)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        # A reward that is paid each time.
        ("size: [3, 1]\nareas: [{at: [1, 0], reward: 2}]", "BR504"),
        # A hole that is a better end than the way.
        ("size: [9, 1]\nstart: [1, 0]\nexit: [8, 0]\nareas: [{at: [0, 0], ends: true}]", "BR537"),
        # An opening beside a door.
        (
            "size: [3, 2]\nstart: [0, 0]\nexit: [2, 0]\nitems: [{name: key, at: [0, 1]}]\n"
            "doors: [{at: [1, 0], side: E, needs: key}]\nexpect: {needs: [key]}",
            "BR540",
        ),
        ("map: |\n  +---+---+\n  | S   E  |\n  +---+---+", "BR312"),
        ("size: [4, 1]\nmovers: [{path: [[1, 0], [3, 0]]}]", "BR323"),
        ("maze: {seed: random}\nexpect: {success: 1}", "BR326"),
        ("size: [3, 1]\nexit: [2, 0]\nitems: [{name: coin, at: [2, 0]}]", "BR318"),
        ("map: |\n  +---+---+\n  | S / E |\n  +---+---+", "BR314"),
        ("map: |\n  +---+---+\n  | S   E |\n  +---+---+\nsize: [2, 1]", "BR206"),
    ],
)
def test_what_it_warns_of_is_found(text: str, code: str) -> None:
    found = brl.lint(f"version: 1\n{text}\n")
    assert code in {each.code for each in found}, found


@pytest.mark.slow
def test_it_is_written_where_that_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "SKILL.md"
    assert brl.skill(path) == path.read_text("utf-8") == (ROOT / "docs/SKILL.md").read_text("utf-8")
    with pytest.raises(FileExistsError):
        brl.skill(path)
    assert brl.skill(path, force=True) == TEXT
