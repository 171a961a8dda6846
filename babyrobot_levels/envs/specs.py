"""Specs of levels and suites, which tell time limit and reward threshold.

Files are read when one of the two is asked for: there may be thousands of levels, and registering
their ids must not read them.
"""

import sys
from collections.abc import Mapping
from dataclasses import fields
from functools import lru_cache
from math import prod
from typing import Any

from gymnasium import error
from gymnasium.envs import registration
from gymnasium.envs.registration import EnvSpec, WrapperSpec, parse_env_id

from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import HEADINGS
from babyrobot_levels.text.errors import BabyRobotError

MAX_STATES = 100_000
"""The threshold of a level that may have more states is not computed: see `reward_threshold`."""

MAX_STATE_STEPS = 5_000_000
"""Nor is that of a level with more states times steps."""


class MadeSpec(EnvSpec):
    """The spec of an environment that was made from a level or a suite."""

    _threshold: float | None = None

    @property
    def reward_threshold(self) -> float | None:
        """The optimal expected return within the time limit, or the value that was set.

        The return is the sum of rewards, from the starts of the level. None without a time limit,
        for several levels and random mazes, and where it would take longer than about a second:
        for a level that may have more than 100,000 states, or 5,000,000 states times steps.
        """
        # While `make` copies a spec, the time limit of the environment is not known yet.
        if self._threshold is not None or _given_to_make() is not None:
            return self._threshold
        return _best_return(self.kwargs, self.max_episode_steps)

    @reward_threshold.setter
    def reward_threshold(self, threshold: float | None) -> None:
        self._threshold = threshold

    def __eq__(self, other: object) -> bool:
        # JSON gives plain specs, in which lists have taken the place of tuples.
        return isinstance(other, EnvSpec) and all(
            _plain(getattr(self, field.name)) == _plain(getattr(other, field.name))
            for field in fields(EnvSpec)
        )

    __hash__ = None  # type: ignore[assignment]


class LevelSpec(MadeSpec):
    """The spec of an id: its time limit is that of the level or suite in its arguments."""

    _steps: int | None = None

    @property
    def max_episode_steps(self) -> int | None:
        """The time limit of an episode: the one that was set, or that of the level or suite.

        While Gymnasium makes an environment, the arguments that it was given count as well.
        """
        given = _given_to_make()
        given = self.kwargs if given is None else given
        steps = given.get("max_episode_steps")
        if steps is None:
            return _own_limit(given) if self._steps is None else self._steps
        return None if steps == -1 else steps

    @max_episode_steps.setter
    def max_episode_steps(self, steps: int | None) -> None:
        self._steps = steps


def is_id(text: str) -> bool:
    """Return whether Gymnasium accepts a text as an id."""
    try:
        parse_env_id(text)
    except error.Error:
        return False
    # Gymnasium would import the part before a colon as a module.
    return ":" not in text


def level_spec(env_id: str, **kwargs: Any) -> LevelSpec:
    """Return the spec under which a level is registered, with arguments such as the level."""
    folder = "babyrobot_levels.envs"
    return _spec(env_id, f"{folder}.making:make_level", f"{folder}.vector.team:make_vector", kwargs)


def suite_spec(env_id: str, **kwargs: Any) -> LevelSpec:
    """Return the spec under which suites are registered, with arguments such as the suite."""
    folder = "babyrobot_levels.envs"
    vector = f"{folder}.vector.env:make_suite_vector"
    return _spec(env_id, f"{folder}.suite:make_suite", vector, kwargs)


def _spec(env_id: str, entry_point: str, vector: str, kwargs: dict[str, Any]) -> LevelSpec:
    # The environments check the order of calls themselves (`ResetNeeded`), without Gymnasium's
    # wrapper for it, because `render` is allowed before `reset`.
    return LevelSpec(
        env_id,
        entry_point=entry_point,
        vector_entry_point=vector,
        order_enforce=False,
        kwargs=kwargs,
    )


def as_spec(cls: type[MadeSpec], spec: EnvSpec) -> MadeSpec:
    """Return a plain spec as one of a class that knows its threshold; others as they are.

    In both, tuples among the arguments become lists, because JSON has no tuples.
    """
    lists = {name: list(value) for name, value in spec.kwargs.items() if isinstance(value, tuple)}
    spec.kwargs |= lists
    if isinstance(spec, MadeSpec):
        return spec
    return cls(**{each.name: getattr(spec, each.name) for each in fields(spec) if each.init})


def _given_to_make() -> dict[str, Any] | None:
    """Return the arguments of the environment for which Gymnasium reads a property of a spec.

    `make` and `make_vec` put a spec's arguments and those of their call together in a variable of
    their own, and do not tell the spec, whose time limit follows from them. None if the property
    is read anywhere else.
    """
    caller = sys._getframe(2)
    if caller.f_globals is not vars(registration):
        return None
    return caller.f_locals.get("env_spec_kwargs")


def _own_limit(given: Mapping[str, Any]) -> int | None:
    """Return the `max_steps` of the level or suite among some arguments.

    None if there is none, if several levels differ, and if nothing can be loaded: then, making
    the environment tells why.
    """
    level: Any = given.get("level")
    levels: Any = given.get("levels")
    suite: Any = given.get("suite")
    try:
        if level is not None:
            return _max_steps(level)
        if levels is suite is None:
            return None
        from babyrobot_levels.suites.suite import Suite, load_suite

        if suite is not None or isinstance(levels, Suite):
            return load_suite(levels if suite is None else suite).max_steps
        limits = {_max_steps(each) for each in levels}
    except (BabyRobotError, TypeError, ValueError):
        return None
    return limits.pop() if len(limits) == 1 else None


def _max_steps(level: Any) -> int | None:
    steps: int | None = (
        level.get("max_steps") if isinstance(level, Mapping) else load(level).max_steps
    )
    return steps


def _best_return(given: Mapping[str, Any], steps: int | None) -> float | None:
    """Return the threshold of an environment; see `MadeSpec.reward_threshold`.

    Args:
        given: its arguments.
        steps: its time limit.
    """
    if steps is None or given.get("level") is None:
        return None
    try:
        level = load(given["level"])
        actions = ACTION_SETS[given.get("actions", "valid")]
    except (BabyRobotError, TypeError, LookupError):
        return None
    states = prod(level.size) * prod(level.things().radices) * (HEADINGS if actions.turns else 1)
    if level.has_random_maze or states > MAX_STATES or states * steps > MAX_STATE_STEPS:
        return None
    name = "turns" if actions.turns else "moves" if actions.first else "all"
    return _solved(level, steps, name)


@lru_cache(maxsize=16)
def _solved(level: Level, steps: int, actions: str) -> float | None:
    from babyrobot_levels.analysis.solver.horizon import best_return_within
    from babyrobot_levels.analysis.solver.results import EpisodeTooLongError

    try:
        return best_return_within(level, steps, actions=actions, quick=True)
    except EpisodeTooLongError:
        return None


def _plain(value: Any) -> Any:
    """Return a value of a spec with lists for tuples, as JSON has them."""
    if isinstance(value, WrapperSpec):
        return _plain(vars(value))
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    return [_plain(each) for each in value] if isinstance(value, list | tuple) else value
