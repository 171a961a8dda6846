"""Datasets of Minari: episodes with exact observations and exact reference scores."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.envs.arguments import checked_observation
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.rollout import Rollout
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.scoring.plays import Play
from babyrobot_levels.scoring.score import score
from babyrobot_levels.scoring.verify import verify_play


@dataclass(frozen=True, eq=False)
class _Episode:
    """An episode that ended; `states` has one more entry than the others."""

    states: Sequence[int]
    actions: Sequence[int]
    rewards: Sequence[float]
    is_terminated: bool
    seed: int | None = None
    options: dict[str, Any] | None = None


def to_minari(
    episodes: Sequence[Play] | Rollout,
    dataset_id: str,
    *,
    level: Any = None,
    actions: str = "all",
    observation: str | Sequence[str] = "position",
    **about: Any,
) -> Any:
    """Write episodes of one level as a dataset of Minari; it needs the extra `minari`.

    The reference scores are exact: the undiscounted expected returns of the random policy and of
    an optimal one, within the time limit. The environment that the dataset recovers repeats plays:
    `reset(seed=…, options=…)` of an episode's metadata, and its actions, give the same episode.

    Args:
        episodes: valid plays of one level, with the same set of actions and time limit; or what
            `brl.rollout` returns. Those that did not end are left out.
        dataset_id: the name, such as `"babyrobot/final-maze/class-v0"`.
        level: of a rollout: its level.
        actions: of a rollout: its set of actions, `"all"`, `"moves"` or `"turns"`.
        observation: what the dataset contains of each state, as in environments.
        about: other arguments of `minari.create_dataset_from_buffers`, such as `author`,
            `algorithm_name` and `description`.

    Returns:
        The `minari.MinariDataset`.

    Raises:
        ImportError: Minari is not installed.
        PlayError: a play is not valid.
        ValueError: no episode ended, the plays are not of one level, or another argument does not
            fit.
    """
    import minari
    from minari.data_collector import EpisodeBuffer

    if isinstance(episodes, Rollout):
        if level is None:
            raise ValueError("a rollout does not tell its level: give level")
        world = load(level)
        found = list(_of_rollout(episodes))
    else:
        world, actions = _level_of(episodes)
        found = list(_of_plays(episodes))
    if not found:
        raise ValueError("no episode ended")
    limit = -1 if world.max_steps is None else world.max_steps
    names = observation if isinstance(observation, str) else tuple(observation)
    env = world.make(observation=names, actions=actions, max_episode_steps=limit)
    extent = Extent.of([world], turns=actions == "turns")
    observer = make_observer(world, checked_observation(observation=names), extent)
    buffers = [
        EpisodeBuffer(
            id=number,
            seed=each.seed,
            options=each.options,
            observations=observer.rows(np.asarray(each.states)),
            actions=np.asarray(each.actions, np.int64),
            rewards=np.asarray(each.rewards, np.float64),
            terminations=_only_last(len(each.actions), each.is_terminated),
            truncations=_only_last(len(each.actions), not each.is_terminated),
        )
        for number, each in enumerate(found)
    ]
    return minari.create_dataset_from_buffers(
        dataset_id,
        buffers,
        env,
        eval_env=env,
        jpeg_encoding=False,
        **{**_references(world, actions), **about},
    )


def _level_of(plays: Sequence[Play]) -> tuple[Level, str]:
    """Return the level of plays under their time limit, and their set of actions."""
    if not plays:
        raise ValueError("there are no plays")
    first, conditions = plays[0], {(play.digest, play.action_set, play.max_steps) for play in plays}
    if len(conditions) > 1:
        raise ValueError("a dataset is of one level, one set of actions and one time limit")
    for number, play in enumerate(plays, 1):
        fault = verify_play(play).fault
        if fault is not None:
            raise PlayError(f"play {number} is not valid: {fault}")
    return first.level.model_copy(update={"max_steps": first.max_steps}), first.action_set


def _of_plays(plays: Sequence[Play]) -> Iterator[_Episode]:
    for play in plays:
        if play.end == "unfinished":
            continue
        cell = play.level.compile().cell(play.states[0])
        yield _Episode(
            play.states,
            play.actions,
            play.rewards,
            play.end == "terminated",
            None if play.seed is None else int(play.seed),
            {"start": list(cell)} if play.start == "chosen" else None,
        )


def _of_rollout(data: Rollout) -> Iterator[_Episode]:
    """Yield the episodes of a rollout that ended."""
    for env, is_over in enumerate((data.terminations | data.truncations).T):
        for begin, end in pairwise([0, *np.flatnonzero(is_over) + 1]):
            rows = slice(begin, end), env
            yield _Episode(
                [*data.observations[rows].tolist(), int(data.next_observations[end - 1, env])],
                data.actions[rows].tolist(),
                data.rewards[rows].tolist(),
                bool(data.terminations[end - 1, env]),
            )


def _only_last(count: int, is_last: bool) -> Any:
    flags = np.zeros(count, bool)
    flags[-1] = is_last
    return flags


def _references(level: Level, actions: str) -> dict[str, float]:
    """Return the exact reference scores; none where the optimum is infinite or undefined."""
    try:
        (found,) = score("random", level, actions=actions, discount=1.0)
    except (ValueError, UndefinedReturnError, EpisodeTooLongError):
        return {}
    if not np.isfinite(found.random):
        return {}
    return {"ref_min_score": found.random, "ref_max_score": found.optimum}
