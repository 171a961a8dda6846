"""Linear systems of Markov chains: expected sums until the end, and averages in the long run."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.model import Model, attractor, closed_classes, surely_ending
from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError
from babyrobot_levels.analysis.solver.sweeps import raised, settled
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.tables import Flags, Floats, Ints
from babyrobot_levels.text import budget

MAX_STEPS = 1e10
"""Sums over more steps than this have lost too many digits: each step takes a part in 10^16."""

ZERO = 1e-12
"""Averages of this share of the largest reward are rounding errors: they count as zero."""

DENSE_STATES = 150
"""Up to so many states, dense elimination is faster than sparse, and needs no SciPy."""

MANY_STATES = 3_000
"""From so many states on, elimination may take long."""

FILLED = 6
"""Where states have more outcomes than this on average, elimination fills up the matrix.

Movers that walk at random make such systems; on a grid alone, elimination keeps them sparse.
"""

MOST_LAYERS = 64
"""The most layers of a level, none of which can be entered from the one before, that are apart."""

ITERATIONS = 500
"""After so many iterations without a solution, elimination does it."""

CONVERGED = 1e-9
"""The largest violation of an equation, as a share of the largest reward, of a solution."""


def expected_sums(
    chain: Model, rewards: Floats, discount: float, steps: Floats | None = None
) -> Floats:
    """Return the expected discounted sum of some rewards until the end.

    Args:
        chain: a model with one action. Without a discount, each state must lead to the end with
            probability one.
        rewards: the reward of a step from each state, `[n]`, or several such columns,
            `[n, columns]`.
        discount: the factor by which each further step counts less.
        steps: the expected steps to the end from each state, `[n]`, where they are known.

    Returns:
        The sums, shaped as `rewards`.

    Raises:
        EpisodeTooLongError: there is no discount, and it takes more than 10^10 steps on average.
    """
    if chain.size == 0:
        return rewards.copy()
    if discount < 1 or steps is not None:
        return _solved(chain, rewards, discount)
    columns = np.column_stack([rewards, np.ones(chain.size)])
    try:
        sums = _solved(chain, columns, 1.0)
    except ArithmeticError:
        raise EpisodeTooLongError from None
    if not ((sums[:, -1] > 0) & (sums[:, -1] < MAX_STEPS)).all():
        raise EpisodeTooLongError
    return sums[:, :-1].reshape(rewards.shape)


def expected_visits(chain: Model, begin: Floats, discount: float) -> Floats:
    """Return the expected discounted number of visits of each state until the end, `[n]`.

    Args:
        chain: as for `expected_sums`.
        begin: how likely an episode begins in each state, `[n]`.
        discount: the factor by which the visit after each further step counts less.

    Raises:
        EpisodeTooLongError: there is no discount, and it takes more than 10^10 steps on average.
    """
    if chain.size == 0:
        return begin.copy()
    try:
        visits = _solved(chain, begin, discount, transposed=True)
    except ArithmeticError:
        raise EpisodeTooLongError from None
    if not (visits.min() >= -CONVERGED and visits.sum() < MAX_STEPS):
        raise EpisodeTooLongError
    return np.maximum(visits, 0.0)


def _solved(chain: Model, rewards: Floats, discount: float, *, transposed: bool = False) -> Floats:
    """Return the solution of `x = rewards + discount * P x`, or with P transposed.

    Raises:
        ArithmeticError: there is none, for all that floating point can tell.
    """
    size = chain.size
    weights = discount * chain.probability[:, 0]
    if size <= DENSE_STATES:
        cells = np.arange(size)[:, None] * (size + 1) + chain.next_state[:, 0]
        flat = np.bincount(cells.ravel(), weights.ravel(), size * (size + 1))
        matrix = np.eye(size) - flat.reshape(size, size + 1)[:, :size]
        try:
            return np.asarray(np.linalg.solve(matrix.T if transposed else matrix, rewards))
        except np.linalg.LinAlgError as error:
            raise ArithmeticError from error
    return _sparse_sums(chain.next_state[:, 0], weights, rewards, transposed=transposed)


def _sparse_sums(next_state: Ints, weights: Floats, rewards: Floats, *, transposed: bool) -> Floats:
    from scipy.sparse import csr_array, eye_array  # type: ignore[import-untyped]
    from scipy.sparse.linalg import splu  # type: ignore[import-untyped]

    size = next_state.shape[0]
    kept = (weights > 0) & (next_state < size)
    first = np.append(0, np.cumsum(kept.sum(axis=1)))
    steps = csr_array((weights[kept], next_state[kept], first), shape=(size, size))
    steps.sum_duplicates()
    steps = steps.T.tocsr() if transposed else steps
    if size >= MANY_STATES and steps.nnz > FILLED * size:
        found = _iterated((eye_array(size, format="csr") - steps).tocsr(), rewards)
        if found is not None:
            return found
    sums = np.zeros_like(rewards)
    for rows in _layers(steps) if size >= MANY_STATES else [np.arange(size)]:
        is_whole = rows.size == size
        onward = steps if is_whole else steps[rows]
        inner = steps if is_whole else onward[:, rows]
        if budget.left() < math.inf:
            budget.spend(_elimination(inner))
        try:
            # No entry outweighs its diagonal, so elimination needs no pivots but those: it can keep
            # to the order that fills in least, which in a maze is nothing at all.
            factors = splu(
                (eye_array(rows.size, format="csr") - inner).tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                panel_size=4,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise ArithmeticError from error
        # One step of refinement takes away most of the elimination's rounding.
        for _ in range(2):
            budget.spend(3 * factors.nnz)
            sums[rows] += factors.solve(rewards[rows] + onward @ sums - sums[rows])
    return sums


def _layers(steps: Any) -> list[Ints]:
    """Split states into layers, from each of which steps lead into itself or to those before it.

    Where few steps in a row cannot be taken back, as taking an item, elimination layer by layer
    fills in far less, and needs room for one layer at a time.

    Returns:
        The states of each layer; all states as one, where there would be too many layers.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components  # type: ignore[import-untyped]

    count, part = connected_components(steps, connection="strong")
    source = np.repeat(part, np.diff(steps.indptr))
    leaves = source != part[steps.indices]
    ends = source[leaves], part[steps.indices[leaves]]
    onward = csr_array((np.ones(ends[0].size), ends), shape=(count, count))
    layer, reached = np.zeros(count, np.int32), np.ones(count)
    while (reached := np.minimum(onward @ reached, 1.0)).any():
        layer += reached > 0
        if layer.max() == MOST_LAYERS:
            return [np.arange(part.size)]
    layers = layer[part]
    return [np.flatnonzero(layers == number) for number in range(layer.max() + 1)]


def _elimination(steps: Any) -> float:
    """Return about how many steps of work it takes to eliminate a sparse matrix.

    A tree is eliminated from its leaves. Each circle that is closed beside it fills in more: in a
    grid, and in what movers make of it, this grows with the power of 1.5.
    """
    from scipy.sparse.csgraph import connected_components

    leads = steps.astype(bool)
    pairs = (leads + leads.T).tocoo()
    count, part = connected_components(pairs, directed=False)
    sides = np.bincount(part[pairs.row[pairs.row > pairs.col]], minlength=count)
    circles = sides - np.bincount(part) + 1
    return float(3 * (circles**1.5).sum() + 100 * steps.shape[0])


def _iterated(matrix: Any, rewards: Floats) -> Floats | None:
    """Return the solution of a sparse system by a Krylov method; None if it does not converge."""
    from scipy.sparse.linalg import bicgstab

    sums = np.zeros_like(rewards)
    # From a vector without structure: a residual of few entries may be orthogonal to the next one.
    start = np.random.default_rng(0).random(sums.shape[0])
    for index in np.ndindex(rewards.shape[1:]):
        column = (slice(None), *index)
        # As after elimination, a second step takes away most of the rounding of the first one.
        for is_first in (True, False):
            budget.spend(50 * matrix.nnz)
            left = rewards[column] - matrix @ sums[column]
            size = np.abs(left).max() or 1.0
            with np.errstate(all="ignore"):
                found, _ = bicgstab(matrix, left / size, start, rtol=1e-13, maxiter=ITERATIONS)
                converges = np.abs(matrix @ found - left / size).max() < CONVERGED
            if converges:
                sums[column] += size * found
            elif is_first:
                return None
    return sums


def cycles(chain: Model, homes: Flags) -> Floats:
    """Return rewards and steps until the next visit of one of some states, the homes.

    Args:
        chain: a model with one action that reaches a home from each state, and never ends.
        homes: the homes, `[n]`.

    Returns:
        The expected sum of rewards, and the expected number of steps, `[n, 2]`; from a home, until
        the next visit of one. Their ratio is a home's average reward.
    """
    columns = np.stack([chain.reward[:, 0], np.ones(chain.size)], axis=1)
    ahead = np.zeros((chain.size + 1, 2))
    others = np.flatnonzero(~homes)
    ahead[others] = expected_sums(chain.restrict(~homes), columns[others], 1.0)
    following = ahead[chain.next_state[:, 0]]
    columns += np.einsum("so,soc->sc", chain.probability[:, 0], following)
    return columns


def class_averages(chain: Model) -> Floats:
    """Return the average reward of each closed class of a chain, `[n]`; nan outside of them."""
    label = closed_classes(chain)
    found = np.full(chain.size, np.nan)
    kept = label >= 0
    _, first, number = np.unique(label[kept], return_index=True, return_inverse=True)
    homes = np.zeros(number.size, bool)
    homes[first] = True
    total, steps = cycles(chain.restrict(kept), homes)[first].T
    found[kept] = (total / steps)[number]
    return found


def long_run(chain: Model, space: StateSpace) -> tuple[Floats, Flags]:
    """Return the sign of the long-run average reward of each state of a chain.

    Returns:
        The sign of the average reward of a state's closed class, `[n]`, nan outside of them; and
        which states these are, `[n]`.

    Raises:
        UndefinedReturnError: there is a class in which rewards cancel out.
    """
    average = class_averages(chain)
    closed = ~np.isnan(average)
    if not closed.any():
        return average, closed
    scale = float(np.abs(chain.reward[closed]).max())
    sign = np.where(np.abs(average) <= ZERO * scale, 0.0, np.sign(average))
    unclear = (sign == 0) & (chain.reward[:, 0] != 0)
    if unclear.any():
        raise space.undefined_return(chain, unclear)
    return sign, closed


def diverging_class(chain: Model, starts: Ints, sign: float) -> Ints:
    """Return the states of a closed class in which an undiscounted return diverges.

    Args:
        chain: a model with one action.
        starts: the states in which an episode can start.
        sign: the sign of the return, which is infinite.

    Returns:
        The class with the most extreme average reward of those reached from the starts, sorted.
    """
    edges = np.flatnonzero(chain.probability > 0)
    source, target = edges // chain.probability.shape[2], chain.next_state.ravel()[edges]
    reached = Graph(chain.size + 1, source, target).distances(starts.tolist())[:-1] >= 0
    average = np.where(reached, sign * class_averages(chain), np.nan)
    label = closed_classes(chain)
    return np.flatnonzero(label == label[np.nanargmax(average)])


SLACK = 1e-14
"""Improvements by no more than this share of the largest value are rounding errors."""

TIE = 1e-13
"""Actions that differ by no more than this share of the largest value are equally good."""

MAX_SWEEPS = 30
"""Sweeps between two exact evaluations. They only save time."""

SWEEPS = "sweeps in order of distance, and policy iteration"
"""How large levels are solved."""

IMPATIENCE = 1e-5
"""The chance to give up at each step, in the search for a policy that ends soon."""


@dataclass(frozen=True, eq=False)
class Iterated:
    """Optimal values, `[n]`, how they were found, and a policy, which is found when asked for."""

    values: Floats
    find_policy: Callable[[], Ints]
    rounds: int
    method: str = "policy iteration"

    @cached_property
    def policy(self) -> Ints:
        """A policy that attains the values, `[n]`."""
        return self.find_policy()


def iterate_policies(
    model: Model, discount: float, slack: float = SLACK, start: Ints | None = None
) -> Iterated:
    """Return optimal values and a policy.

    Without a discount, the policy to begin with must lead to the end with probability one, however
    late, and so does the result: an action is replaced only by one that is strictly better, which
    creates no loop unless its rewards are positive.

    Each round evaluates the policy exactly and then improves it by sweeps of value iteration, so
    that a change spreads over the whole level and not by one cell. The last round raises no value
    by more than rounding; values cannot rise for ever, so there is one.

    Large levels are solved by machine code instead.

    Args:
        model: the states and actions.
        discount: the discount.
        slack: improvements by no more than this share of the largest value do not count.
        start: the policy to begin with, `[n]`; by default, one that is likely to come nearer to the
            end, where that can be reached.
    """

    def begin() -> Ints:
        return towards_end(model) if start is None else start

    found = settled(model, begin, discount)
    if found is not None:
        return Iterated(*found, SWEEPS)
    policy = in_good_time(model, begin()) if discount == 1 else begin()
    found = raised(model, policy, discount, slack)
    if found is not None:
        return Iterated(*found, SWEEPS)
    values = expected_sums(model.under(policy), _rewards(model, policy), discount)
    rounds = 1
    while True:
        improved = _sweep(model, values, policy, discount, slack)
        if (improved == policy).all():
            break
        risen = expected_sums(model.under(improved), _rewards(model, improved), discount)
        rounds += 1
        if not (risen > values + slack / 2 * scale_of(model, values)).any():
            break
        values, policy = risen, improved
    return Iterated(values, lambda: policy, rounds)


def towards_end(model: Model) -> Ints:
    """Return the actions most likely to come nearer to the end, `[n]`; else those that pay most."""
    _, action = attractor(model, model.end, model.allowed)
    return np.where(action >= 0, action, model.reward.argmax(axis=1))


def _rewards(model: Model, policy: Ints) -> Floats:
    return model.reward[np.arange(model.size), policy]


def scale_of(model: Model, values: Floats) -> float:
    """Return the largest size of a value or a reward."""
    rewards = np.abs(model.reward[model.allowed])
    return float(max(np.abs(values).max(initial=0), rewards.max(initial=0)))


def _sweep(model: Model, values: Floats, policy: Ints, discount: float, slack: float) -> Ints:
    """Return the policy after sweeps of value iteration, as long as they change it."""
    rows = np.arange(model.size)
    slack *= scale_of(model, values)
    for _ in range(MAX_SWEEPS):
        ahead = model.action_values(values, discount)
        own, best = ahead[rows, policy], ahead.argmax(axis=1)
        better = ahead[rows, best] > own + slack
        if not better.any():
            break
        policy = np.where(better, best, policy)
        values = np.where(better, ahead[rows, best], own)
    return policy


def in_good_time(model: Model, policy: Ints) -> Ints:
    """Return a policy that ends with probability one, and does so in good time.

    Args:
        model: the states and actions, of which every state can surely end.
        policy: a policy that ends with probability one, but perhaps only after more steps than
            floating point can count.
    """
    chain = model.under(policy)
    if np.isin(chain.probability, (0.0, 1.0)).all():
        return policy
    # With a chance to give up at each step, any policy will do to start from. And a policy that
    # maximizes its chance to end never settles in a loop: there, it would have none.
    chances = model.with_rewards(np.where(model.allowed, model.ending, -np.inf))
    own = expected_sums(chain, _rewards(chances, policy), 1.0 - IMPATIENCE)
    if own.min(initial=1.0) > 0.5:
        return policy
    return iterate_policies(chances, 1.0 - IMPATIENCE, start=policy).policy


def prefer_ending(
    model: Model, values: Floats, policy: Ints, discount: float
) -> tuple[Ints, Floats | None]:
    """Return an optimal policy that ends as soon as can be expected, where it can surely end.

    Where even that takes too long for floating point, the policy stays as it is.

    Args:
        model: the states and actions.
        values: their optimal values, `[n]`.
        policy: an optimal policy, which stays where the end cannot be reached for sure.
        discount: the discount.

    Returns:
        The policy, and its expected steps from each state, `[n]`, if all of them surely end.
    """
    ahead = model.action_values(values, discount)
    tie = TIE * scale_of(model, values)
    sure, rows = surely_ending(model, ahead >= ahead.max(axis=1, keepdims=True) - tie)
    if not sure.any():
        return policy, None
    ending = model.restrict(sure, rows)
    if discount == 1 and sure.all():
        steps = _steps_by_values(ending, values)
        if steps is not None:
            return policy, steps
    counting = ending.with_rewards(np.where(ending.allowed, -1.0, -np.inf))
    try:
        found = iterate_policies(counting, 1.0)
    except EpisodeTooLongError:
        return policy, None
    policy = policy.copy()
    policy[sure] = found.policy
    return policy, -found.values if sure.all() else None


def _steps_by_values(model: Model, values: Floats) -> Floats | None:
    """Return the steps to the end, `[n]`, if values tell them: each step costs the same.

    The last step may have another reward; all others are then as quick as the values say.
    """
    ends = model.ending
    inner, last = model.allowed & (ends == 0), model.allowed & (ends > 0)
    if not inner.any() or not last.any():
        return None
    cost = -model.reward[inner].max()
    extra = (model.reward[last] + cost) / ends[last]
    same = np.ptp(model.reward[inner]) == 0 and np.ptp(extra) <= ZERO * max(cost, extra.max())
    return (extra[0] - values) / cost if same and cost > 0 else None
