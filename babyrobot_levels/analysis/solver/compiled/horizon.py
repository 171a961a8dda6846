"""Backward induction of one small level, compiled: for very many levels, one after the other."""

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.compiled.rows import Floats, jit

_EQUAL = 1e-12
"""As in `within`: probabilities and numbers of steps that differ by no more are equal."""

_ROUNDING = 4 * np.finfo(np.float64).eps


@jit
def optimum(  # type: ignore[no-untyped-def]
    probability: Floats, next_state: NDArray[np.int32], reward: Floats, success: Floats,
    discount: float, slack: float, steps: int,
):  # fmt: skip
    """Return what is expected of the best actions with all steps left, `[n, 3]`.

    These are values, success and steps, as `solve_within` has them: of equally good actions, one
    that is most likely to reach an exit, and of these the fastest.

    Args:
        probability: `[n, actions, outcomes]`.
        next_state: `[n, actions, outcomes]`; `n` for the end.
        reward: `[n, actions]`.
        success: `[n, actions]`.
        discount: the discount factor.
        slack: by how much equally good actions may differ.
        steps: the number of steps.
    """
    size, actions, outcomes = probability.shape
    # What can happen, one outcome after the other: of most actions there is one.
    begin = np.zeros(size * actions + 1, np.uint32)
    chance = np.zeros(probability.size)
    after = np.zeros(probability.size, np.uint32)
    count = 0
    for state in range(size):
        for action in range(actions):
            for outcome in range(outcomes):
                if probability[state, action, outcome] > 0:
                    chance[count] = probability[state, action, outcome]
                    after[count] = next_state[state, action, outcome]
                    count += 1
            begin[state * actions + action + 1] = count
    ahead = np.zeros((size + 1, 3))
    now = np.zeros((size + 1, 3))
    values, equals = np.zeros(actions), np.zeros((actions, 2))
    # Where what is expected ahead differs from a step before: all else stays as it is.
    differs = np.ones(size + 1, np.bool_)
    differs_now = np.zeros(size + 1, np.bool_)
    for _ in range(steps):
        is_same = True
        for state in range(size):
            row = state * actions
            at, end = begin[row], begin[row + actions]
            while at < end and not differs[after[at]]:
                at += 1
            if at == end:
                for column in range(3):
                    now[state, column] = ahead[state, column]
                differs_now[state] = False
                continue
            best = -np.inf
            for action in range(actions):
                value = 0.0
                for at in range(begin[row + action], begin[row + action + 1]):
                    value += chance[at] * ahead[after[at], 0]
                values[action] = reward[state, action] + discount * value
                best = max(best, values[action])
            least, likeliest = best - max(_ROUNDING * abs(best), slack), -np.inf
            # The rest matters of equally good actions only, which are few.
            count = 0
            for action in range(actions):
                if values[action] >= least:
                    likely, length = 0.0, 0.0
                    for at in range(begin[row + action], begin[row + action + 1]):
                        likely += chance[at] * ahead[after[at], 1]
                        length += chance[at] * ahead[after[at], 2]
                    equals[count, 0] = success[state, action] + likely
                    equals[count, 1] = 1.0 + length
                    likeliest = max(likeliest, equals[count, 0])
                    count += 1
            chosen, shortest = 0, np.inf
            if count > 1:
                for each in range(count):
                    if equals[each, 0] >= likeliest - _EQUAL:
                        shortest = min(shortest, equals[each, 1])
                longest = shortest + _EQUAL * max(1.0, shortest)
                while equals[chosen, 0] < likeliest - _EQUAL or equals[chosen, 1] > longest:
                    chosen += 1
            now[state, 0], now[state, 1], now[state, 2] = best, equals[chosen, 0], equals[chosen, 1]
            differs_now[state] = False
            for column in range(3):
                if now[state, column] != ahead[state, column]:
                    differs_now[state], is_same = True, False
        differs_now[size] = False
        ahead, now = now, ahead
        differs, differs_now = differs_now, differs
        if is_same:
            break
    return ahead[:size]
