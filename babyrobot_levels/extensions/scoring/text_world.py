"""A level as a world of text, for agents that read and write: each move is graded exactly."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from babyrobot_levels.agents.plays import Play, play_of
from babyrobot_levels.analysis.solver.by_step import ValuesByStep
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.results import check_seed, check_within
from babyrobot_levels.envs.arguments import check_choice
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.envs.text import narrator_of
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.registry.own import own
from babyrobot_levels.render.sights import SIGHTS, Narrator
from babyrobot_levels.render.words.happenings import happenings
from babyrobot_levels.render.words.phrases import counted
from babyrobot_levels.text.words import Telling

REWARDS = ("world", "advantage", "success")

MOVES = {action.name.lower(): action for action in Action if action is not Action.STAY}
"""The moves by their directions."""

_MAX_SEED = 2**31


@dataclass(frozen=True, slots=True)
class GradedMove(Telling, public=True):
    """A step of an episode, graded by the exact values of its action and its outcome.

    Attributes:
        state: the state before it, as in `level.compile()`.
        action: `"north"`, `"east"`, `"south"`, `"west"` or `"stay"`.
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


class TextWorld(Telling, public=True):
    """A level that is played by text, with its rules in words and each move graded exactly.

    Its public methods are tools for a language model as they stand. What they cannot do is
    answered and counted; they raise no errors. An episode is over after `within` steps, and values
    are those of the best play within the steps that are left.

    The discounted sums of a whole episode satisfy `return_ - optimum == luck - regret`.

    Attributes:
        level: the level.
        within: the number of steps after which an episode is over.
        optimum: the optimal expected return of an episode.
        done: whether the episode is over; True before the first `reset`.
        is_success: whether the episode ended at an exit.
        invalid: how many calls could not be carried out in this episode: wrong directions, and
            moves after its end.
        seed: the seed of the episode.
    """

    def __init__(
        self,
        level: LevelLike,
        *,
        sight: str = "map",
        reward: str = "world",
        within: int | str | None = None,
        blunder: float = 0.1,
        tell_sure: bool = False,
    ) -> None:
        """Make the world of a level.

        Args:
            level: a name, a path, a share code, a mapping or a `Level`.
            sight: what is seen: `"map"`, the whole drawing; `"view"`, the cells that are seen up to
                three cells away; `"words"`, only what is beside the robot.
            reward: what `reward` is: `"world"`, the return; `"advantage"`, the sum of the
                advantages of all moves, which is minus the regret; `"success"`, 1 after an exit.
            within: the number of steps after which an episode is over; by default `max_steps` of
                the level, which must have one then.
            blunder: a move is a blunder if it loses more than this share of what the optimum is
                above the random policy.
            tell_sure: whether it is told with what is seen how sure one can be of everything, by
                all that was told in the episode; see `sure`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid, or its maze has no seed yet.
            ValueError: another argument is invalid, or the level is too large for its drawing, or
                to tell how sure one can be.
            EpisodeTooLongError: there are too many states and steps to grade moves.
        """
        check_choice("sight", sight, SIGHTS)
        check_choice("reward", reward, REWARDS)
        self._sight, self._kind, self._limit, self._blunder = sight, reward, within, blunder
        self._tell_sure = tell_sure
        self._seeds = np.random.default_rng()
        self._enter(load(level))
        self.seed: int | None = None
        self._begin()
        self.done = True

    def reset(self, *, seed: int | None = None, level: Any = None, **columns: Any) -> str:
        """Start an episode.

        Args:
            seed: draws start and outcomes; another one each time if it is left out.
            level: another level to go over to; by default, the present one.
            columns: what else a row of a data set has; nothing depends on it.

        Returns:
            The rules, and what the robot sees.
        """
        check_seed(seed)
        if level is not None:
            self._enter(load(level))
        self.seed = int(self._seeds.integers(_MAX_SEED)) if seed is None else int(seed)
        self._env.reset(seed=self.seed)
        self._begin()
        if self._tracker is not None:
            self._tracker.reset()
            self._tracker.observe((self._stage.shown(self.state), None))
        return f"{self._stage.narrator.rules()}\n\n{self.look()}"

    def move(self, direction: str) -> str:
        """Move the robot to the next cell.

        Args:
            direction: north, east, south or west.

        Returns:
            What happened, and what the robot sees now.
        """
        word = direction.strip().lower() if isinstance(direction, str) else None
        if word not in MOVES:
            self.invalid += 1
            return "That is no direction: move north, east, south or west. Nothing happened."
        return self._step(MOVES[word])

    def wait(self) -> str:
        """Let a step pass in which the robot stays where it is.

        Returns:
            What happened, and what the robot sees now.
        """
        return self._step(Action.STAY)

    def look(self) -> str:
        """Look around; that takes no step.

        Returns:
            What the robot sees.
        """
        if self.done:
            return self._over()
        scene = self._stage.narrator.scene(self.state)
        return scene if self._tracker is None else f"{scene}\n{_told_sure(self._tracker.sure)}"

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
    def sure(self) -> float | None:
        """How probable the likeliest state is for one who knows the level, by all that was told.

        It is that of the last step in which the episode went on. None unless it is told.
        """
        return None if self._tracker is None else self._tracker.sure

    @property
    def largest_regret(self) -> float:
        """A bound of the regret that an episode can have."""
        return self._stage.values.largest_regret

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
    def play(self) -> Play:
        """The episode so far, as `brl.replay` takes it.

        Raises:
            PlayError: there is no step yet.
        """
        if not self._moves:
            raise PlayError("the episode has no step yet")
        end = "unfinished" if not self.done else "terminated" if self._ended else "truncated"
        return play_of(
            self.level,
            self._stage.code,
            action_set="all",
            max_steps=self.within,
            seed=str(self.seed),
            start="drawn",
            states=[*(move.state for move in self._moves), self.state],
            actions=[Action[move.action.upper()].value for move in self._moves],
            rewards=[move.reward for move in self._moves],
            end=end,
        )

    # -- episodes --------------------------------------------------------------------------

    def _enter(self, level: Level) -> None:
        """Go over to a level."""
        given = "max_steps" if self._limit is None else self._limit
        limit = check_within(given, level.max_steps)
        assert limit is not None
        self._stage = _stage_of(level, self._sight, limit)
        self.within = limit
        self.level, self.optimum = level, self._stage.values.optimum
        self._tracker = _tracker_of(level, self._sight, limit) if self._tell_sure else None
        self._env = LevelEnv(level, observation="index", actions="all")

    def _begin(self) -> None:
        values, state = self._stage.values, self.state
        self._moves: list[GradedMove] = []
        self.invalid, self.done, self._ended, self.is_success = 0, False, False, False
        self._visited = {state}
        by_start = values.value(state, self.within) - self.optimum if state >= 0 else 0.0
        self._totals = 0.0, 0.0, by_start

    def _step(self, action: Action) -> str:
        if self.done:
            self.invalid += 1
            return self._over()
        values, before = self._stage.values, self.state
        _, reward, self._ended, _, info = self._env.step(int(action))
        after, left = self.state, self.within - len(self._moves)
        lost, luck = values.graded(
            before, action, float(reward), None if self._ended else after, left
        )
        move = GradedMove(
            state=before,
            action=action.name.lower(),
            reward=float(reward),
            advantage=0.0 - lost,
            luck=luck,
            is_blunder=lost > max(0.0, self._blunder * (self.optimum - values.random)),
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
        self.done = self._ended or left == 1
        self.is_success = self._ended and bool(values.space.exits[after])
        told = [
            *happenings(
                self.level,
                before,
                action,
                after,
                skidded=info["skidded"],
                target_reached=info["target_reached"],
                hit=info.get("hit", False),
            )
        ]
        if self._tracker is not None and not self.done:
            signal = " ".join([*told, f"reward {move.reward:g}"])
            self._tracker.observe((self._stage.shown(after), signal), int(action))
        told.append(self._count())
        return "\n".join([" ".join(told), self.look()])

    def _count(self) -> str:
        limit, steps = self.within, len(self._moves)
        reward = self._moves[-1].reward
        return f"Step {steps} of {limit}: reward {reward:g}, together {self.return_:g}."

    def _over(self) -> str:
        if not self._moves:
            return "There is no episode: reset the world to begin one."
        where = "for want of steps"
        if self._ended:
            cell = self.level.compile().cell(self.state)
            where = "at the exit" if self.is_success else f"at {show_cell(cell)}"
        steps = counted(len(self._moves), "step")
        return f"The episode is over: it ended {where} after {steps}, with {self.return_:g} in all."


@dataclass(frozen=True, eq=False)
class _Stage:
    """What follows from a level, a sight and a limit of steps."""

    narrator: Narrator
    values: ValuesByStep
    code: str

    def shown(self, state: int) -> tuple[str, str]:
        """Return the rules, and what is seen in a state."""
        return self.narrator.rules(), self.narrator.scene(state)


@lru_cache(maxsize=32)
def _stage_of(level: Level, sight: str, limit: int) -> _Stage:
    """Return what worlds of the same kind share: trainers make many of them."""
    values = ValuesByStep(space_of(level, "all"), limit, level.discount)
    told = level.model_copy(update={"max_steps": limit})
    return _Stage(narrator_of(told, sight), values, level.share_code())


def _tracker_of(level: Level, sight: str, limit: int) -> Any:
    """Return what follows the belief of one who reads a world's texts and knows the level."""
    return own("tracker_of")(level, f"text-{sight}", limit)


def _told_sure(sure: float) -> str:
    if sure > 1 - 1e-9:
        return "One can know how everything stands."
    share = "over 99 %" if sure > 0.995 else f"{100 * sure:.0f} %" if sure >= 0.005 else "under 1 %"
    return f"By what was told, one can be {share} sure how everything stands."
