"""Datasets of Minari: episodes with exact observations and exact reference scores."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import gymnasium
import numpy as np

from babyrobot_levels.agents.plays import Play
from babyrobot_levels.agents.verify import verify_play
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.envs.arguments import checked_observation
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.rollout import Rollout
from babyrobot_levels.envs.suite import extent_of
from babyrobot_levels.extensions.scoring.score import score
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.suite import Suite
from babyrobot_levels.text.errors import how_to_install


@dataclass(frozen=True, eq=False)
class _Episode:
    """An episode that ended; `states` has one more entry than the others."""

    level: Level
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
    per_level: int | None = None,
    **about: Any,
) -> Any:
    """Write episodes of a level or of a suite as a dataset of Minari; it needs the extra `minari`.

    The reference scores are exact: the undiscounted expected returns of the random policy and of
    an optimal one, within the time limit; of several levels, the means. The metadata of an episode
    has the `digest` of its level and its file, `level`. The environment that the dataset recovers
    repeats plays: `reset(seed=…, options=…)` of an episode's metadata, and its actions, give the
    same episode. Of a rollout in a suite, `options` has the `index` of the level in the suite.

    Args:
        episodes: valid plays of one level, with the same set of actions and time limit; or what
            `brl.rollout` returns. Those that did not end are left out.
        dataset_id: the name, such as `"babyrobot/final-maze/class-v0"`.
        level: of a rollout: its level; or the `Suite` or the split of one that it is in.
        actions: of a rollout: its set of actions, `"all"`, `"moves"` or `"turns"`.
        observation: what the dataset contains of each state, as in environments.
        per_level: of a rollout: so many episodes of each level are taken, the first ones. By
            default, all that ended; then levels with short episodes have more of them.
        about: other arguments of `minari.create_dataset_from_buffers`, such as `author`,
            `algorithm_name` and `description`.

    Returns:
        The `minari.MinariDataset`.

    Raises:
        ImportError: Minari is not installed.
        PlayError: a play is not valid.
        ValueError: no episode ended, or too few in a level, the plays are not of one level, the
            suite is a slice of another one, or another argument does not fit.
    """
    try:
        import minari
        from minari.data_collector import EpisodeBuffer
    except ImportError as error:
        raise ImportError(f"these datasets need Minari: {how_to_install('minari')}") from error

    suite = level if isinstance(level, Suite) else None
    if isinstance(episodes, Rollout):
        if level is None:
            raise ValueError("a rollout does not tell its level: give level")
        if suite is not None and suite.to_arguments() is None:
            raise ValueError("a dataset is of a suite or a split of it, not of a slice")
        levels = [load(level)] if suite is None else list(suite[: episodes.actions.shape[1]])
        found = list(_of_rollout(episodes, levels))
        if per_level is not None:
            found = _first_ones(found, levels, per_level)
    else:
        world, actions = _level_of(episodes)
        levels, suite = [world], None
        found = list(_of_plays(episodes, world))
    if not found:
        raise ValueError("no episode ended")
    names = observation if isinstance(observation, str) else tuple(observation)
    turns = actions == "turns"
    if suite is None:
        limit = -1 if levels[0].max_steps is None else levels[0].max_steps
        env = levels[0].make(observation=names, actions=actions, max_episode_steps=limit)
        extent = Extent.of(levels, turns=turns)
    else:
        env = gymnasium.make("babyrobot/Suite-v0", suite=suite, observation=names, actions=actions)
        extent = extent_of(suite.bounds, turns=turns)
    chosen = checked_observation(observation=names)
    observers = {each.digest: make_observer(each, chosen, extent) for each in levels}
    buffers = [
        EpisodeBuffer(
            id=number,
            seed=each.seed,
            options=each.options,
            observations=observers[each.level.digest].rows(np.asarray(each.states)),
            actions=np.asarray(each.actions, np.int64),
            rewards=np.asarray(each.rewards, np.float64),
            terminations=_only_last(len(each.actions), each.is_terminated),
            truncations=_only_last(len(each.actions), not each.is_terminated),
        )
        for number, each in enumerate(found)
    ]
    dataset = minari.create_dataset_from_buffers(
        dataset_id,
        buffers,
        env,
        eval_env=env,
        jpeg_encoding=False,
        **{**_references(levels, actions), **about},
    )
    dataset.storage.update_episode_metadata(
        {"digest": each.level.digest, "level": each.level.to_yaml()} for each in found
    )
    return dataset


def _level_of(plays: Sequence[Play]) -> tuple[Level, str]:
    """Return the level of plays under their time limit, and their set of actions."""
    if not plays:
        raise ValueError("there are no plays")
    first, conditions = plays[0], {(play.digest, play.action_set, play.max_steps) for play in plays}
    if len(conditions) > 1:
        raise ValueError("a dataset is of one level, one set of actions and one time limit")
    for number, play in enumerate(plays, 1):
        if (fault := verify_play(play).fault) is not None:
            raise PlayError(f"play {number} is not valid: {fault}")
    return first.level.model_copy(update={"max_steps": first.max_steps}), first.action_set


def _of_plays(plays: Sequence[Play], level: Level) -> Iterator[_Episode]:
    for play in plays:
        if play.end == "unfinished":
            continue
        cell = play.level.compile().cell(play.states[0])
        yield _Episode(
            level,
            play.states,
            play.actions,
            play.rewards,
            play.end == "terminated",
            None if play.seed is None else int(play.seed),
            {"start": list(cell)} if play.start == "chosen" else None,
        )


def _of_rollout(data: Rollout, levels: Sequence[Level]) -> Iterator[_Episode]:
    """Yield the episodes of a rollout that ended."""
    for env, is_over in enumerate((data.terminations | data.truncations).T):
        index = env % len(levels)
        for begin, end in pairwise([0, *np.flatnonzero(is_over) + 1]):
            rows = slice(begin, end), env
            yield _Episode(
                levels[index],
                [*data.observations[rows].tolist(), int(data.next_observations[end - 1, env])],
                data.actions[rows].tolist(),
                data.rewards[rows].tolist(),
                bool(data.terminations[end - 1, env]),
                options={"index": index} if len(levels) > 1 else None,
            )


def _first_ones(
    episodes: Sequence[_Episode], levels: Sequence[Level], count: int
) -> list[_Episode]:
    """Return so many episodes of each level.

    Raises:
        ValueError: fewer ended in one of them.
    """
    found: dict[str, list[_Episode]] = {level.digest: [] for level in levels}
    for each in episodes:
        found[each.level.digest].append(each)
    least = min(found.values(), key=len)
    if len(least) < count:
        raise ValueError(
            f"in a level only {len(least)} episodes ended, not {count}: follow the policy for more "
            "steps"
        )
    return [each for own in found.values() for each in own[:count]]


def _only_last(count: int, is_last: bool) -> Any:
    flags = np.zeros(count, bool)
    flags[-1] = is_last
    return flags


def _references(levels: Sequence[Level], actions: str) -> dict[str, float]:
    """Return the exact reference scores; none where an optimum is infinite or undefined."""
    try:
        scores = score(levels, "random", actions=actions, discount=1.0)
    except (ValueError, UndefinedReturnError, EpisodeTooLongError):
        return {}
    lowest, highest = np.mean([(each.random, each.optimum) for each in scores], axis=0).tolist()
    return {"ref_min_score": lowest, "ref_max_score": highest} if np.isfinite(lowest) else {}
