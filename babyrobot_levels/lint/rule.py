"""What a rule is, and what it finds."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING

from babyrobot_levels.text.diagnostics import Fix, Severity
from babyrobot_levels.text.source import Span

if TYPE_CHECKING:
    from babyrobot_levels.lint.case import Case

Route = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that a rule found, told by the route of keys to where it stands in the file.

    Attributes:
        route: the way to the value; one that goes deeper than the file gives the deepest part
            that is there, and an empty one the file's first line.
        message: what is wrong, in the user's words.
        help: what to do about it.
        key: whether the field itself is meant, and not its value.
        mark: a place in the drawing: line and character (from 0), and how many characters.
        fix: edits that mend it.
        span: the place itself, where no route leads to it: a comment, a line.
    """

    route: Route
    message: str
    help: str | None = None
    key: bool = False
    mark: tuple[int, int, int] | None = None
    fix: Fix | None = None
    span: Span | None = None


class Needs(Enum):
    """What must be there for a rule to look at a level."""

    LEVEL = auto()
    """The level and its text."""
    TABLES = auto()
    """The compiled tables: a level with random mazes has none."""


Check = Callable[["Case"], Iterable[Finding]]


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule: what `babyrobot rule` lists, and the check that finds it.

    Attributes:
        code: the stable code: `BR5xx` of play, `BR6xx` of style.
        name: the rule's name, a slug.
        summary: what it finds, in one sentence.
        page: its page, Markdown.
        severity: how bad a finding is.
        needs: what must be there for the check to run.
        check: the check; None for a rule that looks at several files at once.
        default: whether it runs where nobody selects rules.
    """

    code: str
    name: str
    summary: str
    page: str
    severity: Severity
    needs: Needs
    check: Check | None
    default: bool = True

    def is_called(self, word: str) -> bool:
        """Tell whether a word is the rule's code or its name."""
        return word.upper() == self.code or word.lower() == self.name
