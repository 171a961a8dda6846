"""Many robots in one level, or in several: the Gymnasium vector environment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import error
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import (
    check_choice,
    checked_image_size,
    checked_options,
    checked_start,
)
from babyrobot_levels.envs.engine.arguments import checked_count
from babyrobot_levels.envs.engine.plain import begin
from babyrobot_levels.envs.engine.robots import Layout, Results, Robots
from babyrobot_levels.envs.engine.tables import masks_at, signs_of
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.pictures import RENDER_FPS
from babyrobot_levels.envs.spaces import ACTION_SETS, make_action_space
from babyrobot_levels.envs.vector.arguments import (
    checked_actions,
    checked_autoreset_mode,
    checked_levels,
    checked_numbers,
    checked_reset_mask,
)
from babyrobot_levels.envs.vector.changing import ChangingVectorEnv
from babyrobot_levels.envs.vector.observations import make_batch_observer
from babyrobot_levels.envs.vector.spaces import BatchActions

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.tables import Ints, Tables
    from babyrobot_levels.envs.single import LevelLike

_Step = tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]

# To look them up in their class, each step, would take longer.
_SAME_STEP, _DISABLED = AutoresetMode.SAME_STEP, AutoresetMode.DISABLED


class LevelVectorEnv(ChangingVectorEnv):
    """Many robots walk levels to their exits, all in one call.

    Each environment is what `LevelEnv` is, under the time limit of its level: the same
    observations, actions, rewards and infos, in arrays with one row for each environment. All
    chance comes from one generator, `np_random`; after `reset` with a list of seeds, from one for
    each environment.

    Attributes:
        levels: the levels that are played, as they were given. What each environment plays now,
            `call("level")` tells.
    """

    def __init__(
        self,
        level: LevelLike | None = None,
        *,
        levels: Sequence[LevelLike] | None = None,
        num_envs: int | None = None,
        observation: str = "position",
        actions: str = "valid",
        render_mode: str | None = None,
        image_size: tuple[int, int] | None = None,
        grayscale: bool = False,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        draw_levels: bool = False,
        copy: bool = True,
        engine: str | None = None,
    ) -> None:
        """Make the environment.

        Args:
            level: a name, a path, a mapping or a `Level`. One that says `maze: {seed: random}`
                grows another maze for each episode. Or
            levels: several levels, in a list or a suite: environment i plays level
                `i % len(levels)`.
            num_envs: how many environments there are; by default, as many as levels, or 1 if
                levels are made when episodes begin.
            observation: `"position"`, `"index"`, `"walls"` or `"image"`.
            actions: `"valid"`, `"all"` or `"moves"`.
            render_mode: None or `"rgb_array"`.
            image_size: `(height, width)` in pixels of image observations.
            grayscale: whether image observations are grey.
            max_episode_steps: after how many steps an episode is cut off, -1 for never. By
                default, each level's `max_steps`.
            autoreset_mode: when an environment whose episode is over begins anew: at the next
                step in the place of acting, in the same step (`final_obs` and `final_info` then
                tell how it ended), or when it is reset.
            draw_levels: whether each episode is played in a level that is drawn. Those of a suite
                are made when they are drawn, and the last ones are kept.
            copy: whether what is returned belongs to the user: the parts of one new piece of memory
                for each step. If not, it is always the same arrays, which the next step writes
                over.
            engine: `"numpy"`, `"compiled"`, or None for the fastest that is installed.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid.
            StarvedError: no level meets the conditions of a suite.
            ImportError: the compiled engine is asked for and not installed.
            ValueError: another argument has a value that it cannot have.
        """
        check_choice("observation", observation, OBSERVATIONS)
        check_choice("actions", actions, ACTION_SETS)
        if render_mode is not None:
            check_choice("render_mode", render_mode, ("rgb_array",))
        if observation != "image" and (image_size is not None or grayscale):
            raise ValueError("image_size and grayscale go with observation='image'")
        size = None if num_envs is None else checked_count("num_envs", num_envs)
        played = checked_levels(level, levels, bool(draw_levels), size)
        self.levels = played.levels
        self.num_envs = size or (1 if played.family else len(self.levels))
        self.render_mode = render_mode
        self._mode = checked_autoreset_mode(autoreset_mode)
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": RENDER_FPS,
            "autoreset_mode": self._mode,
        }
        self.single_action_space, first_action = make_action_space(actions)
        num_actions = int(self.single_action_space.n)
        self._robots = Robots(self.num_envs, 1 if played.family else len(self.levels))
        self.action_space = BatchActions(num_actions, self._robots)
        self._samples_possible = actions == "valid"
        self._engine_name = engine
        self._observer = make_batch_observer(
            played.largest,
            observation,
            checked_image_size(image_size),
            bool(grayscale),
            self.num_envs if played.family else max(self.num_envs, len(self.levels)),
        )
        self._take(played, first_action, max_episode_steps, bool(draw_levels))
        self._most_draws = self.num_envs * (self._tables.most_draws + int(self._slots is not None))
        self._tells_levels = self._slots is not None or len(self.levels) > 1
        self.single_observation_space = self._observer.space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._copy = bool(copy)
        self._signs = signs_of(num_actions)
        self._layout = Layout(self.num_envs, self._observer.table.shape[1], self._signs)
        self._kept = None if self._copy else Results(self._layout)
        self._has_begun = False

    def __getstate__(self) -> dict[str, Any]:
        # Copies of the arrays would no longer be views of one memory.
        return {**super().__getstate__(), "_kept": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._kept = None if self._copy else Results(self._layout)

    # -- playing ---------------------------------------------------------------------------

    def reset(
        self,
        *,
        seed: int | Sequence[int] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Begin episodes.

        Args:
            seed: a number, for one generator that all environments share; or a list of
                `num_envs` numbers, for a generator of each environment's own, with which it walks
                as a single one does. None in the list leaves a generator as it is.
            options: `{"start": [x, y]}` begins at that cell; `{"reset_mask": mask}`, bool
                `[num_envs]`, leaves the environments without a True as they are. Where levels are
                made when episodes begin, `{"index": i}` asks for a level of the suite, and
                `{"maze_seed": n}` for the maze of that seed: a number, or one for each
                environment.

        Returns:
            The observations, and an info with `action_mask` (int8 `[num_envs, actions]`),
            `level_digest` and, of several levels, `level_index` (int64 `[num_envs]`): which one
            each environment plays. Of a level that grows its mazes, `maze_seed` (int64
            `[num_envs]`) takes the place of both.

        Raises:
            ValueError: the robots cannot start at that cell, there is no level of that number, no
                such option, or the seed or the mask is none.
            StarvedError: no level meets the conditions of a suite.
        """
        family = None if self._slots is None else self._slots.family
        numbered = () if family is None else (family.option,)
        options = checked_options(options, "start", "reset_mask", *numbered)
        which = checked_reset_mask(options.get("reset_mask"), self.num_envs)
        start = options.get("start")
        numbers = checked_numbers(options, family, self.num_envs)
        if family is None:
            for each in self.levels:
                checked_start(start, each)
        if which.size < self.num_envs and not self._has_begun:
            raise error.ResetNeeded("the first `reset()` must be of all environments")
        self._seed(seed, which)
        robots, draws, results = self._robots, self._draws, self._kept or Results(self._layout)
        if self._most_draws:
            draws.reserve()
        if family is not None:
            self._change_levels(which, numbers, start)
        if start is None:
            self._engine.begin(robots, which, draws)
        else:
            begin(self._beginning_at(start, which), robots, which, draws)
        self._has_begun = True
        self._look(results, np.arange(self.num_envs))
        begun = np.zeros(self.num_envs, np.bool_)
        begun[which] = True
        results.words[~begun] = 0
        info = self._told({"action_mask": results.signs["mask"], **self._digests(which)}, begun)
        return self._observer.batch(results, robots.state, self._copy), info

    def step(self, actions: Any) -> _Step:
        """Take an action in each environment.

        Args:
            actions: whole numbers, `[num_envs]`.

        Returns:
            Observations, rewards (float64 `[num_envs]`), terminated and truncated (bool
            `[num_envs]`), and an info with `action_mask` (int8 `[num_envs, actions]`),
            `target_reached`, `skidded` (bool `[num_envs]`), `level_index` or `maze_seed` if
            `reset` has it, and beside each, under its name with `_` before it, in which
            environments it was said.

        Raises:
            ResetNeeded: no episode has begun, or one is over and nothing begins the next.
            InvalidAction: the action space does not contain the actions.
        """
        if not self._has_begun:
            raise error.ResetNeeded("call `reset()` before the first `step()`")
        robots, draws = self._robots, self._draws
        taken = checked_actions(actions, self.num_envs)
        if self._mode is _DISABLED and np.count_nonzero(robots.over):
            number = int(robots.over.argmax())
            raise error.ResetNeeded(
                f"the episode of environment {number} is over: call "
                "`reset(options={'reset_mask': terminated | truncated})`"
            )
        results = self._kept or Results(self._layout)
        if self._most_draws:
            draws.reserve()
        if self._slots is not None and np.count_nonzero(robots.over):
            if ((taken < 0) | (taken >= self._tables.num_actions)).any():
                self._refuse(taken)
            self._change_levels(robots.over.nonzero()[0])
        if not self._engine.step(robots, taken, draws, results):
            self._refuse(taken)
        ends = self._end(results) if self._mode is _SAME_STEP else {}
        signs, acted, everyone = results.signs, results.acted, results.everyone
        info = {
            **ends,
            "action_mask": signs["mask"],
            "_action_mask": everyone,
            "target_reached": signs["reached"],
            "_target_reached": acted,
            "skidded": signs["skidded"],
            "_skidded": acted,
        }
        if self._tells_levels:
            for word, numbers in self._level_numbers().items():
                info[word] = numbers
                info[f"_{word}"] = everyone
        return (
            self._observer.batch(results, robots.state, self._copy),
            results.rewards,
            results.terminated,
            results.truncated,
            info,
        )

    def action_masks(self) -> NDArray[np.int8]:
        """Return which actions are possible now, int8 `[num_envs, actions]`."""
        if not self._has_begun:
            raise error.ResetNeeded("call `reset()` before asking for the action masks")
        return masks_at(self._tables.standing, self._robots.state, self._tables.num_actions)

    def _beginning_at(self, start: Any, which: Ints) -> Tables:
        """Return the tables of levels in which these robots begin at a cell that was asked for."""
        starts = np.zeros(self._tables.limit.size, np.intp)
        # Of levels that come and go, others may have no such cell.
        slots = np.arange(starts.size) if self._slots is None else self._robots.level[which]
        for slot in np.unique(slots).tolist():
            state = checked_start(start, self._playing[slot])
            assert state is not None
            starts[slot] = state
        return self._tables.beginning_at(starts)

    def _look(self, results: Results, which: Ints) -> None:
        """Write what robots that have just begun are shown."""
        state = self._robots.state[which]
        results.words[which] = self._tables.standing[state]
        results.observations[which] = self._observer.table[state]

    def _told(self, values: dict[str, Any], where: NDArray[np.bool_]) -> dict[str, Any]:
        """Return values as an info, which says of each in which environments it holds."""
        for word, numbers in self._level_numbers().items():
            values[word] = np.where(where, numbers, 0)
        return {**values, **{f"_{name}": where for name in values}}

    def _end(self, results: Results) -> dict[str, Any]:
        """Begin anew where episodes are over, and return an info of how they ended."""
        robots = self._robots
        over = robots.over.nonzero()[0]
        if not over.size:
            return {}
        words = np.zeros_like(results.words)
        words[over] = results.words[over]
        where = np.zeros(self.num_envs, np.bool_)
        where[over] = True
        signs = words.view(self._signs)
        ends = {
            "action_mask": signs["mask"],
            "target_reached": signs["reached"],
            "skidded": signs["skidded"],
        }
        observations = np.full(self.num_envs, None, object)
        shown = self._observer.at(robots.state[over])
        for number, one in zip(over, shown if shown.ndim > 1 else shown.tolist(), strict=True):
            observations[number] = one
        info = {
            "final_obs": observations,
            "_final_obs": where,
            "final_info": self._told(ends, where),
            "_final_info": where,
        }
        if self._slots is not None:
            self._change_levels(over)
        self._engine.begin(robots, over, self._draws)
        self._look(results, over)
        results.acted[over] = False
        return info

    def _refuse(self, actions: Ints) -> None:
        most = self._tables.num_actions - 1
        number = int(((actions < 0) | (actions > most)).argmax())
        raise error.InvalidAction(
            f"{actions[number]}, told to environment {number}, is no action; "
            f"the actions are 0 to {most}"
        )
