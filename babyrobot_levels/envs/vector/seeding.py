"""Random generators of vector environments: one that all share, or one for each environment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import VectorEnv

from babyrobot_levels.envs.engine.draws import OwnDraws, SharedDraws
from babyrobot_levels.envs.engine.factory import whole_number

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.draws import Draws
    from babyrobot_levels.envs.engine.tables import Ints


class SeededVectorEnv(VectorEnv[Any, Any, Any]):
    """A vector environment with `np_random` and seeds. Subclasses define `reset` and `step`."""

    _most_draws: int
    _draws: Draws

    @property
    def np_random(self) -> Any:
        """The generator that all environments share; after a list of seeds, a tuple of theirs.

        Draws are made ahead of time, so the generator has advanced further than was used.
        """
        if self._np_random is None:
            self._share(*seeding.np_random())
        return self._np_random

    @np_random.setter
    def np_random(self, generator: np.random.Generator) -> None:
        self._share(generator, -1)

    @property
    def np_random_seed(self) -> Any:
        """The seed of `np_random`, -1 if it is unknown, or a tuple of seeds."""
        if self._np_random is None:
            self._share(*seeding.np_random())
        return self._np_random_seed

    def _seed(self, seed: Any, which: Ints) -> None:
        """Set the generators as a reset of these environments requires.

        Raises:
            ValueError: there are more or fewer seeds than environments, or one is invalid.
        """
        if seed is None and self._np_random is not None:
            return
        if seed is None or np.ndim(seed) == 0:
            self._share(*seeding.np_random(seed))
        else:
            self._separate(_checked_seeds(seed, self.num_envs), which)

    def _share(self, generator: np.random.Generator, seed: int) -> None:
        self._np_random, self._np_random_seed = generator, seed
        self._draws = SharedDraws(generator, self._most_draws)

    def _reserve_draws(self, most: int) -> None:
        """Make room for the draws of a step; those that were made and not used stay."""
        self._most_draws = most
        if self._np_random is not None:
            self._draws.enlarge(most)

    def _separate(self, seeds: list[int | None], which: Ints) -> None:
        """Give these environments new generators; those with seed None keep what they have.

        An environment that has none yet gets one in any case: all share a generator, or none does.
        """
        own: list[Any] = [None] * self.num_envs
        draws = OwnDraws(self.num_envs)
        if self._np_random is not None and isinstance(self._draws, OwnDraws):
            draws = self._draws
            own = list(zip(self.np_random, self.np_random_seed, strict=True))
        new = {number: seeds[number] for number in which.tolist()}
        for number, known in enumerate(own):
            seed = new.get(number)
            if known is None or seed is not None:
                own[number] = seeding.np_random(seed)
                draws.follow(number, own[number][0])
        generators_and_seeds: Any = tuple(zip(*own, strict=True))
        self._np_random, self._np_random_seed = generators_and_seeds
        self._draws = draws


def _checked_seeds(seed: Any, num_envs: int) -> list[int | None]:
    """Return seeds, one for each environment, None for those that are not seeded.

    Raises:
        ValueError: there are more or fewer of them, or one is not a whole number from 0 on.
    """
    given = list(seed) if np.iterable(seed) else []
    seeds = [None if each is None else whole_number(each) for each in given]
    wrong = [
        each is not None and (number is None or number < 0)
        for each, number in zip(given, seeds, strict=True)
    ]
    if len(seeds) != num_envs or any(wrong):
        raise ValueError(
            f"seed must be a whole number from 0 on, or a list of {num_envs} such numbers, "
            "of which None leaves an environment's generator as it is"
        )
    return seeds
