"""How new levels are: whether they are known, and how far their metrics are from known ones."""

from collections.abc import Sequence

import numpy as np

from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.language.metric_names import METRICS, NEEDS, PATHS, SHAPE
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.suites.suite import Levels, named_levels
from babyrobot_levels.text.words import Telling, check_choice


class NoveltyArchive(Telling, public=True):
    """Known levels, with which others are compared: `level in archive`, and `archive.novelty`.

    After J. Lehman and K. O. Stanley: Abandoning Objectives: Evolution Through the Search for
    Novelty Alone (2011).

    Args:
        levels: levels that are known from the beginning.
        features: the names of the metrics by which levels are compared, as `Metrics` has them; by
            default, those for which no level has to be solved and that all levels have.
        nearest: the number of known levels with which one is compared.

    Raises:
        ValueError: there is no such metric, or it is no number, or `nearest` is below 1.
    """

    def __init__(
        self, levels: Levels = (), *, features: Sequence[str] = (*SHAPE, *PATHS), nearest: int = 5
    ) -> None:
        for name in features:
            check_choice("a feature", name, [name for name in METRICS if name not in NEEDS])
        nearest = check_count("nearest", nearest)
        self._features, self._nearest = tuple(features), nearest
        self._known: dict[str, Floats] = {}
        self.add(levels)

    def __len__(self) -> int:
        return len(self._known)

    def __contains__(self, level: Level) -> bool:
        """Return whether a level with this digest is known."""
        return level.digest in self._known

    def add(self, levels: Levels) -> None:
        """Add levels; those that are known change nothing.

        Args:
            levels: a level, several, a folder, a pack or a suite.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid, or its maze has no seed yet.
        """
        for level in map(load, named_levels(levels)):
            if level not in self:
                self._known[level.digest] = self._measured(level)

    def novelty(self, levels: Levels) -> Floats:
        """Return how new levels are, float64 `[levels]`: 0 for known ones.

        It is the mean distance to the nearest known levels. Each metric counts in standard
        deviations of the known levels, or as it is where they all agree. Where a level does not
        have a metric, the mean of the known levels stands for it.

        Args:
            levels: a level, several, a folder, a pack or a suite.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid, or its maze has no seed yet.
            ValueError: no level is known yet.
        """
        if not self._known:
            raise ValueError("no level is known yet: add some")
        known = np.ma.masked_invalid(list(self._known.values()))
        mean, deviation = known.mean(axis=0), known.std(axis=0).filled(0.0)
        scale = np.where(deviation > 0, deviation, 1.0)
        known = ((known - mean) / scale).filled(0.0)
        found = []
        for level in map(load, named_levels(levels)):
            own = np.ma.masked_invalid(self._measured(level))
            apart = np.linalg.norm(known - ((own - mean) / scale).filled(0.0), axis=1)
            found.append(0.0 if level in self else float(np.sort(apart)[: self._nearest].mean()))
        return np.array(found)

    def _measured(self, level: Level) -> Floats:
        """Return the features of a level, nan for what it does not have."""
        found = metrics(level)
        return np.array([getattr(found, name) for name in self._features], np.float64)
