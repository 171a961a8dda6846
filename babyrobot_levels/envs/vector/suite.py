"""The vector environment of a suite: another of its levels in each episode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from babyrobot_levels.envs.arguments import check_names, checked_given
from babyrobot_levels.envs.suite import make_suite_serializable, suite_and_split
from babyrobot_levels.envs.vector.env import LevelVectorEnv

if TYPE_CHECKING:
    from babyrobot_levels.envs.suite import SuiteLike


class SuiteVectorEnv(LevelVectorEnv):
    """Many environments that step in one call, and draw a level of a suite for each episode.

    The vector entry point of `babyrobot/Suite-v0`. Each environment is equivalent to a `SuiteEnv`
    in the `TimeLimit` of the suite.

    Attributes:
        suite: the suite, or the split of it.
    """

    def __init__(
        self, suite: SuiteLike, *, split: str | None = None, num_envs: int = 1, **kwargs: Any
    ) -> None:
        """Make the environment of a suite.

        Args:
            suite: a name, a path, a mapping or a `Suite`.
            split: the split that is used; by default, the whole suite.
            num_envs: how many environments there are.
            kwargs: the other arguments of `LevelVectorEnv`, such as `sampler`, except for
                `level`, `levels` and `draw_levels`.

        Raises:
            SuiteNotFoundError: there is no such suite.
            LevelError: the suite is not valid.
            UnsatisfiableError: no level meets the suite's conditions.
            ValueError: there is no such split, it has no levels, or another argument is invalid.
        """
        self._given_suite, self.suite = suite_and_split(suite, split)
        super().__init__(levels=self.suite, draw_levels=True, num_envs=num_envs, **kwargs)

    def _make_serializable(self, given: dict[str, Any]) -> None:
        super()._make_serializable(given)
        make_suite_serializable(given, self._given_suite)


def make_suite_vector(suite: SuiteLike | None = None, **kwargs: Any) -> SuiteVectorEnv:
    """Return a suite's vector environment: the vector entry point of `babyrobot/Suite-v0`.

    Args:
        suite: a name, a path, a mapping or a `Suite`.
        kwargs: the other arguments of `SuiteVectorEnv`.

    Raises:
        MissingArgument: there is no suite.
        TypeError: there is no such argument.
    """
    check_names(kwargs, LevelVectorEnv.__init__, "split", "suite")
    return SuiteVectorEnv(checked_given("suite", suite), **kwargs)
