"""`babyrobot diff`: what differs between two levels, also as a diff driver of git.

Git calls a driver with seven arguments: a path, then of each version a file, a hash and a mode. For
a renamed file there are two more, the new path and git's description; for an unmerged one there is
only the path. `/dev/null` stands for no file.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from textwrap import indent
from typing import TYPE_CHECKING, Annotated, Any

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    WRONG_CALL,
    FormatOption,
    ReportFormat,
    bold,
    fail,
    note,
    unified,
    value_option,
    wants_color,
    width_of,
    write,
    write_json,
)
from babyrobot_levels.cli.inputs import load_two
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.reporting import shown_name
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.kinds import KINDS
from babyrobot_levels.render.words.phrases import cells
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.emitter import flow
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.extensions.compare.changes import Change, Changes


def diff(
    levels: Annotated[
        list[str],
        typer.Argument(
            metavar="A B",
            help="Two levels: names, PACK/NAME, paths of files or share codes; one may be `-` for "
            "standard input.",
        ),
    ],
    limit: Annotated[
        int | None,
        value_option(
            "N",
            "How many things, cells, walls and transitions to show; 0 shows all.  [default: 10; "
            "transitions are only counted if something else has changed]",
            min=0,
        ),
    ] = None,
    maze_seed: Annotated[
        int | None,
        value_option("N", "Seed for the maze of levels with a random maze.  [default: 0]"),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Show what differs between two levels: fields, things, cells, walls, transitions, returns.

    Exits with status 0 if the two are the same MDP, with 1 if they differ, and with 2 if one of
    them is not valid.

    It is also a diff driver for git: set `diff.babyrobot.command` to `babyrobot diff` in git's
    configuration, and give level files the attribute `diff=babyrobot`.

    Examples:

      babyrobot diff default side-panel

      babyrobot diff default side-panel --format json --limit 0
    """
    if is_from_git(levels):
        write(text_for_git(levels, limit))
        return
    if len(levels) != 2:
        fail(f"expected two levels, not {len(levels)}")
    before, after = _loaded(*levels)
    names = [shown_name(text) for text in levels]
    if maze_seed is None and (before.has_random_maze or after.has_random_maze):
        note("the maze is random: the mazes of seed 0 are compared (see --maze-seed)")

    with working("comparing"):
        difference = brl.diff(before, after, limit=_most(limit), maze_seed=maze_seed or 0)
    if report_format is ReportFormat.JSON:
        write_json({"before": names[0], "after": names[1], **difference_data(difference)})
    else:
        result = "the same MDP" if difference.same_game else "different MDPs"
        title = f"{names[0]} and {names[1]} are {result}"
        write(difference_text(difference, title, brief=limit is None))
    if not difference.same_game:
        raise typer.Exit(FINDINGS)


def _most(limit: int | None) -> int | None:
    """Return how many changes of a kind `--limit` lets be shown; None for all."""
    return 10 if limit is None else limit or None


def _loaded(before: str, after: str) -> tuple[brl.Level, brl.Level]:
    """Return two levels. An invalid one ends the command with status 2, unlike a difference."""
    try:
        return load_two(before, after)
    except LevelError as error:
        note(error.shown(width_of(sys.stderr)))
        raise typer.Exit(WRONG_CALL) from None


_NO_FILES = ("/dev/null", "nul")


def is_from_git(arguments: list[str]) -> bool:
    """Return whether git called."""
    is_unmerged = len(arguments) == 1 and "GIT_DIFF_PATH_COUNTER" in os.environ
    return len(arguments) in (7, 9) or is_unmerged


def text_for_git(arguments: list[str], limit: int | None) -> str:
    """Return the difference that git asks for, with a blank line below it.

    Errors are part of the text: a driver that exits with another status than 0 ends `git diff`.
    """
    path = arguments[0]
    if len(arguments) == 1:
        return f"{one_line(path)}: unmerged\n\n"
    new_path = arguments[7] if len(arguments) > 7 else path
    title = path if path == new_path else f"{path} -> {new_path}"
    try:
        before, after = _read(arguments[1], path), _read(arguments[4], new_path)
    except LevelError as error:
        return f"{one_line(title)}: {one_line(error.diagnostics[0].message)}\n\n"
    return _compared(title, before, after, limit) + "\n"


@dataclass(frozen=True, slots=True)
class Version:
    """A version of a file: its text, and its level or its errors."""

    source: SourceFile
    level: brl.Level | None
    errors: tuple[str, ...]


def _read(file: str, path: str) -> Version | None:
    """Return a version of a file, None for no file."""
    from babyrobot_levels.library.level import load_source
    from babyrobot_levels.text.files import read_source

    if file in _NO_FILES:
        return None
    source = read_source(Path(file), path)
    # The file may be a temporary one of git, but its themes are beside the original.
    try:
        return Version(source, load_source(source, Path(path)), ())
    except LevelError as error:
        first = error.diagnostics[0]
        return Version(source, None, (f"line {first.line}: {one_line(first.message)}",))


def _compared(title: str, before: Version | None, after: Version | None, limit: int | None) -> str:

    if before is None or after is None:
        return _alone(title, before, after)
    if before.level is None or after.level is None:
        versions = {"before": before, "after": after}
        which = " and ".join(name for name, version in versions.items() if version.level is None)
        return f"{one_line(title)}: not a valid level {which} the change\n" + _lines(
            title, before, after
        )
    difference = brl.diff(before.level, after.level, limit=_most(limit))
    result = "the same MDP" if difference.same_game else "another MDP"
    return difference_text(difference, f"{title}: {result}", brief=limit is None)


def _alone(title: str, before: Version | None, after: Version | None) -> str:
    what, version = ("deleted", before) if after is None else ("new", after)
    if version is not None and version.level is None:
        text = f"{one_line(title)}: {what} file, not a valid level\n"
        return text + _lines(title, before, after)
    text = f"{one_line(title)}: {what} level\n"
    new = after.level if after is not None else None
    return text + f"\n{new.draw()}" if new is not None and not new.has_random_maze else text


def _lines(title: str, before: Version | None, after: Version | None) -> str:
    """Return the errors of the versions that are not valid levels, and the lines that differ."""
    errors = [
        f"  {name}, {error}\n"
        for name, version in (("before", before), ("after", after))
        for error in (version.errors if version is not None else ())
    ]
    one, two = (version.source.text if version else "" for version in (before, after))
    return "".join(errors) + "\n" + unified(one, two, title, color=wants_color(sys.stdout))


WIDEST = 60
"""The largest number of characters shown of a value."""

_NEIGHBOURS = {"E": (1, 0), "S": (0, 1)}


def difference_data(difference: brl.Difference) -> dict[str, Any]:
    """Return the difference for JSON: strings for infinite returns."""
    data = difference.to_dict()
    for name in ("best_return", "random_return"):
        data[name] = [
            number if number is None else _rounded(number) if isfinite(number) else f"{number:g}"
            for number in data[name]
        ]
    return data


def difference_text(difference: brl.Difference, title: str, *, brief: bool) -> str:
    """Return the difference as a text with a title.

    Args:
        difference: the difference.
        title: the title.
        brief: whether to count transitions only, if they follow from other changes.
    """
    same = difference.same_game
    parts = [f"{one_line(title)}\n"]
    lines = [*_mdp_lines(difference, brief)]
    if lines and same:
        parts.append(_section("changed, without effect on the MDP:", lines))
    elif lines:
        parts.append("".join(f"{line}\n" for line in lines))
    if not same:
        parts.append("".join(f"{line}\n" for line in _return_lines(difference)))
    if beside := [_field_line(change) for change in difference.beside]:
        parts.append(_section("not part of the MDP:", beside))
    return "\n".join(parts)


def _section(title: str, lines: list[str]) -> str:
    return f"{bold(title)}\n" + "".join(indent(f"{line}\n", "  ") for line in lines)


def _mdp_lines(difference: brl.Difference, brief: bool) -> Iterator[str]:
    causes = [
        *map(_field_line, difference.game),
        *_listed("things", difference.things, thing_lines),
        *_listed("cells", difference.cells, _cell_lines),
        *_listed("walls", difference.walls, _wall_lines),
    ]
    yield from causes
    changes = difference.transitions
    if brief and causes and changes.count:
        what = bold("transitions:")
        yield f"{what} {changes.count:,} of {changes.total:,} changed (--limit 0 shows all)"
    else:
        yield from _listed("transitions", changes, _transition_lines)


def _return_lines(difference: brl.Difference) -> Iterator[str]:
    for name, (before, after) in (
        ("optimal return", difference.best_return),
        ("random return", difference.random_return),
    ):
        yield f"{bold(difference.named(name) + ':')} {_return(before)} -> {_return(after)}"


def _return(value: float | None) -> str:
    return "no value" if value is None else f"{_rounded(value):.6g}"


def _rounded(value: float) -> float:
    """Return a return without rounding errors in its last digits, and without -0."""
    return round(value, 9) + 0.0


def _listed(name: str, changes: Changes, described: Callable[[Change], list[str]]) -> Iterator[str]:
    if not changes.count:
        return
    yield f"{bold(name + ':')} {changes.count:,} of {changes.total:,} changed"
    for change in changes.first:
        yield from (f"  {line}" for line in described(change))
    if rest := changes.count - len(changes.first):
        yield f"  and {rest:,} more (--limit 0 shows all)"


# -- kinds of changes ----------------------------------------------------------------------


def _field_line(change: Change) -> str:
    name = f"{change.name}:"
    if change.name and change.name.endswith(".looks"):
        # The looks of many entries are easier to see in a picture.
        return f"{bold(name)} changed"
    before, after = (_value(value, change.name) for value in (change.before, change.after))
    if len(before) + len(after) > WIDEST:
        return f"{bold(name)}\n  before: {before}\n  after:  {after}"
    return f"{bold(name)} {before} -> {after}"


def _value(value: Any, name: str | None) -> str:
    if value is None or value == []:
        return "none"
    if name == "size":
        return f"{value[0]} x {value[1]}"
    if name == "exit_needs":
        return ", ".join(value)
    is_cells = name in ("start", "exit", "exit_one_of")
    text = ", ".join(map(_cell, value)) if is_cells else one_line(flow(value))
    return text if len(text) <= WIDEST else text[: WIDEST - 3] + "..."


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
            words.append(f"reward {_reward(value)}")
        elif name == "skid":
            to = "" if value["to"] == "open" else f" to {value['to']}"
            words.append(f"skid {value['probability']:g}{to}")
        elif name == "ends":
            words.append("ends the episode")
        else:
            to = _target(value["to"])
            to += f" at probability {value['probability']:g}" if "probability" in value else ""
            to += f" with weights {value['weights']}" if "weights" in value else ""
            leaving = " on leaving" if value["when"] == "leave" else ""
            reward = f" with reward {value['reward']:g}" if "reward" in value else ""
            words.append(f"warp to {to}{leaving}{reward}")
    return ", ".join(words) or "plain"


def _reward(reward: Any) -> str:
    """Return a reward in words: a number, or values of which one is drawn."""
    if not isinstance(reward, dict):
        return f"{reward:g}"
    weights = f" with weights {reward['weights']}" if "weights" in reward else ""
    return f"{listed([f'{each:g}' for each in reward['values']], 'or')}{weights}"


def _target(to: Any) -> str:
    """Return where a warp leads in words."""
    if isinstance(to, str):
        return to
    return _cell(to) if isinstance(to[0], int) else listed([_cell(cell) for cell in to], "or")


def _wall_lines(change: Change) -> list[str]:
    (x, y), (right, down) = change.cell or (0, 0), _NEIGHBOURS[change.name or "E"]
    before, after = (_wall_words(state) for state in (change.before, change.after))
    return [f"between {_cell((x, y))} and {_cell((x + right, y + down))}: {before} -> {after}"]


def _wall_words(state: Any) -> str:
    return str(state) if isinstance(state, str) else f"glass with pass {state['pass']:g}"


def _transition_lines(change: Change) -> list[str]:
    for digits in (6, 17):
        before, after = (_outcomes(each, digits) for each in (change.before, change.after))
        if before != after:
            break
    place = f"{_cell(change.cell)} {change.name}{_situation(change.things)}"
    return [place, f"  before: {before}", f"  after:  {after}"]


def _outcomes(outcomes: list[dict[str, Any]], digits: int) -> str:
    return "; ".join(
        _cell(outcome["cell"])
        + _situation(outcome.get("things"))
        + (f" with probability {outcome['probability']:.{digits}g}" if len(outcomes) > 1 else "")
        + f", reward {outcome['reward']:.{digits}g}"
        + (", terminal" if outcome["ends"] else "")
        for outcome in outcomes
    )


def _situation(things: dict[str, Any] | None) -> str:
    from babyrobot_levels.mdp.states import situation_words

    words = situation_words(things or {})
    return f" ({words})" if words else ""


def _cell(cell: Any) -> str:
    return f"[{cell[0]}, {cell[1]}]"


_SIDES = {"E": "east", "S": "south"}


def thing_lines(change: Change) -> list[str]:
    """Return a change of a thing as sentences, one for each property that differs."""
    kind, _, name = (change.name or "").partition(".")
    if kind == "things":
        orders = [", ".join(names) for names in (change.before, change.after)]
        return [f"they count in another order: {' -> '.join(orders)}"]
    # A name that is taken begins with "the-" already.
    subject = name if name.startswith("the-") else f"the {name}"
    if kind == "robots":
        subject = f"the robot {name}"
    if change.cell is not None and kind in ("boxes", "targets"):
        noun = next(each.noun for each in KINDS if each.field == kind)
        subject = f"the {noun} at {show_cell(change.cell)}"
    elif kind == "doors" and change.cell is not None:
        subject = f"the door {_SIDES[name]} of {show_cell(change.cell)}"
    before, after = (dict(_said(each)) for each in (change.before, change.after))
    if not before or not after:
        state, said = ("removed", before) if before else ("new", after)
        told = [f"{verb} {text}" for verb, text in said.items() if _USUAL.get(verb) != text]
        which = f", which {' and '.join(told)}" if name else ""
        return [one_line(f"{state}: {subject}{which}")]
    stays = "lies" in after and after["lies"] == before["lies"]
    where = f" {after['lies']}" if stays else ""
    return [
        one_line(f"{subject}{where} {verb} {text} instead of {before[verb]}")
        for verb, text in after.items()
        if before[verb] != text
    ]


_USUAL = {
    "pays": "what the cell pays",
    "is for": "any robot",
    "flips": "every time",
    "begins": "off",
    "leaves": "at the exits of the level",
    "is closed by": "nothing",
}
"""What goes without saying of a new thing."""


def _said(fields: dict[str, Any] | None) -> Iterator[tuple[str, str]]:
    """Yield what a thing does, as verb and object; nothing of one that does not exist."""
    if fields is None:
        return
    if "in" in fields:
        yield "lies", f"at {'one of ' if len(fields['in']) > 1 else ''}{cells(fields['in'])}"
        pays = fields["reward"]
        yield "pays", "what the cell pays" if pays is None else f"{pays:g}"
        taker = fields["robot"]
        yield "is for", _USUAL["is for"] if taker is None else f"the robot {taker}"
    elif "once" in fields:
        yield "lies", f"at {show_cell(fields['at'])}"
        yield "flips", "only the first time" if fields["once"] else "every time"
        yield "begins", "on" if fields["on"] else "off"
    elif "exit" in fields:
        yield "begins", f"at {show_cell(fields['start'])}"
        own = fields["exit"]
        yield "leaves", _USUAL["leaves"] if own is None else f"at {show_cell(own)}"
    elif "at" in fields:
        yield "stands", f"at {show_cell(fields['at'])}"
    elif "needs" not in fields:
        yield "walks", _way(fields)
    else:
        yield "needs", listed(fields["needs"]) or "nothing"
        yield "is closed by", listed(fields["unless"]) or "nothing"


def _way(fields: dict[str, Any]) -> str:
    if "path" in fields:
        return f"{cells(fields['path'])} {'and back' if fields['back'] else 'in a loop'}"
    (x, y), (width, height) = fields["within"]["at"], fields["within"]["size"]
    corners = f"{show_cell((x, y))} to {show_cell((x + width - 1, y + height - 1))}"
    start = "a random cell" if fields["start"] is None else show_cell(fields["start"])
    return f"at random within {corners} from {start}"
