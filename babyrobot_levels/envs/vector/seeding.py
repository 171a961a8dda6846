"""Where a vector environment's chance comes from: one generator, or one for each environment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import VectorEnv

from babyrobot_levels.envs.engine.draws import OwnDraws, SharedDraws
from babyrobot_levels.envs.vector.arguments import checked_seeds

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.draws import Draws
    from babyrobot_levels.envs.engine.tables import Ints


class SeededVectorEnv(VectorEnv[Any, Any, Any]):
    """Many robots that are left to chance. What happens to them, heirs say."""

    _most_draws: int
    _draws: Draws

    @property
    def np_random(self) -> Any:
        """The generator that all environments share; after a list of seeds, a tuple of theirs.

        Draws are made ahead of time: it has gone further than what was used.
        """
        if self._np_random is None:
            self._share(*seeding.np_random())
        return self._np_random

    @np_random.setter
    def np_random(self, generator: np.random.Generator) -> None:
        self._share(generator, -1)

    @property
    def np_random_seed(self) -> Any:
        """The seed of `np_random`, -1 if it is not known, or a tuple of seeds."""
        if self._np_random is None:
            self._share(*seeding.np_random())
        return self._np_random_seed

    def _seed(self, seed: Any, which: Ints) -> None:
        """Do with generators what a reset of these environments says with its seed.

        Raises:
            ValueError: there are more or fewer seeds than environments, or one is none.
        """
        if seed is None and self._np_random is not None:
            return
        if seed is None or np.ndim(seed) == 0:
            self._share(*seeding.np_random(seed))
        else:
            self._part(checked_seeds(seed, self.num_envs), which)

    def _share(self, generator: np.random.Generator, seed: int) -> None:
        self._np_random, self._np_random_seed = generator, seed
        self._draws = SharedDraws(generator, self._most_draws)

    def _part(self, seeds: list[int | None], which: Ints) -> None:
        """Give some environments generators of their own; without a seed, they keep what they have.

        Those that have none yet get one too: either all environments share a generator, or none.
        """
        own: list[Any] = [None] * self.num_envs
        draws = OwnDraws(self.num_envs)
        if self._np_random is not None and isinstance(self._draws, OwnDraws):
            draws = self._draws
            own = list(zip(self.np_random, self.np_random_seed, strict=True))
        asked = {number: seeds[number] for number in which.tolist()}
        for number, known in enumerate(own):
            seed = asked.get(number)
            if known is None or seed is not None:
                own[number] = seeding.np_random(seed)
                draws.follow(number, own[number][0])
        told: Any = tuple(zip(*own, strict=True))
        self._np_random, self._np_random_seed = told
        self._draws = draws
