"""Two levels of one folder that are the same game.

Their digests are equal: grid, starts, exits, and every probability and reward. They may have
other names, other colours, or be written in another way.

## Why it is bad

A game that is there twice counts twice in a course, a benchmark or a training set, and where one
copy is for training and one for testing, what is measured is memory. Often one of the two was
meant to be different, and is not.

## What to do

Take one away, or make it the level that it was meant to be. Where two looks of one game are
meant, say so at the head of the second file: `# babyrobot: ignore[BR515] why`.
"""

from __future__ import annotations

from babyrobot_levels.lint.rule import Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR515", Severity.WARNING, Needs.TABLES

HELP = "take one of the two away, or make it the level that it was meant to be"


def message(other: str) -> str:
    """Return what is to be said of a file whose game another file of the folder has before it."""
    return f"this is the same game as {other}"
