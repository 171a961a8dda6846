"""Linting texts, files and sets of files."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

from babyrobot_levels.language.documents import check_level
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.registry import select
from babyrobot_levels.linter.rule import REGISTERED, Rule
from babyrobot_levels.linter.rules.files import EQUIVALENT_MDP, equivalent_mdp
from babyrobot_levels.linter.settings import settings_for
from babyrobot_levels.suites.checking import check_document, errors_of
from babyrobot_levels.text.diagnostics import Diagnostic, Issue, Severity
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source
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


def check(path_or_text: str | Path, *, lint: bool = False) -> list[Diagnostic]:
    """Return the errors of a level or a suite, given as a path or a text; empty if it is valid.

    A `str` is a text if it contains a line break or a colon and a space, otherwise a path.

    Args:
        path_or_text: the level or the suite.
        lint: whether to apply the linter's rules as well, as `babyrobot lint` does: for a file
            those that its project selects, for a text the default ones.

    Raises:
        SettingsError: the project's settings are invalid.
    """
    if isinstance(path_or_text, str) and ("\n" in path_or_text or ": " in path_or_text):
        source = SourceFile("<text>", path_or_text)
        return lint_source(source, select(None)).diagnostics if lint else errors_of(source)
    path = Path(path_or_text)
    with suppress(RuntimeError):
        path = path.expanduser()
    if lint:
        return lint_file(path, settings_for(path).rules_for(path)).diagnostics
    try:
        return errors_of(read_source(path), path)
    except LevelError as error:
        return [*error.diagnostics]


def lint_files(paths: Iterable[Path]) -> list[Diagnostic]:
    """Return the findings in files, by the settings of each file's project.

    Raises:
        SettingsError: settings are invalid.
    """
    found: list[Diagnostic] = []
    texts: dict[Path, tuple[SourceFile, int]] = {}
    for path in paths:
        report = lint_file(path, settings_for(path).rules_for(path))
        found += report.diagnostics
        if report.source is not None and report.fingerprint is not None:
            texts[path] = report.source, report.fingerprint
    same = equivalent_levels(texts, lambda path: settings_for(path).rules_for(path))
    return [*found, *same.values()]


def lint_file(path: Path, rules: Sequence[Rule]) -> Report:
    """Lint a file; see `lint_source`."""
    try:
        source = read_source(path)
    except LevelError as error:
        return Report(None, [*error.diagnostics])
    return lint_source(source, rules, path)


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
        rules: the rules; see `registry.select`.
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
    level, errors = check_document(document, path)
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
        diagnostics = [_diagnostic(rule, finding, context) for finding in rule.check(context)]
        found += [each for each in diagnostics if not _is_suppressed(rule, each, context)]
    return sorted(found, key=lambda each: (each.line, each.column, each.code))


def equivalent_levels(
    texts: Mapping[Path, tuple[SourceFile, int]], rules_for: Callable[[Path], Sequence[Rule]]
) -> dict[Path, Diagnostic]:
    """Return a finding for each file whose MDP equals that of an earlier file of its folder.

    Args:
        texts: the valid files in order, each with its text and fingerprint.
        rules_for: returns the rules that are selected for a file.
    """
    rule = REGISTERED[EQUIVALENT_MDP]
    groups: dict[tuple[Path, int], list[Path]] = defaultdict(list)
    for path, (_, fingerprint) in texts.items():
        groups[path.absolute().parent, fingerprint].append(path)
    found: dict[Path, Diagnostic] = {}
    for paths in groups.values():
        first: dict[str, Path] = {}
        for path in paths if len(paths) > 1 else ():
            # There are few such files, so they are read again.
            document = read(texts[path][0])
            level = check_level(document, Level, path).value
            if level is None:
                continue
            other = first.setdefault(level.digest, path)
            if other == path or rule not in rules_for(path):
                continue
            context = LintContext(level, document, path)
            for finding in equivalent_mdp(other.name):
                diagnosed = _diagnostic(rule, finding, context)
                if not _is_suppressed(rule, diagnosed, context):
                    found[path] = diagnosed
    return found


def is_note(found: Diagnostic) -> bool:
    """Return whether a finding is a note: reported at `info` by a rule of play.

    Notes do not affect the exit status.
    """
    return found.severity is Severity.INFO and found.code.startswith("BR5")


def _diagnostic(rule: Rule, finding: Finding, context: LintContext) -> Diagnostic:
    location = finding.location
    if location == ():
        keys = context.document.root.keys
        location = next(iter(keys.values())).span if keys else context.document.root.span
    severity = finding.severity or rule.severity
    issue = Issue(rule.code, location, finding.message, finding.help, finding.fix, severity)
    return context.document.diagnostic(issue)


def _is_suppressed(rule: Rule, found: Diagnostic, context: LintContext) -> bool:
    # All suppressions are checked, so that each records what it suppresses.
    answers = [each.covers(rule.names, found.span) for each in context.suppressions]
    return any(answers)
