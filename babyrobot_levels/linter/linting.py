"""`lint`: what is found in files and texts, and the files that fixes change.

The settings of a project are the table `[tool.babyrobot.lint]` of a `pyproject.toml`, or `[lint]`
of a `babyrobot.toml`, in the nearest such file above the level file.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.documents import check_level
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.rule import REGISTERED, Rule
from babyrobot_levels.linter.rules import UnknownRuleError, select
from babyrobot_levels.linter.rules import select as select_rules
from babyrobot_levels.linter.rules.files import EQUIVALENT_MDP, equivalent_mdp
from babyrobot_levels.linter.runner import diagnostic_of, is_suppressed, lint_source
from babyrobot_levels.linter.runner import fix as fixed_text
from babyrobot_levels.suites.checking import texts_of
from babyrobot_levels.text.diagnostics import Diagnostic, Findings
from babyrobot_levels.text.errors import BabyRobotError, LevelError, warn
from babyrobot_levels.text.files import is_file, read_source, write_text
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import did_you_mean

if TYPE_CHECKING:
    from babyrobot_levels.suites.suite import Levels


_KEYS = ("select", "ignore", "per-file-ignores")
_TABLES: dict[str, tuple[str, ...]] = {
    "babyrobot.toml": (),
    "pyproject.toml": ("tool", "babyrobot"),
}
"""The settings files, each with the table that contains the settings of this package."""


class SettingsError(BabyRobotError, public=True):
    """A settings file is invalid."""


@dataclass(frozen=True, slots=True)
class Settings:
    """The rules that a project selects.

    Attributes:
        select: codes, prefixes of codes, names or `ALL`; None for the default rules.
        ignore: the same for rules to leave out.
        per_file_ignores: the same for files that match a pattern, relative to `folder`.
        folder: the folder of the settings file, None if there is none.
        file: the settings file, None if there is none.
    """

    select: tuple[str, ...] | None = None
    ignore: tuple[str, ...] = ()
    per_file_ignores: tuple[tuple[str, tuple[str, ...]], ...] = ()
    folder: Path | None = None
    file: Path | None = None

    @property
    def words(self) -> tuple[str, ...]:
        """All codes and names in the settings."""
        extra = (word for _, words in self.per_file_ignores for word in words)
        return (*(self.select or ()), *self.ignore, *extra)

    def ignoring(self, words: tuple[str, ...]) -> Settings:
        """Return the settings with further rules to leave out."""
        return replace(self, ignore=(*self.ignore, *words)) if words else self

    def rules_for(self, path: Path) -> tuple[Rule, ...]:
        """Return the rules that are selected for a file."""
        extra = (
            word
            for pattern, words in self.per_file_ignores
            if self._matches(path, pattern)
            for word in words
        )
        return select(self.select, (*self.ignore, *extra))

    def _matches(self, path: Path, pattern: str) -> bool:
        name = path.absolute()
        inside = self.folder is not None and name.is_relative_to(self.folder)
        shown = name.relative_to(self.folder) if inside and self.folder is not None else name
        return fnmatch(shown.as_posix(), pattern) or fnmatch(path.name, pattern)


def settings_for(path: Path) -> Settings:
    """Return the settings for a level file: those of the nearest settings file above it.

    Raises:
        SettingsError: that file is invalid.
    """
    for folder in path.absolute().parents:
        for name in _TABLES:
            file = folder / name
            if is_file(file):
                status = file.stat()
                if (found := _settings_in(file, (status.st_mtime_ns, status.st_size))) is not None:
                    return found
    return Settings()


@lru_cache
def _settings_in(path: Path, _state: tuple[int, int]) -> Settings | None:
    """Return the settings in a file, None if it has none. The state makes the cache current."""
    try:
        data: Any = tomllib.loads(path.read_text("utf-8-sig"))
    except (OSError, ValueError) as error:
        raise SettingsError(f"{path} cannot be read: {error}") from None
    for table in _TABLES[path.name]:
        data = data.get(table) if isinstance(data, Mapping) else None
        if data is None:
            return None
    if not isinstance(data, Mapping):
        raise SettingsError(f"{path}: `{'.'.join(_TABLES[path.name])}` must be a table")
    for key in data:
        if key in _KEYS:
            table = ".".join((*_TABLES[path.name], "lint"))
            raise SettingsError(f"{path}: `{key}` belongs in the table `[{table}]`")
        if key != "lint":
            hint = did_you_mean(key, ("lint",))
            raise SettingsError(f"{path}: unknown setting `{key}`{hint}")
    return _settings(path, data.get("lint", {}))


def _settings(path: Path, data: Any) -> Settings:
    if not isinstance(data, Mapping):
        raise SettingsError(f"{path}: `lint` must be a table")
    for key in data:
        if key not in _KEYS:
            raise SettingsError(f"{path}: unknown setting `{key}`{did_you_mean(key, _KEYS)}")
    ignores = data.get("per-file-ignores", {})
    if not isinstance(ignores, Mapping):
        raise SettingsError(f"{path}: `per-file-ignores` must be a table of lists")
    settings = Settings(
        _words(path, "select", data["select"]) if "select" in data else None,
        _words(path, "ignore", data.get("ignore", [])),
        tuple((name, _words(path, name, words)) for name, words in ignores.items()),
        path.parent,
        path,
    )
    try:
        select(settings.select, settings.ignore)
        for _, words in settings.per_file_ignores:
            select(words)
    except UnknownRuleError as error:
        raise SettingsError(f"{path}: {error}") from None
    return settings


def _words(path: Path, key: str, value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(word, str) for word in value):
        raise SettingsError(f'{path}: `{key}` must be a list of codes, for example `["BR5"]`')
    return tuple(value)


@dataclass(frozen=True, slots=True)
class Options:
    """What is done with each text: which rules, and which fixes."""

    select: tuple[str, ...] | None = None
    ignore: tuple[str, ...] = ()
    fix: bool = False
    unsafe: bool = False

    def rules_for(self, path: Path) -> tuple[Rule, ...]:
        """Return the rules for a file: those that are selected, else those of its project."""
        if self.select is not None:
            return self.rules
        return settings_for(path).ignoring(self.ignore).rules_for(path)

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules for a text that belongs to no project."""
        return select_rules(self.select, self.ignore)


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of linting a text, without the level, so that processes can exchange it.

    Attributes:
        diagnostics: the findings that are left.
        before: the original text, None if it could not be read.
        text: the text after fixes, None if they changed nothing.
        count: the number of fixes that were applied.
        mark: the byte order mark of the file, empty if it has none.
        fingerprint: a number that equivalent levels share, if equivalent levels are reported.
        is_cut: whether more might be fixed, by another run.
    """

    diagnostics: list[Diagnostic]
    before: str | None = None
    text: str | None = None
    count: int = 0
    mark: str = ""
    fingerprint: int | None = None
    is_cut: bool = False

    def told_cut(self, name: str) -> str:
        """Return a sentence that tells that fixing was cut, of a file with this name."""
        return f"{name}: {self.count} fixed, and there was too much work for more: fix it again"


def lint(
    levels: Levels,
    *,
    select: Sequence[str] | None = None,
    ignore: Sequence[str] = (),
    fix: bool = False,
    unsafe_fixes: bool = False,
) -> Findings:
    """Return the errors in levels and suites, and what the rules find in valid ones.

    It is what `babyrobot lint` reports. For a file, the rules are those that its project selects.

    Args:
        levels: a name, a path, a text, a share code, a mapping, or a `Level`; a folder or a pack;
            or several of these. A text has a line break, or a colon and a space.
        select: codes, prefixes of codes (`"BR5"`), names, or `"ALL"`; None for the rules of the
            project, else the default ones.
        ignore: the same for rules to leave out.
        fix: whether to write files with the safe fixes; what is returned is left after that.
        unsafe_fixes: whether to apply also fixes that may change the MDP.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: a share code is damaged.
        SettingsError: the project's settings are invalid.
        UnknownRuleError: there is no such rule.
        ValueError: there are no level files in a folder.
    """
    chosen, left_out = ([each] if isinstance(each, str) else each for each in (select, ignore))
    some = None if chosen is None else tuple(chosen)
    options = Options(some, tuple(left_out or ()), fix, unsafe_fixes)
    found, outcomes = Findings(), dict[Path, Outcome]()
    for each in texts_of(levels):
        if isinstance(each, SourceFile):
            found += lint_source(each, options.rules).diagnostics
            continue
        outcomes[each] = outcome = lint_path(options, each)
        if outcome.text is not None:
            write_text(each, outcome.mark + outcome.text)
        if outcome.is_cut:
            warn(outcome.told_cut(str(each)))
    found += findings_of(outcomes, options)
    return found


def lint_path(options: Options, path: Path) -> Outcome:
    """Lint a file, and fix its text if that is asked for, without writing it."""
    try:
        source = read_source(path)
    except LevelError as error:
        return Outcome([*error.diagnostics])
    return outcome_of(options, source, options.rules_for(path), path)


def outcome_of(
    options: Options, source: SourceFile, rules: Sequence[Rule], path: Path | None = None
) -> Outcome:
    """Lint a text, and fix it if that is asked for; see `lint_source`."""
    text, count, is_cut = None, 0, False
    if options.fix:
        fixed = fixed_text(source, rules, path, unsafe=options.unsafe)
        report, count, is_cut = fixed.report, fixed.count, fixed.is_cut
        text = fixed.text if count else None
    else:
        report = lint_source(source, rules, path)
    compares = any(rule.code == EQUIVALENT_MDP for rule in rules)
    fingerprint = report.fingerprint if compares else None
    return Outcome(report.diagnostics, source.text, text, count, source.mark, fingerprint, is_cut)


def findings_of(
    outcomes: Mapping[Path, Outcome], options: Options, name: Callable[[Path], str] = str
) -> list[Diagnostic]:
    """Return what was found in files, first that a file's MDP equals that of an earlier one.

    Args:
        outcomes: what was found in each file alone, in order.
        options: how they were linted.
        name: returns the name of a file in messages.
    """
    same = _equivalent(outcomes, options, name)
    return [
        each
        for path, outcome in outcomes.items()
        for each in [*([same[path]] if path in same else []), *outcome.diagnostics]
    ]


def _equivalent(
    outcomes: Mapping[Path, Outcome], options: Options, name: Callable[[Path], str]
) -> dict[Path, Diagnostic]:
    """Return a finding for each file whose MDP equals that of an earlier file of its folder."""
    rule = REGISTERED[EQUIVALENT_MDP]
    groups: dict[tuple[Path, int], list[Path]] = defaultdict(list)
    for path, each in outcomes.items():
        if each.before is not None and each.fingerprint is not None:
            groups[path.absolute().parent, each.fingerprint].append(path)
    found: dict[Path, Diagnostic] = {}
    for paths in groups.values():
        first: dict[str, Path] = {}
        for path in paths if len(paths) > 1 else ():
            # There are few such files, so they are read again.
            each = outcomes[path]
            document = read(SourceFile(name(path), each.text or each.before or ""))
            level = check_level(document, Level, path).value
            if level is None:
                continue
            other = first.setdefault(level.digest, path)
            if other == path or rule not in options.rules_for(path):
                continue
            context = LintContext(level, document, path)
            for finding in equivalent_mdp(other.name):
                diagnosed = diagnostic_of(rule, finding, context)
                if not is_suppressed(rule, diagnosed, context):
                    found[path] = diagnosed
    return found
