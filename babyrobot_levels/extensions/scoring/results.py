"""Scores: of an agent in each level, and over all levels, with confidence intervals."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar, overload

import numpy as np

from babyrobot_levels.analysis.solver.policies import StateSpace
from babyrobot_levels.extensions.scoring.intervals import interval
from babyrobot_levels.extensions.scoring.summaries import (
    Improvement,
    Summary,
    improvement_of,
    statistics_of,
)
from babyrobot_levels.language.plain_data import json_mapping
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.text.files import write_bytes, write_text
from babyrobot_levels.text.words import Telling

if TYPE_CHECKING:
    from babyrobot_levels.render.scene.shapes import Scene

FEW = 100
"""Scores from fewer episodes in each level are told to be rough."""

MAX_BARS = 100
"""The most levels in a picture."""


def share(earned: float, chance: float, optimum: float) -> float:
    """Return how much of the way from the random policy to an optimum a return covers.

    It is nan where the random policy is optimal.
    """
    way = optimum - chance
    scale = max(1.0, abs(optimum), abs(chance) if math.isfinite(chance) else 1.0)
    return math.nan if way <= 1e-9 * scale else 1.0 - (optimum - earned) / way


@dataclass(frozen=True, slots=True)
class LevelScore(Telling, public=True):
    """The score of an agent in one level.

    Attributes:
        level: the level's name, or its digest if it has none.
        digest: the level's digest.
        expected_return: the expected return of the agent.
        optimum: that of an optimal policy.
        random: that of the random policy.
        share: how much of the way from the random policy to the optimum the agent covers:
            `(expected_return - random) / (optimum - random)`; nan where the random policy is
            optimal.
        regret: `optimum - expected_return`.
        success: the probability of reaching an exit.
        steps: the expected number of steps.
        within: the number of steps after which episodes are truncated; None for no limit.
        discount: the factor by which each further reward counts less.
        episodes: 0 if the score is exact; else the number of episodes that were played.
        low: the lower end of the 95 % confidence interval of the expected return; equal to it if
            the score is exact.
        high: the upper end.
        invalid: of an agent that reads and writes, how many replies of an episode were invalid, on
            average; else 0.
        positive_advantage: if asked for, the mean of the advantages Q(s, a) - V(s) of the agent's
            steps, those below 0 counted as 0, with its own exact action values and values.
        cvar: if asked for, the mean of its returns in the worst share of episodes.
        knowable: if asked for, the best expected return of any agent that observes what this one
            does, remembers it, and knows the level's rules; an upper bound of it where it is not
            found exactly.
    """

    level: str
    digest: str
    expected_return: float
    optimum: float
    random: float
    share: float
    regret: float
    success: float
    steps: float
    within: int | None
    discount: float
    episodes: int
    low: float
    high: float
    invalid: float = 0.0
    positive_advantage: float | None = None
    cvar: float | None = None
    knowable: float | None = None

    @property
    def knowable_share(self) -> float | None:
        """As `share`, of the way from the random policy to `knowable`; None if not asked for.

        It is nan where one who observes this cannot do better than the random policy.
        """
        if self.knowable is None:
            return None
        return share(self.expected_return, self.random, self.knowable)

    @property
    def learnability(self) -> float:
        """`success * (1 - success)`: the variance of success, highest where it is a coin toss.

        After A. Rutherford et al.: No Regrets: Investigating and Improving Regret Approximations
        for Curriculum Discovery (2024).
        """
        return self.success * (1.0 - self.success)

    @property
    def regret_interval(self) -> tuple[float, float]:
        """The 95 % confidence interval of `regret`; both ends equal it if the score is exact."""
        return self.optimum - self.high, self.optimum - self.low

    @property
    def share_interval(self) -> tuple[float, float]:
        """The 95 % confidence interval of `share`; both ends equal it if the score is exact."""
        low, high = self.share_of(np.array([self.low, self.high])).tolist()
        return low, high

    def share_of(self, returns: Floats) -> Floats:
        """Return the shares of returns in the level, as `share` is that of the expected return."""
        way = math.nan if math.isnan(self.share) else self.optimum - self.random
        return self.share + (returns - self.expected_return) / way


@dataclass(frozen=True, slots=True)
class PooledScore(Telling, public=True):
    """The score of an agent that is put into one of several levels, and not told into which.

    All levels are equally likely.

    Attributes:
        expected_return: the expected return of the agent: the mean over the levels.
        optimum: that of one who sees everything, and so knows in which level it is.
        random: that of the random policy.
        knowable: the best expected return of any agent that observes what this one does, remembers
            it, and knows the levels, but not in which it is; an upper bound of it where it is not
            found exactly.
    """

    expected_return: float
    optimum: float
    random: float
    knowable: float

    @property
    def share(self) -> float:
        """How much of the way from the random policy to `optimum` the agent covers."""
        return share(self.expected_return, self.random, self.optimum)

    @property
    def knowable_share(self) -> float:
        """How much of the way from the random policy to `knowable` it covers."""
        return share(self.expected_return, self.random, self.knowable)


Row = TypeVar("Row", bound=Any)
"""A dataclass."""


def csv_of(rows: Iterable[Sequence[Any]]) -> str:
    """Return rows as CSV. Texts that spreadsheets would take for a formula begin with `'`."""
    out = io.StringIO()
    formula = ("=", "+", "-", "@", "\t", "\r")
    for row in rows:
        cells = [f"'{x}" if isinstance(x, str) and x.startswith(formula) else x for x in row]
        csv.writer(out, lineterminator="\n").writerow(cells)
    return out.getvalue()


class Table(Telling, Sequence[Row]):
    """Rows with the same fields, in their order, that can be written as JSON and as CSV."""

    ROW: ClassVar[type[Any]]

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows = tuple(rows)

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> Row: ...

    @overload
    def __getitem__(self, index: slice) -> Self: ...

    def __getitem__(self, index: int | slice) -> Row | Self:
        if isinstance(index, str):
            raise TypeError(f"rows have numbers, 0 to {len(self) - 1}, and no names: {index!r}")
        return self._part(index) if isinstance(index, slice) else self._rows[index]

    def __iter__(self) -> Iterator[Row]:
        return iter(self._rows)

    def _part(self, rows: slice) -> Self:
        return type(self)(self._rows[rows])

    def to_dict(self) -> dict[str, Any]:
        """Return everything as a mapping that JSON can hold; null for nan."""
        raise NotImplementedError

    def to_json(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return everything as JSON, and write it to a file if a path is given."""
        return _written(json.dumps(self.to_dict(), indent=2, allow_nan=False) + "\n", path)

    def to_csv(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return a table with a line for each row, and write it to a file if a path is given."""
        rows = [list(json_mapping(asdict(row)).values()) for row in self]
        return _written(csv_of([[field.name for field in fields(self.ROW)], *rows]), path)


class Scores(Table[LevelScore], public=True):
    """The scores of an agent in several levels, in their order."""

    ROW = LevelScore

    def __init__(
        self,
        scores: Sequence[LevelScore],
        played: Sequence[Played] = (),
        knowable: float | None = None,
        criterion: str = "return",
    ) -> None:
        """Make scores.

        Args:
            scores: that of each level.
            played: the episodes in each level, if there were any.
            knowable: what can be expected in one of the levels, if that was asked for.
            criterion: what was scored: `"return"`, or `"average"`, the average reward of a step.
        """
        super().__init__(scores)
        self.criterion = criterion
        self._played, self._knowable = tuple(played), knowable

    def _part(self, rows: slice) -> Scores:
        return Scores(self._rows[rows], self._played[rows], criterion=self.criterion)

    @property
    def is_exact(self) -> bool:
        """Whether all scores are exact, and none is from episodes that were played."""
        return not any(score.episodes for score in self)

    @property
    def notice(self) -> str | None:
        """What is to be known of scores from few episodes; None for nothing."""
        least = min((score.episodes for score in self if score.episodes), default=FEW)
        if least >= FEW:
            return None
        return (
            f"of an agent with memory, {least:,} episodes in each level tell little: the intervals "
            f"are wide; play {FEW} or more"
        )

    @cached_property
    def summary(self) -> Summary:
        """The scores of all levels in a few numbers."""
        return summary(self)

    @property
    def pooled(self) -> PooledScore | None:
        """The score in one of the levels, of who is not told in which; None if not asked for."""
        if self._knowable is None:
            return None
        rows = [(each.expected_return, each.optimum, each.random) for each in self]
        earned, optimum, chance = np.mean(rows, axis=0).tolist()
        return PooledScore(earned, optimum, chance, self._knowable)

    def to_dict(self) -> dict[str, Any]:
        """Return everything as a mapping that JSON can hold; null for nan."""
        return {
            "summary": json_mapping(asdict(self.summary)),
            **({} if self.pooled is None else {"pooled": json_mapping(asdict(self.pooled))}),
            **({} if self.criterion == "return" else {"criterion": self.criterion}),
            "levels": [json_mapping(asdict(score)) for score in self],
        }

    def to_svg(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return a picture of the shares as an SVG document: a bar for each level.

        Lines mark the random policy, 0, and the optimum, 1. Only the 100 levels with the lowest
        shares are shown of more.

        Args:
            path: a file to write it to as well, atomically; an existing one is replaced.
        """
        from babyrobot_levels.render.svg import to_svg

        return _written(to_svg(self._scene()), path)

    def to_png(self, path: str | os.PathLike[str] | None = None) -> bytes:
        """Return the picture of `to_svg` as a PNG file."""
        from babyrobot_levels.render.raster import to_png

        scene = self._scene()
        picture = to_png(scene, (round(2 * scene.width), round(2 * scene.height)))
        if path is not None:
            write_bytes(Path(path), picture)
        return picture

    def _scene(self) -> Scene:
        from babyrobot_levels.extensions.learning.charts import Bar, bars_scene

        shown: Sequence[LevelScore] = self
        title = f"Share of the optimum, mean {self.summary.mean:.3g}"
        if len(self) == 1:
            what = "Return" if self.criterion == "return" else "Average reward"
            title = (
                what + " {0.expected_return:.4g}; optimum {0.optimum:.4g}, random {0.random:.4g}"
            )
            title = title.format(self[0])
        if len(self) > MAX_BARS:
            shown = sorted(self, key=lambda each: (math.isnan(each.share), each.share))[:MAX_BARS]
            title += f"; the lowest {MAX_BARS} of {len(self):,} levels"
        bars = [Bar(each.level, each.share, *each.share_interval) for each in shown]
        return bars_scene(bars, title=title, zero="random", one="optimum")

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        from babyrobot_levels.render.notebook.html import picture_mimebundle

        return picture_mimebundle(self._scene(), repr(self))

    def __repr__(self) -> str:
        summary, how = self.summary, "exact"
        if not self.is_exact:
            how = f"estimated low={summary.low:.4g} high={summary.high:.4g}"
        return (
            f"<Scores of {len(self)} levels: mean={summary.mean:.4g} iqm={summary.iqm:.4g} "
            f"worst_tenth={summary.worst_tenth:.4g} solved={summary.solved:.4g} {how}>"
        )


def summary(runs: Scores | Sequence[Scores], *, stratified: bool = False) -> Summary:
    """Return the scores of several runs in a few numbers, such as of agents from several seeds.

    The intervals hold for agents that learned elsewhere, in other levels of the same kind; the
    stratified ones for agents that learned elsewhere, in these levels.

    Args:
        runs: the scores of a run, or of several in the same levels.
        stratified: whether the intervals are for other runs in these levels, and not for others.

    Raises:
        ValueError: there are no runs, their levels differ, or a single run is to be stratified.
    """
    runs = _runs_of(runs)
    if stratified and len(runs) < 2:
        raise ValueError(
            "of a single run, nobody knows how others differ in the same levels; give two or more"
        )
    shares = _shares(runs)
    means = np.array([[(each.regret, each.success) for each in run] for run in runs])
    if not means.size:
        means = np.full((len(runs), 1, 2), math.nan)
    ways = [each.optimum - each.random for each in runs[0]] or [math.nan]
    # As for shares: twice as much as chance has, or as the highest that there is.
    most_regret = 2.0 * float(np.max([*ways, *means[..., 0].ravel()]))
    known, intervals = statistics_of(shares, means, most_regret, stratified=stratified)
    low = high = known["mean"]
    if not all(run.is_exact for run in runs):
        low, high = _interval_of(runs)
    return Summary(len(runs[0]), **known, low=low, high=high, runs=len(runs), intervals=intervals)


def improvement(ones: Scores | Sequence[Scores], others: Scores | Sequence[Scores]) -> Improvement:
    """Return the probability that one agent is better than another (Agarwal et al., 2021).

    It is the statistic of Mann and Whitney in each level. Its interval holds for other runs of
    both, and for other levels of the same kind.

    Args:
        ones: the scores of the one agent: of a run, or of several.
        others: those of the other agent, in the same levels.

    Raises:
        ValueError: there are no runs, or their levels differ.
    """
    first, second = _runs_of(ones), _runs_of(others)
    shares = _shares([*first, *second])
    return improvement_of(shares[: len(first)], shares[len(first) :])


def _runs_of(runs: Scores | Sequence[Scores]) -> list[Scores]:
    return [runs] if isinstance(runs, Scores) else [*runs]


def _shares(runs: Sequence[Scores]) -> Floats:
    """Return the shares of runs, `[runs, levels]`, nan for a single level if there are none."""
    if not runs:
        raise ValueError("there are no runs")
    if len({tuple(each.digest for each in run) for run in runs}) > 1:
        raise ValueError("the runs are not in the same levels")
    shares = np.array([[each.share for each in run] for run in runs]).reshape(len(runs), -1)
    shares = shares[:, ~np.isnan(shares).any(axis=0)]
    return shares if shares.size else np.full((len(runs), 1), math.nan)


def _interval_of(runs: Sequence[Scores]) -> tuple[float, float]:
    """Return the 95 % confidence interval of the mean share in these levels; nan without episodes.

    All episodes count as if each were in a level that is drawn, which makes it wider.
    """
    shares, ends = [], []
    for score, played in chain.from_iterable(zip(run, run._played, strict=False) for run in runs):
        if not math.isnan(score.share):
            shares.append(score.share_of(played.returns))
            ends.append(score.share_of(np.array([played.lowest, played.highest])))
    if not shares:
        return math.nan, math.nan
    lows, highs = np.array(ends).T
    return interval(np.concatenate(shares), float(lows.min()), float(highs.max()))


def _written(text: str, path: str | os.PathLike[str] | None) -> str:
    """Return a text, and write it to a file if a path is given."""
    if path is not None:
        write_text(Path(path), text)
    return text


_MOST_SWEEPS, _MOST_WORK = 10_000, 500_000_000
"""After so many sweeps, or outcomes of all sweeps, extremes are bounded by those of rewards."""


@dataclass(frozen=True, eq=False, slots=True)
class Played:
    """The episodes of an agent in a level.

    Attributes:
        returns: `[episodes]`.
        lowest: the lowest return that there can be.
        highest: the highest.
        invalid: how many replies of an episode were invalid, on average.
    """

    returns: Floats
    lowest: float
    highest: float
    invalid: float = 0.0

    def interval(self) -> tuple[float, float]:
        """Return a 95 % confidence interval of the expected return."""
        return interval(self.returns, self.lowest, self.highest)


def extremes(space: StateSpace, limit: int, discount: float) -> tuple[float, float]:
    """Return bounds of the return of an episode, whatever is done and whatever comes of it.

    They are the lowest and the highest return there can be, unless it would take long to find them.

    Args:
        space: the level.
        limit: the number of steps after which episodes are truncated.
        discount: the factor by which each further reward counts less.
    """
    return _least(space, limit, discount, 1.0), -_least(space, limit, discount, -1.0)


def _least(space: StateSpace, limit: int, discount: float, sign: float) -> float:
    """Return the lowest return there can be, of rewards with a sign."""
    mdp, actions = space.mdp, slice(space.first_action, None)
    is_possible = mdp.probability[:, actions] > 0
    reward = np.where(is_possible, sign * mdp.reward[:, actions], np.inf)
    goes_on = np.where(mdp.terminal[:, actions], 0.0, discount)
    following, is_over = mdp.next_state[:, actions], mdp.is_terminal
    is_start = mdp.start > 0
    values = np.zeros(mdp.num_states)
    most = min(limit, _MOST_SWEEPS, max(1, _MOST_WORK // reward.size))
    for sweep in range(1, most + 1):
        found = (reward + goes_on * values[following]).min(axis=(1, 2))
        found[is_over] = 0.0
        change, values = (found - values)[~is_over], found
        # What falls as much everywhere, by going on, goes on to fall like this.
        if sweep > 1 and change.max() == change.min() <= 0 and (discount == 1 or not change.max()):
            return float(values[is_start].min() + (limit - sweep) * change.min())
    # The steps before the last `most` ones have at least the lowest reward, or none.
    ahead = (limit - most) * min(0.0, float(reward.min()))
    return ahead + float(values[is_start].min() if most == limit else min(0.0, values.min()))
