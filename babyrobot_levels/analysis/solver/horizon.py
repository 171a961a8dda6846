"""Episodes with a time limit: backward induction, and optimal values by the steps that are left.

What is optimal then depends on the time: with few steps left, it can be better to take a small
reward than to begin a way to a large one. Backward induction gives all of it exactly: the values
with k + 1 steps left follow from those with k. The states of several levels with the same limit
stand in one sparse matrix, so that a step is one product for all of them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, islice
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.model import Model
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError
from babyrobot_levels.mdp.gridworld import world_of
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.text import budget

MAX_WORK = 10_000_000_000
"""About how many nanoseconds backward induction may take."""

QUICK_WORK = 1_000_000_000
"""The same where it is to be quick."""

_ROUND = 100_000
"""How long a round takes in a small level, in nanoseconds."""

_OUTCOME = 30
"""How long it takes to add up an outcome with NumPy, in nanoseconds."""

_ALWAYS = 2000
"""So many rounds are computed in any level unless it is to be quick."""

FIRST_LOOK = 1024
"""From so many rounds on, it is looked for changes that repeat."""

_MOST_PERIODS = 4
"""How many periods are tried at a time."""

EXACT = 1e-9
"""By which share values may be wrong after all repetitions."""

_EPS = float(np.finfo(np.float64).eps)


def best_return_within(
    level: Any, steps: int, *, actions: str = "all", discount: float = 1.0, quick: bool = False
) -> float:
    """Return the largest expected return of episodes that are truncated after a number of steps.

    It is that of a policy that knows how many steps are left: the expected discounted sum of
    rewards, over the starts of the level. It is exact, and always finite.

    Args:
        level: a name, a path, a mapping or a `Level`.
        steps: how many steps an episode has at most.
        actions: `"all"`, `"moves"` without stay, or `"turns"`: turn left, turn right, forward.
        discount: the discount factor, by default 1: none.
        quick: whether this may take a second at most; see `induction`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: there is no such set of actions, or there are fewer than 0 steps.
        EpisodeTooLongError: it would take longer.
    """
    if steps < 0:
        raise ValueError(f"steps must be 0 or more, not {steps}")
    space = space_of(world_of(level), actions)
    model = space.model()

    def step(values: Floats) -> Floats:
        best: Floats = model.action_values(values, discount).max(axis=1)
        return best

    return space.at_start(
        model, after(step, np.zeros(model.size), steps, model.probability.size, quick)
    )


def after(
    step: Callable[[Floats], Floats], values: Floats, count: int, size: int, quick: bool = False
) -> Floats:
    """Return the values after all rounds of `induction`."""
    found = values
    for _, found, _, _ in induction(step, values, count, size, quick):  # noqa: B007
        pass
    return found


def induction(
    step: Callable[[Floats], Floats], values: Floats, count: int, size: int, quick: bool = False
) -> Iterator[tuple[int, Floats, int, int]]:
    """Yield the values after each round of backward induction but those that are like others.

    Once a round changes nothing, or rounds change values by the same again and again, all that
    remain but the last ones are one sum.

    Args:
        step: returns from the values with k steps left, `[states, …]`, those with k + 1. It takes
            the best of sums with positive weights, or one such sum.
        values: those with no steps left.
        count: how many rounds there are.
        size: how many outcomes a round adds up with NumPy.
        quick: whether this may take a second at most, because nobody asked for the figure
            alone. Else it may take some seconds, and 2,000 rounds whatever they take.

    Yields:
        The number of steps that are left, from 1 on, and the values; and a period and a number of
        repetitions: what is best in this round is also best the period later, twice the period
        later and so on, so many times. Such later rounds are not yielded.

    Raises:
        EpisodeTooLongError: it would take longer.
    """
    rounds, cost = 0, _ROUND + _OUTCOME * size
    allowed = QUICK_WORK // cost if quick else max(_ALWAYS, MAX_WORK // cost)

    def counted(values: Floats) -> Floats:
        nonlocal rounds
        rounds += 1
        if rounds > allowed:
            raise EpisodeTooLongError(
                f"what is earned within {count:,} steps takes too long to compute; "
                "give a smaller limit of steps"
            )
        budget.spend(cost / 10)
        return step(values)

    done, look = 0, FIRST_LOOK
    mix = np.sqrt(np.arange(1, values.size + 1)).reshape(values.shape)
    sums = []
    while done < count:
        past, values = values, counted(values)
        done += 1
        if np.array_equal(past, values):
            yield done, values, 1, count - done
            return
        yield done, values, 0, 0
        sums.append(float((mix * values).sum()))
        if done < look or done == count:
            continue
        look *= 2
        rounding = 64 * _EPS * float((mix * np.abs(values)).sum())
        for period in _periods(np.diff(sums[-look // 4 :]), rounding):
            periods = (count - done) // period
            if not _repeats(counted, values, period, periods):
                continue
            # At both ends, more can be equally good than in between: see `_repeats`.
            for _ in range(3 * period):
                values = counted(values)
                done += 1
                yield done, values, 0, 0
            begin, repetitions = values, periods - 6
            for _ in range(period):
                values = counted(values)
                done += 1
                yield done, values, period, repetitions
            values = values + repetitions * _growth(begin, values)
            done += period * repetitions
            break


def _periods(growth: Floats, least: float) -> list[int]:
    """Return the shortest periods in which numbers repeat but for less than some difference."""
    lags = np.arange(1, growth.size // 2 + 1)
    close = lags[np.abs(growth[-1 - lags] - growth[-1]) <= least]
    found = (
        lag
        for lag in close[: 8 * _MOST_PERIODS].tolist()
        if (np.abs(growth[lag:] - growth[:-lag]) <= least).all()
    )
    return list(islice(found, _MOST_PERIODS))


def _repeats(step: Callable[[Floats], Floats], values: Floats, period: int, periods: int) -> bool:
    """Return whether values go on to change by the same, period after period.

    With F for the rounds of a period and d for what one of them adds, F(v + j d) is convex in j:
    a maximum of sums that grow with j. If it is v + (j + 1) d for j = 0, 1 and the last period, it
    is so for all in between, and what is best in one of these is best in all. Where success and
    number of steps choose among the best, each of them loses a period at both ends.
    """
    if periods < 16:
        return False
    rows = [values]
    for _ in range(3):
        values = rows[-1]
        for _ in range(period):
            values = step(values)
        rows.append(values)
    numbers = np.array([0, 1, 2, 3, periods - 2, periods - 1, periods])
    rows += [rows[0] + number * _growth(*rows[:2]) for number in numbers[4:]]
    for _ in range(period + 1):
        growth = _growth(*rows[:2])
        line = [rows[0] + number * growth for number in numbers]
        largest = np.abs(line[-1]).max(axis=0)
        for number, row, expected in zip(numbers, rows, line, strict=True):
            # Errors of the first periods add up in all that follow.
            share = EXACT / periods if number <= 3 else 64 * _EPS
            if (np.abs(row - expected) > share * largest).any():
                return False
        rows = [step(row) for row in rows]
    return True


def _growth(before: Floats, after: Floats) -> Floats:
    """Return by what values grow, without rounding errors, which many repetitions would spread."""
    unit = np.exp2(np.ceil(np.log2(16 * _EPS * np.maximum(np.abs(after).max(axis=0), 1e-300))))
    growth: Floats = np.rint((after - before) / unit) * unit
    return growth


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
