"""The Gymnasium environment of one level."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Unpack

import numpy as np
from gymnasium import Space, error
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    checked_action,
    checked_maze_seed,
    checked_observation,
    checked_options,
    start_states,
    takes_observation,
)
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.envs.observations.numbers import vector_names
from babyrobot_levels.envs.observations.planes import plane_names
from babyrobot_levels.envs.observations.views import view_planes
from babyrobot_levels.envs.rendering import RENDER_MODES, RenderedEnv, show_wrapped_environments
from babyrobot_levels.envs.spaces import ACTION_SETS, ActionSet, make_action_space
from babyrobot_levels.envs.specs import MadeSpec, as_spec
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Event, Outcome, ToldOutcome, events_of, hits_of
from babyrobot_levels.text.words import check_choice

LevelLike = str | os.PathLike[str] | Mapping[str, Any] | Level

StateOutcome = tuple[float, int, float, bool, bool, bool, bool]
"""Cumulated probability, next state, reward, terminal, target reached, skidded, hit."""

LookedUp = tuple[
    dict[int, tuple[StateOutcome, ...]],
    Callable[[], Any],
    Callable[[], NDArray[np.int8]],
    Any,
    Callable[[], Any],
]
"""What a step needs of a state.

Outcomes by action, makers of observation and mask, the mask, and a maker of what is held.
"""

_Part = tuple[NDArray[np.int8], NDArray[np.bool_], NDArray[np.bool_]]
"""Of the states with one configuration: events and hits of all outcomes, and what is held."""

MAX_MAZE_SEED = 2**31
"""The seeds that are drawn for mazes with `seed: random` are below this."""

_DERIVED = ("_mdp", "_parts", "_observer", "_starts", "_states", "_now", "_table")
"""The attributes that `_enter` sets, all of which follow from the level."""


class LevelEnv(RenderedEnv):
    """A robot moves through a level to an exit.

    Observations, by `observation`:

    - `"position"`: `[x, y]`, int64, in a `MultiDiscrete([width, height])`;
    - `"index"`: the state `y * width + x`, in a `Discrete`;
    - `"walls"`: `[x, y, north, east, south, west]`, int64, with 1 for each side that is open;
    - `"vector"`: what surrounds the robot, float32 `[entries]`, from 0 to 1;
    - `"planes"`: the whole level, float32 `[planes, height, width]`, from 0 to 1;
    - `"image"`: uint8 `[height, width, 3]`, or `[…, 1]` with `grayscale`;
    - `"view"`: what the robot sees around it, uint8 `[side, side, planes]`, zeros and ones;
    - a tuple of these names: a dict with each of them.

    If the level has things, `"position"` and `"walls"` go on with the value of each, and `"index"`
    is the state with its configuration.

    Actions are 0 stay, 1 north, 2 east, 3 south, 4 west; with `actions="moves"` or
    `"valid_moves"`, they are 0 north, 1 east, 2 south, 3 west. With `actions="turns"`, they are
    0 left, 1 right, 2 forward, and observations end with the heading, 0 north, 1 east, 2 south,
    3 west. `info["action_mask"]` (int8 `[actions]`) tells which ones are allowed; a wall refuses
    the others, and the robot stays. An episode is `terminated` at an exit, in a cell that ends it,
    or by a hit, and `truncated` only by the `TimeLimit` wrapper that a level's `max_steps` adds.

    Attributes:
        level: the level of the current episode. If the level has `seed: random`, it is one of its
            mazes.
    """

    __module__ = "babyrobot_levels"

    @takes_observation
    def __init__(
        self,
        level: LevelLike,
        *,
        actions: str = "valid",
        render_mode: str | None = None,
        **options: Unpack[ObservationOptions],
    ) -> None:
        """Make the environment of a level.

        Args:
            level: a name, a path, a mapping or a `Level`.
            actions: `"all"`: five actions; `"moves"`: four, without stay; `"valid"` and
                `"valid_moves"`: the same, but `action_space.sample()` gives only those that the
                action mask allows; `"turns"`: left, right, and forward.
            render_mode: None, `"human"`, `"rgb_array"`, `"ansi"`, `"svg"` or `"canvas"`; see
                `render`.
            options: the observation, and its options:

                - `observation`: one of those above, or a tuple of several; by default
                  `"position"`;
                - `image_size`: `(height, width)` in pixels of image observations;
                - `grayscale`: whether image observations are grey;
                - `view_radius`: how many cells views show in each direction, 1 to 15; by default
                  3;
                - `see_through`: whether views show what walls, doors and blocked cells hide;
                - `channels_last`: whether planes have the shape `[height, width, planes]` and not
                  `[planes, height, width]`;
                - `planes_dtype`: `"float32"`, for planes from 0 to 1, or `"uint8"`, from 0 to 255.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: another argument is invalid.
        """
        self._observation = checked_observation(**options)
        check_choice("actions", actions, ACTION_SETS)
        if render_mode is not None:
            check_choice("render_mode", render_mode, RENDER_MODES)
        self.render_mode = render_mode
        self._given = load(level)
        self._options: tuple[str, ...] = ("start",)
        if self._given.has_random_maze:
            self._options += ("maze_seed",)
        self._actions = self._action_set(actions).with_moves(self._given.moves)
        space = self._make_action_space()
        self.action_space = space
        # Those whose `sample()` knows what is allowed have a mask.
        self._valid: Any = space if hasattr(space, "mask") else None
        self._spec: EnvSpec | None = None
        self._state = -1
        self._num_items, self._has_movers = self._things()
        self._level_number: dict[str, int] = {}
        self._has_more = False
        # Until the first reset, a level with random mazes has the maze of seed 0.
        self._enter(self._given.with_maze_seed(0) if self._given.has_random_maze else self._given)
        self.observation_space = self._observer.space
        self._pictures = None if render_mode is None else self._new_pictures()
        show_wrapped_environments()

    def _action_set(self, actions: str) -> ActionSet:
        return ACTION_SETS[actions]

    def _make_action_space(self) -> Space[Any]:
        return make_action_space(self._actions, self._actions.num_actions)

    def _enter(self, level: Level) -> None:
        """Go over to a level."""
        # A level whose tables would be too large changes nothing.
        mdp = self._numbering(level)
        self.level, self._mdp = level, mdp
        self._parts: dict[int, _Part] = {}
        self._observer: Any = make_observer(level, self._observation, self._extent())
        self._starts: list[int] = mdp.starts.tolist()
        self._states = self._no_states()
        self._now: LookedUp | None = None
        self._table: dict[int, dict[int, list[Outcome]]] | None = None

    def _numbering(self, level: Level) -> Any:
        """Return what is played of a level: its tables."""
        return self._actions.tables(level)

    def _no_states(self) -> Any:
        """Return None for each state: what `_look_up` finds is put there."""
        return [None] * self._mdp.num_states

    def _extent(self) -> Extent:
        """Return the extent of all levels that episodes may have."""
        return Extent.of([self._given], turns=self._actions.turns)

    def _things(self) -> tuple[int, bool]:
        """Return the most items that levels of episodes have, and whether any have movers."""
        return len(self._given.items), bool(self._given.movers)

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
            The observation, and the info that `step` describes.

        Raises:
            ValueError: the robot cannot start in that cell, or there is no such option.
        """
        options = checked_options(options, *self._options)
        # All options are checked before anything changes: a refused reset leaves the current
        # episode as it is.
        start, is_grown = options.get("start"), self._given.has_random_maze
        starts: Sequence[int] | None = None
        # Where an episode can start depends on the maze only if there are things.
        if start is not None and not (is_grown and self._given.has_things):
            starts = start_states(start, self.level, self._mdp)
        maze_seed = checked_maze_seed(options.get("maze_seed"))
        super().reset(seed=seed)
        rng = self.np_random
        if is_grown:
            if maze_seed is None:
                maze_seed = int(rng.random() * MAX_MAZE_SEED)
            level = self._given.with_maze_seed(maze_seed)
            if start is not None and starts is None:
                starts = start_states(start, level, self._actions.tables(level))
            self._enter(level)
            self._level_number = {"maze_seed": maze_seed}
        starts = starts or self._starts
        self._state = starts[0 if len(starts) == 1 else int(rng.integers(len(starts)))]
        self._now = self._states[self._state] or self._look_up(self._state)
        _, observe, copy_mask, mask, copy_held = self._now
        if self._valid is not None:
            self._valid.mask = mask
        if self._pictures is not None:
            self._pictures.reset(self.level, *self._shown(self._state))
        info = {"action_mask": copy_mask(), "target_reached": False, "skidded": False}
        self._has_more = bool(self._num_items or self._has_movers or self._level_number)
        if self._num_items:
            info["held"] = copy_held()
        if self._has_movers:
            info["hit"] = False
        info.update(self._level_number)
        return observe(), info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take an action.

        Returns:
            Observation, reward, terminated, False (`TimeLimit` truncates), and an info with
            `action_mask` (int8 `[actions]`, a copy), `target_reached` (the robot is where the
            action leads without chance, and no wall refused it) and `skidded` (chance took it
            somewhere else), which are False at reset. If the level has `seed: random`, there is
            `maze_seed`; if it has items, `held` (bool `[items]`: which of them the robot holds, in
            the order of the level file); if it has movers, `hit` (whether one hit the robot).

        Raises:
            ResetNeeded: there was no reset yet.
            InvalidAction: the action is not in the action space.
        """
        now = self._now
        if now is None:
            raise error.ResetNeeded("call `reset()` before the first `step()`")
        try:
            outcomes = now[0][action]
        except (KeyError, TypeError):
            outcomes = now[0][checked_action(action, len(now[0]))]
        outcome = outcomes[0]
        if len(outcomes) > 1:
            draw = self._np_random.random()  # type: ignore[union-attr]
            for outcome in outcomes:
                if draw < outcome[0]:
                    break
        _, state, reward, terminal, target_reached, skidded, hit = outcome
        before, self._state = self._state, state
        self._now = self._states[state] or self._look_up(state)
        _, observe, copy_mask, mask, copy_held = self._now
        if self._valid is not None:
            self._valid.mask = mask
        if self._pictures is not None:
            self._show_step(self._pictures, int(action), before, skidded)
        info = {"action_mask": copy_mask(), "target_reached": target_reached, "skidded": skidded}
        if self._has_more:
            # Written out, because a call is a considerable part of a step.
            if self._num_items:
                info["held"] = copy_held()
            if self._has_movers:
                info["hit"] = hit
            if self._level_number:
                info.update(self._level_number)
        return observe(), reward, terminal, False, info

    def action_number(self, action: Any) -> int:
        """Return the number of an action in plays; see `numbered_action` for the inverse."""
        return int(action)

    def numbered_action(self, number: int) -> Any:
        """Return the action that `step` takes for a number."""
        return number

    def action_masks(self) -> NDArray[np.int8]:
        """Return the current action mask, int8 `[actions]`. The name is sb3-contrib's."""
        if self._now is None:
            raise error.ResetNeeded("call `reset()` before asking for the action mask")
        return self._now[2]()

    def _look_up(self, state: int) -> LookedUp:
        """Copy a state's rows out of the compiled tables, at the robot's first visit.

        For one step at a time, tuples are several times faster than arrays; in a large level, only
        the states that are visited cost time.
        """
        first, mdp = self._actions.first, self._mdp
        number, place = divmod(state, mdp.cells * mdp.headings)
        events, hits, held = self._parts.get(number) or self._look_up_part(number)
        mask = mdp.action_mask[state, first:]
        rows = zip(events[place, first:].tolist(), hits[place, first:].tolist(), strict=True)
        outcomes = {
            action: self._outcomes(state, action + first, *row) for action, row in enumerate(rows)
        }
        found = outcomes, self._observer.at(state), mask.copy, mask, held.copy
        self._states[state] = found
        return found

    def _look_up_part(self, number: int) -> _Part:
        """Compute what tells the outcomes in one configuration, at the robot's first visit."""
        mdp, level = self._mdp, self.level
        size = mdp.cells * mdp.headings
        states = slice(number * size, (number + 1) * size)
        part = events_of(mdp, states), hits_of(level, mdp, states), self._held(number)
        self._parts[number] = part
        return part

    def _held(self, number: int) -> NDArray[np.bool_]:
        """Return which items are held in a configuration."""
        level, held = self.level, np.zeros(self._num_items, np.bool_)
        if level.items:
            names = level.configuration(number).held
            held[: len(level.items)] = [name in names for name in self.item_names]
        return held

    def _outcomes(
        self, state: int, action: int, events: list[int], hits: list[bool]
    ) -> tuple[StateOutcome, ...]:
        told = zip(self._mdp.outcomes(state, action), events, hits, strict=False)
        return cumulated((*outcome, event, hit) for outcome, event, hit in told)

    # -- description -----------------------------------------------------------------------

    @property
    def view_planes(self) -> tuple[str, ...]:
        """The names of the planes of views."""
        return view_planes(self._extent())

    @property
    def plane_names(self) -> tuple[str, ...]:
        """The names of the planes of the observation `"planes"`."""
        return plane_names(self._extent())

    @property
    def vector_names(self) -> tuple[str, ...]:
        """The names of the entries of the observation `"vector"`."""
        return vector_names(self._extent())

    @property
    def P(self) -> dict[int, dict[int, list[Outcome]]]:  # noqa: N802  (Gymnasium's name for it)
        """The tables as `{state: {action: [(probability, next state, reward, terminal)]}}`."""
        if self._table is None:
            self._table = self._actions.tables(self.level).to_toy_text(self._actions.first)
        return self._table

    @property
    def action_set(self) -> str:
        """The set of actions by whose numbers they are taken: `"all"`, `"moves"` or `"turns"`."""
        return "turns" if self._actions.turns else "moves" if self._actions.first else "all"

    @property
    def largest_size(self) -> tuple[int, int]:
        """The width and the height of the largest level that an episode can have, in cells."""
        return self._extent().size

    @property
    def state(self) -> int:
        """The current state, as the tables of the level number it; -1 before the first reset."""
        return self._state

    @property
    def level_digest(self) -> str:
        """The digest of the current level, which equivalent levels share."""
        return self.level.digest

    @property
    def item_names(self) -> tuple[str, ...]:
        """The names of the items of the current level, in the order of `info["held"]`."""
        return tuple(item.name for item in self.level.items)

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
            spec = as_spec(MadeSpec, spec)
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
            self._now = self._look_up(self._state)


def cumulated(told: Iterable[ToldOutcome]) -> tuple[StateOutcome, ...]:
    """Return outcomes as steps draw them.

    Args:
        told: probability, next state, reward, terminal, `Event`, and hit of each.
    """
    outcomes: list[StateOutcome] = []
    total = 0.0
    for probability, next_state, reward, terminal, event, hit in told:
        total += probability
        is_reached, is_skid = event == Event.REACHED, event == Event.SKIDDED
        outcomes.append((total, next_state, reward, terminal, is_reached, is_skid, hit))
    # The last outcome takes the rounding error of the sum.
    outcomes[-1] = (2.0, *outcomes[-1][1:])
    return tuple(outcomes)
