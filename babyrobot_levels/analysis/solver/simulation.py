"""Trial runs, many at a time, and what is likely within a number of steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import at_start, model_of
from babyrobot_levels.analysis.solver.model import Flags, Floats, Ints
from babyrobot_levels.analysis.solver.policies import Policy, read_policy
from babyrobot_levels.analysis.solver.results import (
    Simulation,
    check_actions,
    check_discount,
    check_seed,
)
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level

MAX_STEPS = 10_000
"""The limit of levels that have none of their own."""


def simulate(
    level: Any,
    policy: Policy,
    episodes: int = 1000,
    seed: int = 0,
    *,
    discount: float | None = None,
    max_steps: int | None = None,
    actions: str = "all",
) -> Simulation:
    """Play episodes with a policy and return how they went.

    The same arguments give the same episodes. They are not those of the environments, which draw
    from generators of their own.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        episodes: how many, at least 1.
        seed: what all chance is drawn from.
        discount: above 0 and at most 1; by default, the level's.
        max_steps: episodes that are not over after so many steps are cut off. By default, the
            level's `max_steps`, or 10,000 where it has none.
        actions: `"all"`, or `"moves"` without stay.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have.
    """
    level = load(level)
    discount = check_discount(discount, level.discount)
    limit = max_steps if max_steps is not None else level.max_steps or MAX_STEPS
    if episodes < 1 or limit < 1:
        raise ValueError("episodes and max_steps must be at least 1")
    ways = _ways(level, policy, actions)
    mdp = level.compile()
    rng = np.random.default_rng(check_seed(seed))
    state = rng.choice(mdp.num_states, size=episodes, p=mdp.start)
    returns, steps = np.zeros(episodes), np.zeros(episodes, np.int64)
    going = np.arange(episodes)
    factor = 1.0
    for _ in range(limit):
        here = state[going]
        which = (rng.random(going.size)[:, None] >= ways.cumulated[here]).sum(axis=1)
        returns[going] += factor * ways.reward[here, which]
        steps[going] += 1
        state[going] = ways.next_state[here, which]
        factor *= discount
        going = going[~mdp.over[state[going]]]
        if not going.size:
            break
    return Simulation(
        returns=returns,
        steps=steps,
        at_exit=_exits(level)[state],
        cut=~mdp.over[state],
        max_steps=limit,
        discount=discount,
    )


def success_within(
    level: Any, policy: Policy, steps: int | None = None, *, actions: str = "all"
) -> float:
    """Return the exact probability of reaching an exit within a number of steps.

    Args:
        level: a name, a path, a mapping or a `Level`.
        policy: as `evaluate` takes it.
        steps: how many steps there are; by default, the level's `max_steps`.
        actions: `"all"`, or `"moves"` without stay.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has a value that it cannot have, or neither `steps` nor the
            level says how many steps there are.
    """
    level = load(level)
    steps = level.max_steps if steps is None else steps
    if steps is None or steps < 0:
        raise ValueError("steps must be 0 or more; the level has no max_steps of its own")
    model, mdp = model_of(level, check_actions(actions)), level.compile()
    chain = model.mixed(read_policy(policy, mdp, actions)[model.states])
    success = np.zeros(chain.size)
    for _ in range(steps):
        following = np.append(success, 0.0)[chain.next_state[:, 0]]
        ahead = np.einsum("so,so->s", chain.probability[:, 0], following)
        ahead += chain.success[:, 0]
        if np.array_equal(ahead, success):
            break
        success = ahead
    return min(1.0, at_start(success, chain, mdp))


@dataclass(frozen=True, eq=False)
class _Ways:
    """What may happen in a step from each state, `[states, ways]` each."""

    cumulated: Floats
    next_state: Ints
    reward: Floats


def _ways(level: Level, policy: Policy, actions: str) -> _Ways:
    """Return the outcomes of a policy's steps, the possible ones first."""
    first, mdp = check_actions(actions), level.compile()
    weights = read_policy(policy, mdp, actions)
    count = mdp.num_states
    probability = (weights[:, :, None] * mdp.probability[:, first:]).reshape(count, -1)
    order = np.argsort(probability == 0, axis=1, kind="stable")
    order = order[:, : int((probability > 0).sum(axis=1).max())]
    probability = np.take_along_axis(probability, order, axis=1)
    next_state = mdp.next_state[:, first:].reshape(count, -1)
    reward = mdp.reward[:, first:].reshape(count, -1)
    cumulated = np.cumsum(probability, axis=1)
    # Rounding must not leave a gap at the top: the last possible way takes what is left.
    last = np.maximum((probability > 0).sum(axis=1) - 1, 0)
    cumulated[np.arange(probability.shape[1]) >= last[:, None]] = 1.0
    return _Ways(
        cumulated,
        np.take_along_axis(next_state, order, axis=1).astype(np.intp),
        np.take_along_axis(reward, order, axis=1),
    )


def _exits(level: Level) -> Flags:
    """Return which states are exits, `[states]`."""
    width, height = level.size
    flags = np.zeros(width * height, bool)
    flags[[y * width + x for x, y in level.exits]] = True
    return flags
