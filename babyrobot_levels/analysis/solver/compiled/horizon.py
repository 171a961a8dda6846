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
    ahead = np.zeros((size + 1, 3))
    now = np.zeros((size + 1, 3))
    sums = np.zeros((actions, 3))
    for _ in range(steps):
        is_same = True
        for state in range(size):
            best = -np.inf
            for action in range(actions):
                value = 0.0
                for outcome in range(outcomes):
                    after = np.uint32(next_state[state, action, outcome])
                    value += probability[state, action, outcome] * ahead[after, 0]
                sums[action, 0] = reward[state, action] + discount * value
                best = max(best, sums[action, 0])
            least, likeliest = best - max(_ROUNDING * abs(best), slack), -np.inf
            # The rest matters of equally good actions only, which are few.
            for action in range(actions):
                if sums[action, 0] >= least:
                    likely, length = 0.0, 0.0
                    for outcome in range(outcomes):
                        chance = probability[state, action, outcome]
                        after = np.uint32(next_state[state, action, outcome])
                        likely += chance * ahead[after, 1]
                        length += chance * ahead[after, 2]
                    sums[action, 1] = success[state, action] + likely
                    sums[action, 2] = 1.0 + length
                    likeliest = max(likeliest, sums[action, 1])
            shortest = np.inf
            for action in range(actions):
                if sums[action, 0] >= least and sums[action, 1] >= likeliest - _EQUAL:
                    shortest = min(shortest, sums[action, 2])
            for action in range(actions):
                if (
                    sums[action, 0] >= least
                    and sums[action, 1] >= likeliest - _EQUAL
                    and sums[action, 2] <= shortest + _EQUAL * max(1.0, shortest)
                ):
                    now[state, 0] = best
                    now[state, 1] = sums[action, 1]
                    now[state, 2] = sums[action, 2]
                    break
            for column in range(3):
                is_same = is_same and now[state, column] == ahead[state, column]
        ahead, now = now, ahead
        if is_same:
            break
    return ahead[:size]
