"""The Gymnasium vector environment of one level, or of several."""

from collections.abc import Sequence
from functools import partial
from typing import Any, Unpack

import numpy as np
from gymnasium import error
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    check_names,
    checked_actions,
    checked_autoreset_mode,
    checked_given,
    checked_observation,
    checked_options,
    checked_reset_mask,
    start_states,
    takes_observation,
)
from babyrobot_levels.envs.engine.plain import reset
from babyrobot_levels.envs.engine.state import EnvStates, Layout, Results
from babyrobot_levels.envs.engine.tables import Flags, Ints, Tables, masks_at
from babyrobot_levels.envs.observations import make_batch_observer
from babyrobot_levels.envs.observations.numbers import vector_names
from babyrobot_levels.envs.observations.planes import plane_names
from babyrobot_levels.envs.rendering import RENDER_FPS
from babyrobot_levels.envs.samplers import Sampler
from babyrobot_levels.envs.single import LevelLike
from babyrobot_levels.envs.spaces import ACTION_SETS, ActionSet, BatchActions, make_action_space
from babyrobot_levels.envs.suite import SuiteLike, make_suite_serializable, suite_and_split
from babyrobot_levels.envs.vector.levels import ChangingVectorEnv, checked_levels, checked_numbers
from babyrobot_levels.text.words import check_choice

_Step = tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]

# Looking them up in their class, at each step, would take longer.
_SAME_STEP, _DISABLED = AutoresetMode.SAME_STEP, AutoresetMode.DISABLED


class LevelVectorEnv(ChangingVectorEnv):
    """Many environments that step in one call, each with a robot that moves through a level.

    Each is equivalent to a `LevelEnv` in the `TimeLimit` of its level: the same observations,
    actions, rewards and infos, in arrays with one row for each environment. All randomness comes
    from one generator, `np_random`; after `reset` with a list of seeds, from one for each
    environment.

    Attributes:
        levels: the levels, as they were given, or as `set_levels` left them. `call("level")`
            returns the current level of each environment.
        num_items: the most items of a level.
        autoreset_mode: when an environment whose episode is over is reset.
    """

    __module__ = "babyrobot_levels"

    @takes_observation
    def __init__(
        self,
        level: LevelLike | None = None,
        *,
        levels: Sequence[LevelLike] | None = None,
        num_envs: int | None = None,
        actions: str = "valid",
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        draw_levels: bool = False,
        sampler: Sampler | None = None,
        copy: bool = True,
        engine: str | None = None,
        **options: Unpack[ObservationOptions],
    ) -> None:
        """Make the environment.

        Args:
            level: a name, a path, a mapping or a `Level`. With `maze: {seed: random}`, another
                maze is grown for each episode.
            levels: in place of `level`, several levels, as a list or a suite: environment i has
                level `i % len(levels)`.
            num_envs: how many environments there are; by default, as many as levels, or 1 if
                levels are made at resets.
            actions: `"valid"`, `"all"`, `"moves"`, `"valid_moves"` or `"turns"`.
            render_mode: None or `"rgb_array"`.
            max_episode_steps: the time limit of episodes, -1 for none. By default, each level's
                `max_steps`.
            autoreset_mode: when an environment whose episode is over is reset: by the next step,
                which does not act then; in the same step, with the end of the episode in
                `final_obs` and `final_info`; or not automatically.
            draw_levels: whether each episode draws its level. Levels of a suite are made when they
                are drawn, and kept as long as there is room.
            sampler: selects the levels that are drawn. By default, all are drawn equally often, or
                by the weights of the suite.
            copy: whether each step returns new arrays, which are parts of one piece of memory;
                small ones are of the same piece for a few steps. If not, it always returns the
                same arrays, and the next step overwrites them.
            engine: `"numpy"`, `"compiled"`, or None for `"compiled"` where Numba is
                installed, else `"numpy"`. All give the same results.
            options: the observation, and its options, as `LevelEnv` has them.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid.
            UnsatisfiableError: no level meets the conditions of a suite.
            ImportError: an engine is required whose library is not installed.
            ValueError: another argument is invalid.
        """
        chosen = checked_observation(**options)
        check_choice("actions", actions, ACTION_SETS)
        if render_mode is not None:
            check_choice("render_mode", render_mode, ("rgb_array",))
        size = None if num_envs is None else check_count("num_envs", num_envs)
        action_set = self._action_set(actions)
        played = checked_levels(level, levels, bool(draw_levels), sampler, size, action_set.turns)
        action_set = action_set.with_moves(played.extent.moves)
        self.levels, self._extent = played.levels, played.extent
        self.num_envs = size or (1 if played.family else len(self.levels))
        self.render_mode = render_mode
        self.autoreset_mode = checked_autoreset_mode(autoreset_mode)
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": RENDER_FPS,
            "autoreset_mode": self.autoreset_mode,
        }
        num_actions = action_set.num_actions
        self.single_action_space = make_action_space(action_set, num_actions)
        self._envs = EnvStates(self.num_envs, 1 if played.family else len(self.levels))
        self.action_space = BatchActions(num_actions, self._envs)
        self._engine_name = engine
        self._new_observer = partial(
            make_batch_observer,
            chosen,
            played.extent,
            self.num_envs if played.family else max(self.num_envs, len(self.levels)),
        )
        self._observer = self._new_observer()
        self._set_levels(played, action_set, max_episode_steps, bool(draw_levels))
        self._has_level_numbers = self._slots is not None or len(self.levels) > 1
        self.single_observation_space = self._observer.space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._copy = bool(copy)
        self.num_items, self._has_movers = played.num_items, played.has_movers
        # Those of a suite count as having all that one of them can have.
        fixed = () if played.family else self.levels
        self._all_have_items = all(each.items for each in fixed)
        self._all_have_movers = all(each.movers for each in fixed)
        layout = Layout(
            self.num_envs,
            self._observer.table.shape[1],
            num_actions,
            played.num_items,
            played.has_movers,
            self._engine.writes_records,
        )
        self._results = Results(layout)
        self._has_begun = False

    def _action_set(self, actions: str) -> ActionSet:
        return ACTION_SETS[actions]

    # -- episodes --------------------------------------------------------------------------

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start episodes.

        Args:
            seed: a number, for one generator that all environments share; or a list of
                `num_envs` numbers, for a generator of each environment's own, with which its
                episodes are those of a single environment. None in the list leaves a generator as
                it is.
            options: `{"start": [x, y]}` starts in that cell; `{"reset_mask": mask}`, bool
                `[num_envs]`, resets only the environments that have True. Where levels are made at
                resets, `{"index": i}` selects a level of the suite, and `{"maze_seed": n}` the
                maze of that seed: a number, or one for each environment.

        Returns:
            The observations, and the info that `step` describes.

        Raises:
            ValueError: the robot cannot start in that cell, there is no level with that number or
                no such option, or the seed or the mask is invalid.
            UnsatisfiableError: no level meets the conditions of a suite.
        """
        family = None if self._slots is None else self._slots.family
        numbered = () if family is None or family.option is None else (family.option,)
        options = checked_options(options, "start", "reset_mask", *numbered)
        which = checked_reset_mask(options.get("reset_mask"), self.num_envs)
        start = options.get("start")
        numbers = checked_numbers(options, family, self.num_envs)
        if family is None and start is not None:
            for each in self.levels:
                start_states(start, each, self._actions.tables(each))
        if which.size < self.num_envs and not self._has_begun:
            raise error.ResetNeeded("the first `reset()` must be of all environments")
        self._seed(seed, which)
        envs, draws, results = self._envs, self._draws, self._results
        if self._copy:
            results.renew()
        if self._most_draws:
            draws.reserve()
        if family is not None:
            self._change_levels(which, numbers, start)
        if start is None:
            self._engine.reset(envs, which, draws)
        else:
            reset(self._starting_at(start, which), envs, which, draws)
        self._has_begun = True
        self._observe_start(results, np.arange(self.num_envs))
        is_reset = np.zeros(self.num_envs, np.bool_)
        is_reset[which] = True
        return self._observer.batch(results, envs.state, self._copy), self._infos(results, is_reset)

    def step(self, actions: Any) -> _Step:
        """Take an action in each environment.

        Args:
            actions: whole numbers, `[num_envs]`.

        Returns:
            Observations, rewards (float64 `[num_envs]`), terminated and truncated (bool
            `[num_envs]`), and an info: `action_mask` (int8 `[num_envs, actions]`),
            `target_reached` and `skidded` (bool `[num_envs]`, False at reset); for several levels
            `level_index`, for a level with `maze: {seed: random}` `maze_seed` (int64 `[num_envs]`);
            if a level has items `held` (bool `[num_envs, num_items]`, in the order of the level
            file), and if one has movers `hit` (bool `[num_envs]`). For each key there is another
            one with `_` before it: in which environments the value holds. All arrays are
            contiguous.

        Raises:
            ResetNeeded: there was no reset yet, or an episode is over and there is no autoreset.
            InvalidAction: the actions are not in the action space.
        """
        if not self._has_begun:
            raise error.ResetNeeded("call `reset()` before the first `step()`")
        envs, draws = self._envs, self._draws
        taken = checked_actions(actions, self.num_envs)
        if self.autoreset_mode is _DISABLED and np.count_nonzero(envs.done):
            number = int(envs.done.argmax())
            raise error.ResetNeeded(
                f"the episode of environment {number} is over: call "
                "`reset(options={'reset_mask': terminated | truncated})`"
            )
        results = self._results
        if self._copy:
            results.renew()
        if self._most_draws:
            draws.reserve()
        if self._slots is not None and np.count_nonzero(envs.done):
            if ((taken < 0) | (taken >= self._tables.num_actions)).any():
                self._refuse(taken)
            self._change_levels(envs.done.nonzero()[0])
        if not self._act(taken):
            self._refuse(taken)
        final = self._reset_done(results) if self.autoreset_mode is _SAME_STEP else None
        all_true = results.all_true
        info = {
            "action_mask": results.masks,
            "_action_mask": all_true,
            "target_reached": results.reached,
            "_target_reached": all_true,
            "skidded": results.skidded,
            "_skidded": all_true,
        }
        if self.num_items:
            info["held"] = results.held
            info["_held"] = all_true if self._all_have_items else self._with_items(all_true)
        if self._has_movers:
            info["hit"] = results.hit
            info["_hit"] = all_true if self._all_have_movers else self._with_movers(all_true)
        if self._has_level_numbers:
            for key, numbers in self._level_numbers().items():
                info[key] = numbers
                info[f"_{key}"] = all_true
        if final:
            info = {**final, **info}
        return (
            self._observer.batch(results, envs.state, self._copy),
            results.rewards,
            results.terminated,
            results.truncated,
            info,
        )

    def _act(self, actions: Ints) -> bool:
        """Take actions, and tell whether all are in the action space; if not, nothing changes."""
        return self._engine.step(self._envs, actions, self._draws, self._results)

    @property
    def plane_names(self) -> tuple[str, ...]:
        """The names of the planes of the observation `"planes"`."""
        return plane_names(self._extent)

    @property
    def vector_names(self) -> tuple[str, ...]:
        """The names of the entries of the observation `"vector"`."""
        return vector_names(self._extent)

    def action_masks(self) -> NDArray[np.int8]:
        """Return the current action masks, int8 `[num_envs, actions]`."""
        if not self._has_begun:
            raise error.ResetNeeded("call `reset()` before asking for the action masks")
        return masks_at(self._tables.state_info, self._envs.state, self._tables.mask_width)

    def _starting_at(self, start: Any, which: Ints) -> Tables:
        """Return the tables of levels in which these environments start in a given cell."""
        starts: list[tuple[int, ...]] = [(0,)] * self._tables.limit.size
        # Where levels are made at resets, those of other environments may have no such cell.
        slots = np.arange(len(starts)) if self._slots is None else self._envs.level[which]
        for slot in np.unique(slots).tolist():
            level = self._playing[slot]
            assert level is not None
            states = start_states(start, level, self._actions.tables(level))
            assert states is not None
            starts[slot] = states
        return self._tables.starting_at(starts)

    def _observe_start(self, results: Results, which: Ints) -> None:
        """Write the observations and infos of environments that were reset."""
        state = self._envs.state[which]
        results.masks[which] = masks_at(self._tables.state_info, state, self._tables.mask_width)
        results.reached[which] = results.skidded[which] = False
        if self.num_items:
            results.held[which] = self._tables.held[state]
        if self._has_movers:
            results.hit[which] = False
        results.observations[which] = self._observer.table[state]

    def _infos(self, results: Results, where: Flags) -> dict[str, Any]:
        """Return the infos of some environments, as new arrays, with zeros for the others."""
        columns = where[:, None]
        info = {
            "action_mask": results.masks * columns,
            "target_reached": results.reached & where,
            "skidded": results.skidded & where,
        }
        if self.num_items:
            info["held"] = results.held & columns
        if self._has_movers:
            info["hit"] = results.hit & where
        for key, numbers in self._level_numbers().items():
            info[key] = np.where(where, numbers, 0)
        masks = {f"_{key}": where for key in info}
        if self.num_items:
            masks["_held"] = self._with_items(where)
        if self._has_movers:
            masks["_hit"] = self._with_movers(where)
        return info | masks

    def _with_items(self, where: Flags) -> Flags:
        """Return which of some environments have a level with items."""
        if self._all_have_items:
            return where
        return where & self._tables.has_items.take(self._envs.level)

    def _with_movers(self, where: Flags) -> Flags:
        """Return which of some environments have a level with movers."""
        if self._all_have_movers:
            return where
        return where & self._tables.has_movers.take(self._envs.level)

    def _reset_done(self, results: Results) -> dict[str, Any]:
        """Reset the environments whose episodes are over; return an info of how they ended."""
        envs = self._envs
        done = envs.done.nonzero()[0]
        if not done.size:
            return {}
        where = np.zeros(self.num_envs, np.bool_)
        where[done] = True
        observations = np.full(self.num_envs, None, object)
        for number, one in zip(done, self._observer.each(envs.state[done]), strict=True):
            observations[number] = one
        info = {
            "final_obs": observations,
            "_final_obs": where,
            "final_info": self._infos(results, where),
            "_final_info": where,
        }
        if self._slots is not None:
            self._change_levels(done)
        self._engine.reset(envs, done, self._draws)
        self._observe_start(results, done)
        return info

    def _refuse(self, actions: Ints) -> None:
        most = self._tables.num_actions - 1
        number = int(((actions < 0) | (actions > most)).argmax())
        raise error.InvalidAction(
            f"{actions[number]}, the action of environment {number}, is not an action; "
            f"the actions are 0 to {most}"
        )


class SuiteVectorEnv(LevelVectorEnv):
    """Many environments that step in one call, and draw a level of a suite for each episode.

    The vector entry point of `babyrobot/Suite-v0`. Each environment is equivalent to a `SuiteEnv`
    in the `TimeLimit` of the suite.

    Attributes:
        suite: the suite, or the split of it.
    """

    def __init__(
        self, suite: SuiteLike, *, split: str | None = None, num_envs: int = 1, **kwargs: Any
    ) -> None:
        """Make the environment of a suite.

        Args:
            suite: a name, a path, a mapping or a `Suite`.
            split: the split that is used; by default, the whole suite.
            num_envs: how many environments there are.
            kwargs: the other arguments of `LevelVectorEnv`, such as `sampler`, except for
                `level`, `levels` and `draw_levels`.

        Raises:
            SuiteNotFoundError: there is no such suite.
            LevelError: the suite is not valid.
            UnsatisfiableError: no level meets the suite's conditions.
            ValueError: there is no such split, it has no levels, or another argument is invalid.
        """
        self._given_suite, self.suite = suite_and_split(suite, split)
        super().__init__(levels=self.suite, draw_levels=True, num_envs=num_envs, **kwargs)

    def _make_serializable(self, given: dict[str, Any]) -> None:
        super()._make_serializable(given)
        make_suite_serializable(given, self._given_suite)


def make_suite_vector(suite: SuiteLike | None = None, **kwargs: Any) -> SuiteVectorEnv:
    """Return a suite's vector environment: the vector entry point of `babyrobot/Suite-v0`.

    Args:
        suite: a name, a path, a mapping or a `Suite`.
        kwargs: the other arguments of `SuiteVectorEnv`.

    Raises:
        MissingArgument: there is no suite.
        TypeError: there is no such argument.
    """
    check_names(kwargs, LevelVectorEnv.__init__, "split", "suite")
    return SuiteVectorEnv(checked_given("suite", suite), **kwargs)
