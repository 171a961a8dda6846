"""A level as a world of text, for agents that read and write: each move is graded exactly."""

from typing import Any

from babyrobot_levels.analysis.solver.results import check_seed
from babyrobot_levels.extensions.scoring.graded import GradedEpisode
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.registry.own import own
from babyrobot_levels.render.sights import PICTURE
from babyrobot_levels.render.words.happenings import happenings
from babyrobot_levels.render.words.phrases import counted
from babyrobot_levels.text.words import listed

MOVES = {str(action): action for action in Action if action is not Action.STAY}
"""The moves by their directions; a level may have only the first four."""


class TextWorld(GradedEpisode, public=True):
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
                three cells away; `"words"`, only what is beside the robot; `"picture"`, the picture
                in `picture` and `pixels`: the text then tells rules and what happens, and no map.
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
            ValueError: another argument is invalid, or the level is too large for its drawing or
                picture, or to tell how sure one can be, which is not told of pictures.
            EpisodeTooLongError: there are too many states and steps to grade moves.
        """
        if tell_sure and sight == PICTURE:
            raise ValueError("tell_sure is for sights of text, not for sight='picture'")
        self._tell_sure = tell_sure
        super().__init__(load(level), sight, reward, within, blunder)

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
        self._reset(seed)
        if self._tracker is not None:
            self._tracker.reset()
            self._tracker.observe((self._stage.shown(self.state), None))
        return f"{self._stage.narrator.rules()}\n\n{self.look()}"

    def move(self, direction: str) -> str:
        """Move the robot to the next cell.

        Args:
            direction: north, east, south or west; in levels with `moves: 8` also north-east,
                south-east, south-west or north-west.

        Returns:
            What happened, and what the robot sees now.
        """
        word = direction.strip().lower() if isinstance(direction, str) else None
        if word not in self.directions:
            self.invalid += 1
            return f"That is no direction: move {listed(self.directions, 'or')}. Nothing happened."
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

    @property
    def directions(self) -> tuple[str, ...]:
        """The directions that `move` takes: four, or eight with `moves: 8`."""
        return (*MOVES,)[: self.level.moves]

    @property
    def sure(self) -> float | None:
        """How probable the likeliest state is for one who knows the level, by all that was told.

        It is that of the last step in which the episode went on. None unless it is told.
        """
        return None if self._tracker is None else self._tracker.sure

    # -- episodes --------------------------------------------------------------------------

    def _enter(self, level: Level) -> None:
        super()._enter(level)
        self._tracker = _tracker_of(level, self._sight, self.within) if self._tell_sure else None

    def _step(self, action: Action) -> str:
        if self.done:
            self.invalid += 1
            return self._over()
        before = self.state
        info = self._take(int(action), str(action))
        after = self.state
        told = [
            *happenings(
                self.level,
                before,
                action,
                after,
                skidded=info["skidded"],
                target_reached=info["target_reached"],
                hit=info.get("hit", False),
                drawn=self._sight == PICTURE,
            )
        ]
        if self._tracker is not None and not self.done:
            signal = " ".join([*told, f"reward {self._moves[-1].reward:g}"])
            self._tracker.observe((self._stage.shown(after), signal), int(action))
        told.append(self._count())
        return "\n".join([" ".join(told), self.look()])

    def _over(self) -> str:
        if not self._moves:
            return "There is no episode: reset the world to begin one."
        where = "for want of steps"
        if self._ended:
            cell = self.level.compile().cell(self.state)
            where = "at the exit" if self.is_success else f"at {show_cell(cell)}"
        steps = counted(len(self._moves), "step")
        return f"The episode is over: it ended {where} after {steps}, with {self.return_:g} in all."


def _tracker_of(level: Level, sight: str, limit: int) -> Any:
    """Return what follows the belief of one who reads a world's texts and knows the level."""
    return own("tracker_of")(level, f"text-{sight}", limit)


def _told_sure(sure: float) -> str:
    if sure > 1 - 1e-9:
        return "One can know how everything stands."
    share = "over 99 %" if sure > 0.995 else f"{100 * sure:.0f} %" if sure >= 0.005 else "under 1 %"
    return f"By what was told, one can be {share} sure how everything stands."
