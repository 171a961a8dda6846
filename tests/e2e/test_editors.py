"""The pages on editors and on checks: what they tell people to copy does what they say."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from support.places import DOCS, ROOT
from support.sessions import Result, environment, run_here

EDITORS, CHECKS = ((DOCS / name).read_text("utf-8") for name in ("editors.md", "ci.md"))


def blocks(language: str, text: str = EDITORS) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def commands() -> list[str]:
    """Return every `babyrobot …` of the page, in fences and in lines."""
    found = re.findall(r"`(babyrobot [a-z][^`]*)`", EDITORS)
    for text in (EDITORS, CHECKS):
        fenced = "\n".join(blocks("sh", text) + blocks("yaml", text))
        found += re.findall(r"babyrobot [a-z][^`\n\"|>#]*", fenced)
    return [command.strip() for command in found]


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def babyrobot(command: str) -> Result:
    return run_here(command.split()[1:], environment(Path.cwd()))


def test_the_schema_is_found_where_the_page_puts_it(project: Path) -> None:
    (shell,) = blocks("sh")
    for command in shell.splitlines():
        assert babyrobot(command).status == 0
    path = project / "levels" / "first.yaml"
    first = path.read_text("utf-8").splitlines()[0]
    assert first == blocks("yaml")[0].strip()
    schema = path.parent / first.partition("$schema=")[2]
    assert json.loads(schema.read_text("utf-8"))["title"] == "A level, version 1"


def test_every_command_is_one(project: Path) -> None:
    assert len(commands()) > 6
    for command in commands():
        name, *options = command.split()[1:]
        answer = babyrobot(f"babyrobot {name} --help")
        assert answer.status == 0, command
        for option in options:
            if option.startswith("-"):
                assert option in answer.out, command
    formats = re.findall(r"--format (\w+)`", CHECKS)
    assert sorted(formats) == ["json", "junit", "sarif"]


def test_settings_are_json_and_point_at_the_schema() -> None:
    settings, _ = map(json.loads, blocks("json"))
    assert settings == {"yaml.schemas": {"schemas/level.schema.json": "levels/**/*.yaml"}}


def test_the_task_understands_what_is_printed(project: Path) -> None:
    task: dict[str, Any] = json.loads(blocks("json")[1])["tasks"][0]
    pattern = task["problemMatcher"]["pattern"]
    levels = project / "levels"
    levels.mkdir()
    (levels / "bad.yaml").write_text("version: 1\nsize: [3, x]\n", "utf-8")
    walls = "walls:\n  - {at: [0, 0], side: E}\n  - {at: [0, 0], side: S}\n"
    (levels / "shut.yaml").write_text(f"version: 1\n{walls}", "utf-8")
    lines = babyrobot(task["command"]).out.splitlines()
    matches = [match for line in lines if (match := re.search(pattern["regexp"], line))]
    told = [
        {key: match[group] for key, group in pattern.items() if key != "regexp"}
        for match in matches
    ]
    assert told[0] == {
        "file": "levels/bad.yaml",
        "line": "2",
        "column": "11",
        "severity": "error",
        "code": "BR203",
        "message": "`size[1]` must be an integer from 1 to 1024, not `x`",
    }
    assert {each["file"] for each in told} == {"levels/bad.yaml", "levels/shut.yaml"}


def test_workflows_are_yaml_and_name_hooks_that_are_there() -> None:
    documents = [yaml.safe_load(block) for block in blocks("yaml", CHECKS)]
    hooks = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"))
    known = {hook["id"] for hook in hooks}
    (config,) = (each for each in documents if each and "repos" in each)
    assert {hook["id"] for hook in config["repos"][0]["hooks"]} <= known
    assert set(re.findall(r"`(babyrobot-\w+)`", CHECKS)) == known
