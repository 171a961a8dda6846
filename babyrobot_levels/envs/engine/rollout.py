"""Whole rollouts: many robots follow a policy for many steps, and all of it is noted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.policies import read_policy
from babyrobot_levels.analysis.solver.results import check_actions, check_seed
from babyrobot_levels.envs.engine.arguments import checked_count, limits_of
from babyrobot_levels.envs.engine.choice import make_engine
from babyrobot_levels.envs.engine.draws import SharedDraws
from babyrobot_levels.envs.engine.robots import Record, Robots
from babyrobot_levels.envs.engine.tables import ALWAYS, Flags, Floats, build_tables, signs_of
from babyrobot_levels.library.catalogue import load

CHUNK = 16_384
"""About how many steps, of all robots together, are taken with one block of draws."""


@dataclass(frozen=True, eq=False)
class Rollout:
    """What many robots did, one row a step and one column a robot.

    A robot whose episode is over begins the next one at once: the observation of the next row is
    then where that begins, and `next_observations` tells where the last one ended.

    Attributes:
        observations: int32 `[steps, envs]`: the state, `y * width + x`, before the action.
        actions: int8 `[steps, envs]`.
        rewards: float64 `[steps, envs]`.
        terminations: bool `[steps, envs]`.
        truncations: bool `[steps, envs]`.
        next_observations: int32 `[steps, envs]`: the state after the action.
        action_masks: int8 `[steps, envs, actions]`: what was possible before the action.
    """

    observations: NDArray[np.int32]
    actions: NDArray[np.int8]
    rewards: Floats
    terminations: Flags
    truncations: Flags
    next_observations: NDArray[np.int32]
    action_masks: NDArray[np.int8]


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
) -> Rollout:
    """Have robots follow a policy, and return all that they saw and did.

    The levels' chance is drawn from the generator of the seed, as a `LevelVectorEnv` that begins
    anew in the same step draws it; what a policy leaves to chance, from another one.

    Args:
        level: a name, a path, a mapping or a `Level`; or a list of them or a suite, of which
            robot i walks number `i % len(level)`.
        policy: as `brl.evaluate` takes it; of several levels, a word or a list of one for each
            that is walked.
        num_envs: how many robots there are.
        num_steps: how many steps each of them takes.
        seed: a number, from which all chance is drawn; None for another one each time.
        actions: `"all"`, or `"moves"` without stay.
        max_episode_steps: after how many steps an episode is cut off, -1 for never. By default,
            each level's `max_steps`.
        engine: `"numpy"`, `"compiled"`, or None for the fastest that is installed. Both give the
            same.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, or its maze has no seed yet.
        ImportError: the compiled engine is asked for and not installed.
        ValueError: another argument has a value that it cannot have.
    """
    several = isinstance(level, Sequence) and not isinstance(level, str)
    size = checked_count("num_envs", num_envs)
    if several and not isinstance(level, list | tuple):
        # Each level of a suite has to be made, and no more are walked than there are robots.
        level = level[:size]
    levels = [load(each) for each in (level if several else [level])]
    steps = checked_count("num_steps", num_steps)
    first = check_actions(actions)
    if not levels:
        raise ValueError("there must be at least one level")
    mdps = [each.compile() for each in levels]
    tables = build_tables(mdps, limits_of(levels, max_episode_steps), first)
    thresholds = np.concatenate(
        [
            _thresholds(read_policy(told, mdp, actions))
            for told, mdp in zip(_policies(policy, len(levels), several), mdps, strict=True)
        ]
    )
    shown = np.empty((len(tables.over), 0), np.int64)
    walker = make_engine(engine, tables, shown, size)
    robots, record = Robots(size, len(levels)), Record.empty(steps, size)

    source = np.random.default_rng(check_seed(seed))
    choosing = source.spawn(1)[0]
    rows = min(steps, max(1, CHUNK // size))
    chances = np.zeros((rows, size))
    is_random = bool(((thresholds > 0) & (thresholds < ALWAYS)).any())
    draws = SharedDraws(source, rows * size * tables.most_draws)
    draws.reserve()
    walker.begin(robots, np.arange(size), draws)
    for begin in range(0, steps, rows):
        part = record.rows(begin, begin + rows)
        drawn = chances[: len(part.rewards)]
        if is_random:
            choosing.random(out=drawn)
        draws.reserve()
        walker.walk(robots, thresholds, drawn, draws, part)
    return Rollout(
        observations=record.observations,
        actions=record.actions,
        rewards=record.rewards,
        terminations=record.terminations,
        truncations=record.truncations,
        next_observations=record.next_observations,
        action_masks=record.words.view(signs_of(tables.num_actions))["mask"],
    )


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
    # The last action that has a probability takes what rounding leaves over.
    last = policy.shape[1] - 1 - (policy[:, ::-1] > 0).argmax(axis=1)
    cumulated[np.arange(policy.shape[1]) >= last[:, None]] = ALWAYS
    return np.ascontiguousarray(cumulated[:, :-1])
