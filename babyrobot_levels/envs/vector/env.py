"""Many robots in one level, or in several: the Gymnasium vector environment."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import error
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from babyrobot_levels.engine.arguments import checked_count, limits_of
from babyrobot_levels.engine.choice import make_engine
from babyrobot_levels.engine.draws import Draws
from babyrobot_levels.engine.robots import Results, Robots
from babyrobot_levels.engine.tables import build_tables, signs_of
from babyrobot_levels.envs.arguments import check_choice, checked_image_size
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.pictures import RENDER_FPS
from babyrobot_levels.envs.spaces import ACTION_SETS, make_action_space
from babyrobot_levels.envs.vector.arguments import (
    checked_actions,
    checked_autoreset_mode,
    checked_levels,
    checked_reset_mask,
    checked_seeds,
    checked_starts,
)
from babyrobot_levels.envs.vector.observations import make_batch_observer
from babyrobot_levels.envs.vector.rendering import RenderedVectorEnv
from babyrobot_levels.envs.vector.spaces import BatchActions

if TYPE_CHECKING:
    from babyrobot_levels.engine.tables import Ints
    from babyrobot_levels.envs.single import LevelLike

_Step = tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]


class LevelVectorEnv(RenderedVectorEnv):
    """Many robots walk levels to their exits, all in one call.

    Each environment is what `LevelEnv` is, under the time limit of its level: the same
    observations, actions, rewards and infos, in arrays with one row for each environment. All
    chance comes from one generator, `np_random`.

    Attributes:
        levels: the levels that are played.
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
            level: a name, a path, a mapping or a `Level`; or
            levels: several of them: environment i plays level `i % len(levels)`.
            num_envs: how many environments there are; by default, as many as levels.
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
            draw_levels: whether each episode is played in a level that is drawn.
            copy: whether what is returned belongs to the user. If not, it is always the same
                arrays, which the next step writes over.
            engine: `"numpy"`, `"compiled"`, or None for the fastest that is installed.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: a level is not valid.
            ImportError: the compiled engine is asked for and not installed.
            ValueError: another argument has a value that it cannot have.
        """
        check_choice("observation", observation, OBSERVATIONS)
        check_choice("actions", actions, ACTION_SETS)
        if render_mode is not None:
            check_choice("render_mode", render_mode, ("rgb_array",))
        if observation != "image" and (image_size is not None or grayscale):
            raise ValueError("image_size and grayscale go with observation='image'")
        self.levels = tuple(checked_levels(level, levels))
        default = len(self.levels) if num_envs is None else num_envs
        self.num_envs = checked_count("num_envs", default)
        self.render_mode = render_mode
        self._mode = checked_autoreset_mode(autoreset_mode)
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": RENDER_FPS,
            "autoreset_mode": self._mode,
        }
        self.single_action_space, first_action = make_action_space(actions)
        mdps = [each.compile() for each in self.levels]
        limits = limits_of(self.levels, max_episode_steps)
        self._tables = build_tables(mdps, limits, first_action, bool(draw_levels))
        self._robots = Robots(self.num_envs, len(self.levels))
        self._observer = make_batch_observer(
            self.levels, observation, checked_image_size(image_size), bool(grayscale)
        )
        self._engine = make_engine(engine, self._tables, self._observer.table, self.num_envs)
        self._most_draws = self.num_envs * self._tables.most_draws
        self._draws = Draws(self._most_draws)
        self.single_observation_space = self._observer.space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        known = (self._tables.masks, self._robots) if actions == "valid" else ()
        self.action_space = BatchActions(self._tables.num_actions, self.num_envs, *known)
        self._copy = bool(copy)
        self._signs = signs_of(self._tables.num_actions)
        self._numbers = self._observer.table.shape[1]
        self._all = np.ones(self.num_envs, np.bool_)
        self._results = self._new_results()
        self._has_begun = False

    @cached_property
    def _digests(self) -> NDArray[np.object_]:
        return np.array([level.digest for level in self.levels], object)

    def _new_results(self) -> Results:
        return Results(self.num_envs, self._numbers, self._signs)

    # -- playing ---------------------------------------------------------------------------

    def reset(
        self,
        *,
        seed: int | Sequence[int] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Begin episodes.

        Args:
            seed: for the generator that all environments share; a list of `num_envs` numbers
                seeds it with all of them together.
            options: `{"start": [x, y]}` begins at that cell; `{"reset_mask": mask}`, bool
                `[num_envs]`, leaves the environments without a True as they are.

        Returns:
            The observations, and an info with `action_mask` (int8 `[num_envs, actions]`),
            `level_digest` and, of several levels, `level_index` (int64 `[num_envs]`): which one
            each environment plays.

        Raises:
            ValueError: the robots cannot start at that cell, or the seed or the mask is none.
        """
        options = options or {}
        which = checked_reset_mask(options.get("reset_mask"), self.num_envs)
        starts = checked_starts(options.get("start"), self.levels)
        if which.size < self.num_envs and not self._has_begun:
            raise error.ResetNeeded("the first `reset()` must be of all environments")
        if seed is None or np.ndim(seed) == 0:
            super().reset(seed=seed)  # type: ignore[arg-type]
        else:
            self.np_random = np.random.default_rng(checked_seeds(seed, self.num_envs))
        robots, results = self._robots, self._new_results() if self._copy else self._results
        self._draws.reserve(self.np_random, self._most_draws)
        self._engine.begin(robots, which, self._draws)
        if starts is not None:
            level = robots.level[which]
            robots.state[which] = self._tables.offset[level] + starts[level]
        self._has_begun = True
        self._look(results, np.arange(self.num_envs))
        begun = np.zeros(self.num_envs, np.bool_)
        begun[which] = True
        results.words[~begun] = 0
        digests = np.full(self.num_envs, None, object)
        digests[which] = self._digests[robots.level[which]]
        info = self._told({"action_mask": results.signs["mask"], "level_digest": digests}, begun)
        return self._observer.batch(results, robots.state, self._copy), info

    def step(self, actions: Any) -> _Step:
        """Take an action in each environment.

        Args:
            actions: whole numbers, `[num_envs]`.

        Returns:
            Observations, rewards (float64 `[num_envs]`), terminated and truncated (bool
            `[num_envs]`), and an info with `action_mask` (int8 `[num_envs, actions]`),
            `target_reached`, `skidded` (bool `[num_envs]`), and beside each, under its name with
            `_` before it, in which environments it was said.

        Raises:
            ResetNeeded: no episode has begun, or one is over and nothing begins the next.
            InvalidAction: the action space does not contain the actions.
        """
        robots, engine, draws = self._robots, self._engine, self._draws
        if not self._has_begun:
            raise error.ResetNeeded("call `reset()` before the first `step()`")
        taken = checked_actions(actions, self.num_envs)
        if self._mode is AutoresetMode.DISABLED and robots.over.any():
            number = int(robots.over.argmax())
            raise error.ResetNeeded(
                f"the episode of environment {number} is over: call "
                "`reset(options={'reset_mask': terminated | truncated})`"
            )
        results = self._new_results() if self._copy else self._results
        draws.reserve(self.np_random, self._most_draws)
        if not engine.step(robots, taken, draws, results):
            self._refuse(taken)
        info = {}
        if self._mode is AutoresetMode.SAME_STEP:
            over = robots.over.nonzero()[0]
            if over.size:
                info = self._end(results, over)
        signs, acted = results.signs, results.acted
        info["action_mask"] = signs["mask"]
        info["_action_mask"] = self._all.copy() if self._copy else self._all
        info["target_reached"] = signs["reached"]
        info["_target_reached"] = acted
        info["skidded"] = signs["skidded"]
        info["_skidded"] = acted
        if len(self.levels) > 1:
            info["level_index"] = robots.level.copy()
            info["_level_index"] = info["_action_mask"]
        observations = self._observer.batch(results, robots.state, self._copy)
        return observations, results.rewards, results.terminated, results.truncated, info

    def action_masks(self) -> NDArray[np.int8]:
        """Return which actions are possible now, int8 `[num_envs, actions]`."""
        if not self._has_begun:
            raise error.ResetNeeded("call `reset()` before asking for the action masks")
        return self._tables.masks.take(self._robots.state, axis=0)

    def _look(self, results: Results, which: Ints) -> None:
        """Write what robots that have just begun are shown."""
        state = self._robots.state[which]
        results.words[which] = self._tables.standing[state]
        results.observations[which] = self._observer.table[state]

    def _told(self, values: dict[str, Any], where: NDArray[np.bool_]) -> dict[str, Any]:
        """Return values as an info, which says of each in which environments it holds."""
        if len(self.levels) > 1:
            values["level_index"] = np.where(where, self._robots.level, 0)
        return {**values, **{f"_{name}": where for name in values}}

    def _end(self, results: Results, over: Ints) -> dict[str, Any]:
        """Begin anew where episodes are over, and return an info of how they ended."""
        robots, words = self._robots, np.zeros_like(results.words)
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
