"""Applies fixes to a text, again and again until there is nothing left to mend."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.lint.rule import Rule
from babyrobot_levels.lint.runner import Report, lint_source
from babyrobot_levels.text.diagnostics import Diagnostic, Edit, Fix
from babyrobot_levels.text.source import SourceFile

MAX_ROUNDS = 20
"""A fix may lay bare another; rules that undo each other's fixes would never end."""


@dataclass(frozen=True, slots=True)
class Fixed:
    """A text after its fixes.

    Attributes:
        text: the text.
        count: how many fixes were applied.
        report: what linting finds in it now.
    """

    text: str
    count: int
    report: Report


def fix(
    source: SourceFile, rules: Sequence[Rule], path: Path | None = None, *, unsafe: bool = False
) -> Fixed:
    """Apply all safe fixes to a text, and with `unsafe` the others too.

    A safe fix never changes the game: one that did would be dropped. Whatever does not
    load after its fix is dropped too.
    """
    report = lint_source(source, rules, path)
    count, dropped = 0, set[str]()
    for _ in range(MAX_ROUNDS):
        found = [each for each in report.diagnostics if each.code not in dropped]
        batch = _apart(_wanted(found, unsafe))
        if not batch:
            break
        text = apply((edit for each in batch for edit in _edits(each)), source)
        mended = SourceFile(source.name, text)
        after = lint_source(mended, rules, path)
        if _is_broken(report, after, safe=all(_is_safe(each) for each in batch)):
            # Only one at a time tells who is to blame.
            batch = batch[:1] if len(batch) > 1 else batch
            text = apply((edit for edit in _edits(batch[0])), source)
            mended = SourceFile(source.name, text)
            after = lint_source(mended, rules, path)
            if _is_broken(report, after, safe=_is_safe(batch[0])):
                dropped.add(batch[0].code)
                continue
        source, report = mended, after
        count += len(batch)
    return Fixed(source.text, count, report)


def apply(edits: Iterable[Edit], source: SourceFile) -> str:
    """Return a text with edits, which must not overlap, applied to it."""
    text = source.text
    for edit in sorted(edits, key=lambda each: each.span, reverse=True):
        first, last = source.index(edit.span.start), source.index(edit.span.end)
        text = text[:first] + edit.text + text[last:]
    return text


def _wanted(found: Iterable[Diagnostic], unsafe: bool) -> list[Diagnostic]:
    return [each for each in found if each.fix is not None and (each.fix.safe or unsafe)]


def _apart(found: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return those whose edits do not touch the edits of others before them."""
    taken: list[Edit] = []
    batch = []
    for each in found:
        edits = _edits(each)
        if not any(_overlap(edit, other) for edit in edits for other in taken):
            taken += edits
            batch.append(each)
    return batch


def _overlap(one: Edit, other: Edit) -> bool:
    return one.span.start <= other.span.end and other.span.start <= one.span.end


def _edits(found: Diagnostic) -> tuple[Edit, ...]:
    return found.fix.edits if isinstance(found.fix, Fix) else ()


def _is_safe(found: Diagnostic) -> bool:
    return found.fix is not None and found.fix.safe


def _is_broken(before: Report, after: Report, *, safe: bool) -> bool:
    """Tell whether the level no longer loads, or is another game though it must not be."""
    return not after.is_valid or (safe and before.digest != after.digest)
