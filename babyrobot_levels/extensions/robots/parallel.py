"""A level with several robots as PettingZoo's `ParallelEnv`: one agent for each robot."""

from __future__ import annotations

from typing import Any, ClassVar, NoReturn, Unpack

from gymnasium import error, spaces
from pettingzoo import ParallelEnv

from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    checked_observation,
    takes_observation,
)
from babyrobot_levels.envs.observations import space_of
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.single import LevelEnv, LevelLike
from babyrobot_levels.envs.team import TeamEnv
from babyrobot_levels.extensions.robots.seeing import Sights
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.text.words import check_choice, listed

REWARDS = ("own", "team")
"""What the reward of an agent is: what its robot gets, or the sum of what all get."""


class _ByAgent(dict[str, spaces.Space[Any]]):
    """A mapping by agents that tells which there are."""

    def __missing__(self, name: object) -> NoReturn:
        raise KeyError(f"there is no agent {name!r}, but {listed([*self])}")


class LevelParallelEnv(ParallelEnv[str, Any, Any]):  # type: ignore[misc]
    """Several robots move through a level at once, each with an agent of its own.

    Agents have the names of the robots. An action is 0 stay, 1 north, 2 east, 3 south or 4 west.
    The observation `"position"`, the default, is int64: x and y of the agent's own robot, then of
    the others in their order; in the same order 1 for each that has arrived; and the value of each
    other thing. The others are those of `LevelEnv`, seen by the agent's own robot. `infos` has
    `action_mask`, int8 `[5]`. An agent terminates when its robot arrives, or the episode ends;
    those that are left go on. It is truncated after `max_steps` of the level.

    Attributes:
        level: the level.
        possible_agents: the names of all robots.
        agents: the names of those whose episode goes on.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "babyrobot_levels_v0",
        "render_modes": LevelEnv.metadata["render_modes"],
        "is_parallelizable": True,
        "render_fps": 4,
    }

    @takes_observation
    def __init__(
        self,
        level: LevelLike,
        *,
        rewards: str = "own",
        max_cycles: int | None = None,
        render_mode: str | None = None,
        **options: Unpack[ObservationOptions],
    ) -> None:
        """Make the environment of a level with several robots.

        Args:
            level: a name, a path, a mapping or a `Level`.
            rewards: what an agent gets: `"own"`, what its robot gets, or `"team"`, the sum of all.
            max_cycles: the time limit in steps; by default `max_steps` of the level, if it has one.
            render_mode: as for `LevelEnv`.
            options: the observation, and its options, as for `LevelEnv`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: another argument is invalid, or the level has one robot.
        """
        check_choice("rewards", rewards, REWARDS)
        if max_cycles is not None:
            max_cycles = check_count("max_cycles", max_cycles)
        given = load(level)
        self._env = TeamEnv(given, render_mode=render_mode, observation="index")
        self._chosen = checked_observation(**options)
        self._is_grown = given.has_random_maze
        self._for_team = rewards == "team"
        self._limit = given.max_steps if max_cycles is None else max_cycles
        self._steps = 0
        self.render_mode = render_mode
        self.possible_agents = list(self._env.robot_names)
        self.agents: list[str] = []
        # Robots share the size of the grid, so that the space is the same for all.
        extent = Extent.of([given])
        names = self.possible_agents
        self.observation_spaces = _ByAgent({each: space_of(extent, self._chosen) for each in names})
        self._sights = Sights(self._env, self._chosen)
        self.action_spaces = _ByAgent({each: spaces.Discrete(NUM_ACTIONS) for each in names})

    @property
    def level(self) -> Level:
        """The level of the current episode."""
        return self._env.level

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of an agent's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of an agent's actions."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Start an episode.

        Args:
            seed: seeds the environment's own generator, the only source of randomness.
            options: `{"maze_seed": n}` for a level with `seed: random`; others are ignored.

        Returns:
            Observations and infos by agent.
        """
        # Programs may give options that are meant for others.
        known = {"maze_seed"} if self._is_grown else set()
        own = {name: value for name, value in (options or {}).items() if name in known}
        _, info = self._env.reset(seed=seed, options=own)
        self.agents, self._steps = self.possible_agents.copy(), 0
        return self._observations(), self._infos(info)

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, Any],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Take an action of each agent whose episode goes on.

        Returns:
            Observations, rewards, terminations, truncations and infos by agent.

        Raises:
            InvalidAction: the action of one of them is missing, or is none.
        """
        if not self.agents and not self._steps:
            raise error.ResetNeeded("call `reset()` before the first `step()`")
        if not self.agents:
            return {}, {}, {}, {}, {}
        if not isinstance(actions, dict):
            raise error.InvalidAction(f"actions are a dict of {self.agents}, not {actions!r}")
        if missing := [name for name in self.agents if name not in actions]:
            raise error.InvalidAction(f"there is no action for {', '.join(missing)}")
        joint = [
            actions[name] if name in self.agents else int(Action.STAY)
            for name in self.possible_agents
        ]
        _, reward, over, _, info = self._env.step(joint)
        self._steps += 1
        acting = self.agents
        arrived = dict(zip(self.possible_agents, self._sights.arrived(), strict=True))
        late = self._limit is not None and self._steps >= self._limit
        shares = dict(zip(self.possible_agents, info["rewards"].tolist(), strict=True))
        rewards = {name: float(reward) if self._for_team else shares[name] for name in acting}
        terminations = {name: over or arrived[name] for name in acting}
        truncations = {name: late and not terminations[name] for name in acting}
        observations, infos = self._observations(), self._infos(info)
        self.agents = [name for name in acting if not (terminations[name] or truncations[name])]
        return observations, rewards, terminations, truncations, infos

    def state(self) -> Any:
        """Return what the whole team sees: the observation of the first robot.

        Raises:
            ResetNeeded: there was no reset yet.
        """
        if self._env.state < 0:
            raise error.ResetNeeded("call `reset()` before asking for the state")
        return self._sights.of(0)

    def render(self) -> Any:
        """Return a picture, as `render_mode` says."""
        return self._env.render()

    def close(self) -> None:
        """Close the environment."""
        self._env.close()

    def _observations(self) -> dict[str, Any]:
        names = enumerate(self.possible_agents)
        return {name: self._sights.of(number) for number, name in names if name in self.agents}

    def _infos(self, info: dict[str, Any]) -> dict[str, dict[str, Any]]:
        masks = zip(self.possible_agents, info["action_mask"], strict=True)
        return {name: {"action_mask": mask} for name, mask in masks if name in self.agents}
