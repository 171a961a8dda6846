"""Applying fixes to a text until none is left."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.runner import Report, lint_source
from babyrobot_levels.text.diagnostics import Diagnostic, Edit, Fix
from babyrobot_levels.text.source import SourceFile

MAX_ROUNDS = 100
"""One fix may enable another. Rules that undo each other's fixes would never finish."""


@dataclass(frozen=True, slots=True)
class Fixed:
    """A text after its fixes.

    Attributes:
        text: the text.
        count: the number of fixes that were applied.
        report: the findings that are left.
    """

    text: str
    count: int
    report: Report


def fix(
    source: SourceFile, rules: Sequence[Rule], path: Path | None = None, *, unsafe: bool = False
) -> Fixed:
    """Apply all safe fixes to a text and, with `unsafe`, the others too.

    A fix is refused if the level does not load after it, or if the fix claims to be safe and
    changes the MDP. Refused fixes are tried again after the others: some depend on them, such as
    the removal of an anchored value after the removal of its last alias.
    """
    report = lint_source(source, rules, path)
    count, rounds, since = 0, 0, 0
    refused: set[Diagnostic] = set()
    while rounds < MAX_ROUNDS:
        left = [each for each in report.diagnostics if each not in refused]
        batch = _disjoint([each for each in left if each.fix and (each.fix.safe or unsafe)])
        if not batch:
            if not refused or since == count:
                break
            refused.clear()
            since = count
            continue
        while True:
            text = apply((edit for each in batch for edit in _edits(each)), source)
            fixed = SourceFile(source.name, text)
            after = lint_source(fixed, rules, path)
            if not _is_broken(report, after, safe=all(_is_safe(each) for each in batch)):
                source, report = fixed, after
                count, rounds = count + len(batch), rounds + 1
                break
            if len(batch) == 1:
                refused.add(batch[0])
                break
            batch = batch[: len(batch) // 2]
    return Fixed(source.text, count, report)


def apply(edits: Iterable[Edit], source: SourceFile) -> str:
    """Return a text after edits, which must not overlap."""
    text = source.text
    for edit in sorted(edits, key=lambda each: each.span, reverse=True):
        first, last = source.index(edit.span.start), source.index(edit.span.end)
        text = text[:first] + edit.text + text[last:]
    return text


def _disjoint(found: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return those whose edits do not touch the edits of earlier ones."""
    taken: list[Edit] = []
    batch = []
    for each in found:
        edits = _edits(each)
        if not any(_touch(edit, other) for edit in edits for other in taken):
            taken += edits
            batch.append(each)
    return batch


def _touch(one: Edit, other: Edit) -> bool:
    return one.span.start <= other.span.end and other.span.start <= one.span.end


def _edits(found: Diagnostic) -> tuple[Edit, ...]:
    return found.fix.edits if isinstance(found.fix, Fix) else ()


def _is_safe(found: Diagnostic) -> bool:
    return found.fix is not None and found.fix.safe


def _is_broken(before: Report, after: Report, *, safe: bool) -> bool:
    """Return whether the level no longer loads, or changed although it must not."""
    return not after.is_valid or (safe and before.digest != after.digest)
