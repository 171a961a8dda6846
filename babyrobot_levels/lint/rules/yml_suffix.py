"""A level file whose name ends in `.yml`.

## Why it is bad

Level files end in `.yaml`. Some tools and editors take only that for a level, and two suffixes
make two files possible, `maze.yaml` and `maze.yml`, of which one is not found.

## What to do

Rename the file.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR611", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding if the file has the other suffix."""
    if case.path is not None and case.path.suffix == ".yml":
        name = f"{case.path.stem}.yaml"
        yield Finding(
            (), f"the file ends in .yml, not in .yaml: {case.path.name}", f"call it {name}"
        )
