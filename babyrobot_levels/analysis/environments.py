"""Environments of Gymnasium and MiniGrid: levels as such, and what levels are compared with."""

from __future__ import annotations

import contextlib
import importlib
import io
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.actions import Turn
from babyrobot_levels.mdp.gridworld import GridWorld, LevelLike, world_of
from babyrobot_levels.mdp.states import told
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.words import Telling

if TYPE_CHECKING:
    import gymnasium


def make(level: LevelLike, **kwargs: Any) -> gymnasium.Env[Any, Any]:
    """Return a level as a Gymnasium environment; `max_steps` becomes its time limit.

    Args:
        level: a name, a path, a share code, a mapping or a `Level`.
        kwargs: what `gymnasium.make("babyrobot/Level-v0", …)` takes beside `level`:
            `observation`, `actions`, `render_mode`, `image_size`, `grayscale`, `view_radius`,
            `see_through`, `channels_last`, `planes_dtype`. A `max_episode_steps` takes the
            place of the level's `max_steps`, -1 of any limit.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
    """
    import gymnasium

    return gymnasium.make("babyrobot/Level-v0", level=world_of(level), **kwargs)


class ComparisonError(BabyRobotError, ValueError, public=True):
    """What was given cannot be compared with a level."""


@dataclass(frozen=True)
class Certificate(Telling, public=True):
    """The result of comparing a level with another MDP.

    Attributes:
        equal: whether the two are equivalent: the same starts, and the same outcomes of all
            actions in all states that an episode reaches.
        actions: for each action of the other, the level's own number of it (`brl.Action`; three
            actions are left, right and forward). Where the MDPs differ, those under which they
            differ least; None if no actions were compared.
        states: the number of states whose outcomes were compared: those that an episode reaches,
            without the terminal ones.
        outcomes: the number of distinct outcomes of the level that were compared.
        everywhere: whether the states that no episode reaches agree as well.
        difference: the first difference as text; None if there is none.
        digest: the level's digest.
    """

    equal: bool
    actions: tuple[int, ...] | None
    states: int
    outcomes: int
    everywhere: bool
    difference: str | None
    digest: str


def made(env_id: str, kwargs: Mapping[str, Any] | None) -> Any:
    """Return an environment of Gymnasium.

    Raises:
        ComparisonError: it cannot be made.
    """
    import gymnasium

    try:
        return gymnasium.make(env_id, **(kwargs or {}))
    except gymnasium.error.Error as error:
        raise ComparisonError(str(error)) from error
    except Exception as error:  # An environment's own code can raise anything.
        message = f"{type(error).__name__}: {error}"
        raise ComparisonError(f"Gymnasium cannot make {env_id!r}: {message}") from error


MINIGRID = "minigrid:"
"""The prefix that marks the id of an environment of MiniGrid."""

_GROUND = ("wall", "goal", "lava", "floor")
"""What cannot be carried or opened."""

DIRECTIONS = "ESWN"
"""The sides in the order in which MiniGrid numbers directions."""


def made_minigrid(env_id: str, seed: int, kwargs: Mapping[str, Any] | None) -> Any:
    """Return an environment of MiniGrid after a reset, without its wrappers.

    Raises:
        ComparisonError: MiniGrid is not installed, or the environment cannot be made.
    """
    # MiniGrid prints while it draws a task, and Gymnasium warns of earlier versions.
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            importlib.import_module("minigrid")  # It registers its environments.
        except ModuleNotFoundError as error:
            message = "the package `minigrid` is not installed; add it with `pip install minigrid`"
            raise ComparisonError(message) from error
        env = made(env_id, kwargs).unwrapped
        if not is_minigrid(env):
            raise ComparisonError(f"{env_id} is not an environment of MiniGrid")
        env.reset(seed=seed)
    return env


def is_minigrid(env: Any) -> bool:
    """Return whether an environment, without its wrappers, is one of MiniGrid."""
    return any(kind.__name__ == "MiniGridEnv" for kind in type(env).__mro__)


def certify(level: GridWorld, env: Any) -> Certificate:
    """Compare a level with an environment of MiniGrid that was reset, state by state.

    The states are cells and headings, the actions left, right and forward. Compared are the next
    state, whether the episode ends, and whether it succeeds: on an exit here, with a reward there.
    The rewards themselves are not compared, because MiniGrid's shrink with each step. MiniGrid's
    other actions must change nothing. The environment is left in another state than before.

    Args:
        level: the level.
        env: the environment, without its wrappers.

    Raises:
        ComparisonError: the grid has objects.
    """
    _refuse_objects(env)
    mdp = level.compile().turning(level.heading)
    starts = mdp.start.nonzero()[0].tolist()
    pair = _Pair(level, mdp, env, starts[0])
    difference = pair.difference_of_starts(len(starts))
    actions = tuple(map(int, Turn))
    # The list grows while it is gone through.
    waiting = starts[:1]
    seen = set(waiting)
    states = outcomes = 0
    for state in waiting:
        if difference is not None:
            break
        if mdp.is_terminal[state]:
            continue
        states += 1
        difference = pair.difference_of_idling(state)
        for action in actions:
            difference = difference or pair.difference_of_outcomes(state, action)
            for _, after, _, _ in mdp.outcomes(state, action):
                outcomes += 1
                if after not in seen:
                    seen.add(after)
                    waiting.append(after)
    equal = difference is None
    return Certificate(equal, actions, states, outcomes, equal, difference, level.digest)


def _refuse_objects(env: Any) -> None:
    kinds = dict.fromkeys(each.type for each in env.grid.grid if each is not None)
    if objects := ", ".join(kind for kind in kinds if kind not in _GROUND):
        raise ComparisonError(
            f"the grid has objects ({objects}), which MiniGrid's own actions carry and open; only "
            "grids of walls, lava and goals are compared"
        )


@dataclass(frozen=True, slots=True)
class _Step:
    """What one action does; where an episode ends, the place does not matter."""

    cell: tuple[int, int]
    heading: str
    ends: bool
    succeeds: bool

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Step) and self._compared == other._compared

    def __hash__(self) -> int:
        return hash(self._compared)

    @property
    def _compared(self) -> tuple[Any, ...]:
        if self.ends:
            return (self.succeeds,)
        return self.cell, self.heading

    def __str__(self) -> str:
        if self.ends:
            return f"ends in {'success' if self.succeeds else 'failure'}"
        return f"{_cell(self.cell)} looking {self.heading}"


class _Pair:
    """A level and an environment, which is put into the states of the level."""

    def __init__(self, level: GridWorld, mdp: Mdp, env: Any, start: int):
        self.level, self.mdp, self.env, self.start = level, mdp, env, start
        self.exits = frozenset(level.exits)
        x, y = mdp.cell(start)
        # The level's cells may be counted from behind MiniGrid's outer walls.
        self.left, self.top = int(env.agent_pos[0]) - x, int(env.agent_pos[1]) - y

    def difference_of_starts(self, count: int) -> str | None:
        """Return how the starts differ, None if they do not; the cells define the offset."""
        if count > 1:
            return f"episodes start in {count} states in this level, in one in MiniGrid"
        ours, theirs = SIDES[self.mdp.heading(self.start)], DIRECTIONS[self.env.agent_dir]
        if ours != theirs:
            return f"episodes start looking {ours} in this level, looking {theirs} in MiniGrid"
        return None

    def difference_of_outcomes(self, state: int, action: int) -> str | None:
        """Return how the outcomes of an action differ, None if they do not."""
        theirs = self._stepped(state, action)
        ours = self._outcomes(state, action)
        if ours == [theirs]:
            return None
        told = "; ".join(map(str, ours))
        return (
            f"{self._where(state)}, {Turn(action).name.lower()}:\n"
            f"  this level: {told}\n"
            f"  MiniGrid:   {theirs}"
        )

    def difference_of_idling(self, state: int) -> str | None:
        """Return which other action of MiniGrid changes anything, None if none does."""
        before = _Step(self.mdp.cell(state), SIDES[self.mdp.heading(state)], False, False)
        for action in range(len(Turn), int(self.env.action_space.n)):
            if (after := self._stepped(state, action)) != before:
                return f"{self._where(state)}, action {action} of MiniGrid: {after}"
        return None

    def _outcomes(self, state: int, action: int) -> list[_Step]:
        """Return the distinct outcomes of an action of the level."""
        found: dict[_Step, None] = {}
        for _, after, _, ends in self.mdp.outcomes(state, action):
            cell = self.mdp.cell(after)
            heading = SIDES[self.mdp.heading(after)]
            found[_Step(cell, heading, ends, ends and cell in self.exits)] = None
        return list(found)

    def _stepped(self, state: int, action: int) -> _Step:
        """Return what an action of MiniGrid does in a state."""
        env = self.env
        x, y = self.mdp.cell(state)
        env.agent_pos = (x + self.left, y + self.top)
        env.agent_dir = DIRECTIONS.index(SIDES[self.mdp.heading(state)])
        env.step_count = 0
        _, reward, ends, _, _ = env.step(action)
        cell = (int(env.agent_pos[0]) - self.left, int(env.agent_pos[1]) - self.top)
        return _Step(cell, DIRECTIONS[env.agent_dir], bool(ends), reward > 0)

    def _where(self, state: int) -> str:
        return f"at {told(self.level, self.mdp, state)}"


def _cell(cell: tuple[int, int]) -> str:
    return f"[{cell[0]}, {cell[1]}]"
