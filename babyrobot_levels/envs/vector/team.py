"""The Gymnasium vector environment of a level with several robots, and the choice of one."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Unpack

import numpy as np
from gymnasium import error, spaces
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    check_names,
    checked_given,
    takes_observation,
)
from babyrobot_levels.envs.engine.state import Results
from babyrobot_levels.envs.engine.tables import Flags, Floats, Ints, Tables, part_of, robot_masks
from babyrobot_levels.envs.single import LevelLike
from babyrobot_levels.envs.spaces import ActionSet, BatchTeamActions
from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action


class TeamVectorEnv(LevelVectorEnv):
    """Many environments of a level with several robots that step in one call.

    Each is equivalent to a `TeamEnv` in the `TimeLimit` of the level. Actions are integers
    `[num_envs, robots]`; in infos, `action_mask` is int8 `[num_envs, robots, 5]`, and `rewards`,
    float64 `[num_envs, robots]`, has what each robot gets.

    Attributes:
        robot_names: the names of the robots.
    """

    __module__ = "babyrobot_levels"

    action_space: Any

    @takes_observation
    def __init__(
        self,
        level: LevelLike,
        *,
        num_envs: int = 1,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        engine: str | None = None,
        **options: Unpack[ObservationOptions],
    ) -> None:
        """Make the environment.

        Args:
            level: a name, a path, a mapping or a `Level`.
            num_envs: how many environments there are.
            render_mode: None or `"rgb_array"`.
            max_episode_steps: as for `LevelVectorEnv`.
            autoreset_mode: as for `LevelVectorEnv`.
            copy: as for `LevelVectorEnv`.
            engine: as for `LevelVectorEnv`.
            options: the observation, and its options, as for `LevelEnv`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ImportError: an engine is required whose library is not installed.
            ValueError: another argument is invalid, the level has one robot, or another maze in
                each episode.
        """
        given = load(level)
        if not given.robots:
            raise ValueError("the level has one robot: use `brl.LevelVectorEnv`")
        if given.has_random_maze:
            raise ValueError(
                "each episode has another maze, and a vector environment of several robots has one:"
                " give it a seed, or use vectorization_mode='sync'"
            )
        self.robot_names = tuple(robot.name for robot in given.robots)
        super().__init__(
            given,
            num_envs=num_envs,
            render_mode=render_mode,
            max_episode_steps=max_episode_steps,
            autoreset_mode=autoreset_mode,
            copy=copy,
            engine=engine,
            **options,
        )
        self.single_action_space: Any = spaces.MultiDiscrete([NUM_ACTIONS] * len(given.robots))
        self.action_space = BatchTeamActions(len(given.robots), self._envs)
        self.action_space.state_info = self._tables.state_info

    def _action_set(self, actions: str) -> ActionSet:
        return ActionSet(Action.STAY, True, team=True)

    def _use(self, tables: Tables) -> None:
        """Go over to tables, whose rewards become the numbers of outcomes for the engine."""
        super()._use(replace(tables, reward=np.arange(tables.reward.size, dtype=np.float64)))
        self._reward, self._shares = tables.reward, self._shares_of_outcomes()

    def _shares_of_outcomes(self) -> Floats:
        """Return what each robot gets by the numbers of outcomes, float64 `[outcomes, robots]`."""
        (level,) = self.levels
        mdp = self._actions.tables(level)
        assert mdp.shares is not None
        shares = mdp.shares.reshape(-1, *mdp.shares.shape[2:])
        part = part_of(level, mdp, self._actions.first)
        idle = np.zeros((1, mdp.num_robots))
        return np.concatenate([shares[:, 0], idle, shares[part.is_stochastic]])

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start episodes; see `LevelVectorEnv.reset`. The option `start` is not there."""
        if options and "start" in options:
            raise ValueError("the robots of a team begin where the level says: no option `start`")
        self._told = np.zeros((self.num_envs, len(self.robot_names)))
        return super().reset(seed=seed, options=options)

    def step(self, actions: Any) -> tuple[Any, Floats, Flags, Flags, dict[str, Any]]:
        """Take an action of each robot in each environment.

        Args:
            actions: integers `[num_envs, robots]`.

        Returns:
            What `LevelVectorEnv.step` returns, with masks and rewards of each robot.

        Raises:
            ResetNeeded: there was no reset yet, or an episode is over and there is no autoreset.
            InvalidAction: the actions are not in the action space.
        """
        observations, rewards, terminated, truncated, info = super().step(self._joint(actions))
        info["action_mask"] = robot_masks(info["action_mask"], len(self.robot_names))
        info["rewards"], info["_rewards"] = self._told, info["_action_mask"]
        return observations, rewards, terminated, truncated, info

    def _act(self, actions: Ints) -> bool:
        if not super()._act(actions):
            return False
        numbers = self._results.rewards.astype(np.intp)
        self._results.rewards[:] = self._reward.take(numbers)
        self._told = self._shares.take(numbers, axis=0)
        return True

    def _joint(self, actions: Any) -> Ints:
        """Return the numbers of joint actions, intp `[num_envs]`."""
        shape = self.num_envs, len(self.robot_names)
        given = np.asarray(actions)
        is_whole = given.dtype.kind in "iu" and given.shape == shape
        if not is_whole or ((given < 0) | (given >= NUM_ACTIONS)).any():
            raise error.InvalidAction(
                f"actions must be whole numbers, 0 to {NUM_ACTIONS - 1}, in an array {[*shape]}: "
                "one for each robot of each environment"
            )
        powers = NUM_ACTIONS ** np.arange(shape[1] - 1, -1, -1, dtype=np.intp)
        return given.astype(np.intp) @ powers

    def _observe_start(self, results: Results, which: Ints) -> None:
        super()._observe_start(results, which)
        self._told[which] = 0.0

    def _infos(self, results: Results, where: Flags) -> dict[str, Any]:
        info = super()._infos(results, where)
        info["action_mask"] = robot_masks(info["action_mask"], len(self.robot_names))
        info["rewards"], info["_rewards"] = self._told * where[:, None], where
        return info

    def action_masks(self) -> NDArray[np.int8]:
        """Return the masks of all robots, one after the other, int8 `[num_envs, 5 * robots]`."""
        return robot_masks(super().action_masks(), len(self.robot_names)).reshape(self.num_envs, -1)

    def set_levels(self, levels: Any, which: Any = None) -> None:
        """Refuse other levels, whose robots could be others.

        Raises:
            ValueError: always.
        """
        raise ValueError("set_levels is for levels with one robot")


def make_vector(level: LevelLike | None = None, **kwargs: Any) -> LevelVectorEnv:
    """Return a vector environment: the vector entry point of `babyrobot/Level-v0` and all levels.

    Args:
        level: a name, a path, a mapping or a `Level`.
        kwargs: the other arguments of `LevelVectorEnv`, or of `TeamVectorEnv` for several robots.

    Raises:
        MissingArgument: there is neither `level` nor `levels`.
        TypeError: there is no such argument.
    """
    check_names(kwargs, LevelVectorEnv.__init__, "level")
    if kwargs.get("levels") is None:
        given = load(checked_given("level", level))
        if given.robots:
            check_names(kwargs, TeamVectorEnv.__init__, "level")
            return TeamVectorEnv(given, **kwargs)
        level = given
    return LevelVectorEnv(level, **kwargs)
