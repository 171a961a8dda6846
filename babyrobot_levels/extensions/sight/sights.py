"""Sights: what an agent is shown, by the names of observations and of worlds of text.

What an agent is shown in a state is a key, which can be hashed: two states with one key look the
same. What it is told of a step, such as its reward, is a signal.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Sequence
from hashlib import blake2b
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.envs.arguments import checked_observation
from babyrobot_levels.envs.observations import OBSERVATIONS, make_observer
from babyrobot_levels.envs.observations.base import Extent, Observation, Observer
from babyrobot_levels.envs.text import narrator_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Event, Ints, events_of, hits_of
from babyrobot_levels.render.sights import SIGHTS
from babyrobot_levels.render.words.happenings import happenings
from babyrobot_levels.text import budget
from babyrobot_levels.text.words import check_choice

TEXTS = {f"text-{sight}": sight for sight in SIGHTS}
"""The sights of worlds of text by their names here: `view` is an observation as well."""

NAMES = (*OBSERVATIONS.own, *TEXTS)
"""The names of all sights."""

Sensor = Callable[[Level, int], Hashable]
"""A sight of one's own: what an agent is shown in a state of a level."""

_PART = 256
"""Of so many states, observations are made at a time."""


class Sight(ABC):
    """What an agent is shown.

    Args:
        name: what it is called.
        reward: whether the agent is told the reward of each step.
    """

    def __init__(self, name: str, reward: bool) -> None:
        self.name, self.reward = name, reward

    @abstractmethod
    def shown(self, space: StateSpace, states: Ints) -> list[Hashable]:
        """Return what is shown in each of some states of a level."""

    def signals(self, space: StateSpace, states: Ints) -> tuple[Ints, list[Hashable]]:
        """Return what is told of steps.

        Returns:
            The number of the signal of each outcome, `[states, actions, outcomes]`, and all
            signals, of which number 0 tells nothing.
        """
        rewards = space.mdp.reward[states, space.first_action :]
        if not self.reward:
            return np.zeros(rewards.shape, np.intp), [None]
        known, which = np.unique(rewards, return_inverse=True)
        return which.reshape(rewards.shape) + 1, [None, *known.tolist()]

    def key(self, observation: Any, mask: Any, reward: float | None) -> Hashable:
        """Return the key of what an agent was given: what is shown, and the signal.

        Args:
            observation: as the environment gives it.
            mask: the action mask.
            reward: that of the last step; None at reset.
        """
        return self.recognised(observation, mask), reward if self.reward else None

    @abstractmethod
    def recognised(self, observation: Any, mask: Any) -> Hashable:
        """Return what `shown` returns for the state with an observation."""


class ObservationSight(Sight):
    """The observation of an environment, and the action mask, which the info has."""

    def __init__(self, observation: Observation, extent: Extent, mask: bool, reward: bool) -> None:
        name = observation.name
        super().__init__(name if isinstance(name, str) else "+".join(name), reward)
        self.observation, self._extent, self._mask = observation, extent, mask

    def shown(self, space: StateSpace, states: Ints) -> list[Hashable]:
        """Return digests of observations and masks."""
        assert isinstance(space.level, Level)
        observer = make_observer(space.level, self.observation, self._extent)
        self._space = observer.space
        sizes = [each.size for each in _arrays(self._space, self._space.sample())]
        budget.spend(states.size * (1_000 + 4 * sum(sizes) + 150 * _parts(space.level)))
        masks = space.mdp.action_mask[states, space.first_action :]
        keys: list[Hashable] = []
        for begin in range(0, states.size, _PART):
            part = states[begin : begin + _PART]
            keys += _digests(observer, part, masks[begin : begin + _PART], self._mask)
        return keys

    def recognised(self, observation: Any, mask: Any) -> Hashable:
        """Return the digest of an observation and a mask."""
        parts = _arrays(self._space, observation)
        if self._mask and mask is None:
            raise ValueError("this sight has the action mask: give `info['action_mask']` as well")
        return _digest([*parts, np.asarray(mask, np.int8)] if self._mask else parts)


def _digests(
    observer: Observer, states: Ints, masks: NDArray[np.int8], mask: bool
) -> list[Hashable]:
    rows = _arrays(observer.space, observer.rows(states.astype(np.int64)))
    rows += [masks] if mask else []
    return [_digest([each[index] for each in rows]) for index in range(states.size)]


def _parts(level: Level) -> int:
    """Return how many parts of a level are looked at for each state."""
    return len(level.things()) + len(level.doors)


def _arrays(space: Any, observation: Any) -> list[NDArray[Any]]:
    """Return an observation, or many of them, as arrays: one, or one for each entry of a dict."""
    if isinstance(observation, dict):
        return [np.asarray(observation[name], space[name].dtype) for name in space]
    return [np.asarray(observation, space.dtype)]


def _digest(arrays: Sequence[NDArray[Any]]) -> bytes:
    hashed = blake2b(digest_size=16)
    for each in arrays:
        # -0.0 equals 0.0, and has other bytes.
        hashed.update((each + np.zeros((), each.dtype)).tobytes())
    return hashed.digest()


class TextSight(Sight):
    """What a world of text tells: rules, what is seen, what happened, and rewards.

    Args:
        name: one of `TEXTS`.
        within: the number of steps after which an episode is over, which rules tell.
    """

    def __init__(self, name: str, within: int | None) -> None:
        super().__init__(name, reward=True)
        self._sight, self._within = TEXTS[name], within

    def shown(self, space: StateSpace, states: Ints) -> list[Hashable]:
        """Return texts, with the rules, which differ between levels."""
        assert isinstance(space.level, Level)
        size = 25 * prod(space.level.size) + 2_000 * _parts(space.level)
        budget.spend(states.size * (40_000 + size))
        limit = self._within or space.level.max_steps
        narrator = narrator_of(space.level.model_copy(update={"max_steps": limit}), self._sight)
        rules = narrator.rules()
        return [(rules, narrator.scene(state)) for state in states.tolist()]

    def signals(self, space: StateSpace, states: Ints) -> tuple[Ints, list[Hashable]]:
        """Return what is told of steps: what happened, and the reward as it is printed."""
        mdp, level = space.mdp, space.level
        budget.spend(5_000 * int(np.count_nonzero(mdp.probability[states])))
        events, hits = events_of(mdp), hits_of(level, mdp)
        numbers: dict[Hashable, int] = {None: 0}
        table = np.zeros(mdp.probability[states].shape, np.intp)
        for row, action, outcome in np.argwhere(mdp.probability[states] > 0).tolist():
            step = states[row], action, outcome
            told = happenings(
                level,
                int(states[row]),
                action,
                int(mdp.next_state[step]),
                skidded=bool(events[step] == Event.SKIDDED),
                target_reached=bool(events[step] == Event.REACHED),
                hit=bool(hits[step]),
            )
            text = " ".join([*told, f"reward {mdp.reward[step]:g}"])
            table[row, action, outcome] = numbers.setdefault(text, len(numbers))
        return table, [*numbers]

    def key(self, observation: Any, mask: Any, reward: float | None) -> Hashable:
        """Return the key of texts: `observation` is (rules, what is seen, what was told)."""
        return self.recognised(observation, mask), observation[2]

    def recognised(self, observation: Any, mask: Any) -> Hashable:
        """Return the rules and what is seen."""
        rules, scene, _ = observation
        return rules, scene


class SensorSight(Sight):
    """What a function shows: a sensor of one's own."""

    def __init__(self, sensor: Sensor, reward: bool) -> None:
        super().__init__(getattr(sensor, "__name__", "sensor"), reward)
        self._sensor = sensor

    def shown(self, space: StateSpace, states: Ints) -> list[Hashable]:
        """Return what the function returns."""
        assert isinstance(space.level, Level)
        return [self._sensor(space.level, state) for state in states.tolist()]

    def recognised(self, observation: Any, mask: Any) -> Hashable:
        """Return the observation, which is what the function returned."""
        key: Hashable = observation
        return key


def sight_of(
    sight: str | Sequence[str] | Sensor,
    extent: Extent,
    *,
    mask: bool = True,
    reward: bool = False,
    within: int | None = None,
    **options: Any,
) -> Sight:
    """Return a sight.

    Args:
        sight: one of `NAMES`, a tuple of names of observations, or a function.
        extent: that of all levels, whose observations have one space.
        mask: whether an agent that observes gets the action mask as well.
        reward: whether it is told the reward of each step; worlds of text always tell it.
        within: the number of steps after which an episode is over, if it is told.
        options: those of the observation, such as `view_radius`.

    Raises:
        ValueError: there is no such sight, or it has no such option.
        TypeError: there is no such option.
    """
    if callable(sight):
        check_no_options("a function", options)
        return SensorSight(sight, reward)
    if isinstance(sight, str):
        check_choice("sight", sight, NAMES)
        if sight in TEXTS:
            check_no_options(repr(sight), options)
            if extent.headings > 1:
                raise ValueError(f"sight={sight!r} tells of robots that do not turn")
            return TextSight(sight, within)
    return ObservationSight(checked_observation(observation=sight, **options), extent, mask, reward)


def check_no_options(sight: str, options: dict[str, Any]) -> None:
    """Raise a TypeError if there are options for a sight that has none."""
    for name in options:
        raise TypeError(f"unexpected option {name!r}: {sight} has none")
