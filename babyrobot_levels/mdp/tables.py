"""The exact tables, which everything that plays a level reads, what they mean, and their digest."""

from __future__ import annotations

import hashlib
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import IntEnum
from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.actions import HEADINGS, NUM_ACTIONS, Action, checked_number
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.grid import Grid, grid_with_doors
from babyrobot_levels.text import budget
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.words import Telling

Outcome = tuple[float, int, float, bool]
"""Probability, next state, reward, terminal."""

ToldOutcome = tuple[float, int, float, bool, int, bool]
"""Probability, next state, reward, terminal, `Event`, and whether a mover hits the robot."""

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.signedinteger[Any]]
"""Whatever the width of the numbers."""

FREE, REFUSED, GLASS = range(3)
"""What obstructs an action: nothing, a wall, or a wall of glass."""


MAX_WEIGHT = 10_000
"""The greatest weight of a start, times that of an exit."""


def _nothing_drawn() -> NDArray[np.int64]:
    return np.zeros(0, np.int64)


class Numbering(Telling):
    """How states are numbered: what tables have in common with what steps without any.

    Attributes:
        width: the number of columns of cells.
        height: the number of rows of cells.
        headings: 4 with turning, else 1.
        configurations: the value of each thing in each configuration, by its number.
        drawn: the sets of cells of which warps lead to one.
    """

    width: int
    height: int
    headings: int = 1
    configurations: Any
    drawn: Any

    @property
    @abstractmethod
    def num_configurations(self) -> int:
        """The number of configurations."""

    @property
    @abstractmethod
    def num_actions(self) -> int:
        """The number of actions, of several robots that of joint ones."""

    @property
    @abstractmethod
    def num_robots(self) -> int:
        """The number of robots."""

    @property
    @abstractmethod
    def starts(self) -> Ints:
        """The states in which episodes begin: with weights, each as often as it is drawn."""

    @property
    def cells(self) -> int:
        """The number of cells, blocked ones included."""
        return self.width * self.height

    @property
    def num_states(self) -> int:
        """The number of states, those of blocked cells included."""
        return self.num_configurations * self.headings * self.cells

    def robot_actions(self, joint: Any) -> Ints:
        """Return the action of each robot in joint actions, `[…, robots]`.

        Args:
            joint: their numbers, integers of any shape `[…]`; -1 for none gives -1 for each.

        Raises:
            ValueError: they are none.
        """
        numbers, count = np.asarray(joint)[..., np.newaxis], NUM_ACTIONS**self.num_robots
        if self.num_robots == 1:
            return numbers
        if numbers.dtype.kind not in "iu" or ((numbers < -1) | (numbers >= count)).any():
            raise ValueError(f"{joint!r} is not a joint action, 0 to {count - 1}")
        actions: Ints = numbers // NUM_ACTIONS ** np.arange(self.num_robots - 1, -1, -1)
        return np.where(numbers < 0, -1, actions % NUM_ACTIONS)

    def joint_action(self, actions: Any) -> Any:
        """Return the numbers of joint actions; the inverse of `robot_actions`.

        Args:
            actions: the action of each robot, integers `[…, robots]`.

        Raises:
            ValueError: they are none.
        """
        powers = NUM_ACTIONS ** np.arange(self.num_robots - 1, -1, -1)
        numbers = np.asarray(actions)
        is_whole = numbers.dtype.kind in "iu" and numbers.shape[-1:] == powers.shape
        if not is_whole or ((numbers < 0) | (numbers >= NUM_ACTIONS)).any():
            raise ValueError(
                f"{actions!r} is not an action, 0 to 4, of each of the {self.num_robots} robots"
            )
        return numbers @ powers

    def cell(self, state: int) -> tuple[int, int]:
        """Return the cell `(x, y)` of a state."""
        y, x = divmod(self._state(state) % self.cells, self.width)
        return x, y

    def configuration(self, state: int) -> int:
        """Return the number of a state's configuration, 0 without things."""
        return self._state(state) // (self.cells * self.headings)

    def heading(self, state: int) -> int:
        """Return the heading of a state, 0 N, 1 E, 2 S, 3 W; only with turning."""
        return self._state(state) // self.cells % self.headings

    def _state(self, state: Any) -> int:
        cell = f"that of the cell [x, y] is y * {self.width} + x"
        return checked_number("state", state, self.num_states, cell)


@dataclass(frozen=True, eq=False)
class Mdp(Numbering, public=True):
    """A finite Markov decision process whose states are the cells, numbered `y * width + x`.

    Of several robots, the actions are those of all, `[first robot, second robot, …]` as one number
    in base 5; the cell is that of the first, and the configuration tells where the others are.
    Outcomes that differ in `shares` are distinct, too.

    In a level with things, whose configurations are numbered, the state is
    `configuration * cells + y * width + x`; with turning (see `turning`) it is
    `(configuration * 4 + heading) * cells + y * width + x`.

    The tables are `[states, actions, outcomes]`. The outcomes of a state and action are distinct
    in (next state, reward, terminal), sorted by these, and their probabilities sum to one;
    rows with fewer outcomes than the longest are padded with probability 0. Where the episode
    is over, every action leads back with reward 0 and `terminal` set. Pairs of configuration and
    cell that no episode reaches count as over. A hit that ends the episode is told by `terminal`
    alone: the state that it leads to may be one in which an episode goes on.

    Attributes:
        width: the number of columns of cells.
        height: the number of rows of cells.
        probability: float64, `[states, actions, outcomes]`.
        next_state: int32, `[states, actions, outcomes]`.
        reward: float64, `[states, actions, outcomes]`.
        terminal: bool, `[states, actions, outcomes]`.
        start: float64, `[states]`: the probability of each state at reset.
        is_terminal: bool, `[states]`: whether the episode is over there.
        action_mask: int8, `[states, actions]`: 1 for the actions that nothing refuses.
        intended_next_state: int32, `[states, actions]`: where the action leads without chance;
            from the number of states on, to one of a set of cells in `drawn`: 0 is the starts.
            Its configuration and, of a move, its heading are those of before.
        obstruction: int8, `[states, actions]`: `FREE`, `REFUSED` or `GLASS`.
        configurations: int16, `[configurations, things]`: the value of each thing in each
            configuration, in rising order; `[1, 0]` without things.
        headings: 4 with turning, else 1.
        drawn: int64, in rising order: of each set of cells of which warps lead to one, its number
            times `cells` plus each cell; the first set is that of the starts.
        shares: float64, `[states, actions, outcomes, robots]`: what each of several robots gets, of
            which `reward` is the sum; None for one robot.
    """

    width: int
    height: int
    probability: NDArray[np.float64]
    next_state: NDArray[np.int32]
    reward: NDArray[np.float64]
    terminal: NDArray[np.bool_]
    start: NDArray[np.float64]
    is_terminal: NDArray[np.bool_]
    action_mask: NDArray[np.int8]
    intended_next_state: NDArray[np.int32]
    obstruction: NDArray[np.int8]
    configurations: NDArray[np.int16] = field(default_factory=lambda: np.zeros((1, 0), np.int16))
    headings: int = 1
    drawn: NDArray[np.int64] = field(default_factory=_nothing_drawn)
    shares: NDArray[np.float64] | None = None

    def __repr__(self) -> str:
        """Return the shapes of the tables; all numbers would be many pages."""
        shape = [*self.probability.shape]
        return (
            f"<Mdp: {self.width}x{self.height}; probability, next_state, reward, terminal {shape}, "
            f"action_mask {shape[:2]}, start {shape[:1]}>"
        )

    @property
    def starts(self) -> Ints:
        """The states in which episodes begin: with weights, each as often as it is drawn."""
        states = np.flatnonzero(self.start)
        shares = self.start[states] / self.start[states].min()
        if (shares == 1).all():
            return states
        counts = [Fraction(share).limit_denominator(MAX_WEIGHT) for share in shares.tolist()]
        common = lcm(*(count.denominator for count in counts))
        return np.repeat(states, [int(count * common) for count in counts])

    @property
    def num_configurations(self) -> int:
        """The number of configurations, 1 without things."""
        return len(self.configurations)

    @property
    def num_actions(self) -> int:
        """The number of actions: 5, or 9 with `moves: 8`, or 3 with turning.

        Of several robots, it is 5 to their number.
        """
        return int(self.probability.shape[1])

    @property
    def num_robots(self) -> int:
        """The number of robots."""
        return 1 if self.shares is None else int(self.shares.shape[3])

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of an array over states: `(height, width)`.

        With things the number of configurations comes first; with turning, 4 comes before height.
        """
        configurations = (self.num_configurations,) if self.configurations.shape[1] else ()
        headings = (self.headings,) if self.headings > 1 else ()
        return (*configurations, *headings, self.height, self.width)

    def turning(self, heading: str = "E") -> Mdp:
        """Return the tables of a robot that turns: 0 left, 1 right, 2 forward, and no stay.

        A turn is `stay` with another heading; forward is the move that way.

        Args:
            heading: where the robot looks at reset, N, E, S or W.

        Raises:
            ValueError: the heading is none of these; or the robot of these tables turns already.
            LevelError: it moves diagonally.
        """
        return _turning(self, heading)

    def outcomes(self, state: int, action: int) -> list[Outcome]:
        """Return what an action can lead to, as Gymnasium's toy_text tables list it."""
        state = self._state(state)
        action = checked_number("action", action, self.num_actions, "`brl.Action` has their names")
        chances = self.probability[state, action]
        count = int(np.count_nonzero(chances))
        return list(
            zip(
                chances[:count].tolist(),
                self.next_state[state, action, :count].tolist(),
                self.reward[state, action, :count].tolist(),
                self.terminal[state, action, :count].tolist(),
                strict=True,
            )
        )

    def to_toy_text(self, first_action: int = 0) -> dict[int, dict[int, list[Outcome]]]:
        """Return the tables as `{state: {action: [(probability, next state, reward, terminal)]}}`.

        Args:
            first_action: the action that becomes number 0: 1 leaves `stay` out.
        """
        first_action = checked_number("action", first_action, self.num_actions, "1 is without stay")
        return {
            state: {
                action - first_action: self.outcomes(state, action)
                for action in range(first_action, self.num_actions)
            }
            for state in range(self.num_states)
        }

    def freeze(self) -> Mdp:
        """Make all arrays read-only and return self: a table that all share must not change."""
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Mdp:
        return self

    def __setstate__(self, state: dict[str, Any]) -> None:
        # An array that comes from a pickle could be written to.
        self.__dict__.update(state)
        self.freeze()


def _turning(mdp: Mdp, heading: str) -> Mdp:
    """Return the tables with a heading in the state; see `Mdp.turning`."""
    if heading not in SIDES:
        raise ValueError(f"heading must be one of {', '.join(SIDES)}, not {heading!r}")
    if mdp.headings != 1:
        raise ValueError("the robot of these tables turns already")
    if mdp.num_robots > 1:
        raise ValueError("only the robot of a level with one can turn")
    if mdp.num_actions != NUM_ACTIONS:
        raise LevelError(message="the level has `moves: 8`, and robots that turn have four moves")
    count, cells = mdp.num_configurations, mdp.cells
    first = np.arange(HEADINGS)
    # The action of the level that each action comes to, and the heading after it.
    taken = np.stack([np.zeros(HEADINGS, int), np.zeros(HEADINGS, int), first + Action.NORTH], 1)
    after = np.stack([(first - 1) % HEADINGS, (first + 1) % HEADINGS, first], 1)

    def table(values: NDArray[Any]) -> NDArray[Any]:
        """Return `[states, actions, …]` of the level as that of the turning robot."""
        shaped = values.reshape(count, cells, *values.shape[1:])
        # [configurations, cells, headings, actions, …]
        chosen = np.moveaxis(shaped[:, :, taken], 2, 1)
        return np.ascontiguousarray(chosen).reshape(count * HEADINGS * cells, 3, *values.shape[2:])

    def headed(states: NDArray[np.signedinteger]) -> NDArray[np.int32]:
        """Return next states of the level, `[states, 3, …]`, with the heading after the action."""
        configuration, cell = np.divmod(states, cells)
        shape = (1, HEADINGS, 1, 3, *[1] * (states.ndim - 2))
        grouped = configuration.reshape(count, HEADINGS, cells, *states.shape[1:])
        numbers = (grouped * HEADINGS + after.reshape(shape)) * cells
        return (numbers.reshape(states.shape) + cell).astype(np.int32)

    over = np.broadcast_to(mdp.is_terminal.reshape(count, 1, cells), (count, HEADINGS, cells))
    over = np.ascontiguousarray(over).reshape(-1)
    itself = np.arange(over.size, dtype=np.int32)
    next_state = headed(table(mdp.next_state))
    next_state[over, :, 0] = itself[over, None]
    intended = table(mdp.intended_next_state)
    is_drawn = intended >= mdp.num_states
    target = np.where(
        is_drawn, intended - mdp.num_states + over.size, headed(np.where(is_drawn, 0, intended))
    )
    target[over] = itself[over, None]
    obstruction = table(mdp.obstruction)
    obstruction[:, :2] = FREE
    start = np.zeros((count, HEADINGS, cells))
    start[:, SIDES.index(heading)] = mdp.start.reshape(count, cells)
    return Mdp(
        width=mdp.width,
        height=mdp.height,
        probability=table(mdp.probability),
        next_state=next_state,
        reward=table(mdp.reward),
        terminal=table(mdp.terminal),
        start=start.reshape(-1),
        is_terminal=over,
        action_mask=table(mdp.action_mask),
        intended_next_state=target.astype(np.int32),
        obstruction=obstruction,
        configurations=mdp.configurations,
        headings=HEADINGS,
        drawn=mdp.drawn,
    ).freeze()


PART = 1 << 13
"""How many states are read or made at a time."""


def parts_of(states: int) -> Iterator[slice]:
    """Yield the states in parts: what is made of all their outcomes at a time needs much room."""
    return (slice(at, min(at + PART, states)) for at in range(0, states, PART))


DIGEST_VERSION = 1
_HEADER = f"babyrobot-levels game {DIGEST_VERSION}\n".encode("ascii")


def digest(level: LevelFields, grid: Grid, mdp: Mdp) -> str:
    """Return `sha256:` and 64 hex digits over the compiled level.

    The bytes are, all little-endian: the header with the version of this layout; width and
    height; the open sides and the blocked cells, a byte each; the walls of glass (cell, side,
    probability), sorted; the probability of each start; where the episode is over; and of each
    state and action the number of outcomes, then of all outcomes that can happen the
    probabilities, next states, rewards and terminal flags. With things there follow the word
    `things`, their number and that of configurations, the configurations, and the open sides in
    each of them. Names are no part of it.
    """
    budget.spend(10 * mdp.probability.size)
    hashed = hashlib.sha256(_HEADER)
    for part in _parts(level, grid, mdp):
        hashed.update(part if isinstance(part, bytes) else part.tobytes())
    return f"sha256:{hashed.hexdigest()}"


def _parts(level: LevelFields, grid: Grid, mdp: Mdp) -> Iterator[bytes | NDArray[Any]]:
    """Yield what is hashed, part by part: copies of large tables take much room."""
    sides = "NESW"
    glass = sorted((cell, sides.index(side), p) for (cell, side), p in grid.glass.items())
    yield np.array([grid.width, grid.height], "<u4")
    yield grid.open_bits
    yield grid.blocked_cells
    yield np.array([len(glass)], "<u4")
    yield np.array([(cell, side) for cell, side, _ in glass], "<u4")
    yield np.array([probability for _, _, probability in glass], "<f8")
    yield mdp.start.astype("<f8")
    yield mdp.is_terminal.astype("u1")
    parts = [*parts_of(mdp.num_states)]
    for part in parts:
        yield (mdp.probability[part] > 0).sum(axis=2).astype("<u4")
    for table, kind in (
        (mdp.probability, "<f8"),
        (mdp.next_state, "<u4"),
        (mdp.reward, "<f8"),
        (mdp.terminal, "u1"),
    ):
        for part in parts:
            yield table[part][mdp.probability[part] > 0].astype(kind)
    if level.has_things:
        yield from _things(level, grid, mdp)
    if mdp.shares is not None:
        yield b"robots\n"
        yield np.array([mdp.num_robots], "<u4")
        for part in parts:
            yield mdp.shares[part][mdp.probability[part] > 0].astype("<f8")


def _things(level: LevelFields, grid: Grid, mdp: Mdp) -> Iterator[bytes | NDArray[Any]]:
    things = Things(level)
    yield b"things\n"
    yield np.array([len(things), mdp.num_configurations], "<u4")
    yield mdp.configurations.astype("<i2")
    sides: dict[tuple[bool, ...], bytes] = {}
    for values in mdp.configurations.tolist():
        closed = things.closed(things.met(values))
        if closed not in sides:
            sides[closed] = grid_with_doors(level, grid, closed).open_bits
        yield sides[closed]


class Event(IntEnum):
    """What happens to the robot in an outcome of an action."""

    REACHED = 0
    """It ends up where the action leads without chance."""
    BUMPED = 1
    """A wall refuses the move, and it stays."""
    SKIDDED = 2
    """Chance takes it somewhere else."""
    BOUNCED = 3
    """A wall of glass does not let it through."""


ALL = slice(None)


def events_of(mdp: Mdp, states: slice = ALL) -> NDArray[np.int8]:
    """Return the `Event` of each outcome, int8 `[states, actions, outcomes]`.

    Only the robot's cell counts, not what happens to things. The events of padding, outcomes of
    probability 0, mean nothing.

    Args:
        mdp: the tables.
        states: the states whose outcomes are told.
    """
    obstruction = mdp.obstruction[states, :, None]
    intended = mdp.intended_next_state[states, :, None]
    return events(mdp, intended, obstruction, mdp.next_state[states])


def events(
    mdp: Numbering, intended: Ints, obstruction: NDArray[np.int8], next_state: Ints
) -> NDArray[np.int8]:
    """Return the `Event` of outcomes, by where actions lead without chance, and what hinders."""
    at_target = leads_to(mdp, intended, next_state)
    found: NDArray[np.int8] = _EVENTS.take(at_target * _ROW + obstruction)
    return found


def leads_to(mdp: Numbering, intended: Ints, next_state: Ints) -> Flags:
    """Return whether next states are in the cells to which actions lead without chance."""
    next_cell = next_state % mdp.cells
    found: Flags = next_cell == intended % mdp.cells
    is_drawn = intended >= mdp.num_states
    if is_drawn.any():
        where = np.broadcast_to(is_drawn, found.shape)
        number = np.broadcast_to(intended, found.shape)[where] - mdp.num_states
        found[where] = np.isin(number * np.int64(mdp.cells) + next_cell[where], mdp.drawn)
    return found


def hits_of(level: LevelFields, mdp: Mdp, states: slice = ALL) -> NDArray[np.bool_]:
    """Return which outcomes are hits, bool `[states, actions, outcomes]`.

    A mover hits the robot if they stand in one cell after the step, or have changed places in it.
    There are no hits where the episode is over. Those of padding mean nothing.

    Args:
        level: the level.
        mdp: its tables, with or without turning.
        states: the states whose outcomes are told.
    """
    hits = np.zeros(mdp.next_state[states].shape, np.bool_)
    goes_on = ~mdp.is_terminal[states]
    if level.movers:
        steps = _steps(mdp, states, goes_on)
        crowd = Crowded(np.stack([*_cells_of_movers(level, mdp)], axis=1), mdp.cells)
        hits[goes_on] = crowd.hits(*(each.ravel() for each in steps)).reshape(steps[-1].shape)
    return hits


def hits_by_mover(level: LevelFields, mdp: Mdp, states: slice = ALL) -> Iterator[NDArray[np.bool_]]:
    """Yield the hits of each mover in turn; see `hits_of`."""
    goes_on = ~mdp.is_terminal[states]
    before, here, after, there = _steps(mdp, states, goes_on)
    for cells in _cells_of_movers(level, mdp):
        budget.spend(10 * there.size)
        was, now = cells[before], cells[after]
        hits = np.zeros(mdp.next_state[states].shape, np.bool_)
        hits[goes_on] = (now == there) | ((now == here) & (was == there) & (here != there))
        yield hits


def _steps(mdp: Mdp, states: slice, goes_on: Flags) -> tuple[Ints, ...]:
    """Return, `[states, actions, outcomes]`, configuration and cell before a step and after it."""
    next_state = mdp.next_state[states][goes_on]
    state = np.arange(mdp.num_states)[states][goes_on]
    state = np.broadcast_to(state[:, None, None], next_state.shape)
    size, wide = mdp.cells, mdp.cells * mdp.headings
    return state // wide, state % size, next_state // wide, next_state % size


def _cells_of_movers(level: LevelFields, mdp: Mdp) -> Iterator[Ints]:
    """Yield for each mover its cell in each configuration: movers are the last things."""
    values = mdp.configurations[:, mdp.configurations.shape[1] - len(level.movers) :]
    for mover, phase in zip(level.movers, values.T, strict=True):
        yield np.array([y * mdp.width + x for x, y in mover.phases])[phase]


class Crowded:
    """Where movers stand, and whom they hit: as fast for many movers as for one.

    Args:
        cells: the cell of each mover, `[situations, movers]`.
        size: the number of cells.

    Attributes:
        stands: bool, `[situations, cells]`: whether some mover stands there.
    """

    def __init__(self, cells: Ints, size: int):
        self._cells, self._size = cells, size
        self.stands = np.zeros((len(cells), size), bool)
        np.put_along_axis(self.stands, cells, True, axis=1)

    def hits(self, before: Ints, here: Ints, after: Ints, there: Ints) -> Flags:
        """Tell which steps are hits: a mover comes to the robot's cell, or changes places with it.

        Args:
            before: the situation before the step.
            here: the robot's cell before it.
            after: the situation after it.
            there: the robot's cell after it.
        """
        stands, size = self.stands, self._size
        hit = stands[after, there]
        may_swap = stands[before, there] & stands[after, here] & (here != there)
        if may_swap.any():
            # Of each pair of situations that occurs, all moves, by the cells that they join.
            steps = before[may_swap].astype(np.int64) * len(stands) + after[may_swap]
            steps, which = np.unique(steps, return_inverse=True)
            budget.spend(10 * steps.size * self._cells.shape[1])
            was, now = (self._cells[each] for each in np.divmod(steps, len(stands)))
            moves = (np.arange(steps.size)[:, None] * size + was) * size + now
            hit[may_swap] |= np.isin(
                (which * size + there[may_swap]) * size + here[may_swap], moves
            )
        return hit


_ROW = np.int8(3)
_EVENTS = np.empty((2, _ROW), np.int8)
"""The events, by whether the robot ends up where the action leads, and by what hinders it."""
_EVENTS[0, [FREE, REFUSED, GLASS]] = Event.SKIDDED, Event.SKIDDED, Event.BOUNCED
_EVENTS[1, [FREE, REFUSED, GLASS]] = Event.REACHED, Event.BUMPED, Event.REACHED
