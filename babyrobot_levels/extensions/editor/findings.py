"""Where the findings in a level are shown in its picture."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from threading import Lock
from typing import Any, TypeGuard

from babyrobot_levels.extensions.editor.answers import Answers, work_time
from babyrobot_levels.language.kinds import KINDS
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, marked_at
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.rules import find, select
from babyrobot_levels.linter.rules.expectations import BROKEN_EXPECTATION
from babyrobot_levels.linter.runner import Report, applicable, findings_in, names_of
from babyrobot_levels.render.page import MAX_CELLS
from babyrobot_levels.text.diagnostics import Diagnostic, Edit, Fix
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.source import Position, Span
from babyrobot_levels.text.words import nearest

PLACED = {field for kind in KINDS for field in kind.fields}
"""The fields that say where something stands."""

MOST_PLACES = 400
"""The most cells or sides at which a finding is shown."""

_MEANT = re.compile(r"; did you mean `([\w.-]+)`\?$")
"""The question of a message that one other word answers."""

_CELL = re.compile(r"\[(\d{1,4}), (\d{1,4})\]")

Place = tuple[int, int, str]
"""A cell `(x, y)` and a side of it, which is empty for the cell itself."""


def findings_of(linting: Linting, size: tuple[int, int]) -> Iterator[dict[str, Any]]:
    """Yield findings as plain data, each with where it is shown.

    To `Diagnostic.to_dict` it adds `title`, what its rule is about; `is_outdated`, whether it was
    found in the text before, and not looked for again yet; `cells`, `[x, y]` each; and `sides`,
    `[x, y, side]` each. The places are those of the entry, or of the part of the drawing, at which
    a finding points; or else those that its message names.

    Args:
        linting: the findings.
        size: the size of the picture; what is off it is left out.
    """
    document = linting.report.document
    found = [(each, False) for each in linting.report.diagnostics]
    found += [(each, True) for each in linting.outdated]
    for each, is_outdated in sorted(found, key=lambda pair: (pair[0].line, pair[0].column)):
        places = [*_places(document, each.span)] if document is not None else []
        named = ((int(x), int(y), "") for x, y in _CELL.findall(each.message))
        inside = [
            (x, y, side)
            for x, y, side in dict.fromkeys(places or named)
            if x < size[0] and y < size[1]
        ]
        rule, fix = find(each.code), fix_of(each)
        yield {
            **each.to_dict(),
            "fix": None if fix is None else fix.to_dict(),
            "title": "" if rule is None else rule.summary,
            "is_outdated": is_outdated,
            "cells": [[x, y] for x, y, side in inside if not side],
            "sides": [[x, y, side] for x, y, side in inside if side],
        }


def fix_of(found: Diagnostic) -> Fix | None:
    """Return the fix of a finding; of a misspelt word, the word that its message asks for."""
    meant = _MEANT.search(found.message)
    if found.fix is not None or meant is None or found.source is None:
        return found.fix
    source, span = found.source, found.span
    word = source.text[source.index(span.start) : source.index(span.end)]
    # What is called otherwise, and not only misspelt, has another form as well.
    if f"`{word}`" not in found.message or not nearest(word, [meant[1]], 1, 0.75):
        return None
    return Fix(f"write `{meant[1]}`", (Edit(span, meant[1]),), safe=False)


def _places(document: Document, span: Span) -> Iterator[Place]:
    """Yield what the text at a span is about."""
    mark, data = document.mark(span.start), document.data
    if mark is not None:
        if (place := marked_at(data["map"], mark)) is not None:
            yield place
        return
    index = document.source.index(span.start)
    for name in PLACED & document.root.children.keys():
        node = document.root.children[name]
        if node.first <= index < node.last:
            inner = (each for each in node.children.values() if each.first <= index < each.last)
            entry = next(inner, node) if isinstance(node.data, list) else node
            # The entry is a coordinate where the field is a single cell.
            whole = node if isinstance(entry.data, int) else entry
            yield from islice(_of_entry(whole.data), MOST_PLACES)


def _of_entry(entry: Any) -> Iterator[Place]:
    """Yield the cells or sides of an entry, which need not be valid."""
    if _is_pair(entry):
        yield entry[0], entry[1], ""
    elif isinstance(entry, list):
        for each in entry:
            yield from _of_entry(each)
    elif isinstance(entry, dict):
        at, size, side = entry.get("at"), entry.get("size"), entry.get("side")
        length = entry.get("length", 1)
        if _is_pair(at) and side in ("N", "E", "S", "W"):
            for step in range(length if isinstance(length, int) else 1):
                yield at[0] + step * (side in "NS"), at[1] + step * (side in "EW"), side
            return
        if _is_pair(at) and _is_pair(size):
            columns, rows = size
            yield from ((at[0] + x, at[1] + y, "") for y in range(rows) for x in range(columns))
            return
        for name in ("at", "one_of", "to", "path"):
            yield from _of_entry(entry.get(name))


def _is_pair(value: Any) -> TypeGuard[list[int]]:
    """Return whether a value may be a cell or a size."""
    is_list = isinstance(value, list) and len(value) == 2
    return is_list and all(type(number) is int and number >= 0 for number in value)


# -- rules that are applied as the text changes ------------------------------------------


LONG = 0.02
"""How long a rule may take if its findings are to be shown at once, in seconds."""


@dataclass(eq=False)
class Linting:
    """What is found in one text.

    Attributes:
        report: what is found so far.
        waiting: the rules that were not applied yet.
        outdated: what these found in the text before, at the places where that is now.
        context: the level, for the rules; None if the text is no level.
    """

    report: Report
    waiting: Sequence[Rule] = ()
    outdated: Sequence[Diagnostic] = ()
    context: LintContext | None = None


class Linter:
    """Applies the linter's rules to one text after the other, as they are edited."""

    def __init__(self) -> None:
        self._rules = [*map(self._timed, select(None))]
        self._times: dict[str, float] = {}
        self._late: set[str] = set()
        self._is_first = True
        self._last: Linting | None = None
        self._catching_up = Lock()

    def follow(self, report: Report, path: Path | None, answers: Answers) -> Linting:
        """Apply the rules to a text, but for those that took long in the texts before.

        Args:
            report: its errors; if it has none, its level.
            path: its file.
            answers: what is known about its level.
        """
        before, self._last = self._last, self._linted(report, path, answers)
        linting = self._last
        if before is not None and linting.waiting and linting.report.document is not None:
            codes = {rule.code for rule in linting.waiting}
            old = [*before.report.diagnostics, *before.outdated]
            outdated = [each for each in old if each.code in codes]
            linting.outdated = _moved(outdated, before.report, linting.report.document)
        return linting

    def _linted(self, report: Report, path: Path | None, answers: Answers) -> Linting:
        if report.level is None or report.document is None:
            return Linting(report)
        rules = applicable(self._rules)
        context = LintContext(report.level, report.document, path, names_of(rules))
        _share(answers, context)
        # One rule looks at what all others find, the last one at which suppressions they used.
        last = {BROKEN_EXPECTATION, rules[-1].code}
        late = self._late | last if self._late else self._late
        waiting = [rule for rule in rules if answers.waits or rule.code in late]
        ready = [rule for rule in rules if rule not in waiting]
        found = findings_in(context, ready, max_cells=MAX_CELLS)
        # What the first run takes is also what it loads.
        if not self._is_first:
            self._late |= {rule.code for rule in ready if self._times.get(rule.code, 0.0) > LONG}
        self._is_first = False
        return Linting(replace(report, diagnostics=found), waiting, context=context)

    def catch_up(self, answers: Answers) -> None:
        """Apply the rules that wait to the last text, however long that takes."""
        with self._catching_up:
            linting = self._last
            if linting is None or linting.context is None or not linting.waiting:
                return
            context = linting.context
            _share(answers, context)
            began = work_time()
            known = linting.report.diagnostics
            late = findings_in(context, linting.waiting, max_cells=MAX_CELLS, known=known)
            # Together, since one rule computes what others then have.
            if work_time() - began <= LONG:
                self._late.clear()
            found = [*known, *late]
            found.sort(key=lambda each: (each.line, each.column, each.code))
            linting.report = replace(linting.report, diagnostics=found)
            linting.waiting = linting.outdated = ()

    def _timed(self, rule: Rule) -> Rule:
        """Return a rule that notes how long it takes."""
        check = rule.check
        if check is None:
            return rule

        def timed(context: LintContext) -> list[Finding]:
            began = work_time()
            found = [*check(context)]
            self._times[rule.code] = work_time() - began
            return found

        return replace(rule, check=timed)


def _share(answers: Answers, context: LintContext) -> None:
    """Give rules what was computed for the answers to the same level."""
    if answers.level is not context.level:
        return
    if answers.reach is not None:
        context.reach = answers.reach
    solution = None if answers.optimum is None else answers.optimum.solution
    if solution is None:
        return
    from babyrobot_levels.language.metric_names import MAX_SOLVED

    if context.mdp.num_states <= MAX_SOLVED:
        context.solution = solution


def _moved(found: list[Diagnostic], before: Report, document: Document) -> list[Diagnostic]:
    """Return findings of a text at their places in another one, without those in what differs.

    They have no fixes, which would be edits of the other text.
    """
    if not found or before.source is None:
        return []
    old, new = before.source.lines, document.source.lines
    most = min(len(old), len(new))
    first = next((number for number in range(most) if old[number] != new[number]), most)
    most -= first
    same = next((n for n in range(most) if old[-1 - n] != new[-1 - n]), most)
    shift = len(new) - len(old)
    moved = []
    for each in found:
        if each.end.line > first and each.line <= len(old) - same:
            continue
        by = 0 if each.end.line <= first else shift
        line, end = each.line + by, Position(each.end.line + by, each.end.column)
        moved.append(replace(each, line=line, end=end, fix=None, source=document.source))
    return moved
