"""What users ask to be shown, as a mapping, read into an `Overlay`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.looks import PATTERN
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.render.scene.overlays import Note, Overlay
from babyrobot_levels.render.scene.overlays.numbers import short
from babyrobot_levels.render.scene.told_policy import read_policy
from babyrobot_levels.render.scene.told_rows import cells_of, number_of
from babyrobot_levels.text.words import did_you_mean

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

KEYS = (
    "values",
    "policy",
    "action_values",
    "visits",
    "coordinates",
    "text",
    "side_panel",
    "bottom_panel",
    "precision",
)
"""What can be shown."""

MAX_PRECISION = 6

_ELSEWHERE = {
    "coords": "coordinates",
    "directions": "policy",
    "side_info": "side_panel",
    "bottom_info": "bottom_panel",
}
"""What PyPI's babyrobot calls the same things."""


def overlay_from(info: Mapping[str, Any], level: GridWorld) -> Overlay:
    """Return what a mapping asks to be shown on a level.

    All keys may be left out. Arrays are NumPy's, or lists; where they hold nan or None nothing is
    shown, and ±inf is shown as such. A `Solution` or a `Sweep` stands for its array of that name.

    Args:
        info: with these keys:

            - `values`: what each cell is worth, `[height, width]`;
            - `policy`: where arrows lead, `[height, width]`: in each cell an action, its name
              (`"north"`, `"N"`), a list or set of actions, or nothing; a negative number is
              nothing. Or `[height, width, actions]`, probabilities or flags, of which the largest
              count: of 5 actions, or of the 4 moves;
            - `action_values`: what each action is worth, `[height, width, actions]`, likewise;
            - `visits`: how often the robot was in each cell, `[height, width]`;
            - `coordinates`: whether cells show their coordinates;
            - `text`: a list of `((x, y), text)` or `((x, y), text, colour)`; whole numbers are the
              middle of a cell, fractions lie between cells;
            - `side_panel`, `bottom_panel`: a text, or a list of lines;
            - `precision`: how many decimals numbers have at most, 0 to 6; by default 2.
        level: the level.

    Raises:
        ValueError: a key is unknown, or what it says cannot be shown on the level.
    """
    if not isinstance(info, Mapping):
        raise ValueError(f"what is shown is given as a mapping, not as {type(info).__name__}")
    for key in info:
        if key not in KEYS:
            raise ValueError(f"nothing called `{key}` can be shown{_hint(str(key))}")
    told = {key: value for key, value in info.items() if value is not None}
    precision = told.get("precision", 2)
    if isinstance(precision, bool) or precision not in range(MAX_PRECISION + 1):
        raise ValueError(f"`precision` must be 0 to {MAX_PRECISION}, not {precision!r}")
    return Overlay(
        values=_values(told["values"], level) if "values" in told else None,
        actions=read_policy(told["policy"], level) if "policy" in told else None,
        action_values=(
            _action_values(told["action_values"], level) if "action_values" in told else None
        ),
        visits=_visits(told["visits"], level) if "visits" in told else None,
        coordinates=bool(told.get("coordinates", False)),
        notes=tuple(_note(item, precision, level) for item in _items(told, "text")),
        side_panel=_lines(told, "side_panel"),
        bottom_panel=_lines(told, "bottom_panel"),
        precision=int(precision),
    )


def _hint(key: str) -> str:
    if key in _ELSEWHERE:
        return f"; here it is `{_ELSEWHERE[key]}`"
    return did_you_mean(key, KEYS) or f"; there are {', '.join(KEYS)}"


def _values(told: Any, level: GridWorld) -> list[list[float | None]]:
    rows = cells_of(told, "values", level)
    return [[number_of(cell, "values") for cell in row] for row in rows]


def _visits(told: Any, level: GridWorld) -> list[list[float | None]]:
    rows = [[number_of(cell, "visits") for cell in row] for row in cells_of(told, "visits", level)]
    for count in (count for row in rows for count in row if count is not None):
        if not 0 <= count < math.inf:
            raise ValueError(f"`visits` must be counts, not {count:g}")
    return rows


def _action_values(told: Any, level: GridWorld) -> list[list[list[float | None]]]:
    rows = cells_of(told, "action_values", level, deep=True)
    numbers = [
        [[number_of(value, "action_values") for value in cell] for cell in row] for row in rows
    ]
    # Of the moves alone, staying has no value.
    return [
        [cell if len(cell) == NUM_ACTIONS else [None, *cell] for cell in row] for row in numbers
    ]


def _note(item: Any, precision: int, level: GridWorld) -> Note:
    try:
        (x, y), text, color = item if len(item) == 3 else (*item, None)
        x, y = float(x), float(y)
    except (TypeError, ValueError):
        raise ValueError(
            f"`text` must be a list of ((x, y), text), and {item!r} is none of them; an array of "
            "numbers goes to `values`"
        ) from None
    width, height = level.size
    if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
        raise ValueError(f"the text {text!r} is at [{x:g}, {y:g}], which is not on the level")
    if color is not None and not (isinstance(color, str) and re.fullmatch(PATTERN, color)):
        raise ValueError(f"the text {text!r} has a colour that is none of CSS: {color!r}")
    shown = short(text, precision) if isinstance(text, float) and math.isfinite(text) else text
    return Note(x, y, str(shown), color)


def _lines(told: Mapping[str, Any], key: str) -> tuple[str, ...]:
    lines = _items(told, key)
    for line in lines:
        if not isinstance(line, str):
            raise ValueError(f"`{key}` must be a list of texts, and {line!r} is none")
    return lines


def _items(told: Mapping[str, Any], key: str) -> tuple[Any, ...]:
    items = told.get(key, ())
    if isinstance(items, str):
        return (items,)
    if not isinstance(items, Iterable):
        raise ValueError(f"`{key}` must be a list, not {items!r}")
    return tuple(items)
