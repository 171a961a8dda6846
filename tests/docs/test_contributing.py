"""CONTRIBUTING.md names files that exist, and registries that are complete."""

from __future__ import annotations

import importlib
import re
from typing import Any

import pytest
from support.places import DOCS, ROOT

import babyrobot_levels as brl
from babyrobot_levels.language.cells import ADDED, Rewards

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
SECTIONS = dict(
    re.findall(r"^### Adding an? (.*?)\n(.*?)(?=^##|\Z)", TEXT, re.MULTILINE | re.DOTALL)
)


def paths_in(text: str) -> list[str]:
    return re.findall(r"`((?:\w+/)*[\w.-]+(?:/|\.\w+))`", text)


def registry(section: str) -> Any:
    found = re.search(r"Registry: `([\w.]+):(\w+)`", SECTIONS[section])
    assert found
    return getattr(importlib.import_module(found[1]), found[2])


def rows(page: str) -> set[str]:
    """Return what stands in the first column of a page's tables."""
    lines = re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)
    return {word for line in lines for word in re.findall(r"`\"?([\w-]+)\"?`", line)}


def test_the_lists_are_those_of_the_house() -> None:
    assert list(SECTIONS) == [
        "field",
        "reward",
        "thing with a state",
        "rule",
        "command",
        "painter",
        "maze algorithm",
        "format",
        "observation",
    ]


@pytest.mark.parametrize("section", SECTIONS)
def test_every_file_of_a_list_exists(section: str) -> None:
    assert registry(section)
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


def test_the_fields_are_those_of_the_reference() -> None:
    fields = set(registry("field").model_fields)
    assert fields <= rows((DOCS / "level-format.md").read_text(encoding="utf-8"))


def test_the_rewards_and_their_order_are_those_of_the_language() -> None:
    of_things = {"hit", "warp", "item"}
    assert {*registry("reward"), *ADDED} - of_things == set(Rewards.model_fields)


def test_each_rule_has_a_function_and_a_page() -> None:
    names = {rule.name for rule in registry("rule")()}
    modules = (ROOT / "babyrobot_levels" / "linter" / "rules").glob("*.py")
    sources = "".join(path.read_text(encoding="utf-8") for path in modules)
    functions = re.findall(r"^@rule\([^)]*\)\ndef (\w+)", sources, re.MULTILINE)
    assert {name.replace("_", "-") for name in functions} == names
    pages = {path.stem for path in (DOCS / "rules").glob("*.md")}
    assert names <= pages


def test_the_maze_algorithms_are_those_of_the_language() -> None:
    names = set(registry("maze algorithm"))
    for name in names:
        assert brl.loads(f"version: 1\nmaze: {{seed: 1, algorithm: {name}}}\n").digest


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
