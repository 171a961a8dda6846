"""A level whose name and whose file disagree.

A level is found by its `name`, and without one by the stem of its file. This rule finds a `name`
that is not the file's.

## Why it is bad

Who sees `brl.load("red-maze")` looks for a file `red-maze.yaml`, and who sees the file types its
name. Where they differ, both search.

## What to do

Rename the file, or leave the field `name` out.
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.documents import slug
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR601", Severity.INFO, Needs.LEVEL


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding if the file gives the level another name than its own."""
    given = case.data.get("name")
    if case.path is None or given is None:
        return
    stem = slug(case.path.stem)
    if stem is not None and given != stem:
        yield Finding(
            ("name",),
            f"the level is called `{given}`, and its file {case.path.name}",
            f"call the file {given}{case.path.suffix}, or leave `name` out",
        )
