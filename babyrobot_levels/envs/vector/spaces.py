"""The action space of many robots: masks are arrays, as they come in `info`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

if TYPE_CHECKING:
    from babyrobot_levels.engine.robots import Robots


class BatchActions(spaces.MultiDiscrete[Any]):
    """A `MultiDiscrete`, one action for each robot, whose `sample` takes a mask for all of them.

    It equals the plain `MultiDiscrete` of its size, and contains all that it contains.
    """

    def __init__(
        self,
        num_actions: int,
        num_robots: int,
        masks: NDArray[np.int8] | None = None,
        robots: Robots | None = None,
    ) -> None:
        """Make the space.

        Args:
            num_actions: how many actions a robot has.
            num_robots: how many robots there are.
            masks: the possible actions of each state, int8 `[states, actions]`; if they are
                given, `sample()` gives only possible ones.
            robots: the robots whose states these are.
        """
        super().__init__(np.full(num_robots, num_actions, np.int64))
        self._masks, self._robots = masks, robots
        self._ways: tuple[NDArray[np.int64], NDArray[np.int8]] | None = None

    def sample(self, mask: Any = None, probability: Any = None) -> NDArray[Any]:
        """Return an action for each robot, each of its possible ones with equal probability.

        Args:
            mask: which actions are possible, int8 `[robots, actions]` as `info["action_mask"]`
                has it, or a tuple of `[actions]`. A robot without any gets action 0.
            probability: a tuple of the probabilities of each robot's actions.
        """
        if isinstance(mask, np.ndarray) and probability is None:
            if mask.shape != (self.nvec.size, self.nvec[0]):
                raise ValueError(
                    f"the mask must have shape [{self.nvec.size}, {self.nvec[0]}], "
                    f"not {list(mask.shape)}"
                )
            return self._chosen(*_ways_of(mask))
        if mask is not None or probability is not None or self._masks is None:
            return super().sample(mask, probability)
        assert self._robots is not None
        state = self._robots.state
        if state[0] < 0:
            return super().sample()
        if self._ways is None:
            self._ways = _ways_of(self._masks)
        count, ways = self._ways
        return self._chosen(count.take(state), ways.take(state, axis=0))

    def _chosen(self, count: NDArray[np.int64], ways: NDArray[np.int8]) -> NDArray[Any]:
        which = (self.np_random.random(count.size) * count).astype(np.intp)
        return ways[np.arange(count.size), which].astype(self.dtype)


def _ways_of(masks: NDArray[np.int8]) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
    """Return how many actions are possible, `[…]`, and actions, the possible ones first."""
    ways = np.argsort(masks == 0, axis=1, kind="stable")
    return (masks != 0).sum(axis=1), ways.astype(np.int8)
