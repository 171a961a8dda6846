"""The difference of two levels in words, and as JSON."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from math import isfinite
from typing import TYPE_CHECKING, Any

from babyrobot_levels.cli.console import wants_color
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.emitter import flow

if TYPE_CHECKING:
    from babyrobot_levels.analysis.diff import Change, Changes, Difference

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
