"""The action space of many robots: masks are arrays, as they come in `info`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.tables import masks_at
from babyrobot_levels.mdp.actions import NUM_ACTIONS

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.robots import Robots
    from babyrobot_levels.envs.engine.tables import Words


class BatchActions(spaces.MultiDiscrete[Any]):
    """A `MultiDiscrete`, one action for each robot, whose `sample` takes a mask for all of them.

    It equals the plain `MultiDiscrete` of its size, and contains all that it contains.
    """

    standing: Words | None = None
    """The words of `Tables` of which masks are taken for `sample()`; None for any action."""

    def __init__(self, num_actions: int, robots: Robots) -> None:
        """Make the space.

        Args:
            num_actions: how many actions a robot has.
            robots: the robots.
        """
        super().__init__(np.full(robots.state.size, num_actions, np.int64))
        self._robots = robots

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
            return self._chosen((mask != 0).view(np.int8))
        if mask is not None or probability is not None or self.standing is None:
            return super().sample(mask, probability)
        state = self._robots.state
        if state[0] < 0:
            return super().sample()
        return self._chosen(masks_at(self.standing, state, int(self.nvec[0])))

    def _chosen(self, masks: NDArray[np.int8]) -> NDArray[Any]:
        sets = (masks @ _WEIGHTS[: masks.shape[1]]).astype(np.intp)
        which = (self.np_random.random(sets.size) * _COUNTS.take(sets)).astype(np.intp)
        actions: NDArray[Any] = _WAYS.take(sets * NUM_ACTIONS + which)
        return actions


_WEIGHTS = 1 << np.arange(NUM_ACTIONS, dtype=np.int8)
_SETS = np.arange(2**NUM_ACTIONS)[:, None] & _WEIGHTS > 0
"""The sets of actions, bool `[sets, actions]`; a set's number is the sum of its weights."""
_COUNTS = _SETS.sum(axis=1)
_WAYS = np.argsort(~_SETS, axis=1, kind="stable").ravel().astype(np.int64)
"""The actions of each set, the possible ones first."""
