"""Many levels at once, each within its own limit of steps: returns, chances and numbers of steps.

The states of levels with the same limit stand in one sparse matrix, so that a step of backward
induction is one product for all of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.horizon import after
from babyrobot_levels.analysis.solver.model import Floats, Model
from babyrobot_levels.analysis.solver.space import StateSpace

MAX_STATES = 100_000
"""The most states of levels that are solved together; a level with more stands alone."""

_FASTER = 8
"""How much faster a product with a sparse matrix is than the same sums with NumPy, about."""


@dataclass(frozen=True, eq=False)
class Worth:
    """What a policy is worth from the starts of several levels, float64 `[levels]` each.

    Attributes:
        returns: the expected return.
        success: the probability of reaching an exit in time.
        steps: the expected number of steps.
    """

    returns: Floats
    success: Floats
    steps: Floats


def best_returns_within(
    spaces: Sequence[StateSpace], limits: Sequence[int], discounts: Sequence[float]
) -> Floats:
    """Return the optimal expected returns of levels, float64 `[levels]`.

    Args:
        spaces: the levels' states, all with the same set of actions.
        limits: after how many steps the episodes of each are truncated.
        discounts: the discount factor of each.

    Raises:
        EpisodeTooLongError: a limit is so large that this takes too long.
    """
    found = np.zeros(len(spaces))
    for part, limit in _parts(spaces, limits):
        models = [spaces[number].model() for number in part]
        ahead, reward = _transitions(models), np.concatenate([model.reward for model in models])
        discount = _by_state([discounts[number] for number in part], models)[:, None]

        def step(
            values: Floats, ahead: Any = ahead, reward: Floats = reward, factor: Floats = discount
        ) -> Floats:
            best: Floats = (reward + factor * (ahead @ values).reshape(reward.shape)).max(axis=1)
            return best

        values = after(step, np.zeros(len(reward)), limit, ahead.nnz // _FASTER)
        found[part] = _at_starts(values, [spaces[number] for number in part], models)
    return found


def worth_within(
    spaces: Sequence[StateSpace],
    limits: Sequence[int],
    discounts: Sequence[float],
    policies: Sequence[Floats],
    quick: bool = False,
) -> Worth:
    """Return what policies are worth, each in its level.

    Args:
        spaces: the levels' states, all with the same set of actions.
        limits: after how many steps the episodes of each are truncated.
        discounts: the discount factor of each.
        policies: the probability of each action, `[states, actions]` for each level.
        quick: whether this may take a second at most; see `induction`.

    Raises:
        EpisodeTooLongError: a limit is so large that it would take longer.
    """
    found = np.zeros((3, len(spaces)))
    for part, limit in _parts(spaces, limits):
        own = [spaces[number] for number in part]
        models = [space.model() for space in own]
        chains = [
            model.mixed(policies[number][model.states])
            for number, model in zip(part, models, strict=True)
        ]
        ahead = _transitions(chains)
        gains = np.concatenate(
            [np.stack([c.reward[:, 0], c.success[:, 0], np.ones(c.size)]).T for c in chains]
        )
        factors = np.ones_like(gains)
        factors[:, 0] = _by_state([discounts[number] for number in part], chains)

        def step(
            sums: Floats, ahead: Any = ahead, gains: Floats = gains, factors: Floats = factors
        ) -> Floats:
            more: Floats = gains + factors * (ahead @ sums)
            return more

        sums = after(step, np.zeros_like(gains), limit, ahead.nnz // _FASTER, quick)
        for row, column in zip(found, sums.T, strict=True):
            row[part] = _at_starts(column, own, models)
    return Worth(found[0], np.clip(found[1], 0.0, 1.0), found[2])


def _parts(spaces: Sequence[StateSpace], limits: Sequence[int]) -> Iterator[tuple[list[int], int]]:
    """Yield the numbers of levels that are solved together, and their limit."""
    order = sorted(range(len(spaces)), key=lambda number: limits[number])
    for limit, numbers in groupby(order, key=lambda number: limits[number]):
        part: list[int] = []
        states = 0
        for number in numbers:
            size = spaces[number].mdp.num_states
            if part and states + size > MAX_STATES:
                yield part, limit
                part, states = [], 0
            part.append(number)
            states += size
        yield part, limit


def _transitions(models: Sequence[Model]) -> Any:
    """Return the probabilities to come from a state by an action to a state, as one sparse matrix.

    Its rows are the actions of each state in turn. What ends the episode is left out.
    """
    from scipy.sparse import csr_array  # type: ignore[import-untyped]

    first = np.cumsum([0, *(model.size for model in models)])
    rows, columns, chances = [], [], []
    row = 0
    for model, offset in zip(models, first.tolist(), strict=False):
        goes_on = (model.probability > 0) & (model.next_state < model.size)
        where = np.flatnonzero(goes_on)
        actions, outcomes = model.probability.shape[1:]
        rows.append(where // outcomes + row)
        columns.append(model.next_state.ravel()[where] + offset)
        chances.append(model.probability.ravel()[where])
        row += model.size * actions
    entries = np.concatenate(chances), (np.concatenate(rows), np.concatenate(columns))
    return csr_array(entries, shape=(row, int(first[-1])))


def _by_state(numbers: Sequence[float], models: Sequence[Model]) -> Floats:
    return np.repeat(np.asarray(numbers, np.float64), [model.size for model in models])


def _at_starts(
    values: Floats, spaces: Sequence[StateSpace], models: Sequence[Model]
) -> list[float]:
    """Return the expectation of values over the starts of each level."""
    parts = np.split(values, np.cumsum([model.size for model in models])[:-1])
    return [
        space.at_start(model, part)
        for space, model, part in zip(spaces, models, parts, strict=True)
    ]
