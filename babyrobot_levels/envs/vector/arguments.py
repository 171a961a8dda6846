"""Checks of what users hand to a vector environment, with messages that say what would be right."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import error
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.arguments import whole_number
from babyrobot_levels.envs.vector.families import Family, GrownMazes, SuiteLevels
from babyrobot_levels.envs.vector.observations import largest_of
from babyrobot_levels.generate.suites import Suite
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level

_INT = np.dtype(np.intp)
_MOST = np.iinfo(np.int64).max


@dataclass(frozen=True, slots=True)
class Played:
    """What is played.

    Attributes:
        levels: the levels, as they were given.
        largest: the largest width and height of one of them, in cells.
        family: what makes levels when episodes begin; None if these are all that there are.
    """

    levels: Sequence[Level]
    largest: tuple[int, int]
    family: Family | None = None


def checked_levels(level: Any, levels: Any, draw_levels: bool, num_envs: int | None) -> Played:
    """Return what is played, of which one argument or the other tells.

    Args:
        level: a level, or None.
        levels: several of them, a suite, or None.
        draw_levels: whether each episode draws its level.
        num_envs: how many environments there are, if that was told.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        ValueError: both or none are given, or a level grows another maze each time, and is not the
            only one.
    """
    if (level is None) == (levels is None):
        raise ValueError("give `level`, or `levels`, and not both")
    if levels is not None and (isinstance(levels, str) or not isinstance(levels, Sequence)):
        raise ValueError(f"levels must be a list of levels or a suite, not {levels!r}")
    if levels is not None and not len(levels):
        raise ValueError("levels must have at least one level in it")
    if isinstance(levels, Suite):
        if draw_levels:
            return Played(levels, levels.largest, SuiteLevels(levels))
        # No more of them are played, and a suite may have a billion.
        return Played(tuple(levels[:num_envs]), levels.largest)
    loaded = tuple(load(each) for each in ([level] if levels is None else levels))
    largest = largest_of(loaded)
    if not any(each.has_random_maze for each in loaded):
        return Played(loaded, largest)
    if len(loaded) > 1:
        raise ValueError(
            "a level that grows another maze each time is played alone, or some of its mazes are "
            "drawn: levels=[level.with_maze_seed(seed) for seed in range(100)], draw_levels=True"
        )
    return Played(loaded, largest, GrownMazes(loaded[0]))


def checked_numbers(options: Mapping[str, Any], family: Family | None, num_envs: int) -> Any:
    """Return the numbers of the levels that a reset asks for, int64 `[num_envs]`, or None.

    Raises:
        ValueError: they are no numbers of levels.
    """
    asked = None if family is None else options.get(family.option)
    if family is None or asked is None:
        return None
    array = np.asarray(asked)
    if array.dtype.kind not in "iu" or array.shape not in ((), (num_envs,)):
        raise ValueError(
            f"options[{family.option!r}] must be a whole number, or {num_envs} of them, "
            f"not {asked!r}"
        )
    if (array > _MOST).any():
        raise ValueError(f"options[{family.option!r}] must be below 2**63, not {asked!r}")
    if not isinstance(family, GrownMazes) and not ((array >= 0) & (array < family.count)).all():
        raise ValueError(
            f"options[{family.option!r}] must be below {family.count:,}, not {asked!r}"
        )
    return np.broadcast_to(array.astype(np.int64), num_envs)


def checked_autoreset_mode(mode: Any) -> AutoresetMode:
    """Return the mode; its value, such as `"SameStep"`, may stand for it.

    Raises:
        ValueError: it is none.
    """
    try:
        return AutoresetMode(mode)
    except ValueError:
        known = ", ".join(str(each) for each in AutoresetMode)
        raise ValueError(f"autoreset_mode must be one of {known}, not {mode!r}") from None


def checked_actions(actions: Any, num_envs: int) -> NDArray[np.intp]:
    """Return actions as an array `[num_envs]`; what numbers they are, engines check.

    Raises:
        InvalidAction: they are no such array of whole numbers.
    """
    try:
        array = np.asarray(actions)
    except ValueError as reason:  # Lists of different lengths are no array.
        raise error.InvalidAction(f"actions must be {num_envs} whole numbers: {reason}") from None
    # Most actions come so, and the checks below would take longer.
    if array.dtype is _INT and array.shape == (num_envs,) and array.flags.carray:
        return array
    if array.dtype.kind not in "iu" or array.shape != (num_envs,):
        raise error.InvalidAction(
            f"actions must be {num_envs} whole numbers, not an array of {array.dtype} "
            f"with shape {list(array.shape)}"
        )
    return array.astype(np.intp)


def checked_reset_mask(mask: Any, num_envs: int) -> NDArray[np.intp]:
    """Return the numbers of the environments that a reset is about; None stands for all.

    Raises:
        TypeError: the mask is no array of bools.
        ValueError: it has another shape than `[num_envs]`, or no True in it.
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


def checked_seeds(seed: Any, num_envs: int) -> list[int | None]:
    """Return the seeds, one for each environment, None for those that are not seeded.

    Raises:
        ValueError: there are more or fewer of them, or one is no whole number from 0 on.
    """
    given = list(seed) if np.iterable(seed) else []
    seeds = [None if each is None else whole_number(each) for each in given]
    wrong = [
        each is not None and (number is None or number < 0)
        for each, number in zip(given, seeds, strict=True)
    ]
    if len(seeds) != num_envs or any(wrong):
        raise ValueError(
            f"seed must be a whole number from 0 on, or a list of {num_envs} such numbers, "
            "of which None leaves an environment's generator as it is"
        )
    return seeds
