"""Reading the mapping of `show_info` into an `Overlay`."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.looks import is_color
from babyrobot_levels.mdp.actions import (
    HEADINGS,
    MOVES,
    NUM_ACTIONS,
    NUM_MOVES,
    Action,
    Turn,
    drawn_policy,
)
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.states import configuration_words, initial_configuration, occurring
from babyrobot_levels.render.scene.layout import Note, Overlay
from babyrobot_levels.render.scene.texts import short
from babyrobot_levels.text.words import did_you_mean

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
"""The keys of the mapping."""

MAX_PRECISION = 6

_NAMES = {str(action).upper(): action for action in Action}
_NAMES |= {action.name[0]: action for action in MOVES}
_TIE = 1e-9
"""The relative difference up to which two probabilities count as equal."""

_ELSEWHERE = {
    "coords": "coordinates",
    "directions": "policy",
    "side_info": "side_panel",
    "bottom_info": "bottom_panel",
}
"""The names of the same keys in PyPI `babyrobot`."""


def overlay_from(info: Mapping[str, Any], level: GridWorld) -> Overlay:
    """Return the overlay that a mapping describes.

    All keys are optional. Arrays are NumPy arrays or lists; nan and None are not shown, and ±inf is
    shown as such. A `Solution` or a `Sweep` stands for its array of that name.

    In a level with things, NumPy arrays may have the axis of configurations first; pictures show
    the part of the configuration at hand, and in the level's own picture that in which episodes
    begin. Of a robot that turns, arrays have an axis of 4 headings before height, and 3 actions:
    pictures show the part of its heading. Actions are shown as moves, a turn as that to where the
    robot then looks. Where there is no heading at hand, a cell shows the largest value (of visits:
    the sum) over all headings, and moves in the directions in which a robot that looks there goes
    forward.

    Args:
        info: with these keys:

            - `values`: the value of each cell, `[height, width]`;
            - `policy`: the arrows, `[height, width]`: for each cell an action, its name (`"north"`,
              `"N"`), a list or set of actions, or nothing; negative numbers are nothing. Or
              `[height, width, actions]`, probabilities or flags of 5 actions or of the 4 moves: the
              more probable an action, the longer its arrow;
            - `action_values`: the value of each action, `[height, width, actions]`, likewise;
            - `visits`: the number of visits to each cell, `[height, width]`;
            - `coordinates`: whether cells show their coordinates;
            - `text`: a list of `((x, y), text)` or `((x, y), text, colour)`; integers are the
              centre of a cell, fractions are between cells;
            - `side_panel`, `bottom_panel`: a text, or a list of lines;
            - `precision`: the largest number of decimals, 0 to 6; by default 2.
        level: the level.

    Raises:
        ValueError: a key is unknown, or its value does not fit the level.
    """
    if not isinstance(info, Mapping):
        raise ValueError(f"info must be a mapping, not {type(info).__name__}")
    for key in info:
        if key not in KEYS:
            raise ValueError(f"unknown key `{key}`{_hint(str(key))}")
    given = {key: value for key, value in info.items() if value is not None}
    if level.robots:
        given |= {key: _of_first(key, given[key], level) for key in _JOINT if key in given}
    parts = InfoParts(given, level)
    return replace(parts(None, None), parts=parts) if parts.differ else flat_overlay(given, level)


_JOINT = ("policy", "action_values")
"""The keys of arrays that tell of the joint actions of several robots."""


def _of_first(key: str, given: Any, level: GridWorld) -> Any:
    """Return what pictures show of joint actions: the actions of the first robot.

    Each has the probability of all joint actions with it, or the value of the best one.
    """
    mdp = level.compile()
    table = np.asarray(drawn_policy(given)[0] if key == "policy" else getattr(given, key, given))
    if table.shape[-1:] == (mdp.num_actions,) and table.ndim > 2:
        by_robot = table.reshape(*table.shape[:-1], NUM_ACTIONS, -1)
        if key == "action_values":
            return by_robot.max(axis=-1)
        return by_robot.any(axis=-1) if table.dtype == bool else by_robot.sum(axis=-1)
    if key == "policy" and table.dtype.kind in "iu":
        return mdp.robot_actions(table)[..., 0]
    return given


def flat_overlay(given: Mapping[str, Any], level: GridWorld) -> Overlay:
    """Return the overlay of a mapping whose arrays are over cells alone; see `overlay_from`."""
    precision = given.get("precision", 2)
    if isinstance(precision, bool) or precision not in range(MAX_PRECISION + 1):
        raise ValueError(f"`precision` must be 0 to {MAX_PRECISION}, not {precision!r}")
    arrays = {
        name: read(given[key], level) for name, (key, read) in _ARRAYS.items() if key in given
    }
    return Overlay(
        **arrays,
        coordinates=bool(given.get("coordinates", False)),
        notes=tuple(_note(item, precision, level) for item in _items(given, "text")),
        side_panel=_lines(given, "side_panel"),
        bottom_panel=_lines(given, "bottom_panel"),
        precision=int(precision),
    )


def _hint(key: str) -> str:
    if key in _ELSEWHERE:
        return f"; use `{_ELSEWHERE[key]}`"
    return did_you_mean(key, KEYS) or f"; the keys are {', '.join(KEYS)}"


def _numbers(given: Any, key: str, level: GridWorld) -> list[list[float | None]]:
    return [[number_of(cell, key) for cell in row] for row in cells_of(given, key, level)]


def _visits(given: Any, level: GridWorld) -> list[list[float | None]]:
    rows = _numbers(given, "visits", level)
    for count in (count for row in rows for count in row if count is not None):
        if not 0 <= count < math.inf:
            raise ValueError(f"`visits` must be counts, not {count:g}")
    return rows


def _action_values(given: Any, level: GridWorld) -> list[list[list[float | None]]]:
    if level.moves > NUM_MOVES:
        raise ValueError(
            f"`action_values` are drawn for {NUM_MOVES} moves, and the level has "
            f"`moves: {level.moves}`; draw `values` or `policy`"
        )
    rows = cells_of(given, "action_values", level, deep=True)
    numbers = [
        [[number_of(value, "action_values") for value in cell] for cell in row] for row in rows
    ]
    # Values of the 4 moves: `stay` has none.
    return [
        [cell if len(cell) == NUM_ACTIONS else [None, *cell] for cell in row] for row in numbers
    ]


def _note(item: Any, precision: int, level: GridWorld) -> Note:
    try:
        (x, y), text, color = item if len(item) == 3 else (*item, None)
        x, y = float(x), float(y)
    except (TypeError, ValueError):
        raise ValueError(
            f"invalid entry in `text`: {item!r}; expected ((x, y), text), "
            "or use `values` for an array of numbers"
        ) from None
    width, height = level.size
    if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
        raise ValueError(
            f"the text {text!r} is at [{x:g}, {y:g}], which is not on the level; "
            "texts in a panel are lines: `side_panel` or `bottom_panel`"
        )
    if color is not None and not (isinstance(color, str) and is_color(color)):
        raise ValueError(f"the text {text!r} has an invalid CSS colour: {color!r}")
    shown = short(text, precision) if isinstance(text, float) and math.isfinite(text) else text
    return Note(x, y, str(shown), color)


def _lines(given: Mapping[str, Any], key: str) -> tuple[str, ...]:
    lines = _items(given, key)
    for line in lines:
        if not isinstance(line, str):
            raise ValueError(f"`{key}` must be a list of texts; {line!r} is not a text")
    return lines


def _items(given: Mapping[str, Any], key: str) -> tuple[Any, ...]:
    items = given.get(key, ())
    if isinstance(items, str):
        return (items,)
    if isinstance(items, Mapping) and "panel" in key:
        raise ValueError(
            f"`{key}` must be a text or a list of texts, not a mapping; the level's `display` "
            "sets the width and the colours of a panel"
        )
    if isinstance(items, Mapping) or not isinstance(items, Iterable):
        raise ValueError(f"`{key}` must be a list, not {items!r}")
    return tuple(items)


# -- policies ------------------------------------------------------------------------------------


def policy_actions(policy: Any, level: GridWorld) -> list[list[tuple[Action, ...]]]:
    """Return the actions of a policy in each cell, `[height][width]`; see `overlay_from`.

    Raises:
        ValueError: it has another size than the level, or contains an invalid action.
    """
    table, first = drawn_policy(policy)
    if len(shape_of(table, 3)) == 3 and hasattr(table, "shape"):
        rows = cells_of(table, "policy", level, deep=True)
        return [[_most_likely(cell, level) for cell in row] for row in rows]
    rows = cells_of(table, "policy", level)
    return [[tuple(sorted(_actions(cell, level, first or 0))) for cell in row] for row in rows]


def _probabilities(policy: Any, level: GridWorld) -> list[list[dict[int, float]]] | None:
    """Return the probability of each action in each cell; None where these are all equal."""
    table, _ = drawn_policy(policy)
    if len(shape_of(table, 3)) != 3 or not hasattr(table, "shape"):
        return None
    rows = [
        [
            {
                1 + level.moves - len(cell) + index: number
                for index, weight in enumerate(cell)
                if (number := number_of(weight, "policy"))
            }
            for cell in row
        ]
        for row in cells_of(table, "policy", level, deep=True)
    ]
    # Flags, and probabilities that are all equal, have nothing to tell by lengths.
    is_told = any(len(set(cell.values())) > 1 for row in rows for cell in row)
    return rows if is_told else None


def _most_likely(weights: Sequence[Any], level: GridWorld) -> tuple[Action, ...]:
    numbers = [number_of(weight, "policy") or 0.0 for weight in weights]
    if min(numbers) < 0:
        raise ValueError(f"probabilities in `policy` must not be negative: {min(numbers):g}")
    most = max(numbers)
    first = 1 + level.moves - len(numbers)
    return tuple(
        Action(first + index)
        for index, number in enumerate(numbers)
        if most and number >= most - _TIE * most
    )


def _actions(entry: Any, level: GridWorld, first: int) -> set[Action]:
    """Return the actions of a cell's entry."""
    if entry is None:
        return set()
    if isinstance(entry, str):
        action = _NAMES.get(entry.upper())
        if action is None:
            raise ValueError(f"invalid action in `policy`: {entry!r}")
        return {action}
    if isinstance(entry, Iterable):
        return {action for part in entry for action in _actions(part, level, first)}
    number = number_of(entry, "policy")
    if number is None or number < 0:
        return set()
    if not number.is_integer() or number + first > level.moves or math.isinf(number):
        raise ValueError(f"invalid action in `policy`: {entry!r}; actions are 0 to {level.moves}")
    return {Action(first + int(number))}


_ARRAYS: dict[str, tuple[str, Callable[[Any, GridWorld], Any]]] = {
    "values": ("values", lambda given, level: _numbers(given, "values", level)),
    "actions": ("policy", policy_actions),
    "probabilities": ("policy", _probabilities),
    "action_values": ("action_values", _action_values),
    "visits": ("visits", _visits),
}
"""The rows of an overlay, each with the key that gives them, and how they are read."""


# -- arrays --------------------------------------------------------------------------------------


def cells_of(given: Any, key: str, level: GridWorld, *, deep: bool = False) -> list[list[Any]]:
    """Return the entry of each cell, `[height][width]`.

    Args:
        given: an array or lists, or an object that has them as an attribute.
        key: the name of that attribute, which messages use as well.
        level: the level.
        deep: whether each cell has a number for each action (or move).

    Raises:
        ValueError: it has another size than the level.
    """
    given = getattr(given, key, given)
    width, height = level.size
    counts = (1 + level.moves, level.moves)
    expected = [(height, width, count) for count in counts] if deep else [(height, width)]
    if (shape := shape_of(given, len(expected[0]))) not in expected:
        raise ValueError(_shape_message(key, shape, expected) + _of_things(level))
    return given.tolist() if hasattr(given, "tolist") else [*map(list, given)]


def _of_things(level: GridWorld) -> str:
    if not level.has_things or len(counts := level.compile().shape[:-2]) == 0:
        return ""
    return f", or NumPy arrays with an axis of {counts[0]} configurations before these"


def shape_of(given: Any, depth: int) -> tuple[int, ...]:
    """Return the shape of an array, or of nested lists as far as it is regular."""
    if hasattr(given, "shape"):
        return tuple(given.shape)
    if depth == 0 or not isinstance(given, list | tuple):
        return ()
    inner = {shape_of(part, depth - 1) for part in given}
    return (len(given), *(inner.pop() if len(inner) == 1 else ()))


def number_of(given: Any, key: str) -> float | None:
    """Return a number, or None for nan and None.

    Raises:
        ValueError: it is not a number.
    """
    if given is None:
        return None
    if isinstance(given, str):
        raise ValueError(f"`{key}` must be numbers, not {given!r}")
    try:
        value = float(given)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"`{key}` must be numbers, not {given!r}") from None
    return None if math.isnan(value) else value


def _shape_message(key: str, shape: tuple[int, ...], expected: Sequence[tuple[int, ...]]) -> str:
    height, width = expected[0][:2]
    must = " or ".join(map(str, expected))
    text = f"`{key}` has the shape {shape}; for this level it must be {must}"
    if not shape:
        text = f"`{key}` must be an array of the shape {must}; "
        text += "`brl.evaluate(level, policy)` has those of a policy"
    elif shape[:1] == (height * width,):
        text += f"; reshape it with `.reshape{(height, width, *shape[1:])}`"
    elif shape[:2] == (width, height):
        text += "; arrays are indexed by [y, x]"
    elif key == "values" and len(shape) == 3:
        text += "; use `action_values` for values of actions"
    return text


# -- arrays that differ by configuration or heading ------------------------------------------------

_KEYS = {"values": (0,), "visits": (0,), "action_values": (1,), "policy": (0, 1)}
"""The keys of arrays over cells, with the numbers of axes that may come after the cells."""

_CACHED = 64
"""The number of overlays that are cached."""


@dataclass(frozen=True, slots=True)
class _Array:
    """An array over states: whether its first axes are configurations and headings."""

    table: NDArray[Any]
    by_configuration: bool
    by_heading: bool


@dataclass(eq=False)
class InfoParts:
    """The overlays of a mapping in which arrays differ by configuration or heading.

    Args:
        info: the mapping, as for `show_info`.
        level: the level.
    """

    info: Mapping[str, Any]
    level: GridWorld
    _made: dict[tuple[int | None, int | None], Overlay] = field(default_factory=dict)

    @cached_property
    def _arrays(self) -> dict[str, _Array]:
        found = ((key, _array_of(self.info, key, self.level)) for key in _KEYS if key in self.info)
        return {key: array for key, array in found if array is not None}

    @cached_property
    def _extent(self) -> tuple[float, float] | None:
        """The lowest and highest finite value of all configurations and headings."""
        tables = [
            self._arrays[key].table for key in ("values", "action_values") if key in self._arrays
        ]
        numbers = [table[np.isfinite(table)] for table in tables]
        found = np.concatenate(numbers) if numbers else np.zeros(0)
        return (float(found.min()), float(found.max())) if found.size else None

    @property
    def differ(self) -> bool:
        """Whether there is such an array."""
        return bool(self._arrays)

    def __call__(self, configuration: int | None, heading: int | None) -> Overlay:
        """Return the overlay of a configuration and heading.

        Args:
            configuration: its number; None for the one in which episodes begin.
            heading: where the robot looks; None shows the largest value over all headings, and the
                moves forward that the policy takes if the robot looks that way.

        Raises:
            ValueError: the mapping does not fit the level.
        """
        if (configuration, heading) not in self._made:
            number = initial_configuration(self.level) if configuration is None else configuration
            parts = {key: _part(key, array, number, heading) for key, array in self._arrays.items()}
            if len(self._made) >= _CACHED:
                del self._made[next(iter(self._made))]
            overlay = flat_overlay({**self.info, **parts}, self.level)
            overlay = replace(overlay, extent=self._extent, **self._told(number))
            self._made[configuration, heading] = overlay
        return self._made[configuration, heading]

    @cached_property
    def _occurs(self) -> NDArray[np.bool_]:
        return occurring(self.level.compile())

    def _told(self, number: int) -> dict[str, Any]:
        """Return which cells no robot can be in, though in other configurations, and the words."""
        if not any(array.by_configuration for array in self._arrays.values()):
            return {}
        cells = np.argwhere(self._occurs.any(axis=0) & ~self._occurs[number])[:, ::-1].tolist()
        words = configuration_words(self.level, number)
        caption = f"{'hatched: cannot occur' if cells else 'shown'} {words}"
        return {"never": frozenset(map(tuple, cells)), "caption": caption}


def _array_of(info: Mapping[str, Any], key: str, level: GridWorld) -> _Array | None:
    """Return an array of a mapping that differs by configuration or heading, else None."""
    given = info[key]
    if key == "policy":
        table, first = drawn_policy(given)
    else:
        table, first = getattr(given, key, given), None
    if not hasattr(table, "shape"):
        return None
    width, height = level.size
    shape, cells = tuple(table.shape), (height, width)
    counts = level.compile().shape[:-2] if level.has_things else ()
    # Numbers of actions come after the cells, and turning has 3 of them.
    for by_heading in (False, True):
        axes = (*counts, *((HEADINGS,) if by_heading else ()), *cells)
        rest = shape[len(axes) :]
        if shape[: len(axes)] == axes and len(axes) > 2 and len(rest) in _KEYS[key]:
            numbers = np.asarray(table)
            if key == "policy" and by_heading and not rest and numbers.dtype.kind == "f":
                # Probabilities of moves, in a level of 4 by 4.
                continue
            if key == "policy" and first and not rest and not by_heading:
                numbers = np.where(numbers >= 0, numbers + first, numbers)
            return _Array(numbers, bool(counts), by_heading)
    return None


def _part(key: str, array: _Array, configuration: int, heading: int | None) -> NDArray[Any]:
    table = array.table[configuration] if array.by_configuration else array.table
    if not array.by_heading:
        return table
    if key == "policy":
        return _moves(_weights(table), heading)
    if key == "action_values":
        return _moves(table, heading)
    if heading is not None:
        return np.asarray(table[heading])
    return np.asarray(np.fmax.reduce(table) if key == "values" else np.nansum(table, axis=0))


def _weights(policy: NDArray[Any]) -> NDArray[np.float64]:
    """Return a policy of turns as the weight of each turn, `[4, height, width, 3]`."""
    if policy.ndim == 4:
        return np.asarray(policy, np.float64)
    return np.asarray(policy[..., np.newaxis] == np.arange(len(Turn)), np.float64)


def _moves(table: NDArray[Any], heading: int | None) -> NDArray[np.float64]:
    """Return the numbers of turns, `[4, height, width, 3]`, as those of moves.

    The direction of a move is that in which the robot then looks. Without a heading it is that of
    a move forward by a robot that looks there, if there is nothing better for it to do.
    """
    moves = np.full((*table.shape[1:3], NUM_ACTIONS), np.nan)
    if heading is None:
        for looks in range(HEADINGS):
            moves[..., Action.NORTH + looks] = table[looks, ..., Turn.FORWARD]
        return moves
    for turn, shift in ((Turn.LEFT, -1), (Turn.RIGHT, 1), (Turn.FORWARD, 0)):
        moves[..., Action.NORTH + (heading + shift) % HEADINGS] = table[heading, ..., turn]
    return moves
