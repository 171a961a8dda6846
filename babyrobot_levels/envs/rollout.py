"""Rollouts: many environments follow a policy for many steps, and all transitions are recorded."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.analysis.solver.results import check_actions, check_count, check_seed
from babyrobot_levels.analysis.solver.within import ByStep, weights_by_step
from babyrobot_levels.envs.arguments import limits_of
from babyrobot_levels.envs.engine.draws import SharedDraws
from babyrobot_levels.envs.engine.plain import make_engine
from babyrobot_levels.envs.engine.state import EnvStates, Record
from babyrobot_levels.envs.engine.tables import (
    ALWAYS,
    Flags,
    Floats,
    Ints,
    Tables,
    build_tables,
    masks_of,
    part_of,
)
from babyrobot_levels.envs.remembering import Player, follow
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.text.words import Telling, unexpected

CHUNK = 16_384
"""About how many steps, of all environments together, use one block of draws."""

_KEYWORDS = "num_envs", "num_steps", "seed", "actions", "max_episode_steps", "engine"
"""What may be said of a policy without memory."""


@dataclass(frozen=True, eq=False)
class Rollout(Telling, public=True):
    """The transitions of many environments, one row for each step and one column for each of them.

    When an episode is over, the environment is reset in the same step: the next row of
    `observations` has the start of the next episode, and `next_observations` the end of the last.

    Attributes:
        observations: int32 `[steps, envs]`: the state before the action: `y * width + x`; with
            things or turns, as `Mdp` and `Mdp.turning` number it.
        actions: int8 `[steps, envs]`.
        rewards: float64 `[steps, envs]`.
        terminations: bool `[steps, envs]`.
        truncations: bool `[steps, envs]`.
        next_observations: int32 `[steps, envs]`: the state after the action.
        action_masks: int8 `[steps, envs, actions]`: the action mask before the action.
    """

    observations: NDArray[np.int32]
    actions: NDArray[np.int8]
    rewards: Floats
    terminations: Flags
    truncations: Flags
    next_observations: NDArray[np.int32]
    action_masks: NDArray[np.int8]

    def __repr__(self) -> str:
        """Return how much there is; all numbers would be many pages."""
        (steps, envs), ends = self.actions.shape, self.terminations | self.truncations
        return f"<Rollout of {steps:,} steps in {envs:,} environments: {ends.sum():,} ends>"


def rollout(
    level: Any,
    policy: Any = "random",
    num_envs: int = 1,
    num_steps: int = 1000,
    seed: int | None = None,
    *,
    actions: str = "all",
    max_episode_steps: int | None = None,
    engine: str | None = None,
    **options: Any,
) -> Rollout:
    """Follow a policy in many environments, and return all transitions.

    The outcomes of actions are drawn from the generator of the seed, in the order of a
    `LevelVectorEnv` with `SAME_STEP` autoreset; the actions of a stochastic policy, from another
    one. An agent with memory plays in one level, in one environment after the other; each of them
    has a seed of its own.

    Args:
        level: a name, a path, a mapping or a `Level`; or a list of them or a suite, of which
            environment i has number `i % len(level)`.
        policy: a policy as for `brl.evaluate`, also one for each step of an episode; for several
            levels, a word or a list with a policy for each level that is used. Or an object with
            memory, as for `brl.score`: `reset()` begins an episode, `act(observation, mask)`
            returns an action.
        num_envs: how many environments there are.
        num_steps: how many steps each of them takes.
        seed: a number that seeds all randomness; None for an unpredictable one.
        actions: `"all"`, `"moves"` without stay, or `"turns"`.
        max_episode_steps: the time limit of episodes, -1 for none. By default, that of the policy,
            if it is a `Solution` within one, else each level's `max_steps`.
        engine: `"numpy"`, `"compiled"`, or None for `"compiled"` where Numba is installed,
            else `"numpy"`. All give the same results.
        options: what an agent with memory observes: `observation`, by default `"position"`, and
            its options, as in environments.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, or its maze has no seed yet.
        ImportError: an engine is required whose library is not installed.
        ValueError: another argument is invalid.
    """
    several = isinstance(level, Sequence) and not isinstance(level, str)
    size = check_count("num_envs", num_envs)
    if several and not isinstance(level, list | tuple):
        # Levels of a suite are made on access, and at most `num_envs` of them are used.
        level = level[:size]
    levels = [load(each) for each in (level if several else [level])]
    steps = check_count("num_steps", num_steps)
    first = check_actions(actions)
    if not levels:
        raise ValueError("there must be at least one level")
    own = ACTION_SETS[actions].with_moves(levels[0].moves)
    mdps = [own.tables(each) for each in levels]
    if isinstance(policy, Player):
        if len(levels) > 1:
            raise ValueError("an agent with memory is followed in one level, not in several")
        (limit,) = limits_of(levels, max_episode_steps)
        record = Record.empty(steps, size)
        masks = np.empty((steps, size, mdps[0].num_actions - first), np.int8)
        options["actions"] = actions
        follow(policy, levels[0], record, masks, check_seed(seed), limit, **options)
        return _result(record, masks)
    for name in options:
        raise TypeError(unexpected("rollout", name, _KEYWORDS))
    parts = [part_of(each, mdp, first) for each, mdp in zip(levels, mdps, strict=True)]
    policies = _policies(policy, len(levels), several)
    limits = limits_of(levels, max_episode_steps)
    if max_episode_steps is None:
        limits = [
            getattr(each, "within", None) or limit
            for each, limit in zip(policies, limits, strict=True)
        ]
    weights = [
        weights_by_step(each, StateSpace(one, mdp, actions), limit, "max_episode_steps")
        for each, one, mdp, limit in zip(policies, levels, mdps, limits, strict=True)
    ]
    tables = build_tables(parts, limits)
    thresholds = np.concatenate([_thresholds(each(0)) for each in weights])
    is_by_step = any(len(each.runs) > 1 for each in weights)
    if is_by_step:
        # Where steps choose, each action has an even share of the chances.
        thresholds[:] = np.arange(1, tables.num_actions) / tables.num_actions
    stepper = make_engine(engine, tables, np.empty((tables.state_info.size, 0), np.int64), size)
    envs, record = EnvStates(size, len(levels)), Record.empty(steps, size)

    source = np.random.default_rng(check_seed(seed))
    choosing = source.spawn(1)[0]
    rows = min(steps, max(1, CHUNK // size))
    chances = np.zeros((rows, size))
    is_random = bool(((thresholds > 0) & (thresholds < ALWAYS)).any())
    draws = SharedDraws(source, rows * size * tables.most_draws)
    draws.reserve()
    stepper.reset(envs, np.arange(size), draws)
    for begin in range(0, steps, rows):
        part = record.rows(begin, begin + rows)
        drawn = chances[: len(part.rewards)]
        if is_random:
            choosing.random(out=drawn)
        draws.reserve()
        if not is_by_step:
            stepper.run(envs, thresholds, drawn, draws, part)
            continue
        for row in range(len(drawn)):
            taken = _taken(weights, tables, envs, drawn[row])
            even = (taken[None] + 0.5) / tables.num_actions
            stepper.run(envs, thresholds, even, draws, part.rows(row, row + 1))
    return _result(record, masks_of(record.words, tables.num_actions))


def _result(record: Record, masks: NDArray[np.int8]) -> Rollout:
    return Rollout(
        observations=record.observations,
        actions=record.actions,
        rewards=record.rewards,
        terminations=record.terminations,
        truncations=record.truncations,
        next_observations=record.next_observations,
        action_masks=masks,
    )


def _taken(weights: Sequence[ByStep], tables: Tables, envs: EnvStates, chances: Floats) -> Ints:
    """Return the action of each environment, in the step that its episode has come to."""
    steps = tables.limit[envs.level] - (envs.deadline - envs.clock)
    taken = np.zeros(chances.size, np.intp)
    for number, policy in enumerate(weights):
        for step in np.unique(steps[envs.level == number]).tolist():
            here = (envs.level == number) & (steps == step)
            rows = policy(step)[envs.state[here] - tables.offset[number]]
            taken[here] = (chances[here, None] >= _thresholds(rows)).sum(axis=1)
    return taken


def _policies(policy: Any, count: int, several: bool) -> Sequence[Any]:
    """Return a policy for each level."""
    if not several:
        return [policy]
    if isinstance(policy, str):
        return [policy] * count
    if not isinstance(policy, list | tuple) or len(policy) != count:
        raise ValueError(
            f"policy must be a word, or a list of {count} policies, one for each level"
        )
    return policy


def _thresholds(policy: Floats) -> Floats:
    """Return a policy's cumulated probabilities without the last, `[states, actions - 1]`."""
    cumulated = np.cumsum(policy, axis=1)
    # The last action with a probability takes the rounding error of the sum.
    last = policy.shape[1] - 1 - (policy[:, ::-1] > 0).argmax(axis=1)
    cumulated[np.arange(policy.shape[1]) >= last[:, None]] = ALWAYS
    return np.ascontiguousarray(cumulated[:, :-1])
