"""Checks of the arguments of environments. Messages name the argument and what it accepts."""

from __future__ import annotations

import inspect
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypedDict, Unpack

import numpy as np
from gymnasium import error
from gymnasium.vector import AutoresetMode
from numpy import ndarray
from numpy.typing import NDArray

from babyrobot_levels.analysis.picture_options import takes
from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.envs.engine.tables import NO_LIMIT
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.observations.base import DEFAULT_RADIUS, Observation
from babyrobot_levels.envs.observations.planes import DTYPES
from babyrobot_levels.envs.observations.views import MAX_RADIUS
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.compiler.terrain import build_terrain
from babyrobot_levels.mdp.configurations import Values
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.words import check_choice, did_you_mean, meant, words_beside

MAX_IMAGE_SIDE = 4096

_INT = np.dtype(np.intp)


# -- making ----------------------------------------------------------------------------------


def check_names(given: Iterable[str], function: Callable[..., Any], *others: str) -> None:
    """Raise a TypeError if a keyword argument is none that a function accepts.

    Args:
        given: the names of the arguments.
        function: the function whose keyword-only parameters are accepted.
        others: further names that are accepted.
    """
    parameters = inspect.signature(function).parameters.values()
    accepted = [each.name for each in parameters if each.kind is each.KEYWORD_ONLY]
    accepted += others
    for name in given:
        if name not in accepted:
            told = words_beside(__file__)["elsewhere"].get(name)
            guess = f"; {told}" if told else did_you_mean(name, accepted)
            # TorchRL's GymEnv passes `frameskip`, and knows Python's words where it is refused.
            raise TypeError(
                f"unexpected keyword argument {name!r}{guess}; "
                f"accepted arguments: {', '.join(accepted)}"
            )


def checked_given(name: str, value: Any) -> Any:
    """Return an argument without which an id makes nothing.

    Args:
        name: the argument: `"level"` or `"suite"`.
        value: its value, None if it is missing.

    Raises:
        MissingArgument: it is missing.
    """
    if value is None:
        raise error.MissingArgument(words_beside(__file__)["missing"][name])
    return value


class ObservationOptions(TypedDict, total=False):
    """What is observed, and how: all environments take these; see `LevelEnv`."""

    observation: str | Sequence[str]
    image_size: tuple[int, int] | None
    grayscale: bool
    view_radius: int | None
    see_through: bool
    channels_last: bool
    planes_dtype: str


_DEFAULTS: dict[str, Any] = {
    "observation": "position",
    "image_size": None,
    "grayscale": False,
    "view_radius": None,
    "see_through": False,
    "channels_last": False,
    "planes_dtype": DTYPES[0],
}

_PLAIN = Observation()
"""What is observed by default."""

takes_observation = takes(ObservationOptions, **_DEFAULTS)
"""Lets a function take `ObservationOptions` by name."""


def checked_observation(**options: Unpack[ObservationOptions]) -> Observation:
    """Return the observation that the arguments of an environment choose.

    Raises:
        TypeError: there is no such option.
        ValueError: there is no such observation, or it does not have such an option.
    """
    # Most environments are made without options, and many are made one after the other.
    if all(value is _DEFAULTS.get(name, options) for name, value in options.items()):
        return _PLAIN
    given = {**_DEFAULTS, **options}
    for name in given.keys() - _DEFAULTS.keys():
        raise TypeError(f"unexpected option {name!r}{meant(name, _DEFAULTS)}")
    observation = given["observation"]
    names = checked_names(observation)
    check_choice("planes_dtype", given["planes_dtype"], DTYPES)
    changed = {name for name, default in _DEFAULTS.items() if _differs(given[name], default)}
    for kind, observer in OBSERVATIONS.own.items():
        if kind not in names and not changed.isdisjoint(observer.options):
            raise ValueError(f"{' and '.join(observer.options)} need observation={kind!r}")
    return Observation(
        observation if isinstance(observation, str) else names,
        checked_image_size(given["image_size"]),
        bool(given["grayscale"]),
        checked_view_radius(given["view_radius"]),
        bool(given["see_through"]),
        bool(given["channels_last"]),
        given["planes_dtype"],
    )


def _differs(value: Any, default: Any) -> bool:
    """Return whether a value is not the default, which it may equal: 0 is False."""
    return value is not default and (default is None or bool(value != default))


def checked_names(observation: Any) -> tuple[str, ...]:
    """Return the names of the observations that are chosen: by a name, or by several.

    Raises:
        ValueError: there are none, one of them does not exist, or one is named twice.
    """
    if not isinstance(observation, list | tuple):
        check_choice("observation", observation, OBSERVATIONS)
        return (observation,)
    for name in observation:
        if isinstance(name, int):
            raise ValueError(
                f"observation names what is shown, not its size; {observation!r} pixels are "
                f"observation='image', image_size={tuple(observation)!r}"
            )
        check_choice("observation", name, OBSERVATIONS)
    if not observation or len(set(observation)) < len(observation):
        raise ValueError(
            f"observation must name at least one, and each only once, not {observation!r}"
        )
    return tuple(observation)


def checked_view_radius(radius: Any) -> int:
    """Return how many cells a view shows in each direction; None stands for the default.

    Raises:
        ValueError: it is not a whole number from 1 to `MAX_RADIUS`.
    """
    if radius is None:
        return DEFAULT_RADIUS
    return check_count("view_radius", radius, 1, MAX_RADIUS)


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


def checked_autoreset_mode(mode: Any) -> AutoresetMode:
    """Return an autoreset mode, given as such or as its value, for example `"SameStep"`.

    Raises:
        ValueError: it is neither.
    """
    if not isinstance(mode, AutoresetMode):
        check_choice("autoreset_mode", mode, [each.value for each in AutoresetMode])
    return AutoresetMode(mode)


def limits_of(levels: Sequence[Level], max_episode_steps: Any) -> list[int]:
    """Return the time limit of each level, in steps.

    Args:
        levels: the levels.
        max_episode_steps: the limit of all of them, -1 for none; None for each level's own.

    Raises:
        ValueError: it is anything else.
    """
    if max_episode_steps is None:
        return [level.max_steps or NO_LIMIT for level in levels]
    number = whole_number(max_episode_steps)
    if number is None or (number < 1 and number != -1):
        raise ValueError(
            f"max_episode_steps must be at least 1, or -1 for no limit, not {max_episode_steps!r}"
        )
    return [NO_LIMIT if number == -1 else min(number, NO_LIMIT)] * len(levels)


def whole_number(value: Any) -> int | None:
    """Return a value as an int, None if it is not a whole number."""
    try:
        return operator.index(value)
    except TypeError:
        return None


# -- resetting -------------------------------------------------------------------------------


_OPTIONS = {
    "start": "for all environments",
    "maze_seed": "for levels that say `maze: {seed: random}`",
    "index": "for suites",
    "reset_mask": "for vector environments",
}
"""The options of `reset` of all environments, and which environments have them."""


def checked_options(options: Any, *known: str) -> dict[str, Any]:
    """Return the options of a reset.

    Args:
        options: a mapping, or None.
        known: the options of this environment.

    Raises:
        ValueError: it is not a mapping, or the environment does not have such an option.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ValueError(f"options must be a dict, not {options!r}")
    for name, value in options.items():
        if name not in _OPTIONS:
            guess = did_you_mean(str(name), known)
            names = ", ".join(f"`{each}`" for each in known) or "none"
            stop = "" if guess.endswith("?") else ";"
            raise ValueError(f"`reset` has no option {name!r}{guess}{stop} known options: {names}")
        if name not in known and value is not None:
            raise ValueError(f"options[{name!r}] is {_OPTIONS[name]}")
    return {**options}


def checked_cell(cell: Any, level: GridWorld) -> tuple[int, int]:
    """Return a cell `[x, y]` of a level in which an episode is to start.

    Raises:
        ValueError: it is not a cell, or not one of the level.
    """
    try:
        x, y = (operator.index(number) for number in cell)
    except (TypeError, ValueError):
        raise ValueError(f"options['start'] must be a cell, [x, y], not {cell!r}") from None
    width, height = level.size
    if not (0 <= x < width and 0 <= y < height):
        raise ValueError(
            f"the start [{x}, {y}] is off the grid, which is {width} wide and {height} high"
        )
    return x, y


def start_states(start: Any, level: GridWorld, mdp: Mdp) -> tuple[int, ...]:
    """Return the states in which an episode can start in a cell `[x, y]`.

    In a level with things there is one for each way in which these can lie at the beginning. The
    robot holds the item that lies in the cell; nothing else there changes.

    Args:
        start: the cell.
        level: the level, whose maze has a seed.
        mdp: its tables, with or without turning.

    Raises:
        ValueError: it is not a cell; the robot cannot stand there or would be done there; or no
            episode comes there while all things are as at its beginning.
    """
    x, y = checked_cell(start, level)
    cell = y * mdp.width + x
    size = mdp.headings * mdp.cells
    place = cell + (SIDES.index(level.heading) * mdp.cells if mdp.headings > 1 else 0)
    things = level.things()
    begins = (things.taken_at_start(values, (x, y)) for values in things.draws())
    numbers = (_number_of(values, mdp.configurations) for values in begins)
    states = [number * size + place for number in numbers if number is not None]
    states = [state for state in states if not mdp.is_terminal[state]]
    if not states and build_terrain(level, level.grid()).over[cell]:
        raise ValueError(
            f"at the start [{x}, {y}] the episode would be over: "
            "it is an exit, blocked, or ends the episode"
        )
    if any(warp.at == (x, y) and warp.when == "enter" for warp in level.warps):
        raise ValueError(f"the start [{x}, {y}] is a warp, in which the robot cannot stand")
    if not states:
        raise ValueError(
            f"no episode comes to the start [{x}, {y}] while all things are as at its beginning"
        )
    return tuple(states)


def _number_of(values: Values, configurations: NDArray[np.int16]) -> int | None:
    """Return the number of the configuration with some values, None where there is none."""
    first, last = 0, len(configurations)
    # Configurations are in rising order, the first value counting most.
    for column, value in enumerate(values):
        part = configurations[first:last, column]
        begin, end = np.searchsorted(part, value), np.searchsorted(part, value, "right")
        first, last = first + int(begin), first + int(end)
    return first if first < last else None


def checked_maze_seed(maze_seed: Any) -> int | None:
    """Return the maze seed of a reset, None for None.

    Raises:
        ValueError: it is not a whole number.
    """
    if maze_seed is None:
        return None
    number = None if isinstance(maze_seed, bool) else whole_number(maze_seed)
    if number is None:
        raise ValueError(f"options['maze_seed'] must be a whole number, not {maze_seed!r}")
    return number


def checked_index(index: Any, count: int) -> int | None:
    """Return the number of a level of a suite, None for None.

    Raises:
        ValueError: there is no such level.
    """
    return None if index is None else check_count("options['index']", index, 0, count - 1)


def checked_reset_mask(mask: Any, num_envs: int) -> NDArray[np.intp]:
    """Return the indices of the environments that a reset is for; None stands for all.

    Raises:
        TypeError: the mask is not an array of bools.
        ValueError: its shape is not `[num_envs]`, or no entry is True.
    """
    if mask is None:
        return np.arange(num_envs)
    if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
        raise TypeError("options['reset_mask'] must be a NumPy array of bools")
    if mask.shape != (num_envs,) or not mask.any():
        raise ValueError(
            f"options['reset_mask'] must have shape [{num_envs}] and at least one True in it"
        )
    return mask.nonzero()[0]


# -- stepping --------------------------------------------------------------------------------


def checked_action(action: Any, count: int) -> int:
    """Return an action as a number from 0 to count - 1.

    Raises:
        InvalidAction: it is anything else.
    """
    number = whole_number(action)
    if number is None or not 0 <= number < count:
        told = "; `brl.Action` has the number of each" if isinstance(action, str) else ""
        known = f"the actions are 0 to {count - 1}{told}"
        raise error.InvalidAction(f"{action!r} is not an action; {known}")
    return number


def checked_actions(actions: Any, num_envs: int) -> NDArray[np.intp]:
    """Return actions as an array `[num_envs]`. Engines check which numbers they are.

    Raises:
        InvalidAction: they are not such an array of whole numbers.
    """
    # The usual case first: the checks below would take longer.
    if (
        type(actions) is ndarray
        and actions.dtype is _INT
        and actions.shape == (num_envs,)
        and actions.flags.carray
    ):
        return actions
    try:
        array = np.asarray(actions)
    except ValueError as reason:  # Lists of different lengths.
        raise error.InvalidAction(f"actions must be {num_envs} whole numbers: {reason}") from None
    if array.dtype.kind not in "iu" or array.shape != (num_envs,):
        raise error.InvalidAction(
            f"actions must be {num_envs} whole numbers, not an array of {array.dtype} "
            f"with shape {list(array.shape)}"
        )
    return array.astype(np.intp)
