"""The optimum as fractions, with a proof: no action is better, by comparison of whole numbers.

The tables hold floats, but each of them is a fraction with a denominator that follows from the
level: numbers of a file are the decimals that it says, skids are shared among at most three
directions, starts and ways of movers are drawn evenly. Rounding to that denominator gives back what
the float stands for. The optimal policy of the float solver is evaluated over the rationals and
improved until no action is better.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import lcm, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.model import Core, Model, attractor
from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.analysis.solver.results import ExactSolution, NotExactError, Solution
from babyrobot_levels.language.cells import RandomReward
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Flags, Floats, Ints
from babyrobot_levels.text import budget
from babyrobot_levels.text.errors import how_to_install

MAX_STATES = 3_000
"""Elimination over the rationals takes the third power of the number of states."""

DIGITS, MAX_DENOMINATOR, ROUNDED = 16, 1_000, Fraction(1, 10**15)
"""A number with so many characters that is as near to such a fraction is that fraction."""

ROUNDING = 32 * 2.0**-53
"""By which share a number of the tables may differ from what it stands for, at most."""

Numbers = NDArray[np.object_]
"""Whole numbers or fractions of any size."""


@dataclass(frozen=True, eq=False)
class _Rows:
    """A core with whole numbers: a step from state s pays `reward / (chance * unit)`.

    Attributes:
        model: the states and actions.
        probability: `[n, actions, outcomes]`, in units of `1 / chance`.
        reward: the expected reward, `[n, actions]`, in units of `1 / (chance * unit)`.
        chance: the denominator of probabilities.
        unit: the denominator of rewards.
    """

    model: Model
    probability: Numbers
    reward: Numbers
    chance: int
    unit: int


def solve_exactly(space: StateSpace, found: Solution, core: Core) -> ExactSolution:
    """Return the optimum as fractions.

    Args:
        space: the states.
        found: the solution in floating point.
        core: the states with finite values.

    Raises:
        NotExactError: there are too many states, numbers with too many digits, or no python-flint.
    """
    if core.model.size > MAX_STATES:
        raise NotExactError(
            f"exact values are computed for up to {MAX_STATES:,} states, not {core.model.size:,}"
        )
    discount = exactly(found.discount)
    rows = _rows_of(space, core)
    policy, values, ahead, rounds = _improved(rows, core.policy, discount)
    whole, whole_policy = space.model(), found.policy.ravel().copy()
    states, stop = core.model.states, whole.reward.shape[1]
    changed = (policy != core.policy) & (policy != stop)
    whole_policy[states[changed]] = policy[changed]
    all_values = found.values.ravel()[whole.states].astype(object)
    all_ahead = found.action_values.reshape(space.mdp.num_states, -1)[whole.states].astype(object)
    all_values[core.inside] = values
    finite = rows.model.allowed[:, :stop]
    all_ahead[core.inside] = np.where(finite, ahead[:, :stop], all_ahead[core.inside])
    greedy = found.greedy.reshape(space.mdp.num_states, -1).copy()
    greedy[states] = finite & (ahead[:, :stop] == values[:, None])
    steps, success = _episode(space, whole.under(whole_policy[whole.states]), found)
    shape = space.mdp.shape
    return ExactSolution(
        values=_spread(space, whole, all_values),
        action_values=_spread(space, whole, all_ahead),
        expected_return=_at_start(space, whole, all_values),
        expected_steps=steps,
        exit_probability=success,
        discount=discount,
        actions=found.actions,
        greedy=greedy.reshape(*shape, -1),
        policy=whole_policy.reshape(shape),
        error=_largest_error(values, found.values.ravel()[states]),
        iterations=rounds,
        level=found.level,
    )


def _largest_error(values: Numbers, floats: Floats) -> float:
    pairs = zip(values, floats.tolist(), strict=True)
    return float(max((abs(one - Fraction(other)) for one, other in pairs), default=0))


# -- what the floats of the tables stand for ---------------------------------------------------


def _decimals(value: Any) -> Iterator[Fraction]:
    """Yield the numbers of a level, as the decimals that its file says."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple):
        for each in value:
            yield from _decimals(each)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield exactly(value)


def exactly(number: float) -> Fraction:
    """Return what a number of a file stands for: its decimals, or the fraction that it rounds to.

    `0.4` is 2/5. `0.6666666666666667`, with all digits that a float has, is 2/3.
    """
    said = Fraction(repr(number))
    simple = said.limit_denominator(MAX_DENOMINATOR)
    is_rounded = len(repr(number)) >= DIGITS and abs(simple - said) < abs(said) * ROUNDED
    return simple if is_rounded else said


def denominators(level: GridWorld) -> tuple[int, int]:
    """Return a denominator of all probabilities of a level, and one of all rewards."""
    numbers = _decimals(level.model_dump(exclude={*fields_with(Role.EXPECTATION)}))
    unit = lcm(*(number.denominator for number in numbers))
    wanderers = sum(mover.within is not None for mover in level.movers)
    ways = lcm(*range(1, NUM_ACTIONS + 1)) ** wanderers
    ways *= prod(_of_chances(level))
    # A move may meet glass and skid; a warp may lead to one of the starts.
    robots = len(level.robots)
    # A skid is shared by as many directions as are left.
    moves = (unit * unit * lcm(*range(1, level.moves))) ** max(1, robots)
    return moves * (1 if robots else sum(level.weights_of_starts)) * ways, unit


def _of_chances(level: GridWorld) -> Iterator[int]:
    """Yield denominators of what wind, warps and draws of rewards do by chance.

    Chains of warps may take all of them; each robot draws one reward.
    """
    rewards = (area.reward for area in level.areas)
    drawn = (each for each in rewards if isinstance(each, RandomReward))
    yield lcm(*(sum(each.weights_of_values) for each in drawn)) ** max(1, len(level.robots))
    if level.wind is not None:
        yield exactly(level.wind.probability).denominator * (3 if level.wind.varies else 1)
    for warp in level.warps:
        yield exactly(warp.probability).denominator
        if not isinstance(warp.to, str):
            yield sum(weight for _, weight in level.leads_of(warp))


def _whole(numbers: Floats, denominator: int) -> Numbers:
    """Return numbers in units of `1 / denominator`.

    Raises:
        NotExactError: rounding may have changed what they stand for.
    """
    error = float(np.abs(numbers).max(initial=0.0)) * denominator * ROUNDING
    if error > 0.25:
        raise NotExactError(
            "the numbers of the level have too many digits for exact values; "
            "give probabilities and rewards with fewer decimals"
        )
    scaled = numbers * float(denominator)
    found = np.rint(scaled)
    assert (np.abs(found - scaled) <= error).all(), "the tables hold other numbers"
    return found.astype(np.int64).astype(object)


def _rows_of(space: StateSpace, core: Core) -> _Rows:
    """Return the core with whole numbers."""
    model, mdp = core.model, space.mdp
    chance, unit = denominators(space.level)
    probability = _whole(model.probability, chance)
    rewards = _whole(mdp.reward[model.states, space.first_action :], unit)
    reward = np.zeros(model.reward.shape, object)
    taken = rewards.shape[1]
    reward[:, :taken] = (probability[:, :taken, : rewards.shape[2]] * rewards).sum(axis=2)
    return _Rows(model, probability, reward, chance, unit)


# -- linear systems over the rationals ---------------------------------------------------------


def _flint() -> Any:
    try:
        import flint
    except ImportError as error:
        help_text = how_to_install("exact")
        raise NotExactError(f"exact values need python-flint: {help_text}") from error
    return flint


def _solved(
    probability: Numbers,
    next_state: Ints,
    columns: list[list[int]],
    chance: int,
    discount: Fraction,
) -> tuple[list[list[int]], int]:
    """Return the solution of `chance * x = columns + discount * probability x`.

    Args:
        probability: `[n, outcomes]`, in units of `1 / chance`.
        next_state: `[n, outcomes]`; number `n` is the end.
        columns: whole numbers, `[columns][n]`.
        chance: the denominator of the probabilities.
        discount: the discount.

    Returns:
        The numerators, `[columns][n]`, and their denominator.
    """
    flint, size = _flint(), len(probability)
    budget.spend(size**3 / 10)
    if not size:
        return [[] for _ in columns], 1
    cells = [0] * (size * size)
    for row, (chances, targets) in enumerate(
        zip(probability.tolist(), next_state.tolist(), strict=True)
    ):
        cells[row * size + row] = discount.denominator * chance
        for one, target in zip(chances, targets, strict=True):
            if target < size:
                cells[row * size + target] -= discount.numerator * one
    right = [discount.denominator * each for row in zip(*columns, strict=True) for each in row]
    matrix = flint.fmpz_mat(size, size, cells)
    solution = matrix.solve(flint.fmpz_mat(size, len(columns), right))
    numerators, denominator = solution.numer_denom()
    table = [[int(each) for each in row] for row in numerators.tolist()]
    return [list(column) for column in zip(*table, strict=True)], int(denominator)


def _improved(rows: _Rows, policy: Ints, discount: Fraction) -> tuple[Ints, Numbers, Numbers, int]:
    """Return an optimal policy, its values and action values, and the rounds that it took.

    Howard's policy iteration over the rationals: it ends when no action is better.
    """
    model, number = rows.model, np.arange(rows.model.size)
    rounds = 0
    while True:
        rounds += 1
        (values,), denominator = _solved(
            rows.probability[number, policy],
            model.next_state[number, policy],
            [rows.reward[number, policy].tolist()],
            rows.chance,
            discount,
        )
        # In units of 1 / (denominator * unit); action values of 1 / (that * chance * divisor).
        now = np.array([*values, 0], object)
        following = (rows.probability * now[model.next_state]).sum(axis=2)
        own = rows.reward * (denominator * discount.denominator)
        ahead = own + discount.numerator * following
        bar = now[:-1] * (rows.chance * discount.denominator)
        best = np.where(model.allowed, ahead, bar[:, None] - 1).argmax(axis=1)
        better = ahead[number, best] > bar
        if not better.any():
            unit = denominator * rows.unit
            step = unit * rows.chance * discount.denominator
            return policy, _fractions(now[:-1], unit), _fractions(ahead, step), rounds
        policy = np.where(better, best, policy)


def _fractions(numerators: Numbers, denominator: int) -> Numbers:
    found = np.empty(numerators.shape, object)
    for at, numerator in np.ndenumerate(numerators):
        found[at] = Fraction(int(numerator), denominator)
    return found


def _episode(
    space: StateSpace, chain: Model, found: Solution
) -> tuple[Fraction | float, Fraction | float]:
    """Return the expected steps to the end, inf if there may be none, and how likely an exit is."""
    ends: Flags = attractor(chain, chain.end, chain.allowed)[0]
    part = chain.restrict(ends)
    chance, _ = denominators(space.level)
    probability = _whole(part.probability[:, 0], chance)
    success = _whole(part.success[:, 0], chance)
    columns = [[chance] * part.size, success.tolist()]
    (steps, exits), denominator = _solved(
        probability, part.next_state[:, 0], columns, chance, Fraction(1)
    )
    both = np.zeros((2, chain.size), object)
    both[:, ends] = _fractions(np.array([steps, exits], object), denominator)
    likely = _at_start(space, chain, both[1])
    endless = np.isinf(found.expected_steps)
    return float("inf") if endless else _at_start(space, chain, both[0]), likely


def _at_start(space: StateSpace, model: Model, values: Numbers) -> Fraction | float:
    """Return the expectation over the starts."""
    chances = space.mdp.start[model.states]
    begin = np.flatnonzero(chances)
    infinite = [value for value in values[begin] if isinstance(value, float)]
    if infinite:
        return max(infinite)
    weights = [Fraction(float(chance)).limit_denominator(10**6) for chance in chances[begin]]
    if sum(weights) != 1:
        raise NotExactError("the level has too many starts for exact values")
    return sum((a * b for a, b in zip(weights, values[begin], strict=True)), Fraction(0))


def _spread(space: StateSpace, model: Model, values: Numbers) -> Numbers:
    """Return values of a model's states as an array over all states, as `StateSpace.spread`."""
    table = np.full((space.mdp.num_states, *values.shape[1:]), Fraction(0), object)
    table[space.without_value] = float("nan")
    table[model.states] = values
    return table.reshape(*space.mdp.shape, *values.shape[1:])
