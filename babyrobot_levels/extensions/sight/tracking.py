"""What one believes who is shown things step by step, and knows the levels."""

from collections.abc import Hashable
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.extensions.sight.model import PartialModel, build_model
from babyrobot_levels.extensions.sight.sights import sight_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Floats, Ints


class Tracker:
    """The belief of an episode.

    Args:
        model: the POMDP.

    Attributes:
        model: the POMDP.
        states: the hidden states that may be, rising.
        chances: their probabilities.
    """

    def __init__(self, model: PartialModel) -> None:
        self.model = model
        self.reset()

    def reset(self) -> None:
        """Forget the episode before."""
        self.steps = 0
        self.states: Ints = np.zeros(0, np.intp)
        self.chances: Floats = np.zeros(0)

    def observe(self, key: Hashable, action: int = -1) -> int:
        """Take in what is shown, and return its number in the model.

        Args:
            key: what is shown, and the signal, as the model's sight has them.
            action: the action before it; none at reset.

        Raises:
            ValueError: no episode of these levels shows this after what was shown before.
        """
        model, number = self.model, self.model.keys.get(key, -1)
        beliefs = model.after(self.states, self.chances, action) if self.steps else model.initial()
        for _, states, chances in beliefs:
            if model.observation[states[0]] == number:
                self.steps, self.states, self.chances = self.steps + 1, states, chances
                return number
        raise ValueError(
            f"no episode comes to what was observed in step {self.steps}; is it an environment "
            f"of these levels, with the sight {model.sight.name!r} and its options?"
        )

    @property
    def sure(self) -> float:
        """The probability of the likeliest state."""
        return float(self.chances.max())


def tracker_of(level: Level, sight: str, within: int | None = None, **options: Any) -> Tracker:
    """Return what follows beliefs in a level.

    Args:
        level: the level.
        sight: one of `NAMES`.
        within: the number of steps after which an episode is over, which worlds of text tell.
        options: those of the observation.

    Raises:
        TooLargeError: the level has too many states.
    """
    chosen = sight_of(sight, Extent.of([level], turns=False), within=within, **options)
    return Tracker(build_model([space_of(level, "all")], chosen, [1.0], [level.discount]))
