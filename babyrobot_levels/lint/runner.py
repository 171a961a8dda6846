"""Lints a file: its errors, or else what the rules find in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import check_document
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs, Rule
from babyrobot_levels.text.diagnostics import Diagnostic, Issue, Key, Location, Mark, Severity
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile, Span


@dataclass(frozen=True, slots=True)
class Report:
    """What linting a text found.

    Attributes:
        source: the text, None where the file could not be read.
        diagnostics: what was found, in the order of the text.
        level: the level; None where the text has errors.
    """

    source: SourceFile | None
    diagnostics: list[Diagnostic]
    level: Level | None = None

    @property
    def digest(self) -> str | None:
        """The game's digest; None where the text has errors, or its level has no tables."""
        return None if self.level is None or self.level.has_random_maze else self.level.digest

    @property
    def is_valid(self) -> bool:
        """Whether the text is a level, however much could be better about it."""
        return not any(each.severity is Severity.ERROR for each in self.diagnostics)


def lint_file(path: Path, rules: Sequence[Rule]) -> Report:
    """Lint a file; see `lint_source`."""
    try:
        source = read_source(path)
    except LevelError as error:
        return Report(None, [*error.diagnostics])
    return lint_source(source, rules, path)


def lint_source(source: SourceFile, rules: Sequence[Rule], path: Path | None = None) -> Report:
    """Return all errors of a text, or if it has none, what the rules find in the level.

    Args:
        source: the text.
        rules: the rules that look at it; see `registry.select`.
        path: the file that it is from: it gives the level's name, and themes beside it.
    """
    try:
        document = read(source)
    except LevelError as error:
        return Report(source, [*error.diagnostics])
    level, errors = check_document(document, path)
    if not isinstance(level, Level):
        # A suite has no levels of its own to look at, only errors.
        return Report(source, errors)
    case = Case(level, document, path, rules)
    # In the order of their codes: the last one asks which silences were of use.
    found = []
    for rule in rules:
        if rule.check is None or (rule.needs is Needs.TABLES and level.has_random_maze):
            continue
        told = [diagnostic_of(rule, finding, case) for finding in rule.check(case)]
        found += [each for each in told if not is_silenced(rule, each, case)]
    found.sort(key=lambda each: (each.line, each.column, each.code))
    return Report(source, found, level)


def diagnostic_of(rule: Rule, finding: Finding, case: Case) -> Diagnostic:
    """Return what is to be said of a finding."""
    location: Location = Key(finding.route) if finding.key else finding.route
    if finding.mark is not None:
        location = Mark(*finding.mark)
    elif finding.span is not None:
        location = finding.span
    elif not finding.route:
        location = _first_field(case)
    issue = Issue(rule.code, location, finding.message, finding.help, finding.fix, rule.severity)
    return case.document.diagnostic(issue)


def _first_field(case: Case) -> Span:
    """Return where a finding about the whole file points."""
    keys = case.document.root.keys
    return next(iter(keys.values())).span if keys else case.document.root.span


def is_silenced(rule: Rule, told: Diagnostic, case: Case) -> bool:
    """Tell whether a comment of the file silences a finding, and note that it was of use."""
    # All of them are asked, so that each notes what it silences.
    answers = [silence.covers(rule, told.span) for silence in case.silences]
    return any(answers)
