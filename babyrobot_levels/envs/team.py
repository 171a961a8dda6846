"""The Gymnasium environment of a level with several robots, which one agent moves all at once."""

from __future__ import annotations

from typing import Any, Unpack

import numpy as np
from gymnasium import error, spaces
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import ObservationOptions, takes_observation, whole_number
from babyrobot_levels.envs.single import LevelEnv, LevelLike, LookedUp, StateOutcome, cumulated
from babyrobot_levels.envs.spaces import ActionSet
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.mdp.compiler.robots import Robots
from babyrobot_levels.mdp.tables import Mdp

MOST_KEPT = 20_000
"""Of how many states outcomes are kept, where there are no tables."""


class TeamActions(spaces.MultiDiscrete):
    """A `MultiDiscrete`, one action for each robot, whose `sample()` respects the action masks.

    It equals the plain `MultiDiscrete` of its size, and contains the same actions.
    """

    mask: NDArray[np.int8] | None = None
    """The mask of the current joint actions, int8; None before the first reset."""

    def sample(self, mask: Any = None, probability: Any = None) -> NDArray[Any]:
        """Return an allowed action of each robot, each with equal probability.

        A `mask`, a tuple with one `[5]` for each robot, or a `probability` takes the place of the
        current masks.
        """
        if mask is not None or probability is not None or self.mask is None:
            return super().sample(mask, probability)
        allowed = self.mask.nonzero()[0]
        which = allowed[self.np_random.integers(allowed.size)]
        return np.array(np.unravel_index(which, self.nvec), np.int64)


class _Visited(dict[int, Any]):
    """What was found of states that were visited; None of others."""

    def __missing__(self, state: int) -> None:
        return None


class _Outcomes(dict[int, tuple[StateOutcome, ...]]):
    """The outcomes of joint actions in a state, each computed when it is first taken.

    Attributes:
        shares: what each robot gets, `[outcomes, robots]` of each action.
    """

    def __init__(self, robots: Robots, state: int) -> None:
        self._robots, self._state = robots, state
        self.shares: dict[int, NDArray[np.float64]] = {}

    def __missing__(self, action: int) -> tuple[StateOutcome, ...]:
        told, self.shares[action] = self._robots.outcomes(self._state, action)
        found = self[action] = cumulated(told)
        return found


class TeamEnv(LevelEnv):
    """Several robots move through a level at once, and one agent chooses the actions of all.

    An action is one of each robot, 0 stay, 1 north, 2 east, 3 south, 4 west, in a `MultiDiscrete`.
    The reward is the sum of what each robot gets; `info["rewards"]` (float64 `[robots]`) is its
    parts, and `info["action_mask"]` a tuple with a mask for each robot, int8 `[5]`: one that has
    arrived can only stay. The observation `"position"`, the default, is x and y of each robot, then
    for each 1 if it has arrived, then the value of each other thing; the others are those of
    `LevelEnv`, seen by the first robot, and show where the others are. Episodes end as the level's
    `team` says.

    Where there are too many joint states for tables, each one is computed when it is visited, and
    states are numbered by what they are: there are no `P` and no digest.

    Attributes:
        robot_names: the names of the robots.
    """

    __module__ = "babyrobot_levels"

    @takes_observation
    def __init__(
        self,
        level: LevelLike,
        *,
        render_mode: str | None = None,
        **options: Unpack[ObservationOptions],
    ) -> None:
        """Make the environment of a level with several robots.

        Args:
            level: a name, a path, a mapping or a `Level`.
            render_mode: as for `LevelEnv`.
            options: the observation, and its options, as for `LevelEnv`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: another argument is invalid, or the level has one robot.
        """
        given = load(level)
        if not given.robots:
            raise ValueError("the level has one robot: use `brl.LevelEnv`")
        self.robot_names = tuple(robot.name for robot in given.robots)
        super().__init__(given, render_mode=render_mode, **options)
        self._options = tuple(name for name in self._options if name != "start")

    def _action_set(self, actions: str) -> ActionSet:
        return ActionSet(Action.STAY, True, team=True)

    def _make_action_space(self) -> spaces.Space[Any]:
        return TeamActions([NUM_ACTIONS] * len(self._given.robots))

    def _numbering(self, level: Level) -> Any:
        return level.numbering()

    def _no_states(self) -> Any:
        return super()._no_states() if isinstance(self._mdp, Mdp) else _Visited()

    def _enter(self, level: Level) -> None:
        super()._enter(level)
        self._masks: dict[int, list[NDArray[np.int8]]] = {}
        self._is_over = False

    def _look_up(self, state: int) -> LookedUp:
        """Return what a step needs of a state; without tables, it is computed."""
        robots = self._mdp
        if isinstance(robots, Mdp):
            return super()._look_up(state)
        if len(self._states) >= MOST_KEPT:
            self._states.clear()
            self._masks.clear()
        outcomes, mask = _Outcomes(robots, state), robots.mask(state)
        held = self._held(robots.configuration(state))
        found = outcomes, self._observer.at(state), mask.copy, mask, held.copy
        self._states[state] = found
        return found

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode; see `LevelEnv.reset`. The option `start` is not there."""
        if options and "start" in options:
            raise ValueError("the robots of a team begin where the level says: no option `start`")
        self._is_over = False
        observation, info = super().reset(seed=seed, options=options)
        return observation, self._told(info, np.zeros(len(self.robot_names)))

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take an action of each robot.

        Args:
            action: integers `[robots]`.

        Returns:
            What `LevelEnv.step` returns, and in the info `rewards`.

        Raises:
            ResetNeeded: there was no reset yet.
            InvalidAction: the action is not in the action space.
        """
        if self._now is None:
            raise error.ResetNeeded("call `reset()` before the first `step()`")
        joint = self.action_number(action)
        before, outcomes = self._state, self._now[0]
        row = outcomes[joint]
        draw = 0.0 if len(row) == 1 else float(self.np_random.random())
        number = next(number for number, outcome in enumerate(row) if draw < outcome[0])
        _, self._state, reward, terminal, target_reached, skidded, hit = row[number]
        if isinstance(outcomes, _Outcomes):
            shares, self._is_over = outcomes.shares[joint], terminal
        else:
            assert self._mdp.shares is not None
            shares = self._mdp.shares[before, joint]
        rewards = shares[number].copy()
        self._now = self._states[self._state] or self._look_up(self._state)
        _, observe, _, mask, copy_held = self._now
        self._valid.mask = mask
        if self._pictures is not None:
            own = joint // NUM_ACTIONS ** (len(self.robot_names) - 1)
            self._show_step(self._pictures, own, before, skidded)
        info: dict[str, Any] = {"target_reached": target_reached, "skidded": skidded}
        if self._num_items:
            info["held"] = copy_held()
        if self._has_movers:
            info["hit"] = hit
        info.update(self._level_number)
        return observe(), reward, terminal, False, self._told(info, rewards)

    @property
    def initial_state_distrib(self) -> NDArray[np.float64]:
        """The probability of each state at reset, float64 `[states]`; the name is toy_text's."""
        return self.level.compile().start.copy()

    def action_number(self, action: Any) -> int:
        """Return the number of a joint action, as `Mdp.joint_action` does.

        Raises:
            InvalidAction: it is none.
        """
        parts = action.tolist() if isinstance(action, np.ndarray) else action
        joint = 0
        if isinstance(parts, list | tuple) and len(parts) == len(self.robot_names):
            for part in parts:
                number = whole_number(part)
                if number is None or isinstance(part, bool) or not 0 <= number < NUM_ACTIONS:
                    break
                joint = joint * NUM_ACTIONS + number
            else:
                return joint
        raise error.InvalidAction(
            f"{action!r} is not an action: it is one of 0 to {NUM_ACTIONS - 1} for each of "
            f"the {len(self.robot_names)} robots"
        )

    def numbered_action(self, number: int) -> tuple[int, ...]:
        """Return the action of each robot for the number of their joint action."""
        actions: list[int] = self._mdp.robot_actions(number).tolist()
        return tuple(actions)

    def _told(self, info: dict[str, Any], rewards: NDArray[np.float64]) -> dict[str, Any]:
        """Return an info as one of several robots."""
        info["action_mask"] = self.robot_masks()
        info["rewards"] = rewards
        return info

    def robot_masks(self) -> tuple[NDArray[np.int8], ...]:
        """Return the current action mask of each robot, int8 `[5]`."""
        if self._now is None:
            raise error.ResetNeeded("call `reset()` before asking for the action mask")
        if self._is_over:
            return tuple(np.eye(1, NUM_ACTIONS, dtype=np.int8)[0] for _ in self.robot_names)
        masks = self._masks.get(self._state)
        if masks is None:
            joint = self._now[3].reshape([NUM_ACTIONS] * len(self.robot_names))
            axes = range(joint.ndim)
            masks = self._masks[self._state] = [
                joint.max(axis=tuple(other for other in axes if other != axis)) for axis in axes
            ]
        return tuple(mask.copy() for mask in masks)

    def action_masks(self) -> NDArray[np.int8]:
        """Return the masks one after the other, int8 `[5 * robots]`. The name is sb3-contrib's."""
        return np.concatenate(self.robot_masks())
