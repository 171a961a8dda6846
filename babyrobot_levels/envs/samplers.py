"""Which level an episode is in: samplers, and the families from which they and others draw.

A family is a suite or a list of levels, the mazes of a level, or levels that are exchanged.
"""

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babyrobot_levels.analysis.solver.results import check_count, check_share
from babyrobot_levels.envs.engine import draws as engine_draws
from babyrobot_levels.envs.engine.tables import Ints
from babyrobot_levels.envs.single import MAX_MAZE_SEED
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.suite import Suite
from babyrobot_levels.text.words import Telling, check_choice

Draws = NDArray[np.float64]
Numbers = NDArray[np.int64]

_BELOW_ONE = float(np.nextafter(1, 0))


@runtime_checkable
class Sampler(Protocol):
    """Turns uniform draws into the numbers of levels.

    The environment makes the draws with its own generator, so that the same seed gives the same
    levels, as long as the sampler is in the same state.
    """

    def sample(self, draws: Draws) -> Numbers:
        """Return the number of a level for each draw.

        Args:
            draws: float64 `[n]`, from 0 up to but not including 1.

        Returns:
            int64 `[n]`, from 0 up to but not including the number of levels.
        """


Sampler.__module__ = "babyrobot_levels"


class UniformSampler:
    """Draws all levels equally often.

    Args:
        count: how many levels there are.
    """

    __module__ = "babyrobot_levels"

    def __init__(self, count: int) -> None:
        self._count = check_count("count", count)

    def sample(self, draws: Draws) -> Numbers:
        """Return the number of a level for each draw; see `Sampler`."""
        return (draws * self._count).astype(np.int64)


class WeightedSampler:
    """Draws levels in proportion to weights.

    Args:
        weights: the weights, float64 `[groups]`, none below 0.
        counts: how many levels each group has, which share its weight equally; int64 `[groups]`.
            By default, each group is one level.

    Raises:
        ValueError: weights are negative or infinite, all are 0, or a count is below 1.
    """

    __module__ = "babyrobot_levels"

    def __init__(self, weights: ArrayLike, counts: ArrayLike | None = None) -> None:
        self._weights = np.array(weights, np.float64)
        self._counts = np.array(1 if counts is None else counts, np.int64)
        self._counts = np.broadcast_to(self._counts, self._weights.shape)
        total = self._weights.sum()
        if self._weights.ndim != 1 or (self._weights < 0).any() or not 0 < total < np.inf:
            raise ValueError("weights must be finite numbers from 0 on, at least one of them above")
        if (self._counts < 1).any():
            raise ValueError("counts must be whole numbers, at least 1")
        self._first = np.cumsum(self._counts) - self._counts
        self._ends = np.cumsum(self._weights)
        # The last group that can be drawn takes the rounding error of the sum.
        self._ends[int(self._weights.nonzero()[0][-1]) :] = np.inf
        self._total = float(total)

    def sample(self, draws: Draws) -> Numbers:
        """Return the number of a level for each draw; see `Sampler`."""
        place = draws * self._total
        group = np.searchsorted(self._ends, place, side="right")
        begin = np.where(group > 0, self._ends.take(group - 1), 0.0)
        within = np.clip((place - begin) / self._weights.take(group), 0, _BELOW_ONE)
        numbers: Numbers = self._first.take(group)
        return numbers + (within * self._counts.take(group)).astype(np.int64)


class PrioritizedSampler(Telling, public=True):
    """Prioritised level replay: draws the levels more often from which more is to be learnt.

    The training loop says how much that is, by `update`. An episode is in a level without a score
    with a probability of `unseen`, uniformly; otherwise in one with a score, with the probability
    `(1 - staleness) * P_score + staleness * P_stale`. `P_score` is proportional to
    `priority ** (1 / temperature)`, where the priority is 1 / rank, the highest score having rank
    1, or the score itself. `P_stale` is proportional to the number of episodes since the level was
    drawn last. After M. Jiang, E. Grefenstette, T. Rocktäschel: Prioritized Level Replay (2021).

    Args:
        count: how many levels there are.
        by: `"rank"` or `"score"`: what priorities are.
        temperature: above 0; the lower, the more often the highest priority is drawn.
        staleness: from 0 to 1: how often levels are drawn because they were not for long.
        unseen: from 0 to 1: how often levels without a score are drawn while there are some. By
            default, the share of these among all levels.

    Attributes:
        scores: float64 `[count]`: the last score of each level, NaN for none.

    Raises:
        ValueError: an argument is not in its range.
    """

    def __init__(
        self,
        count: int,
        *,
        by: str = "rank",
        temperature: float = 0.1,
        staleness: float = 0.1,
        unseen: float | None = None,
    ) -> None:
        check_choice("by", by, ("rank", "score"))
        check_count("count", count)
        if not temperature > 0:
            raise ValueError(f"temperature must be above 0, not {temperature}")
        check_share("staleness", staleness)
        check_share("unseen", 0.0 if unseen is None else unseen)
        self.scores = np.full(count, np.nan)
        self._by, self._temperature = by, temperature
        self._staleness, self._unseen = staleness, unseen
        self._drawn_at, self._episodes = np.zeros(count, np.int64), 0

    def update(self, levels: ArrayLike, scores: ArrayLike) -> None:
        """Set the scores of levels; of a level that is named twice, the last one counts.

        Args:
            levels: the numbers of the levels, int64 `[n]`, such as `info["level_index"]`.
            scores: their scores, float64 `[n]`.

        Raises:
            ValueError: the arrays differ in size, a level does not exist, or a score is not
                finite, or negative with `by="score"`.
        """
        numbers, values = np.asarray(levels), np.asarray(scores, np.float64)
        if numbers.shape != values.shape or numbers.ndim != 1:
            raise ValueError("levels and scores must be lists of the same length")
        if numbers.size and numbers.dtype.kind not in "iu":
            raise ValueError("levels must be whole numbers")
        if ((numbers < 0) | (numbers >= self.scores.size)).any():
            raise ValueError(f"levels must be whole numbers below {self.scores.size:,}")
        if not np.isfinite(values).all() or (self._by == "score" and (values < 0).any()):
            least = " from 0 on" if self._by == "score" else ""
            raise ValueError(f"scores must be finite numbers{least}")
        for number, value in zip(numbers.tolist(), values.tolist(), strict=True):
            self.scores[number] = value

    def probabilities(self) -> NDArray[np.float64]:
        """Return the probability of each level in the next episode, float64 `[count]`."""
        is_new = np.isnan(self.scores)
        unseen = float(is_new.mean()) if self._unseen is None else self._unseen
        if is_new.all() or not is_new.any():
            unseen = float(is_new.all())
        chances = np.where(is_new, unseen / max(1, int(is_new.sum())), 0.0)
        if (known := np.flatnonzero(~is_new)).size:
            age = (self._episodes - self._drawn_at[known]).astype(np.float64)
            share = self._staleness if age.any() else 0.0
            replayed = (1 - share) * _normalised(self._priorities(self.scores[known]))
            if share:
                replayed += share * _normalised(age)
            chances[known] = (1 - unseen) * replayed
        return chances

    def sample(self, draws: Draws) -> Numbers:
        """Return the number of a level for each draw; see `Sampler`."""
        numbers = WeightedSampler(self.probabilities()).sample(draws)
        self._episodes += draws.size
        self._drawn_at[numbers] = self._episodes
        return numbers

    def _priorities(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the priorities of scores, to the power of 1 / temperature; the highest is 1."""
        if self._by == "rank":
            priority = np.empty(scores.size)
            # Of equal scores, the lower number has the higher rank.
            priority[np.argsort(-scores, kind="stable")] = 1 / np.arange(1, scores.size + 1)
        else:
            highest = scores.max()
            priority = scores / highest if highest > 0 else np.ones(scores.size)
        return priority ** (1 / self._temperature)


def _normalised(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    shares: NDArray[np.float64] = weights / weights.sum()
    return shares


def suite_sampler(suite: Suite) -> Sampler:
    """Return the sampler of a suite: by its weights, if it has any."""
    groups = suite.groups
    if len({weight for _, weight in groups}) == 1:
        return UniformSampler(len(suite))
    counts = [count for count, _ in groups]
    return WeightedSampler([count * weight for count, weight in groups], counts)


def checked_sampler(sampler: Any, levels: Sequence[Any]) -> Sampler:
    """Return the sampler of levels; without one, that of the suite, or a uniform one.

    Raises:
        ValueError: it has no method `sample`.
    """
    if sampler is None:
        return suite_sampler(levels) if isinstance(levels, Suite) else UniformSampler(len(levels))
    if not isinstance(sampler, Sampler):
        raise ValueError(f"sampler must have a method `sample(draws)`; {sampler!r} has none")
    return sampler


def sampled(sampler: Sampler, draws: Draws, count: int) -> Numbers:
    """Return what a sampler makes of draws.

    Raises:
        ValueError: these are not numbers of levels.
    """
    numbers = np.asarray(sampler.sample(draws))
    if numbers.shape != draws.shape or numbers.dtype.kind not in "iu":
        raise ValueError(
            f"the sampler must return {draws.size} whole numbers, int64 [{draws.size}], "
            f"not an array of {numbers.dtype} with shape {list(numbers.shape)}"
        )
    if ((numbers < 0) | (numbers >= count)).any():
        wrong = numbers[(numbers < 0) | (numbers >= count)][0]
        raise ValueError(f"the sampler returned {wrong}, but the levels are 0 to {count - 1:,}")
    return numbers.astype(np.int64, copy=False)


# -- families --------------------------------------------------------------------------------


class Family(Protocol):
    """Levels that are made from their numbers."""

    @property
    def key(self) -> str:
        """The name of a level's number in infos."""

    @property
    def option(self) -> str | None:
        """The name of the option of `reset` that selects a number, None for no option."""

    @property
    def count(self) -> int:
        """Numbers are below this."""

    @property
    def kept(self) -> int:
        """How many levels to keep at most for later episodes."""

    @property
    def most_starts(self) -> int:
        """The most starts of a level, as far as it is known."""

    @property
    def levels(self) -> Sequence[Level]:
        """The levels, as they were given."""

    def level(self, number: int) -> Level:
        """Return the level of a number."""

    def next_numbers(self, which: Ints, draws: engine_draws.Draws) -> Numbers:
        """Return the number of the next level of each of these environments, int64 `[which]`."""


class DrawnLevels:
    """A suite, a part of it, or a list of levels; a sampler selects the level of each episode."""

    key, option = "level_index", "index"

    def __init__(self, levels: Sequence[Level], sampler: Sampler, most_starts: int) -> None:
        self.levels, self._sampler = levels, sampler
        self.count = self.kept = len(levels)
        self.most_starts = most_starts

    def level(self, number: int) -> Level:
        """Return a level by its number in the suite, or in the part of it."""
        return self.levels[number]

    def next_numbers(self, which: Ints, draws: engine_draws.Draws) -> Numbers:
        """Return numbers that the sampler selects."""
        return sampled(self._sampler, draws.uniform(which), self.count)


class GrownMazes:
    """The mazes of a level with `maze: {seed: random}`."""

    key = option = "maze_seed"
    count = MAX_MAZE_SEED
    kept = 0

    def __init__(self, level: Level) -> None:
        self.levels: Sequence[Level] = (level,)
        self.most_starts = 1

    def level(self, number: int) -> Level:
        """Return the level with the maze of a seed."""
        return self.levels[0].with_maze_seed(number)

    def next_numbers(self, which: Ints, draws: engine_draws.Draws) -> Numbers:
        """Return seeds, drawn uniformly."""
        return UniformSampler(self.count).sample(draws.uniform(which))


class ExchangedLevels:
    """Levels that environments keep until they are given others.

    The number of a level is its place in `levels`. Numbers that no environment has any more are
    given to new levels, so that there are never more than two for each environment.
    """

    key, option = "level_index", None

    def __init__(self, levels: Sequence[Level], level: Ints) -> None:
        """Keep the levels that environments have: `level`, intp `[envs]`, is the number of each."""
        self.levels: Sequence[Level] = tuple(levels)
        self.next_level = level.astype(np.int64)
        self.most_starts = 1

    @property
    def count(self) -> int:
        """How many numbers there are."""
        return len(self.levels)

    @property
    def kept(self) -> int:
        """All levels."""
        return len(self.levels)

    def level(self, number: int) -> Level:
        """Return a level."""
        return self.levels[number]

    def next_numbers(self, which: Ints, draws: engine_draws.Draws) -> Numbers:
        """Return the numbers of the levels that the environments were given."""
        return self.next_level[which]

    def exchange(self, levels: Sequence[Level], which: Ints, playing: Numbers) -> list[int]:
        """Give levels to environments, from their next episodes on.

        Args:
            levels: the level of each of these environments.
            which: the indices of the environments.
            playing: int64 `[envs]`: the numbers of the levels in which episodes are.

        Returns:
            The numbers that stand for other levels than before.
        """
        staying = np.delete(self.next_level, which)
        busy = {*playing.tolist(), *staying.tolist()}
        known = [*self.levels]
        number_of = {id(known[number]): number for number in busy}
        free = iter([number for number in range(len(known)) if number not in busy])
        changed = []
        for level in levels:
            if id(level) not in number_of:
                number = next(free, len(known))
                if number == len(known):
                    known.append(level)
                known[number] = level
                number_of[id(level)] = number
                changed.append(number)
        self.levels = tuple(known)
        self.next_level[which] = [number_of[id(level)] for level in levels]
        return changed
