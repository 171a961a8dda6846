"""The Gymnasium environment of one level."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium import error
from gymnasium.wrappers import TimeLimit
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import (
    check_choice,
    check_names,
    checked_action,
    checked_maze_seed,
    checked_observation,
    checked_options,
    checked_start,
)
from babyrobot_levels.envs.observations import Extent, Observer, make_observer
from babyrobot_levels.envs.rendering import (
    RENDER_MODES,
    RenderedEnv,
    show_wrapped_environments,
)
from babyrobot_levels.envs.spaces import ACTION_SETS, ValidActions, make_action_space
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.events import Event, events_of

if TYPE_CHECKING:
    from gymnasium.envs.registration import EnvSpec

    from babyrobot_levels.mdp.tables import Mdp, Outcome

LevelLike = str | os.PathLike[str] | Mapping[str, Any] | Level

_Outcome = tuple[float, int, float, bool, bool, bool]
"""Cumulated probability, next state, reward, terminal, target reached, skidded."""

_Cell = tuple[
    dict[int, tuple[_Outcome, ...]], Callable[[], Any], Callable[[], NDArray[np.int8]], Any
]
"""What a step needs of a state: outcomes by action, makers of observation and mask, the mask."""

MAX_MAZE_SEED = 2**31
"""The seeds that are drawn for mazes with `seed: random` are below this."""

_DERIVED = ("_mdp", "_events", "_observer", "_starts", "_cells", "_table")
"""The attributes that `_enter` sets, all of which follow from the level."""


class LevelEnv(RenderedEnv):
    """A robot moves through a level to an exit.

    Observations, by `observation`:

    - `"position"`: `[x, y]`, int64, in a `MultiDiscrete([width, height])`;
    - `"index"`: the state `y * width + x`, in a `Discrete`;
    - `"walls"`: `[x, y, north, east, south, west]`, int64, with 1 for each side that is open;
    - `"image"`: uint8 `[height, width, 3]`, or `[…, 1]` with `grayscale`.

    Actions are 0 stay, 1 north, 2 east, 3 south, 4 west; with `actions="moves"` or
    `"valid_moves"`, they are 0 north, 1 east, 2 south, 3 west. `info["action_mask"]` (int8
    `[actions]`) tells which ones are allowed; a wall refuses the others, and the robot stays. An
    episode is `terminated` at an exit or in a cell that ends it, and `truncated` only by the
    `TimeLimit` wrapper that a level's `max_steps` adds.

    Attributes:
        level: the level of the current episode. If the level has `seed: random`, it is one of its
            mazes.
    """

    __module__ = "babyrobot_levels"

    def __init__(
        self,
        level: LevelLike,
        *,
        observation: str = "position",
        actions: str = "valid",
        render_mode: str | None = None,
        image_size: tuple[int, int] | None = None,
        grayscale: bool = False,
        view_radius: int | None = None,
        see_through: bool = False,
    ):
        """Make the environment of a level.

        Args:
            level: a name, a path, a mapping or a `Level`.
            observation: `"position"`, `"index"`, `"walls"` or `"image"`.
            actions: `"all"`: five actions; `"moves"`: four, without stay; `"valid"` and
                `"valid_moves"`: the same, but `action_space.sample()` gives only those that the
                action mask allows.
            render_mode: None, `"human"`, `"rgb_array"`, `"ansi"`, `"svg"` or `"canvas"`; see
                `render`.
            image_size: `(height, width)` in pixels of image observations.
            grayscale: whether image observations are grey.
            view_radius: how many cells views show in each direction, 1 to 15; by default 3.
            see_through: whether views show what walls, doors and blocked cells hide.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: another argument is invalid.
        """
        self._observation = checked_observation(
            observation, image_size, grayscale, view_radius, see_through
        )
        check_choice("actions", actions, ACTION_SETS)
        if render_mode is not None:
            check_choice("render_mode", render_mode, RENDER_MODES)
        self.render_mode = render_mode
        self._given = load(level)
        self._options = ("start", "maze_seed") if self._given.has_random_maze else ("start",)
        space, self._first_action = make_action_space(actions)
        self.action_space = space
        self._valid = space if isinstance(space, ValidActions) else None
        self._spec: EnvSpec | None = None
        self._state = -1
        # Until the first reset, a level with random mazes has the maze of seed 0.
        self._enter(self._given.with_maze_seed(0) if self._given.has_random_maze else self._given)
        self.observation_space = self._observer.space
        self._pictures = None if render_mode is None else self._new_pictures()
        show_wrapped_environments()

    def _enter(self, level: Level) -> None:
        """Switch to a level."""
        self.level = level
        self._mdp: Mdp = level.compile()
        self._events = events_of(self._mdp)
        self._observer = self._new_observer(level)
        self._starts: list[int] = self._mdp.start.nonzero()[0].tolist()
        self._cells: list[_Cell | None] = [None] * self._mdp.num_states
        self._table: dict[int, dict[int, list[Outcome]]] | None = None

    def _new_observer(self, level: Level) -> Observer:
        """Return the observer of a level."""
        return make_observer(level, self._observation, Extent.of([self._given]))

    # -- episodes --------------------------------------------------------------------------

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode.

        Args:
            seed: seeds the environment's own generator, the only source of randomness.
            options: `{"start": [x, y]}` starts in that cell. If the level has `seed: random`,
                `{"maze_seed": n}` selects the maze of that seed.

        Returns:
            The observation, and an info with `action_mask` and `level_digest`. If the level has
            `seed: random`, `maze_seed` takes the place of the latter.

        Raises:
            ValueError: the robot cannot start in that cell, or there is no such option.
        """
        options = checked_options(options, *self._options)
        # All options are checked before anything changes: a refused reset leaves the current
        # episode as it is.
        start = checked_start(options.get("start"), self.level)
        maze_seed = checked_maze_seed(options.get("maze_seed"))
        super().reset(seed=seed)
        rng = self.np_random
        info: dict[str, Any] = {}
        if self._given.has_random_maze:
            if maze_seed is None:
                maze_seed = int(rng.random() * MAX_MAZE_SEED)
            self._enter(self._given.with_maze_seed(maze_seed))
            info["maze_seed"] = maze_seed
        else:
            info["level_digest"] = self.level.digest
        if start is not None:
            self._state = start
        elif len(self._starts) == 1:
            self._state = self._starts[0]
        else:
            self._state = self._starts[int(rng.integers(len(self._starts)))]
        _, observe, copy_mask, mask = self._cells[self._state] or self._look_up(self._state)
        if self._valid is not None:
            self._valid.mask = mask
        if self._pictures is not None:
            self._pictures.reset(self.level, self._state)
        info["action_mask"] = copy_mask()
        return observe(), info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take an action.

        Returns:
            Observation, reward, terminated, False (`TimeLimit` truncates), and an info with
            `action_mask` (int8 `[actions]`, a copy), `target_reached` (the robot is where the
            action leads without chance, and no wall refused it) and `skidded` (chance took it
            somewhere else).

        Raises:
            ResetNeeded: there was no reset yet.
            InvalidAction: the action is not in the action space.
        """
        cell = self._cells[self._state]
        if cell is None:
            # During an episode, the current state was looked up when the robot came to it.
            raise error.ResetNeeded("call `reset()` before the first `step()`")
        try:
            outcomes = cell[0][action]
        except (KeyError, TypeError):
            outcomes = cell[0][checked_action(action, len(cell[0]))]
        outcome = outcomes[0]
        if len(outcomes) > 1:
            draw = self._np_random.random()  # type: ignore[union-attr]
            for outcome in outcomes:
                if draw < outcome[0]:
                    break
        _, state, reward, terminal, target_reached, skidded = outcome
        self._state = state
        _, observe, copy_mask, mask = self._cells[state] or self._look_up(state)
        if self._valid is not None:
            self._valid.mask = mask
        if self._pictures is not None:
            self._pictures.step(int(action) + self._first_action, state, skidded)
        return (
            observe(),
            reward,
            terminal,
            False,
            {"action_mask": copy_mask(), "target_reached": target_reached, "skidded": skidded},
        )

    def action_masks(self) -> NDArray[np.int8]:
        """Return the current action mask, int8 `[actions]`. The name is sb3-contrib's."""
        cell = self._cells[self._state] if self._state >= 0 else None
        if cell is None:
            raise error.ResetNeeded("call `reset()` before asking for the action mask")
        return cell[2]()

    def _look_up(self, state: int) -> _Cell:
        """Copy a state's rows out of the compiled tables, at the robot's first visit.

        For one step at a time, tuples are several times faster than arrays; in a large level, only
        the cells that are visited cost time.
        """
        first = self._first_action
        mask = self._mdp.action_mask[state, first:]
        events = self._events[state, first:].tolist()
        outcomes = {
            number: self._outcomes(state, number + first, row) for number, row in enumerate(events)
        }
        cell = (
            outcomes,
            self._observer.at(state),
            mask.copy,
            mask,
        )
        self._cells[state] = cell
        return cell

    def _outcomes(self, state: int, action: int, events: list[int]) -> tuple[_Outcome, ...]:
        outcomes: list[_Outcome] = []
        total = 0.0
        for outcome, event in zip(self._mdp.outcomes(state, action), events, strict=False):
            probability, next_state, reward, terminal = outcome
            total += probability
            is_reached, is_skid = event == Event.REACHED, event == Event.SKIDDED
            outcomes.append((total, next_state, reward, terminal, is_reached, is_skid))
        # The last outcome takes the rounding error of the sum.
        outcomes[-1] = (2.0, *outcomes[-1][1:])
        return tuple(outcomes)

    # -- description -----------------------------------------------------------------------

    @property
    def P(self) -> dict[int, dict[int, list[Outcome]]]:  # noqa: N802  (Gymnasium's name for it)
        """The tables as `{state: {action: [(probability, next state, reward, terminal)]}}`."""
        if self._table is None:
            self._table = self._mdp.to_toy_text(self._first_action)
        return self._table

    @property
    def initial_state_distrib(self) -> NDArray[np.float64]:
        """The probability of each state at reset, float64 `[states]`; the name is toy_text's."""
        return self._mdp.start.copy()

    @property
    def spec(self) -> EnvSpec | None:
        """The spec from which Gymnasium made the environment; it can be written as JSON."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None:
            self._make_serializable(spec.kwargs)
        self._spec = spec

    def _make_serializable(self, given: dict[str, Any]) -> None:
        """Replace arguments that JSON does not have by equivalent ones that it has."""
        if not isinstance(given.get("level"), str | None):
            given["level"] = self._given.to_dict(whole=True)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in _DERIVED}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._enter(self.level)
        if self._state >= 0:
            self._look_up(self._state)


def make_level(level: LevelLike, **kwargs: Any) -> gymnasium.Env[Any, Any]:
    """Return a level's environment, in a `TimeLimit` if the level has `max_steps`.

    The entry point of `babyrobot/Level-v0`, whose spec cannot have the limit of the level.

    Args:
        level: a name, a path, a mapping or a `Level`.
        kwargs: the other arguments of `LevelEnv`.

    Raises:
        TypeError: there is no such argument.
    """
    check_names(kwargs, LevelEnv.__init__, "max_episode_steps")
    loaded = load(level)
    env = LevelEnv(loaded, **kwargs)
    return env if loaded.max_steps is None else TimeLimit(env, loaded.max_steps)


make_level.metadata = LevelEnv.metadata  # type: ignore[attr-defined]
