"""Action sets, the values of the argument `actions`, and their spaces.

`sample()` of the spaces respects action masks.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.tables import Words, masks_at, robot_masks_at
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS, NUM_MOVES, Action, Turn
from babyrobot_levels.mdp.gridworld import check_one_robot
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.state import EnvStates


class ActionSet(NamedTuple):
    """What a value of `actions` means.

    Attributes:
        first: the action that is number 0 of the space.
        samples_valid: whether `sample()` gives only actions that the action mask allows.
        turns: whether the robot turns: the actions are those of `Turn`, in the tables of
            `Mdp.turning`, whose states have a heading.
        team: whether they are the joint actions of several robots.
        moves: how many ways the robot moves, unless it turns.
    """

    first: int
    samples_valid: bool
    turns: bool = False
    team: bool = False
    moves: int = NUM_MOVES

    @property
    def num_actions(self) -> int:
        """The number of actions of a robot."""
        return len(Turn) if self.turns else 1 + self.moves - self.first

    def with_moves(self, moves: int) -> ActionSet:
        """Return these actions for a robot that moves in so many ways."""
        return self._replace(moves=moves)

    def tables(self, level: Level) -> Mdp:
        """Return the tables of a level for a robot with these actions, which begin at `first`.

        Raises:
            LevelError: the level has several robots, and these actions are those of one, or its
                robot moves in more or fewer ways.
        """
        if not self.team:
            check_one_robot(level, "environments of one agent that moves one robot")
        if self.turns:
            return level.compile().turning(level.heading)
        if level.moves != self.moves:
            raise LevelError(
                message=f"the level has `moves: {level.moves}`, and the environment is for "
                f"`moves: {self.moves}`: it has one action space"
            )
        return level.compile()


ACTION_SETS = {
    "valid": ActionSet(Action.STAY, True),
    "all": ActionSet(Action.STAY, False),
    "moves": ActionSet(Action.NORTH, False),
    "valid_moves": ActionSet(Action.NORTH, True),
    "turns": ActionSet(Turn.LEFT, False, turns=True),
}
"""The values of `actions`. From the first action of each set, all further ones belong to it."""


# Before version 1.4, these classes of Gymnasium take no type parameters at run time.
class ValidActions(spaces.Discrete):
    """A `Discrete` whose `sample()` gives only actions that are allowed in the current state.

    It equals a plain `Discrete` of its size, and contains all its actions: the others can be taken
    too, and are refused by a wall. The environment keeps `mask` up to date.
    """

    mask: NDArray[np.int8] | None = None
    """The current action mask, int8 `[actions]`; None before the first reset."""

    def sample(self, mask: Any = None, probability: Any = None) -> Any:
        """Return an allowed action, each with equal probability, or 0 where none is allowed.

        A `mask` or `probability` that is given takes the place of the current mask.
        """
        if mask is not None or probability is not None or self.mask is None:
            return super().sample(mask, probability)
        allowed = self.mask.nonzero()[0]
        if not allowed.size:
            return self.start
        return allowed[self.np_random.integers(allowed.size)]


def make_action_space(actions: ActionSet, num_actions: int) -> spaces.Discrete[Any]:
    """Return the space of an action set, which has so many actions."""
    make = ValidActions if actions.samples_valid else spaces.Discrete
    return make(num_actions)


class BatchActions(spaces.MultiDiscrete):
    """A `MultiDiscrete`, one action for each environment, whose `sample` takes masks as one array.

    It equals the plain `MultiDiscrete` of its size, and contains the same actions.
    """

    state_info: Words | None = None
    """What `Tables` has under this name, for the masks of `sample()`; None for any action."""

    def __init__(self, num_actions: int, envs: EnvStates) -> None:
        """Make the space.

        Args:
            num_actions: how many actions each environment has.
            envs: the states of the environments.
        """
        super().__init__(np.full(envs.state.size, num_actions, np.int64))
        self._envs = envs

    def sample(self, mask: Any = None, probability: Any = None) -> NDArray[Any]:
        """Return an action for each environment, each allowed one with equal probability.

        Args:
            mask: which actions are allowed, int8 `[num_envs, actions]` as in
                `info["action_mask"]`, or a tuple of `[actions]`. An environment that allows none
                gets action 0.
            probability: a tuple of the probabilities of each environment's actions.
        """
        if isinstance(mask, np.ndarray) and probability is None:
            if mask.shape != (self.nvec.size, self.nvec[0]):
                raise ValueError(
                    f"the mask must have shape [{self.nvec.size}, {self.nvec[0]}], "
                    f"not {list(mask.shape)}"
                )
            return _chosen(self.np_random, (mask != 0).view(np.int8))
        if mask is not None or probability is not None or self.state_info is None:
            return super().sample(mask, probability)
        state = self._envs.state
        if state[0] < 0:  # Before the first reset.
            return super().sample()
        return _chosen(self.np_random, masks_at(self.state_info, state, int(self.nvec[0])))


class BatchTeamActions(spaces.Box):
    """An action of each robot of each environment, of which `sample` gives allowed ones.

    It equals the batch of the plain `MultiDiscrete`, int64 `[num_envs, robots]`.
    """

    state_info: Words | None = None
    """What `Tables` has under this name, for the masks of `sample()`; None for any action."""

    def __init__(self, num_robots: int, envs: EnvStates) -> None:
        """Make the space of so many robots in environments."""
        super().__init__(0, NUM_ACTIONS - 1, (envs.state.size, num_robots), np.int64)
        self._envs = envs

    def sample(self, mask: Any = None, probability: Any = None) -> NDArray[Any]:
        """Return an action of each robot, each allowed one with equal probability."""
        state = self._envs.state
        if self.state_info is None or state[0] < 0:  # Before the first reset.
            return super().sample(mask, probability)
        masks = robot_masks_at(self.state_info, state, self.shape[1])
        return _chosen(self.np_random, masks.reshape(-1, NUM_ACTIONS)).reshape(self.shape)


def _chosen(rng: np.random.Generator, masks: NDArray[np.int8]) -> NDArray[Any]:
    """Return an action that each mask allows, each with equal probability."""
    num_actions = masks.shape[1]
    weights, counts, members = _sets(num_actions)
    sets = (masks @ weights).astype(np.intp)
    which = (rng.random(sets.size) * counts.take(sets)).astype(np.intp)
    actions: NDArray[Any] = members.take(sets * num_actions + which)
    return actions


@cache
def _sets(num_actions: int) -> tuple[NDArray[Any], ...]:
    """Return what there is of all sets of actions; a set's number is the sum of its weights.

    These are the weights of actions, `[actions]`, the sizes of sets, `[sets]`, and their actions,
    the members first, `[sets * actions]`.
    """
    dtype: Any = np.int8 if num_actions < 8 else np.int16
    weights = 1 << np.arange(num_actions, dtype=dtype)
    sets = np.arange(2**num_actions)[:, None] & weights > 0
    members = np.argsort(~sets, axis=1, kind="stable").ravel().astype(np.int64)
    return weights, sets.sum(axis=1), members
