"""Episodes that are told in words: each step is graded by the exact values of all actions."""

import base64
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.agents.plays import Play, play_of
from babyrobot_levels.analysis.solver.by_step import ValuesByStep
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.results import check_seed, check_within
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.envs.text import narrator_of
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.states import has_succeeded
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.render.sights import PICTURE, SIGHTS, Narrator, check_sight
from babyrobot_levels.text.words import Telling, check_choice

REWARDS = ("world", "advantage", "success")

_MAX_SEED = 2**31


@dataclass(frozen=True, slots=True)
class GradedMove(Telling, public=True):
    """A step of an episode, graded by the exact values of its action and its outcome.

    Attributes:
        state: the state before it, as in `level.compile()`.
        action: `"north"`, `"east"`, `"south"`, `"west"`, with `moves: 8` also `"north-east"` and so
            on, or `"stay"`; those of several robots are
            one text, `"east, stay"`.
        reward: the reward.
        advantage: the value of the action, less that of the best one: 0, or negative.
        luck: what chance added: the reward and the value of the next state, less the value of the
            action.
        is_blunder: whether the advantage is below the threshold of blunders.
        is_loop: whether the step led to a state in which the episode has been before.
    """

    state: int
    action: str
    reward: float
    advantage: float
    luck: float
    is_blunder: bool
    is_loop: bool


class GradedEpisode(Telling):
    """What the worlds of one robot and of several have in common: the episode, and its grades."""

    def __init__(
        self, level: Level, sight: str, reward: str, within: int | str | None, blunder: float
    ) -> None:
        """Take the arguments of `TextWorld`."""
        check_choice("sight", sight, (*SIGHTS, PICTURE))
        check_choice("reward", reward, REWARDS)
        self._sight, self._kind, self._limit, self._blunder = sight, reward, within, blunder
        self._seeds = np.random.default_rng()
        self._enter(level)
        self.seed: int | None = None
        self._begin()
        self.done = True

    # -- grades ----------------------------------------------------------------------------

    @property
    def moves(self) -> tuple[GradedMove, ...]:
        """The steps of the episode so far, graded."""
        return tuple(self._moves)

    @property
    def state(self) -> int:
        """The present state, as `level.compile()` numbers it; -1 before the first `reset`."""
        return self._env.state

    @property
    def largest_regret(self) -> float:
        """A bound of the regret that an episode can have."""
        values = self._stage.values
        return math.nan if values is None else values.largest_regret

    @property
    def return_(self) -> float:
        """The discounted sum of the rewards so far."""
        return self._totals[0]

    @property
    def regret(self) -> float:
        """What the moves so far have lost: the discounted sum of their advantages, negated."""
        return self._totals[1]

    @property
    def luck(self) -> float:
        """What chance has added so far: by the start that it drew, and by all outcomes."""
        return self._totals[2]

    @property
    def reward(self) -> float:
        """The reward of the episode so far, of the kind that was chosen."""
        if self._kind == "success":
            return float(self.is_success)
        return self.return_ if self._kind == "world" else 0.0 - self.regret

    @property
    def blunders(self) -> int:
        """How many moves were blunders."""
        return sum(move.is_blunder for move in self._moves)

    @property
    def loops(self) -> int:
        """How many moves led to a state in which the episode had been before."""
        return sum(move.is_loop for move in self._moves)

    @property
    def pixels(self) -> NDArray[np.uint8] | None:
        """The picture of the present state, uint8 `[height, width, 3]`, as environments render it.

        None with another sight than `"picture"`, and before the first `reset`.
        """
        if self._sight != PICTURE or self.state < 0:
            return None
        pixels: NDArray[np.uint8] = self._env.render()
        return pixels

    @property
    def picture(self) -> bytes | None:
        """The same picture as a PNG file; None where there are no `pixels`."""
        from babyrobot_levels.render.raster import pixels_to_png

        pixels = self.pixels
        return None if pixels is None else pixels_to_png(pixels)

    @property
    def data_url(self) -> str | None:
        """The same PNG file as a URL, as chat models take pictures; None where there is none."""
        picture = self.picture
        if picture is None:
            return None
        return f"data:image/png;base64,{base64.b64encode(picture).decode()}"

    @property
    def play(self) -> Play:
        """The episode so far, as `brl.replay` takes it.

        Raises:
            PlayError: there is no step yet.
        """
        if not self._moves:
            raise PlayError("the episode has no step yet")
        return play_of(
            self.level,
            self._stage.code,
            action_set="all",
            max_steps=self.within,
            seed=str(self.seed),
            start="drawn",
            states=[*(move.state for move in self._moves), self.state],
            actions=self._actions,
            rewards=[move.reward for move in self._moves],
            end="unfinished" if not self.done else "terminated" if self._ended else "truncated",
        )

    # -- episodes --------------------------------------------------------------------------

    def _make_env(self, level: Level) -> LevelEnv:
        """Return the environment of a level."""
        return LevelEnv(level, observation="index", actions="all", render_mode=self._render_mode)

    @property
    def _render_mode(self) -> str | None:
        return "rgb_array" if self._sight == PICTURE else None

    def _enter(self, level: Level) -> None:
        """Go over to a level."""
        check_sight(level, self._sight)
        limit = check_within("max_steps" if self._limit is None else self._limit, level.max_steps)
        assert limit is not None
        self._env = self._make_env(level)
        self._stage = _stage_of(level, self._sight, limit)
        self.within = limit
        values = self._stage.values
        self.level, self.optimum = level, math.nan if values is None else values.optimum
        if values is None and self._kind == "advantage":
            raise ValueError(
                "reward='advantage' is what moves lose to the optimum, which is not known where "
                "there are too many joint states for tables; use 'world' or 'success'"
            )

    def _reset(self, seed: int | None) -> None:
        """Start an episode, with a seed of its own if none is given."""
        check_seed(seed)
        self.seed = int(self._seeds.integers(_MAX_SEED)) if seed is None else int(seed)
        self._env.reset(seed=self.seed)
        self._begin()

    def _begin(self) -> None:
        values, state = self._stage.values, self.state
        value = math.nan if values is None or state < 0 else values.value(state, self.within)
        self._moves: list[GradedMove] = []
        self._actions: list[int] = []
        self.invalid, self.done, self._ended, self.is_success = 0, False, False, False
        self._visited = {state}
        # Where the optimum is not known, neither are regret and luck.
        nothing = 0.0 if values is not None else math.nan
        self._totals = 0.0, nothing, value - self.optimum if state >= 0 else nothing

    def _take(self, action: int, name: str) -> dict[str, Any]:
        """Take a step, and grade it.

        Args:
            action: the number of the action.
            name: what it is called.

        Returns:
            The environment's info.
        """
        values, before = self._stage.values, self.state
        _, reward, self._ended, _, info = self._env.step(self._env.numbered_action(action))
        after, left = self.state, self.within - len(self._moves)
        lost = luck = threshold = math.nan
        if values is not None:
            ended_in = None if self._ended else after
            lost, luck = values.graded(before, action, float(reward), ended_in, left)
            threshold = max(0.0, self._blunder * (self.optimum - values.random))
        move = GradedMove(
            state=before,
            action=name,
            reward=float(reward),
            advantage=0.0 - lost,
            luck=luck,
            is_blunder=lost > threshold,
            is_loop=after in self._visited,
        )
        self._visited.add(after)
        factor = self.level.discount ** len(self._moves)
        earned, missed, added = self._totals
        self._totals = (
            earned + factor * move.reward,
            missed + factor * lost,
            added + factor * move.luck,
        )
        self._moves.append(move)
        self._actions.append(action)
        self.done = self._ended or left == 1
        self.is_success = self._ended and self._is_success(after)
        return info

    def _is_success(self, state: int) -> bool:
        values, level = self._stage.values, self.level
        if values is not None:
            return bool(values.space.exits[state])
        return has_succeeded(level, level.configuration(level.numbering().configuration(state)))

    def _count(self) -> str:
        limit, steps = self.within, len(self._moves)
        reward = self._moves[-1].reward
        return f"Step {steps} of {limit}: reward {reward:g}, together {self.return_:g}."


@dataclass(frozen=True, eq=False)
class _Stage:
    """What follows from a level, a sight and a limit of steps: a narrator for each robot.

    There are no values where there are no tables.
    """

    narrators: tuple[Narrator, ...]
    values: ValuesByStep | None
    code: str

    @property
    def narrator(self) -> Narrator:
        return self.narrators[0]

    def shown(self, state: int) -> tuple[str, str]:
        """Return the rules, and what is seen in a state."""
        return self.narrator.rules(), self.narrator.scene(state)


@lru_cache(maxsize=32)
def _stage_of(level: Level, sight: str, limit: int) -> _Stage:
    """Return what worlds of the same kind share: trainers make many of them."""
    values = None
    if isinstance(level.numbering(), Mdp):
        values = ValuesByStep(space_of(level, "all"), limit, level.discount)
    told = level.model_copy(update={"max_steps": limit})
    robots = range(max(1, len(level.robots)))
    narrators = tuple(narrator_of(told, sight, robot) for robot in robots)
    return _Stage(narrators, values, level.share_code())
