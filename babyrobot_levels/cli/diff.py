"""`babyrobot diff`: what changed from one level to another, also as git's diff driver."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    WRONG_CALL,
    FormatOption,
    ReportFormat,
    fail,
    note,
    unified,
    wants_color,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import load_two
from babyrobot_levels.cli.reporting import shown_name
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.emitter import flow
from babyrobot_levels.text.source import SourceFile

if TYPE_CHECKING:
    from babyrobot_levels.analysis.diff.changes import Change, Changes
    from babyrobot_levels.analysis.diff.levels import Difference
    from babyrobot_levels.library.level import Level


def diff(
    levels: Annotated[
        list[str],
        typer.Argument(
            metavar="A B",
            help="Two levels: names, pack/name, paths of files, or share codes; one of them may be "
            "`-`, standard input.",
        ),
    ],
    limit: Annotated[
        int,
        typer.Option(
            min=0, metavar="N", help="How many cells, walls and transitions to tell, 0 for all."
        ),
    ] = 10,
    maze_seed: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Of levels with random mazes, compare the mazes of this seed.  [default: 0]",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Tell what changed in the game from one level to another.

    Ends with status 0 if the two are the same game, with 1 if they differ, and with 2 if that
    cannot be told. It also takes the seven arguments that git gives to a diff driver: to see games
    in `git diff`, set `diff.babyrobot.command` to `babyrobot diff` in git's configuration, and
    give level files the attribute `diff=babyrobot`.

    Examples:

      babyrobot diff default side-panel

      babyrobot diff default side-panel --format json --limit 0
    """
    if is_from_git(levels):
        write(text_for_git(levels, limit or None))
        return
    if len(levels) != 2:
        fail(f"diff takes two levels, not {len(levels)}")
    before, after = _loaded(*levels)
    names = [shown_name(text) for text in levels]
    if maze_seed is None and (before.has_random_maze or after.has_random_maze):
        note("each reset grows another maze; those of seed 0 are compared (see --maze-seed)")
    from babyrobot_levels.analysis.diff.levels import diff as difference_of

    difference = difference_of(before, after, limit=limit or None, maze_seed=maze_seed or 0)
    if report_format is ReportFormat.JSON:
        write_json({"before": names[0], "after": names[1], **difference_data(difference)})
    else:
        told = "the same game" if difference.same_game else "different games"
        write(difference_text(difference, f"{names[0]} and {names[1]} are {told}"))
    if not difference.same_game:
        raise typer.Exit(FINDINGS)


def _loaded(before: str, after: str) -> tuple[Level, Level]:
    """Return two levels; one that is not valid is no difference, but cannot be compared."""
    from babyrobot_levels.text.errors import LevelError

    try:
        return load_two(before, after)
    except LevelError as error:
        note(str(error))
        raise typer.Exit(WRONG_CALL) from None


_NO_FILES = ("/dev/null", "nul")


def is_from_git(arguments: list[str]) -> bool:
    """Tell whether it is git that called."""
    is_unmerged = len(arguments) == 1 and "GIT_DIFF_PATH_COUNTER" in os.environ
    return len(arguments) in (7, 9) or is_unmerged


def text_for_git(arguments: list[str], limit: int | None) -> str:
    """Return the difference that git asks for, a blank line below it.

    What cannot be compared is told as well: git takes a driver that fails for a crash.
    """
    from babyrobot_levels.text.files import ReadFault

    path = arguments[0]
    if len(arguments) == 1:
        return f"{one_line(path)}: not merged yet\n\n"
    new_path = arguments[7] if len(arguments) > 7 else path
    title = path if path == new_path else f"{path} -> {new_path}"
    try:
        before, after = _read(arguments[1], path), _read(arguments[4], new_path)
    except ReadFault as fault:
        return f"{one_line(title)}: {one_line(str(fault))}\n\n"
    return _told(title, before, after, limit) + "\n"


@dataclass(frozen=True, slots=True)
class Version:
    """A version of a file: its text, and the level that it is, or else what is wrong with it."""

    source: SourceFile
    level: Level | None
    faults: tuple[str, ...]


def _read(file: str, path: str) -> Version | None:
    """Return a version, None for no file."""
    from babyrobot_levels.library.reading import read_level
    from babyrobot_levels.text.files import read_source

    if file in _NO_FILES:
        return None
    source = read_source(Path(file), path)
    # The other version may lie in a folder of git's, but its themes lie where the path says.
    level, diagnostics = read_level(source, Path(path))
    faults = tuple(f"line {each.line}: {one_line(each.message)}" for each in diagnostics)
    return Version(source, level, () if level is not None else faults[:1])


def _told(title: str, before: Version | None, after: Version | None, limit: int | None) -> str:
    from babyrobot_levels.analysis.diff.levels import diff

    if before is None or after is None:
        return _told_alone(title, before, after)
    if before.level is None or after.level is None:
        versions = {"before": before, "after": after}
        which = " and ".join(name for name, version in versions.items() if version.level is None)
        return f"{one_line(title)}: no valid level {which} the change\n" + _lines(
            title, before, after
        )
    difference = diff(before.level, after.level, limit=limit)
    told = "the same game" if difference.same_game else "another game"
    return difference_text(difference, f"{title}: {told}")


def _told_alone(title: str, before: Version | None, after: Version | None) -> str:
    told, version = ("is gone", before) if after is None else ("is new", after)
    if version is not None and version.level is None:
        text = f"{one_line(title)}: the file {told}, and no valid level\n"
        return text + _lines(title, before, after)
    text = f"{one_line(title)}: the level {told}\n"
    new = after.level if after is not None else None
    return text + f"\n{new.draw()}" if new is not None and not new.has_random_maze else text


def _lines(title: str, before: Version | None, after: Version | None) -> str:
    """Return what is wrong with the versions that are no levels, and which lines differ."""
    faults = [
        f"  {name}, {fault}\n"
        for name, version in (("before", before), ("after", after))
        for fault in (version.faults if version is not None else ())
    ]
    one, two = (version.source.text if version else "" for version in (before, after))
    return "".join(faults) + "\n" + unified(one, two, title, color=wants_color(sys.stdout))


WIDEST = 60
"""The most characters that are told of a value."""

_NEIGHBOURS = {"E": (1, 0), "S": (0, 1)}


def difference_data(difference: Difference) -> dict[str, Any]:
    """Return the difference as JSON can hold it: texts for infinite returns."""
    data = difference.to_dict()
    for name in ("best_return", "random_return"):
        data[name] = [
            number if number is None else _rounded(number) if isfinite(number) else f"{number:g}"
            for number in data[name]
        ]
    return data


def difference_text(difference: Difference, title: str) -> str:
    """Return the difference for people to read, below a title."""
    same = difference.same_game
    parts = [f"{one_line(title)}\n"]
    lines = [*_game_lines(difference)]
    if lines and same:
        parts.append(_section("changed, but without effect on the game:", lines))
    elif lines:
        parts.append("".join(f"{line}\n" for line in lines))
    if not same:
        parts.append("".join(f"{line}\n" for line in _return_lines(difference)))
    beside = [_field_line(change) for change in difference.beside]
    if beside:
        parts.append(_section("beside the game:", beside))
    return "\n".join(parts)


def _section(title: str, lines: list[str]) -> str:
    return f"{_bold(title)}\n" + "".join(f"  {line}\n" for line in lines)


def _game_lines(difference: Difference) -> Iterator[str]:
    yield from map(_field_line, difference.game)
    yield from _listed("cells", difference.cells, _cell_lines)
    yield from _listed("walls", difference.walls, _wall_lines)
    yield from _listed("transitions", difference.transitions, _transition_lines)


def _return_lines(difference: Difference) -> Iterator[str]:
    for name, (before, after) in (
        ("best return", difference.best_return),
        ("random return", difference.random_return),
    ):
        yield f"{_bold(name + ':')} {_return(before)} -> {_return(after)}"


def _return(value: float | None) -> str:
    return "no value" if value is None else f"{_rounded(value):.6g}"


def _rounded(value: float) -> float:
    """Return a return without what computing leaves in its last digits, and without -0."""
    return round(value, 9) + 0.0


def _listed(name: str, changes: Changes, told: Callable[[Change], list[str]]) -> Iterator[str]:
    if not changes.count:
        return
    yield f"{_bold(name + ':')} {changes.count:,} of {changes.total:,} changed"
    for change in changes.first:
        yield from (f"  {line}" for line in told(change))
    rest = changes.count - len(changes.first)
    if rest:
        yield f"  and {rest:,} more (--limit 0 tells all)"


# -- kinds of changes ----------------------------------------------------------------------


def _field_line(change: Change) -> str:
    name = f"{change.name}:"
    if change.name and change.name.endswith(".looks"):
        # Which of many entries looks how is better seen than read.
        return f"{_bold(name)} changed"
    before, after = (_value(value, change.name) for value in (change.before, change.after))
    return f"{_bold(name)} {before} -> {after}"


def _value(value: Any, name: str | None) -> str:
    if value is None or value == []:
        return "none"
    if name == "size":
        return f"{value[0]} x {value[1]}"
    is_cells = name in ("start", "exit")
    told = ", ".join(map(_cell, value)) if is_cells else one_line(flow(value))
    return told if len(told) <= WIDEST else told[: WIDEST - 3] + "..."


def _cell_lines(change: Change) -> list[str]:
    before, after = (_cell_words(properties) for properties in (change.before, change.after))
    return [f"{_cell(change.cell)}: {before} -> {after}"]


def _cell_words(properties: dict[str, Any]) -> str:
    words = []
    for name, value in properties.items():
        if name == "blocked":
            words.append("blocked")
        elif name == "puddle":
            words.append(f"{value} puddle")
        elif name == "reward":
            words.append(f"reward {value:g}")
        elif name == "skid":
            to = "" if value["to"] == "open" else f" to {value['to']}"
            words.append(f"skid {value['probability']:g}{to}")
        elif name == "ends":
            words.append("ends the episode")
        else:
            to = value["to"] if isinstance(value["to"], str) else _cell(value["to"])
            leaving = " on leaving" if value["when"] == "leave" else ""
            reward = f" with reward {value['reward']:g}" if "reward" in value else ""
            words.append(f"warp to {to}{leaving}{reward}")
    return ", ".join(words) or "plain"


def _wall_lines(change: Change) -> list[str]:
    (x, y), (right, down) = change.cell or (0, 0), _NEIGHBOURS[change.name or "E"]
    before, after = (_wall_words(state) for state in (change.before, change.after))
    return [f"between {_cell((x, y))} and {_cell((x + right, y + down))}: {before} -> {after}"]


def _wall_words(state: Any) -> str:
    return str(state) if isinstance(state, str) else f"glass with pass {state['pass']:g}"


def _transition_lines(change: Change) -> list[str]:
    for digits in (6, 17):
        before, after = (_outcomes(told, digits) for told in (change.before, change.after))
        if before != after:
            break
    return [f"{_cell(change.cell)} {change.name}", f"  before: {before}", f"  after:  {after}"]


def _outcomes(outcomes: list[dict[str, Any]], digits: int) -> str:
    return "; ".join(
        _cell(outcome["cell"])
        + (f" with probability {outcome['probability']:.{digits}g}" if len(outcomes) > 1 else "")
        + f", reward {outcome['reward']:.{digits}g}"
        + (", the end" if outcome["ends"] else "")
        for outcome in outcomes
    )


def _cell(cell: Any) -> str:
    return f"[{cell[0]}, {cell[1]}]"


def _bold(text: str) -> str:
    return f"\x1b[1m{text}\x1b[0m" if wants_color(sys.stdout) else text
