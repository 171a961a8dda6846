"""The reports of faulty files, as a user gets to read them."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.rules import find
from babyrobot_levels.linter.runner import lint_source
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source
from support.places import TESTS
from support.reading import read_level

LEVELS = TESTS / "levels"
GOOD = sorted((LEVELS / "good").glob("*.yaml"))
BAD = sorted((LEVELS / "bad").glob("*.yaml"))
RULES = TESTS / "linter" / "rules"
LINT_GOOD = sorted(RULES.glob("*/good-*.yaml"))
LINT_BAD = sorted(RULES.glob("*/bad-*.yaml"))


def each_rule(rules: Iterable[Rule]) -> list[Any]:
    """Return values for `parametrize`; slow is the one whose examples compile large levels."""
    slow = [pytest.mark.slow]
    return [pytest.param(rule, marks=slow if rule.code == "BR539" else []) for rule in rules]


@cache
def read(path: Path) -> tuple[Level | None, list[Diagnostic]]:
    """Read a level file under its bare name, so that reports do not speak of this machine."""
    try:
        return read_level(read_source(path, path.name))
    except LevelError as fault:
        return None, [*fault.diagnostics]


def report(path: Path) -> str:
    """Return all that is said about a file, ending with a line end."""
    return "\n\n".join(map(str, read(path)[1])) + "\n"


def linted(path: Path) -> list[Diagnostic]:
    """Return what the rule that a file's folder is named for finds in it."""
    rule = find(path.parent.name)
    assert rule is not None, f"there is no rule {path.parent.name}"
    return lint_source(read_source(path, path.name), [rule]).diagnostics


def lint_report(path: Path) -> str:
    """Return all that the rule of its folder says about a file, ending with a line end."""
    return "\n\n".join(map(str, linted(path))) + "\n"
