"""Episodes with a time limit: optimal values by the number of steps that are left.

What is optimal then depends on the time: with few steps left, it can be better to take a small
reward than to begin a way to a large one. Backward induction gives all of it exactly: the values
with k + 1 steps left follow from those with k.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.model import Floats, Model
from babyrobot_levels.analysis.solver.space import StateSpace, space_of
from babyrobot_levels.library.catalogue import load

MAX_STATE_STEPS = 5_000_000
"""Up to this many states times steps, it takes about a second at most."""


def best_return_within(
    level: Any, steps: int, *, actions: str = "all", discount: float = 1.0
) -> float:
    """Return the largest expected return of episodes that are truncated after a number of steps.

    It is that of a policy that knows how many steps are left: the expected discounted sum of
    rewards, over the starts of the level. It is exact, and always finite.

    Args:
        level: a name, a path, a mapping or a `Level`.
        steps: how many steps an episode has at most.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        discount: the discount factor, by default 1: none.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: there is no such set of actions, or there are fewer than 0 steps.
    """
    space = space_of(load(level), actions)
    return _at_start(space, space.model(), steps, discount)


def _at_start(space: StateSpace, model: Model, steps: int, discount: float) -> float:
    """Return the largest expected return from the starts with a number of steps left."""
    if steps < 0:
        raise ValueError(f"steps must be 0 or more, not {steps}")
    values = np.zeros(model.size)
    for more in islice(values_by_steps_left(model, discount), 1, steps + 1):
        if np.array_equal(more, values):
            # Further steps add nothing.
            break
        values = more
    return space.at_start(model, values)


def values_by_steps_left(model: Model, discount: float) -> Iterator[Floats]:
    """Yield the optimal values, `[n]`, with 0 steps left, with 1, with 2, and so on, without end.

    With k + 1 steps left, the best actions are those of the largest
    `model.action_values(values, discount)`, where `values` are those with k.
    """
    values = np.zeros(model.size)
    while True:
        yield values
        values = model.action_values(values, discount).max(axis=1)
