"""Many robots in the levels of a suite, another level in each episode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from babyrobot_levels.envs.suite import spell_out_suite, suite_and_split
from babyrobot_levels.envs.vector.env import LevelVectorEnv

if TYPE_CHECKING:
    from babyrobot_levels.envs.suite import SuiteLike


class SuiteVectorEnv(LevelVectorEnv):
    """Many robots walk the levels of a suite: each episode is played in a level that is drawn.

    The vector entry point of `babyrobot/Suite-v0`. Each environment is what `SuiteEnv` is, under
    the time limit of the suite.

    Attributes:
        suite: the levels, or the split of them, that are played.
    """

    def __init__(
        self, suite: SuiteLike, *, split: str | None = None, num_envs: int = 1, **kwargs: Any
    ) -> None:
        """Make the environment of a suite.

        Args:
            suite: a name, a path, a mapping or a `Suite`.
            split: the split whose levels are played; all of them if left out.
            num_envs: how many environments there are.
            kwargs: what `LevelVectorEnv` takes beside these and the levels.

        Raises:
            SuiteNotFoundError: there is no such suite.
            LevelError: the suite is not valid.
            StarvedError: no level meets the suite's conditions.
            ValueError: there is no such split, no level at all, or another argument has a value
                that it cannot have.
        """
        self._given_suite, self.suite = suite_and_split(suite, split)
        super().__init__(levels=self.suite, draw_levels=True, num_envs=num_envs, **kwargs)

    def _spell_out(self, given: dict[str, Any]) -> None:
        super()._spell_out(given)
        spell_out_suite(given, self._given_suite)
