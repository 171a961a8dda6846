"""The environment: gymnax's interface to levels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, Unpack

import jax
import jax.numpy as jnp
from gymnax.environments import environment, spaces
from jax import Array
from jax.tree_util import register_dataclass

from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    checked_observation,
    limits_of,
    takes_observation,
)
from babyrobot_levels.envs.observations import space_of
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.envs.suite import extent_of
from babyrobot_levels.jax.loading import MAX_BYTES, Loader, bounds_of, levels_in
from babyrobot_levels.jax.observations import Room, gymnax_space, look_up
from babyrobot_levels.jax.params import (
    HIT,
    REACHED,
    SKIDDED,
    TERMINAL,
    EnvParams,
    below,
    chosen,
    draw_words,
)
from babyrobot_levels.suites.sources import Bounds
from babyrobot_levels.suites.suite import Levels, Suite
from babyrobot_levels.text.words import check_choice

Info = dict[str, Array]


@register_dataclass
@dataclass(frozen=True)
class EnvState:
    """The state of an environment.

    Attributes:
        time: int32: how many steps the episode has taken.
        state: int32: the state, in the numbering of `EnvParams`.
        level: int32: the level, in that numbering.
    """

    time: Array
    state: Array
    level: Array


class LevelEnvironment(environment.Environment[EnvState, EnvParams]):
    """Levels as an environment of gymnax 1.0; made by `babyrobot_levels.jax.make`.

    Observations, actions, rewards and ends of episodes are those of `LevelEnv`. All that belongs to
    the levels is in `EnvParams`, which every call takes; without them, the levels with which it was
    made become constants of the compiled code. An action below 0 is taken as 0, and one beyond the
    last as the last: compiled code cannot raise errors.
    """

    def __init__(self, params: EnvParams, loader: Loader, room: Room, name: str) -> None:
        """Make the environment.

        Args:
            params: the levels.
            loader: puts other levels into tables.
            room: the size of the tables.
            name: the name of the environment.
        """
        super().__init__()
        self._params, self._loader, self._room, self._name = params, loader, room, name
        self._observation_space = gymnax_space(space_of(loader.extent, loader.observation))

    # -- gymnax ------------------------------------------------------------------------------

    @property
    def default_params(self) -> EnvParams:
        """The levels that the environment was made with."""
        return self._params

    @property
    def name(self) -> str:
        """The name of the level or suite, or how many levels there are."""
        return self._name

    @property
    def num_actions(self) -> int:
        """How many actions there are."""
        return self._params.num_actions

    @partial(jax.jit, static_argnames=("self",))
    def reset(self, key: Array, params: EnvParams | None = None) -> tuple[Any, EnvState]:
        """Start an episode.

        Args:
            key: the source of randomness.
            params: the levels.

        Returns:
            The observation and the state.
        """
        return self.reset_env(key, self._params if params is None else params)

    @partial(jax.jit, static_argnames=("self",))
    def step(
        self, key: Array, state: EnvState, action: Any, params: EnvParams | None = None
    ) -> tuple[Any, EnvState, Array, Array, Array, Info]:
        """Take an action; if the episode is over then, start the next one in the same step.

        Args:
            key: the source of randomness.
            state: the state.
            action: int32.
            params: the levels.

        Returns:
            The observation and the state, those of the next episode's start where this one is
            over; reward, terminated, truncated; and an info with `final_observation`, the
            observation before a reset, `action_mask` (int8 `[actions]`, after it), `level_index`
            (of the level in which the action was taken), `target_reached`, `skidded`, and, with
            movers, `hit`, with items, `held` (before it).
        """
        if params is None:
            params = self._params
        words = draw_words(key, params.step_words + params.reset_words)
        taken, reset = words[: params.step_words], words[params.step_words :]
        after, reward, terminated, info = self.transition(taken, state, action, params)
        truncated = self.is_truncated(after, params)
        start = self.start(reset, params, None if params.draws_levels else state.level)
        done = terminated | truncated
        now = jax.tree.map(partial(jnp.where, done), start, after)
        final = params.observations.at(after.state)
        info |= {
            "action_mask": self.action_mask(now, params),
            "terminated": terminated,
            "truncated": truncated,
            "final_observation": final,
        }
        return params.observations.at(now.state), now, reward, terminated, truncated, info

    def step_env(
        self, key: Array, state: EnvState, action: Any, params: EnvParams
    ) -> tuple[Any, EnvState, Array, Array, Info]:
        """Take an action without a reset; `step` does the rest."""
        words = draw_words(key, params.step_words)
        after, reward, terminated, info = self.transition(words, state, action, params)
        info["action_mask"] = self.action_mask(after, params)
        return params.observations.at(after.state), after, reward, terminated, info

    def reset_env(self, key: Array, params: EnvParams) -> tuple[Any, EnvState]:
        """Start an episode in a level that is drawn."""
        if params.num_levels > 1 and not params.draws_levels:
            words = draw_words(key, 1 + params.reset_words)
            state = self.start(words[1:], params, params.drawn_level(words[0]))
        else:
            state = self.start(draw_words(key, params.reset_words), params)
        return params.observations.at(state.state), state

    @partial(jax.jit, static_argnames=("self",))
    def reset_to_level(
        self, key: Array, level: Any, params: EnvParams | None = None
    ) -> tuple[Any, EnvState]:
        """Start an episode in the level with a number.

        Args:
            key: the source of randomness.
            level: int32.
            params: the levels.
        """
        params = self._params if params is None else params
        words = draw_words(key, params.reset_words)
        state = self.start(words, params, jnp.asarray(level, jnp.int32))
        return params.observations.at(state.state), state

    def observe(self, key: Array | None, state: EnvState, action: Any, params: EnvParams) -> Any:
        """Return the observation of a state."""
        return params.observations.at(state.state)

    def is_terminated(self, state: EnvState, params: EnvParams) -> Array:
        """Return whether a state is terminal: whatever is done in it, it leads back to itself."""
        entry = state.state * params.num_actions
        stays = params.next_state[entry] == state.state
        return stays & ((params.outcome[entry] & TERMINAL) > 0)

    def is_truncated(self, state: EnvState, params: EnvParams) -> Array:
        """Return whether the level's time limit is reached."""
        return state.time >= _of_level(params.limit, state.level, params)

    def action_space(self, params: EnvParams | None = None) -> spaces.Discrete:
        """Return the space of actions."""
        return spaces.Discrete(self.num_actions)

    def observation_space(self, params: EnvParams | None = None) -> spaces.Space:
        """Return the space of observations."""
        return self._observation_space

    def state_space(self, params: EnvParams | None = None) -> spaces.Dict:
        """Return the space of states."""
        params = self._params if params is None else params
        return spaces.Dict(
            {
                "time": spaces.Discrete(int(params.max_steps_in_episode)),
                "state": spaces.Discrete(params.num_states),
                "level": spaces.Discrete(params.num_levels),
            }
        )

    # -- levels ------------------------------------------------------------------------------

    def load(self, levels: Any) -> EnvParams:
        """Return other levels, in arrays of the same shapes: nothing is compiled anew for them.

        Args:
            levels: as many levels as the environment was made with, as `make` takes them.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid.
            ValueError: the levels do not fit into the spaces or the arrays.
        """
        return self._loader.load(levels, self._room, weighted=self._params.weights is not None)

    @partial(jax.jit, static_argnames=("self",))
    def observations(self, params: EnvParams | None = None) -> Any:
        """Return the observations of all states, `[states, …]`; a dict of such, if of several.

        Args:
            params: the levels; without a level axis.
        """
        params = self._params if params is None else params
        return params.observations.at(jnp.arange(params.num_states))

    def sample_action(self, key: Array, state: EnvState, params: EnvParams | None = None) -> Array:
        """Return an action that the mask allows, int32, each as often; 0 if there is none.

        Args:
            key: the source of randomness.
            state: the state.
            params: the levels.
        """
        counted = jnp.cumsum(self.action_mask(state, params), axis=-1, dtype=jnp.int32)
        place = below(draw_words(key, 1)[0], counted[..., -1])
        return jnp.argmax(counted > place, axis=-1).astype(jnp.int32)

    def action_mask(self, state: EnvState, params: EnvParams | None = None) -> Array:
        """Return the action mask, int8 `[actions]`: 1 for the actions that nothing refuses."""
        params = self._params if params is None else params
        bits = look_up(params.mask, state.state)[..., None] >> jnp.arange(
            params.num_actions, dtype=params.mask.dtype
        )
        return (bits & 1).astype(jnp.int8)

    def transition(
        self, words: Array, state: EnvState, action: Any, params: EnvParams
    ) -> tuple[EnvState, Array, Array, Info]:
        """Take an action with given randomness, and without a reset.

        Args:
            words: uint32 `[params.step_words]`; a word w stands for the draw `w / 2**32`, with
                which the other engines draw the same outcome.
            state: the state.
            action: int32.
            params: the levels.

        Returns:
            The state after the action, the reward, whether the episode has terminated, and an
            info.
        """
        entry = self._entry(words, state, action, params)
        next_state = look_up(params.next_state, entry)
        after = EnvState(time=state.time + 1, state=next_state, level=state.level)
        told = look_up(params.outcome, entry)
        info = {
            "level_index": _of_level(params.number, state.level, params),
            "target_reached": (told & REACHED) > 0,
            "skidded": (told & SKIDDED) > 0,
        }
        if params.has_movers:
            info["hit"] = (told & HIT) > 0
        if params.held.shape[-1]:
            info["held"] = look_up(params.held, next_state)
        return after, look_up(params.reward, entry), (told & TERMINAL) > 0, info

    def _entry(self, words: Array, state: EnvState, action: Any, params: EnvParams) -> Array:
        """Return the entry of the outcome that words draw."""
        action = jnp.clip(jnp.asarray(action, jnp.int32), 0, params.num_actions - 1)
        entry = state.state * params.num_actions + action
        if params.draws_outcomes:
            number = -1 - look_up(params.next_state, entry)
            row = jnp.maximum(number, 0)
            outcome = chosen(words[0], look_up(params.threshold, row))
            drawn = params.num_rows + row * params.most_outcomes + outcome
            entry = jnp.where(number >= 0, drawn, entry)
        return entry

    def start(self, words: Array, params: EnvParams, level: Array | None = None) -> EnvState:
        """Return the state in which an episode starts, with given randomness.

        Args:
            words: uint32 `[params.reset_words]`: for the level, if levels are drawn, and for the
                start, if a level has several.
            params: the levels.
            level: the level, which is not drawn then.
        """
        if level is None:
            level = params.drawn_level(words[0]) if params.draws_levels else jnp.int32(0)
        number = _of_level(params.first_start, level, params)
        if params.draws_starts:
            end = _of_level(params.first_start[1:], level, params)
            number += below(words[-1], end - number)
        return EnvState(time=jnp.int32(0), state=look_up(params.starts, number), level=level)


def _of_level(table: Array, level: Array, params: EnvParams) -> Array:
    """Return what a table has of a level; of a single one, without a look-up."""
    return look_up(table, level) if params.num_levels > 1 else table[0]


@takes_observation
def make(
    levels: Levels,
    *,
    actions: str = "valid",
    draw_levels: bool = True,
    room_for: Levels | None = None,
    max_episode_steps: int | None = None,
    max_bytes: float = MAX_BYTES,
    **options: Unpack[ObservationOptions],
) -> tuple[LevelEnvironment, EnvParams]:
    """Return levels as an environment of gymnax, and as its parameters.

    The tables of all levels are made at once. Observations, actions, rewards and ends of
    episodes are those of `LevelVectorEnv` with the same arguments.

    Args:
        levels: a level, a folder, a pack or a suite: a name, a path, a mapping, a `Level` or a
            `Suite`; or several levels.
        actions: `"valid"`, `"all"`, `"moves"`, `"valid_moves"` or `"turns"`. There is no difference
            between `"valid"` and `"all"`, or `"valid_moves"` and `"moves"`: `sample_action` gives
            valid actions, and the action space all.
        draw_levels: whether each episode draws its level: all equally often, or by the weights of
            the suite. If not, `reset` draws it, and later episodes stay in it.
        room_for: further levels, as `levels`: `load` can then put any levels into the arrays that
            are not larger than the largest of all these. By default, levels that are not larger
            altogether.
        max_episode_steps: the time limit of episodes, -1 for none. By default, each level's
            `max_steps`.
        max_bytes: how much memory the arrays may take; while they are made, it is about three
            times as much. Transitions take 9 bytes for each state and action, and 17 for each
            outcome where there are several. Observations take 4 bytes for each number of each
            state, views an eighth of a byte, images one; planes are kept once for each
            configuration.
        options: the observation, and its options, as `LevelEnv` has them.

    Returns:
        The environment, and the parameters that its methods take.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid.
        UnsatisfiableError: no level meets the conditions of a suite.
        ValueError: the arrays would take too much memory, there are no levels, one has
            `maze: {seed: random}`, or another argument is invalid.
    """
    chosen = checked_observation(**options)
    check_choice("actions", actions, ACTION_SETS)
    limits_of((), max_episode_steps)
    given = levels_in(levels)
    others = () if room_for is None else levels_in(room_for)
    bounds = Bounds.joined([bounds_of(given), bounds_of(others)])
    action_set = ACTION_SETS[actions].with_moves(bounds.moves)
    loader = Loader(
        chosen,
        bounds,
        extent_of(bounds, turns=action_set.turns),
        action_set,
        bool(draw_levels),
        max_episode_steps,
        # 1e6 is what people write.
        check_count("max_bytes", int(max_bytes) if isinstance(max_bytes, float) else max_bytes),
    )
    params, room = loader.make(given, others)
    name = given.name if isinstance(given, Suite) else given[0].name if len(given) == 1 else None
    return LevelEnvironment(params, loader, room, name or f"{len(given):,} levels"), params


class UnderspecifiedEnv:
    """Levels as an environment of JaxUED: each episode is in a level that is given.

    It has the methods of JaxUED's class of this name, which wrappers call, and does not need JaxUED
    itself. A level is its number in the params, int32, so that `jnp.arange(params.num_levels)` is
    the batch of all levels.
    """

    def __init__(self, env: LevelEnvironment) -> None:
        """Wrap an environment that `babyrobot_levels.jax.make` returned."""
        self._env = env

    @property
    def default_params(self) -> EnvParams:
        """The levels that the environment was made with."""
        return self._env.default_params

    @partial(jax.jit, static_argnames=("self",))
    def reset_to_level(
        self, rng: Array, level: Any, params: EnvParams | None = None
    ) -> tuple[Any, EnvState]:
        """Start an episode in a level.

        Args:
            rng: the source of randomness.
            level: int32: the number of the level.
            params: the levels.

        Returns:
            The observation and the state.
        """
        begun: tuple[Any, EnvState] = self._env.reset_to_level(rng, level, params)
        return begun

    @partial(jax.jit, static_argnames=("self",))
    def step(
        self, rng: Array, state: EnvState, action: Any, params: EnvParams | None = None
    ) -> tuple[Any, EnvState, Array, Array, Info]:
        """Take an action. There is no reset when the episode is over: wrappers of JaxUED do it.

        Args:
            rng: the source of randomness.
            state: the state.
            action: int32.
            params: the levels.

        Returns:
            The observation, the state, the reward, whether the episode is over, and the info of
            `LevelEnvironment.step` without `final_observation`.
        """
        params = self.default_params if params is None else params
        observation, after, reward, terminated, info = self._env.step_env(
            rng, state, action, params
        )
        truncated = self._env.is_truncated(after, params)
        info |= {"terminated": terminated, "truncated": truncated}
        return observation, after, reward, terminated | truncated, info

    def action_space(self, params: EnvParams | None = None) -> spaces.Discrete:
        """Return the space of actions."""
        return self._env.action_space(params)
