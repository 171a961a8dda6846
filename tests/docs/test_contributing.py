"""CONTRIBUTING.md names files that exist, and registries that are complete."""

from __future__ import annotations

import importlib
import json
import re
from typing import Any

import pytest
import typer
from support.places import DOCS, ROOT

import babyrobot_levels as brl

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
SECTIONS = dict(
    re.findall(r"^### Adding an? (.*?)\n(.*?)(?=^##|\Z)", TEXT, re.MULTILINE | re.DOTALL)
)
CLI = (ROOT / "cli.md").read_text(encoding="utf-8")


def paths_in(text: str) -> list[str]:
    return re.findall(r"`((?:\w+/)*[\w.-]+(?:/|\.\w+))`", text)


def registry(section: str) -> Any:
    found = re.search(r"Registry: `([\w.]+):(\w+)`", SECTIONS[section])
    assert found
    return getattr(importlib.import_module(found[1]), found[2])


def level_schema() -> dict[str, Any]:
    text = (ROOT / "schemas" / "level.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema


def rows(page: str) -> set[str]:
    """Return what stands in the first column of a page's tables."""
    lines = re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)
    return {word for line in lines for word in re.findall(r"`\"?([\w-]+)\"?`", line)}


def test_the_lists_are_those_of_the_house() -> None:
    assert list(SECTIONS) == [
        "field", "rule", "command", "painter", "maze algorithm", "format", "observation"
    ]  # fmt: skip


@pytest.mark.parametrize("section", SECTIONS)
def test_every_file_of_a_list_exists(section: str) -> None:
    paths = [path for path in paths_in(SECTIONS[section]) if "/" in path or path == "cli.md"]
    assert len(paths) >= 3
    for path in paths:
        # A word in capitals stands for any name.
        assert list(ROOT.glob(re.sub(r"NAME", "*", path))), path


def test_the_scripts_accept_what_is_shown() -> None:
    script = (ROOT / "scripts" / "check.sh").read_text(encoding="utf-8")
    for word in re.findall(r"bash scripts/check\.sh (\w+)", TEXT):
        assert re.search(rf"\b{word}\b", script), word


# -- the registries --------------------------------------------------------------------------


def test_the_fields_are_those_of_the_schema_and_of_the_reference() -> None:
    fields = set(registry("field").model_fields)
    assert fields == set(level_schema()["properties"])
    assert fields <= rows((DOCS / "level-format.md").read_text(encoding="utf-8"))


def test_each_rule_has_a_function_and_a_page() -> None:
    names = {rule.name for rule in registry("rule")()}
    modules = (ROOT / "babyrobot_levels" / "linter" / "rules").glob("*.py")
    sources = "".join(path.read_text(encoding="utf-8") for path in modules)
    functions = re.findall(r"^@rule\([^)]*\)\ndef (\w+)", sources, re.MULTILINE)
    assert {name.replace("_", "-") for name in functions} == names
    pages = {path.stem for path in (DOCS / "rules").glob("*.md")}
    assert names <= pages


def test_the_commands_are_those_of_the_reference() -> None:
    group: Any = typer.main.get_command(registry("command"))
    assert set(group.commands) == set(re.findall(r"^##+ ([a-z-]+)$", CLI, re.MULTILINE))


def test_the_painters_are_offered_by_preview() -> None:
    section = CLI.partition("## preview")[2].partition("\n## ")[0]
    assert set(registry("painter")) <= set(re.findall(r"[a-z]+", section))


def test_the_maze_algorithms_are_those_of_the_language() -> None:
    names = set(registry("maze algorithm"))
    for name in names:
        assert brl.loads(f"version: 1\nmaze: {{seed: 1, algorithm: {name}}}\n").digest
    text = json.dumps(level_schema())
    assert all(f'"{name}"' in text for name in names)


def test_the_formats_are_offered_by_import_and_export() -> None:
    for command in ("import", "export"):
        section = CLI.partition(f"## {command}\n")[2].partition("\n## ")[0]
        assert set(registry("format")) <= set(re.findall(r"[a-z]+(?:-[a-z]+)*", section))


def test_the_observations_are_those_of_the_environments() -> None:
    names = set(registry("observation"))
    level = brl.load("default")
    for name in names:
        env = level.make(observation=name)
        env.reset(seed=0)
        env.close()
    with pytest.raises(ValueError, match="observation"):
        level.make(observation="none of them")
    assert names <= rows((DOCS / "environments.md").read_text(encoding="utf-8"))
