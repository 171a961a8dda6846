"""Checks of what users hand to a vector environment, with messages that say what would be right."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import error
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from babyrobot_levels.catalogue import load
from babyrobot_levels.engine.arguments import whole_number
from babyrobot_levels.envs.arguments import checked_start
from babyrobot_levels.level import Level


def checked_levels(level: Any, levels: Any) -> list[Level]:
    """Return the levels that are played, of which one argument or the other tells.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        ValueError: both or none are given, or a level grows another maze each time.
    """
    if (level is None) == (levels is None):
        raise ValueError("give a level, or a list of levels, and not both")
    if levels is not None and (isinstance(levels, str) or not isinstance(levels, Sequence)):
        raise ValueError(f"levels must be a list of levels, not {levels!r}")
    loaded = [load(each) for each in ([level] if levels is None else levels)]
    if not loaded:
        raise ValueError("levels must have at least one level in it")
    for each in loaded:
        if each.has_random_maze:
            raise ValueError(
                "a vector environment needs levels whose mazes have a seed. In the place of "
                "`maze: {seed: random}`, let it draw among some of its mazes: "
                "levels=[level.with_maze_seed(seed) for seed in range(100)], draw_levels=True"
            )
    return loaded


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
    array = np.asarray(actions)
    if array.dtype.kind not in "iu" or array.shape != (num_envs,):
        raise error.InvalidAction(
            f"actions must be {num_envs} whole numbers, not an array of {array.dtype} "
            f"with shape {list(array.shape)}"
        )
    if array.dtype == np.intp and array.flags.carray:
        return array
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


def checked_starts(start: Any, levels: Sequence[Level]) -> NDArray[np.intp] | None:
    """Return the state of a cell in each level, `[levels]`, None for None.

    Raises:
        ValueError: an episode cannot begin there, in one of the levels.
    """
    if start is None:
        return None
    return np.array([checked_start(start, level) for level in levels], np.intp)


def checked_seeds(seed: Any, num_envs: int) -> Any:
    """Return the seeds, one for each environment.

    Raises:
        ValueError: there are more or fewer of them, or one is no whole number from 0 on.
    """
    seeds = [whole_number(each) for each in seed] if np.iterable(seed) else []
    if len(seeds) != num_envs or any(each is None or each < 0 for each in seeds):
        raise ValueError(
            f"seed must be a whole number from 0 on, or a list of {num_envs} such numbers"
        )
    return seeds
