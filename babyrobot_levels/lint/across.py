"""What only several files show: levels of one folder that are the same game."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from babyrobot_levels.diagnostics import Diagnostic
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.registry import rule_of
from babyrobot_levels.lint.rule import Finding, Rule
from babyrobot_levels.lint.rules import same_game
from babyrobot_levels.lint.runner import Report, diagnostic_of, is_silenced
from babyrobot_levels.reading import read_document
from babyrobot_levels.syntax.reader import read


def same_games(
    reports: Mapping[Path, Report], rules_for: Callable[[Path], Sequence[Rule]]
) -> dict[Path, Diagnostic]:
    """Return a finding for each file whose game another file of its folder has before it.

    Args:
        reports: what linting each file by itself gave, in order.
        rules_for: gives the rules that are wanted for a file.
    """
    rule = rule_of(same_game)
    games: dict[tuple[Path, str], list[Path]] = defaultdict(list)
    for path, report in reports.items():
        if report.digest is not None:
            games[path.absolute().parent, report.digest].append(path)
    found: dict[Path, Diagnostic] = {}
    for first, *others in games.values():
        for path in others:
            if rule in rules_for(path):
                told = _told(rule, path, first.name, reports[path])
                if told is not None:
                    found[path] = told
    return found


def _told(rule: Rule, path: Path, other: str, report: Report) -> Diagnostic | None:
    # Such files are few: they are read a second time.
    if report.source is None:
        return None
    document = read(report.source)
    level, _ = read_document(document, path)
    if level is None:
        return None
    case = Case(level, document, path)
    finding = Finding((), same_game.message(other), same_game.HELP)
    told = diagnostic_of(rule, finding, case)
    return None if is_silenced(rule, told, case) else told
