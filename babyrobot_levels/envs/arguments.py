"""Checks of what users hand to an environment, with messages that say what would be right."""

from __future__ import annotations

import operator
from collections.abc import Collection, Mapping
from typing import Any

from gymnasium import error

from babyrobot_levels.library.level import Level
from babyrobot_levels.text.words import did_you_mean

MAX_IMAGE_SIDE = 4096


def check_choice(name: str, value: Any, choices: Collection[str]) -> None:
    """Raise a ValueError if an argument is not one of its choices."""
    if value not in choices:
        known = ", ".join(map(repr, choices))
        guess = did_you_mean(value, choices) if isinstance(value, str) else ""
        raise ValueError(f"{name} must be one of {known}, not {value!r}{guess}")


_OPTIONS = {
    "start": "for all environments",
    "maze_seed": "for levels that say `maze: {seed: random}`",
    "index": "for suites",
    "reset_mask": "for vector environments",
}
"""The options of resets, and for what they are."""


def checked_options(options: Any, *known: str) -> dict[str, Any]:
    """Return the options of a reset.

    Args:
        options: what was given: a mapping, or None.
        known: those that this environment has.

    Raises:
        ValueError: it is no mapping, or the environment has no such option.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ValueError(f"options must be a dict, not {options!r}")
    for name, value in options.items():
        if name not in _OPTIONS:
            guess = did_you_mean(name, known) if isinstance(name, str) else ""
            raise ValueError(f"`reset` has no option {name!r}{guess}")
        if name not in known and value is not None:
            raise ValueError(f"options[{name!r}] is {_OPTIONS[name]}")
    return {**options}


def checked_image_size(image_size: Any) -> tuple[int, int] | None:
    """Return `(height, width)` in pixels, or None for the default.

    Raises:
        ValueError: it is anything else.
    """
    if image_size is None:
        return None
    try:
        height, width = (operator.index(number) for number in image_size)
    except (TypeError, ValueError):
        height = width = 0
    if not (1 <= height <= MAX_IMAGE_SIDE and 1 <= width <= MAX_IMAGE_SIDE):
        raise ValueError(
            f"image_size must be (height, width) in pixels, 1 to {MAX_IMAGE_SIDE} each, "
            f"not {image_size!r}"
        )
    return height, width


def checked_action(action: Any, count: int) -> int:
    """Return an action as a number from 0 to count - 1.

    Raises:
        InvalidAction: it is anything else.
    """
    try:
        number = operator.index(action)
    except TypeError:
        number = -1
    if not 0 <= number < count:
        raise error.InvalidAction(f"{action!r} is no action; the actions are 0 to {count - 1}")
    return number


def checked_start(start: Any, level: Level) -> int | None:
    """Return the state of a cell `[x, y]` at which an episode can begin, None for None.

    Whether an episode can begin there does not depend on the maze.

    Raises:
        ValueError: it is no cell, or the robot cannot stand there or would be done there.
    """
    if start is None:
        return None
    try:
        x, y = (operator.index(number) for number in start)
    except (TypeError, ValueError):
        raise ValueError(f"options['start'] must be a cell, [x, y], not {start!r}") from None
    width, height = level.size
    if not (0 <= x < width and 0 <= y < height):
        raise ValueError(
            f"the start [{x}, {y}] is off the grid, which is {width} wide and {height} high"
        )
    state = y * width + x
    if level.compile().over[state]:
        raise ValueError(
            f"at the start [{x}, {y}] the episode would be over: "
            "it is an exit, blocked, or ends the episode"
        )
    if any(warp.at == (x, y) and warp.when == "enter" for warp in level.warps):
        raise ValueError(f"the start [{x}, {y}] is a warp, and nobody can stand there")
    return state


def checked_maze_seed(maze_seed: Any) -> int | None:
    """Return the seed of the maze that a reset asks for, None for None.

    Raises:
        ValueError: it is no whole number.
    """
    if maze_seed is None:
        return None
    try:
        if isinstance(maze_seed, bool):
            raise TypeError
        return operator.index(maze_seed)
    except TypeError:
        raise ValueError(
            f"options['maze_seed'] must be a whole number, not {maze_seed!r}"
        ) from None
