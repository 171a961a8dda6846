"""One robot in one level: the Gymnasium environment."""

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
    checked_action,
    checked_image_size,
    checked_maze_seed,
    checked_options,
    checked_start,
)
from babyrobot_levels.envs.ipython import show_wrapped_environments
from babyrobot_levels.envs.observations import OBSERVATIONS, Observer, make_observer
from babyrobot_levels.envs.pictures import RENDER_MODES
from babyrobot_levels.envs.rendering import RenderedEnv
from babyrobot_levels.envs.spaces import ACTION_SETS, ValidActions, make_action_space
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.tables import GLASS, REFUSED

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
"""Mazes of `seed: random` levels have seeds below this."""


class LevelEnv(RenderedEnv):
    """A robot walks a level to an exit.

    Observations are, by `observation`:

    - `"position"`: `[x, y]`, int64, in a `MultiDiscrete([width, height])`;
    - `"index"`: the state `y * width + x`, in a `Discrete`;
    - `"walls"`: `[x, y, north, east, south, west]`, int64, the sides 1 where they are open;
    - `"image"`: uint8 `[height, width, 3]`, or `[…, 1]` with `grayscale`.

    Actions are 0 stay, 1 north, 2 east, 3 south, 4 west, or with `actions="moves"` 0 north, 1 east,
    2 south, 3 west. `info["action_mask"]` (int8 `[actions]`) says which are possible;
    one that is not is refused. An episode is `terminated` at an exit or a cell that ends it, and
    truncated only by the `TimeLimit` that a level's `max_steps` gives it.

    Attributes:
        level: the level that is played. Of a level with `seed: random`, the one of this episode.
    """

    def __init__(
        self,
        level: LevelLike,
        *,
        observation: str = "position",
        actions: str = "valid",
        render_mode: str | None = None,
        image_size: tuple[int, int] | None = None,
        grayscale: bool = False,
    ):
        """Make the environment of a level.

        Args:
            level: a name, a path, a mapping or a `Level`.
            observation: `"position"`, `"index"`, `"walls"` or `"image"`.
            actions: `"valid"`: five actions, of which `action_space.sample()` gives only those
                that are possible; `"all"`: five actions; `"moves"`: four, without stay.
            render_mode: None, `"human"`, `"rgb_array"`, `"ansi"`, `"svg"` or `"canvas"`; what
                each of them gives, `render` tells.
            image_size: `(height, width)` in pixels of image observations.
            grayscale: whether image observations are grey.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: another argument has a value that it cannot have.
        """
        check_choice("observation", observation, OBSERVATIONS)
        check_choice("actions", actions, ACTION_SETS)
        if render_mode is not None:
            check_choice("render_mode", render_mode, RENDER_MODES)
        if observation != "image" and (image_size is not None or grayscale):
            raise ValueError("image_size and grayscale go with observation='image'")
        self.render_mode = render_mode
        self._given = load(level)
        self._options = ("start", "maze_seed") if self._given.has_random_maze else ("start",)
        self._observation = observation
        self._image = (checked_image_size(image_size), bool(grayscale))
        space, self._first_action = make_action_space(actions)
        self.action_space = space
        self._valid = space if isinstance(space, ValidActions) else None
        self._spec: EnvSpec | None = None
        self._state = -1
        # Until the first reset, a level with random mazes shows the one of seed 0.
        self._enter(self._given.with_maze_seed(0) if self._given.has_random_maze else self._given)
        self.observation_space = self._observer.space
        self._pictures = None if render_mode is None else self._new_pictures()
        show_wrapped_environments()

    def _enter(self, level: Level) -> None:
        """Make ready to play a level."""
        self.level = level
        self._mdp: Mdp = level.compile()
        self._observer = self._new_observer(level)
        self._starts: list[int] = self._mdp.start.nonzero()[0].tolist()
        self._cells: list[_Cell | None] = [None] * self._mdp.num_states
        self._table: dict[int, dict[int, list[Outcome]]] | None = None

    def _new_observer(self, level: Level) -> Observer:
        """Return what shows the states of a level."""
        return make_observer(level, self._observation, *self._image)

    # -- playing ---------------------------------------------------------------------------

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: for the environment's own generator, from which everything is drawn.
            options: `{"start": [x, y]}` begins at that cell. Of a level with `seed: random`,
                `{"maze_seed": n}` asks for the maze of that seed.

        Returns:
            The observation, and an info with `action_mask` and `level_digest`, or in its place,
            for a level with `seed: random`, `maze_seed`.

        Raises:
            ValueError: the robot cannot start at that cell, or there is no such option.
        """
        options = checked_options(options, *self._options)
        # All that is asked for is checked before anything changes: a refused reset leaves the
        # running episode as it is.
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
            self._pictures.begin(self.level, self._state)
        info["action_mask"] = copy_mask()
        return observe(), info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take an action.

        Returns:
            Observation, reward, terminated, False (truncating is the TimeLimit's), and an info with
            `action_mask` (int8 `[actions]`, a copy), `target_reached` (the robot stands where the
            action leads when chance does not interfere, and was not refused) and `skidded`.

        Raises:
            ResetNeeded: no episode has begun.
            InvalidAction: the action space does not contain the action.
        """
        cell = self._cells[self._state]
        if cell is None:
            # Every state of a running episode was looked up when the robot came to it.
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
        """Return which actions are possible now, int8 `[actions]`, as sb3-contrib asks for it."""
        cell = self._cells[self._state] if self._state >= 0 else None
        if cell is None:
            raise error.ResetNeeded("call `reset()` before asking for the action mask")
        return cell[2]()

    def _look_up(self, state: int) -> _Cell:
        """Copy a state's rows out of the compiled tables, the first time that the robot is there.

        Lists are several times faster than arrays for one step at a time; a large level costs
        only for the cells that are visited.
        """
        mdp, first = self._mdp, self._first_action
        actions = range(first, NUM_ACTIONS)
        mask = mdp.possible[state, first:]
        cell = (
            {action - first: self._outcomes(state, action) for action in actions},
            self._observer.at(state),
            mask.copy,
            mask,
        )
        self._cells[state] = cell
        return cell

    def _outcomes(self, state: int, action: int) -> tuple[_Outcome, ...]:
        mdp = self._mdp
        target, hindered = int(mdp.target[state, action]), int(mdp.hindered[state, action])
        outcomes: list[_Outcome] = []
        total = 0.0
        for probability, next_state, reward, terminal in mdp.outcomes(state, action):
            total += probability
            at_target = next_state == target or (
                target == mdp.num_states and next_state in self._starts
            )
            reached = at_target and hindered != REFUSED
            skidded = not at_target and hindered != GLASS
            outcomes.append((total, next_state, reward, terminal, reached, skidded))
        # The last one takes what rounding leaves over.
        outcomes[-1] = (2.0, *outcomes[-1][1:])
        return tuple(outcomes)

    # -- what it is ------------------------------------------------------------------------

    @property
    def P(self) -> dict[int, dict[int, list[Outcome]]]:  # noqa: N802  (Gymnasium's name for it)
        """The tables as `{state: {action: [(probability, next state, reward, terminal)]}}`."""
        if self._table is None:
            self._table = self._mdp.to_toy_text(self._first_action)
        return self._table

    @property
    def initial_state_distrib(self) -> NDArray[np.float64]:
        """The probability of each state at reset, `[states]`, under toy_text's name for it."""
        return self._mdp.start.copy()

    @property
    def spec(self) -> EnvSpec | None:
        """The spec by which Gymnasium made the environment; it can be written as JSON."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None:
            self._spell_out(spec.kwargs)
        self._spec = spec

    def _spell_out(self, given: dict[str, Any]) -> None:
        """Put what is JSON into the place of arguments that are not, and say the same."""
        if not isinstance(given.get("level"), str | None):
            given["level"] = self._given.to_dict(whole=True)

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_cells": None, "_table": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._cells = [None] * self._mdp.num_states
        if self._state >= 0:
            self._look_up(self._state)


def make_level(level: LevelLike, **kwargs: Any) -> gymnasium.Env[Any, Any]:
    """Return a level's environment under the time limit that its `max_steps` gives it.

    The entry point of `babyrobot/Level-v0`: Gymnasium knows no limit before it has the level.
    """
    loaded = load(level)
    env = LevelEnv(loaded, **kwargs)
    return env if loaded.max_steps is None else TimeLimit(env, loaded.max_steps)


make_level.metadata = LevelEnv.metadata  # type: ignore[attr-defined]
