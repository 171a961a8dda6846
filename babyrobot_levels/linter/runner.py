"""Linting a text: its errors, else what the rules find; and applying fixes until none is left."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.rules.expectations import BROKEN_EXPECTATION, not_clean
from babyrobot_levels.mdp.numeric import is_numeric
from babyrobot_levels.suites.checking import check_document
from babyrobot_levels.text.budget import COMMAND, READ, Meter, OverBudgetError, metered, within
from babyrobot_levels.text.diagnostics import Diagnostic, Edit, Fix, Issue, Severity
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError, UnplayableError
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
        """The level's digest; None if the text has errors or there are no tables."""
        if self.level is None or self.level.has_random_maze or not is_numeric():
            return None
        return self.level.digest

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
        """Whether the text has no errors that keep it from loading."""
        return self.level is not None or not self.diagnostics


def lint_source(source: SourceFile, rules: Sequence[Rule], path: Path | None = None) -> Report:
    """Return the errors of a text or, if it has none, the findings of the rules.

    Args:
        source: the text.
        rules: the rules; see `rules.select`.
        path: the file of the text, which gives the level's name and the folder of its themes.
    """
    try:
        document = read(source)
    except LevelError as error:
        return Report(source, [*error.diagnostics])
    return lint_document(document, rules, path)


def lint_document(document: Document, rules: Sequence[Rule], path: Path | None = None) -> Report:
    """Return the errors of a document or, if it has none, the findings; see `lint_source`."""
    source = document.source
    level, errors = check_document(document, Level, path)
    if not isinstance(level, Level):
        # Rules check levels; a suite only has errors.
        return Report(source, errors, document=document)
    rules = applicable(rules)
    context = LintContext(level, document, path, names_of(rules))
    try:
        found = findings_in(context, rules)
    except UnplayableError as error:
        # To find that out takes longer than `validate` takes for a level.
        return Report(source, [*map(document.diagnostic, error.issues)], document=document)
    return Report(source, found, level, document)


def applicable(rules: Iterable[Rule]) -> list[Rule]:
    """Return the rules that can be applied: without NumPy, those that need only the level."""
    has_numpy = is_numeric()
    return [rule for rule in rules if has_numpy or rule.needs is Needs.LEVEL]


def names_of(rules: Iterable[Rule]) -> frozenset[str]:
    """Return the codes and names of the rules that check levels, in lower case."""
    return frozenset(name for rule in rules if rule.check is not None for name in rule.names)


def findings_in(
    context: LintContext,
    rules: Sequence[Rule],
    *,
    max_cells: int | None = None,
    known: Sequence[Diagnostic] = (),
) -> list[Diagnostic]:
    """Return the findings of rules in a level, sorted by position; see `lint_source`.

    `known` are those of other rules, which are found already. Rules that need the tables of the
    level are checked if it has at most `max_cells`, by default any number.

    Rules are in the order of their codes: the last one checks which suppressions were used. What
    a level that expects to be clean has is told once all is found.
    """
    with within(READ):
        return _findings_in(context, rules, max_cells, known)


def _findings_in(
    context: LintContext, rules: Sequence[Rule], max_cells: int | None, known: Sequence[Diagnostic]
) -> list[Diagnostic]:
    columns, rows = context.level.size
    is_small = max_cells is None or columns * rows <= max_cells
    has_tables = is_small and not context.level.has_random_maze
    found: list[Diagnostic] = []
    # What was not checked is told once the others are done, before what was suppressed.
    for rule in (*sorted(rules[:-1], key=lambda rule: rule.needs is Needs.SIZE), *rules[-1:]):
        if rule.check is None or (rule.needs in (Needs.TABLES, Needs.SIZE) and not has_tables):
            continue
        if rule.needs is Needs.TABLES and context.too_large:
            continue
        try:
            diagnostics = [diagnostic_of(rule, finding, context) for finding in rule.check(context)]
        except OverBudgetError as error:
            context.given_up = str(error)
            continue
        found += [each for each in diagnostics if not is_suppressed(rule, each, context)]
    for rule in rules if context.level.expect is not None else ():
        if rule.code == BROKEN_EXPECTATION:
            others = [each for each in (*known, *found) if each.code != rule.code]
            findings = not_clean(context, [each for each in others if not is_note(each)])
            diagnostics = [diagnostic_of(rule, finding, context) for finding in findings]
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


MAX_ROUNDS = 100
"""One fix may enable another. Rules that undo each other's fixes would never finish."""


@dataclass(frozen=True, slots=True)
class Fixed:
    """A text after its fixes.

    Attributes:
        text: the text.
        count: the number of fixes that were applied.
        report: the findings that are left.
        is_cut: whether more might be fixed, by another run: the work came to that of a command.
    """

    text: str
    count: int
    report: Report
    is_cut: bool


def fix(
    source: SourceFile, rules: Sequence[Rule], path: Path | None = None, *, unsafe: bool = False
) -> Fixed:
    """Apply all safe fixes to a text and, with `unsafe`, the others too.

    A fix is refused if the level does not load after it, or if the fix claims to be safe and
    changes the MDP. Refused fixes are tried again after the others: some depend on them, such as
    the removal of an anchored value after the removal of its last alias. The rest is left once the
    work comes to that of a whole command.
    """
    with metered() as done:
        return _fixed(source, rules, path, unsafe, done)


def _fixed(
    source: SourceFile, rules: Sequence[Rule], path: Path | None, unsafe: bool, done: Meter
) -> Fixed:
    report = lint_source(source, rules, path)
    count, rounds, since = 0, 0, 0
    refused: set[Diagnostic] = set()
    while rounds < MAX_ROUNDS and done.steps < COMMAND.steps:
        batch = _disjoint([each for each in _fixable(report, unsafe) if each not in refused])
        if not batch:
            if not refused or since == count:
                break
            refused.clear()
            since = count
            continue
        while done.steps < COMMAND.steps:
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
    is_cut = done.steps >= COMMAND.steps and bool(_fixable(report, unsafe))
    return Fixed(source.text, count, report, is_cut)


def _fixable(report: Report, unsafe: bool) -> list[Diagnostic]:
    return [each for each in report.diagnostics if each.fix and (each.fix.safe or unsafe)]


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
    changed = before.is_valid and before.digest != after.digest
    return not after.is_valid or (safe and changed)
