"""Verification of plays by the tables of their level and by their seed; and how likely they were.

Whether a play is genuine cannot be known: a cheat may look for a lucky seed, or tell none. What is
verified is that it can have happened, that its seed gives it, and how likely it was.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from babyrobot_levels.agents.decisions import Decisions, decisions_of
from babyrobot_levels.agents.plays import Play, read_plays, return_of
from babyrobot_levels.analysis.solver.distribution import ReturnDistribution, open_loop_distribution
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.analysis.solver.results import action_names
from babyrobot_levels.envs.arguments import start_states
from babyrobot_levels.envs.making import make_level
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.mdp.tables import Event, events_of
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import write_bytes
from babyrobot_levels.text.words import Telling

if TYPE_CHECKING:
    from babyrobot_levels.render.gif import Step
    from babyrobot_levels.render.raster import Progress

_EQUAL = 1e-9
"""Returns that differ by less, as a share of the sum of all rewards' sizes, count as equal."""


@dataclass(frozen=True, eq=False)
class Verification(Telling, public=True):
    """What the tables of a level say about a play.

    Attributes:
        play: the play.
        fault: why the play cannot have happened; None if it can.
        log_probability: the natural logarithm of the probability of all its outcomes, given its
            start and its actions; -inf if it cannot have happened.
    """

    play: Play
    fault: str | None
    log_probability: float

    @property
    def is_valid(self) -> bool:
        """Whether the play can have happened as it is told."""
        return self.fault is None

    @property
    def probability(self) -> float:
        """The probability of all its outcomes, given its start and its actions."""
        return math.exp(self.log_probability)

    @cached_property
    def distribution(self) -> ReturnDistribution | None:
        """The distribution of the return if the same actions are taken from the same start.

        They are taken in the same order, whatever comes of them; an episode that ends before the
        last one keeps its return. None for a play that is not valid, and where the exact
        distribution would take too long.
        """
        if self.fault is not None:
            return None
        play = self.play
        space = space_of(play.level, play.action_set)
        return open_loop_distribution(space, play.states[0], play.actions, play.discount)

    @property
    def expected_return(self) -> float | None:
        """The expected return under the same actions; None as for `distribution`."""
        found = self.distribution
        return None if found is None else found.mean

    @property
    def chance(self) -> float | None:
        """The probability of this return or a higher one under the same actions.

        1 where chance plays no part; the smaller, the luckier. None as for `distribution`.
        """
        found = self.distribution
        if found is None:
            return None
        at_least = found.values >= self.play.return_ - _margin(self.play)
        return min(1.0, float(found.probabilities[at_least].sum()))

    @cached_property
    def _decisions(self) -> Decisions:
        none = Decisions(math.nan, math.nan)
        return decisions_of(self.play) if self.fault is None else none

    @property
    def regret(self) -> float:
        """What the decisions of a valid play cost: what its actions lose against the best ones.

        It goes by expected returns, so that chance plays no part; the return is the optimum, less
        this, and `luck`. nan where the level has no optimum, or it takes too long to be found.
        """
        return self._decisions.regret

    @property
    def luck(self) -> float:
        """What chance added to a valid play, by its start and its outcomes; nan as `regret`."""
        return self._decisions.luck

    def to_gif(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        scale: float | None = None,
        progress: Progress | None = None,
    ) -> bytes:
        """Return a valid play as an animated GIF; a robot that turns is shown without its heading.

        Args:
            path: a file to write it to as well, atomically; an existing one is replaced.
            scale: the size; 1 is 64 pixels per cell. By default it is the largest up to 1 with
                which no side has more than 800 pixels.
            progress: told of the frames that are done.

        Raises:
            PlayError: the play is not valid.
            ValueError: the film is too large.
        """
        from babyrobot_levels.render.gif import to_gif

        if self.fault is not None:
            raise PlayError(f"the play is not valid: {self.fault}")
        film = to_gif(self.play.level, steps_of(self.play), scale=scale, progress=progress)
        if path is not None:
            write_bytes(Path(path), film)
        return film

    def __repr__(self) -> str:
        told = "valid" if self.fault is None else self.fault
        return f"<Verification: {told}, probability={self.probability:.4g}>"


class Replays(list[Verification]):
    """Episodes that were verified, in the order of their file."""

    __module__ = "babyrobot_levels"

    def __repr__(self) -> str:
        rows = (f"  {each.play!r}: {each.fault or 'valid'}" for each in self)
        return "\n".join([f"{len(self):,} episode{'s' * (len(self) != 1)}", *rows])


def replay(plays: str | os.PathLike[str] | Play | Iterable[Play]) -> Replays:
    """Verify recorded episodes by the tables of their level, as `babyrobot replay` does.

    The level of a play's share code must have its digest. Its start must be one of the level's,
    or, if it was chosen, a state in which episodes can be told to start. Each outcome must be
    possible after its action, and, if it has a seed, the one that this seed draws. The rewards
    must add up to its return, and its end must be the one told.

    Args:
        plays: the path of a `.brlplay` file, a `Play`, or several, as `read_plays` returns them.

    Returns:
        For each play whether it is valid, and how lucky it was; it has the play, and its film.

    Raises:
        OSError: the file cannot be read.
        PlayError: there is no file, or it is none of plays.
    """
    if isinstance(plays, Play):
        plays = [plays]
    elif isinstance(plays, str | os.PathLike):
        plays = read_plays(plays)
    return Replays(map(verify_play, plays))


def verify_play(play: Play) -> Verification:
    """Verify a play; see `replay`."""
    try:
        level = play.level
        if level.has_random_maze:
            return _refused(play, "its level has a random maze, without a seed")
        if level.digest != play.digest:
            return _refused(play, "its digest is not that of the level of its share code")
    except LevelError as error:
        reason = error.message or "; ".join(each.message for each in error.diagnostics)
        return _refused(play, f"its level cannot be read: {reason}")
    space = space_of(level, play.action_set)
    fault = _start_fault(play, space)
    if fault is not None:
        return _refused(play, fault)
    total = 0.0
    for step, chance in enumerate(_chances(play, space), 1):
        if chance is None:
            return _refused(play, f"step {step} is not possible: {_step_text(play, space, step)}")
        total += math.log(chance)
    fault = _end_fault(play, space) or _seed_fault(play, space)
    return _refused(play, fault) if fault is not None else Verification(play, None, total)


def _refused(play: Play, fault: str) -> Verification:
    return Verification(play, fault, -math.inf)


def _start_fault(play: Play, space: StateSpace) -> str | None:
    """Return why an episode cannot start where a play does; None if it can."""
    state, mdp = play.states[0], space.mdp
    if max(play.states) >= mdp.num_states:
        return f"it has a state {max(play.states):,}, and the level has {mdp.num_states:,} states"
    if play.start == "drawn":
        return None if mdp.start[state] > 0 else "no episode of the level starts in its first state"
    possible = False
    if not space.level.robots:
        with suppress(ValueError):
            possible = state in start_states(mdp.cell(state), space.level, mdp)
    return None if possible else "no episode can be told to start in its first state"


def _chances(play: Play, space: StateSpace) -> Iterator[float | None]:
    """Yield the probability of each outcome; None for one that is not possible."""
    mdp, first = space.mdp, space.first_action
    states, last = np.array(play.states), play.steps - 1
    for step, (action, reward) in enumerate(zip(play.actions, play.rewards, strict=True)):
        state, row = states[step], action + first
        if row >= mdp.num_actions or mdp.is_terminal[state]:
            yield None
            return
        is_it = (
            (mdp.next_state[state, row] == states[step + 1])
            & (mdp.reward[state, row] == reward)
            & (mdp.terminal[state, row] == (step == last and play.end == "terminated"))
        )
        chance = float(mdp.probability[state, row][is_it].sum())
        yield chance or None


def _step_text(play: Play, space: StateSpace, step: int) -> str:
    """Describe a step that is not possible."""
    before, after = (space.text(state) for state in play.states[step - 1 : step + 1])
    action, reward = play.actions[step - 1], play.rewards[step - 1]
    names = action_names(play.action_set, space.mdp)[space.first_action :]
    name = names[action] if action < len(names) else f"action {action}"
    ends = ", at the end of the episode" if step == play.steps and play.end == "terminated" else ""
    return f"{name} from {before} to {after} with the reward {reward:g}{ends}"


def _end_fault(play: Play, space: StateSpace) -> str | None:
    """Return what is wrong with the return or the end of a play; None if nothing is."""
    total = return_of(play.rewards, play.discount)
    if abs(total - play.return_) > _margin(play):
        return f"its rewards add up to a return of {total:.10g}, and not to {play.return_:.10g}"
    if play.max_steps is not None and play.steps > play.max_steps:
        return f"it has {play.steps:,} steps, more than its time limit of {play.max_steps:,}"
    is_late = play.steps == play.max_steps
    if play.end == "truncated" and not is_late:
        return "it was not truncated: it did not reach its time limit"
    if play.end == "unfinished" and is_late:
        return "it is not unfinished: it reached its time limit"
    return None


def _seed_fault(play: Play, space: StateSpace) -> str | None:
    """Return where a play leaves the episode of its seed; None if it does not, or has no seed.

    Pages draw the numbers that environments draw, and steps that were undone are drawn anew.
    """
    if play.seed is None:
        return None
    options = {} if play.level.robots else {"actions": play.action_set}
    env = make_level(play.level, observation="index", **options)
    start = {"start": space.mdp.cell(play.states[0])} if play.start == "chosen" else None
    env.reset(seed=int(play.seed), options=start)
    if env.state != play.states[0]:
        return f"with its seed {play.seed}, an episode starts in {space.text(env.state)}"
    for step, action in enumerate(play.actions, 1):
        _, reward, *_ = env.step(env.numbered_action(action))
        if (env.state, reward) != (play.states[step], play.rewards[step - 1]):
            drawn = f"leads to {space.text(env.state)} with the reward {reward:g}"
            return f"with its seed {play.seed}, step {step} {drawn}"
    return None


def _margin(play: Play) -> float:
    return _EQUAL * max(1.0, sum(map(abs, play.rewards)))


def steps_of(play: Play) -> list[Step]:
    """Return the steps of a valid play in the numbering of `level.compile()`.

    A robot that turns is shown without its heading.
    """
    from babyrobot_levels.render.gif import Step

    mdp = play.level.compile()
    cells = mdp.cells
    if play.action_set == "turns":
        size = mdp.cells * 4
        states = [state // size * cells + state % cells for state in play.states]
        headings = [state // cells % 4 for state in play.states]
        actions = [
            headings[step] + Action.NORTH if action == Turn.FORWARD else Action.STAY
            for step, action in enumerate(play.actions)
        ]
    else:
        states = play.states
        first = Action.NORTH if play.action_set == "moves" else Action.STAY
        actions = [action + first for action in play.actions]
    steps = []
    for number, (action, reward) in enumerate(zip(actions, play.rewards, strict=True)):
        state, after = states[number], states[number + 1]
        is_it = (mdp.probability[state, action] > 0) & (mdp.next_state[state, action] == after)
        event = events_of(mdp, slice(state, state + 1))[0, action][is_it.argmax()]
        own = int(mdp.robot_actions(action)[0]) if mdp.num_robots > 1 else int(action)
        steps.append(Step(state, own, after, reward, bool(event == Event.SKIDDED)))
    return steps
