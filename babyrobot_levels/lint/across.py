"""What only several files show: levels of one folder that are the same game."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from zlib import crc32

from babyrobot_levels.language.documents import check_level
from babyrobot_levels.library.level import Level
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.registry import rule_of
from babyrobot_levels.lint.rule import Finding, Rule
from babyrobot_levels.lint.rules import same_game
from babyrobot_levels.lint.runner import diagnostic_of, is_silenced
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


def likeness(level: Level) -> int:
    """Return a number that is the same for equal games, and mostly differs for others.

    It is much faster than the digest: only where it is the same, games are compared.
    """
    grid = level.grid()
    parts = (level.size, sorted(level.starts), grid.open_bits, grid.blocked_cells)
    return crc32(repr(parts).encode("ascii"))


def same_games(
    texts: Mapping[Path, tuple[SourceFile, int]], rules_for: Callable[[Path], Sequence[Rule]]
) -> dict[Path, Diagnostic]:
    """Return a finding for each file whose game another file of its folder has before it.

    Args:
        texts: the files with levels in them, in order, and the likeness of each.
        rules_for: gives the rules that are wanted for a file.
    """
    rule = rule_of(same_game)
    alike: dict[tuple[Path, int], list[Path]] = defaultdict(list)
    for path, (_, number) in texts.items():
        alike[path.absolute().parent, number].append(path)
    found: dict[Path, Diagnostic] = {}
    for paths in alike.values():
        first: dict[str, Path] = {}
        for path in paths if len(paths) > 1 else ():
            case = _case(texts[path][0], path)
            if case is None:
                continue
            other = first.setdefault(case.level.digest, path)
            if other != path and rule in rules_for(path):
                told = _told(rule, case, other.name)
                if told is not None:
                    found[path] = told
    return found


def _case(source: SourceFile, path: Path) -> Case | None:
    # Such files are few: they are read a second time.
    document = read(source)
    level = check_level(document, Level, path).value
    return None if level is None else Case(level, document, path)


def _told(rule: Rule, case: Case, other: str) -> Diagnostic | None:
    finding = Finding((), same_game.message(other), same_game.HELP)
    told = diagnostic_of(rule, finding, case)
    return None if is_silenced(rule, told, case) else told
