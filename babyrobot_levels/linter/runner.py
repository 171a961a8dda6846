"""Linting a text: its errors, else what the rules find."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.suites.checking import check_document
from babyrobot_levels.text.diagnostics import Diagnostic, Issue, Severity
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


@dataclass(frozen=True, slots=True)
class Report:
    """The result of linting a text.

    Attributes:
        source: the text, None if the file could not be read.
        diagnostics: the findings, sorted by position.
        level: the level; None if the text has errors.
        document: the text as it was read; None if it is not YAML.
    """

    source: SourceFile | None
    diagnostics: list[Diagnostic]
    level: Level | None = None
    document: Document | None = None

    @property
    def digest(self) -> str | None:
        """The level's digest; None if the text has errors or the level has no tables."""
        return None if self.level is None or self.level.has_random_maze else self.level.digest

    @property
    def fingerprint(self) -> int | None:
        """A number that equivalent levels share; None where there is no digest.

        It is much faster to compute than the digest, which is only compared where it is equal.
        """
        if self.level is None or self.level.has_random_maze:
            return None
        grid = self.level.grid()
        parts = (self.level.size, sorted(self.level.starts), grid.open_bits, grid.blocked_cells)
        return crc32(repr(parts).encode("ascii"))

    @property
    def is_valid(self) -> bool:
        """Whether the text has no errors."""
        return not any(each.severity is Severity.ERROR for each in self.diagnostics)


def lint_source(
    source: SourceFile,
    rules: Sequence[Rule],
    path: Path | None = None,
    *,
    max_cells: int | None = None,
) -> Report:
    """Return the errors of a text or, if it has none, the findings of the rules.

    Args:
        source: the text.
        rules: the rules; see `rules.select`.
        path: the file of the text, which gives the level's name and the folder of its themes.
        max_cells: the most cells of a level for which rules that need its tables are checked; by
            default any number.
    """
    try:
        document = read(source)
    except LevelError as error:
        return Report(source, [*error.diagnostics])
    return lint_document(document, rules, path, max_cells=max_cells)


def lint_document(
    document: Document,
    rules: Sequence[Rule],
    path: Path | None = None,
    *,
    max_cells: int | None = None,
) -> Report:
    """Return the errors of a document or, if it has none, the findings; see `lint_source`."""
    source = document.source
    level, errors = check_document(document, Level, path)
    if not isinstance(level, Level):
        # Rules check levels; a suite only has errors.
        return Report(source, errors, document=document)
    context = LintContext(level, document, path, names_of(rules))
    return Report(source, findings_in(context, rules, max_cells=max_cells), level, document)


def names_of(rules: Iterable[Rule]) -> frozenset[str]:
    """Return the codes and names of the rules that check levels, in lower case."""
    return frozenset(name for rule in rules if rule.check is not None for name in rule.names)


def findings_in(
    context: LintContext, rules: Sequence[Rule], *, max_cells: int | None = None
) -> list[Diagnostic]:
    """Return the findings of rules in a level, sorted by position; see `lint_source`.

    Rules are in the order of their codes: the last one checks which suppressions were used.
    """
    columns, rows = context.level.size
    is_small = max_cells is None or columns * rows <= max_cells
    has_tables = is_small and not context.level.has_random_maze
    found = []
    for rule in rules:
        if rule.check is None or (rule.needs is Needs.TABLES and not has_tables):
            continue
        diagnostics = [diagnostic_of(rule, finding, context) for finding in rule.check(context)]
        found += [each for each in diagnostics if not is_suppressed(rule, each, context)]
    return sorted(found, key=lambda each: (each.line, each.column, each.code))


def is_note(found: Diagnostic) -> bool:
    """Return whether a finding is a note: reported at `info` by a rule of play.

    Notes do not affect the exit status.
    """
    return found.severity is Severity.INFO and found.code.startswith("BR5")


def diagnostic_of(rule: Rule, finding: Finding, context: LintContext) -> Diagnostic:
    """Return what a rule finds as a diagnostic of the level's document."""
    location = finding.location
    if location == ():
        keys = context.document.root.keys
        location = next(iter(keys.values())).span if keys else context.document.root.span
    severity = finding.severity or rule.severity
    issue = Issue(rule.code, location, finding.message, finding.help, finding.fix, severity)
    return context.document.diagnostic(issue)


def is_suppressed(rule: Rule, found: Diagnostic, context: LintContext) -> bool:
    """Return whether a comment in the level suppresses a finding."""
    # All suppressions are checked, so that each records what it suppresses.
    answers = [each.covers(rule.names, found.span) for each in context.suppressions]
    return any(answers)
