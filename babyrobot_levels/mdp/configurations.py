"""Configurations: the value of every thing of a level, and what they come to. Needs no NumPy.

Things count in this order: the drawn exit, items, switches, boxes by their cells, targets, robots,
movers; where nothing is said, as listed. A `Thing` says
all that compilers, words and pictures need to know of one; a kind of things with a state is a
function that makes them of its entries, and its line in `_MAKERS`. At the end: how many states and
outcomes there may be.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import comb, prod
from typing import Any

from babyrobot_levels.language.cells import RandomReward, gusts
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import Cell, blocked_cells
from babyrobot_levels.language.things import MAX_BOXED_STATES
from babyrobot_levels.text import budget
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import UnplayableError
from babyrobot_levels.text.words import Telling, listed

Values = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Thing:
    """What has a state: numbered values, and what each of them means.

    Attributes:
        kind: its kind, as in `language.kinds`.
        entry: the entry of the level that gives it; None for the drawn exit.
        name: its name; empty for one to which the program gives a name, by `usual_name`.
        cells: for each value, the cell in which it is, None where it is in none.
        states: for each value, the state in words, or the cell, where that is what changes.
        begins: the values with which an episode may begin, all equally probable.
        after: for each value, that after the robot arrives at its cell. Empty if arrivals change
            nothing.
        reward: the reward of the step that changes it; None if that of the cell counts.
        is_met: the value in which doors and exits that need it have it; None if none can need it.
        at_start: whether a robot that begins an episode at its cell arrives there.
        moves: whether its value changes by itself, at each step.
        usual_name: what the program calls one without a name.
    """

    kind: str
    entry: Any
    name: str
    cells: tuple[Cell | None, ...]
    states: tuple[str | Cell, ...]
    begins: Sequence[int]
    after: tuple[int, ...] = ()
    reward: float | None = None
    is_met: int | None = None
    at_start: bool = False
    moves: bool = False
    usual_name: str = ""

    @property
    def first_arrived(self) -> int:
        """The first value of a robot that says that it has arrived."""
        return self.states.index("arrived")

    @property
    def values(self) -> int:
        """How many values it has."""
        return len(self.states)

    @property
    def met(self) -> str:
        """Its state when doors and exits that need it have it, in words; empty if none can."""
        return "" if self.is_met is None else str(self.states[self.is_met])


def _drawn_exit(level: LevelFields) -> Iterator[Thing]:
    if (cells := level.exit_one_of) is not None:
        yield Thing("exit", None, "", cells, cells, range(len(cells)), usual_name="exit")


def _items(level: LevelFields) -> Iterator[Thing]:
    for item in level.items:
        held = len(item.places)
        yield Thing(
            "item",
            item,
            item.name,
            cells=(*item.places, None),
            states=(*(item.places if held > 1 else ["lies"]), "held"),
            begins=range(held),
            after=(held,) * (held + 1),
            reward=item.reward,
            is_met=held,
            at_start=True,
        )


def _switches(level: LevelFields) -> Iterator[Thing]:
    for switch in level.switches:
        flipped = (1, 0)
        if switch.once:
            flipped = (1, 1) if not switch.on else (0, 0)
        yield Thing(
            "switch",
            switch,
            switch.name,
            cells=(switch.at, switch.at),
            states=("off", "on"),
            begins=(int(switch.on),),
            after=flipped,
            is_met=1,
        )


def _boxes(level: LevelFields) -> Iterator[Thing]:
    """Yield the boxes: alike, so the first stands in the first cell, row by row."""
    width, height = level.size
    cells = tuple((x, y) for y in range(height) for x in range(width)) if level.boxes else ()
    numbers = sorted(y * width + x for x, y in (box.at for box in level.boxes))
    for number, (box, cell) in enumerate(zip(level.boxes, numbers, strict=True), 1):
        yield Thing("box", box, "", cells, cells, (cell,), usual_name=f"box-{number}")


def _targets(level: LevelFields) -> Iterator[Thing]:
    boxes = {*(box.at for box in level.boxes), *(level.starts if level.robots else ())}
    for number, target in enumerate(level.targets, 1):
        yield Thing(
            "target",
            target,
            target.name or "",
            cells=(target.at, target.at),
            states=("not covered", "covered"),
            begins=(int(target.at in boxes),),
            is_met=1,
            usual_name=f"target-{number}",
        )


def _robots(level: LevelFields) -> Iterator[Thing]:
    """Yield several robots.

    Where the first one is, the state tells as that of a single one; its value only says whether it
    has arrived. The values of the others are the cells, and after these the cells again, for those
    who have arrived there.
    """
    width, height = level.size
    every = tuple((x, y) for y in range(height) for x in range(width)) if level.robots else ()
    stays = level.team.arrived == "stay"
    for number, (robot, (x, y)) in enumerate(level.team_starts):
        if number == 0:
            yield Thing("robot", robot, robot.name, (None,) * 2, ("on the way", "arrived"), (0,))
            continue
        cells: tuple[Cell | None, ...] = (*every, *(every if stays else [None] * len(every)))
        states: tuple[str | Cell, ...] = (*every, *["arrived"] * len(every))
        yield Thing("robot", robot, robot.name, cells, states, (y * width + x,))


def _movers(level: LevelFields) -> Iterator[Thing]:
    for number, mover in enumerate(level.movers, 1):
        cells = mover.phases
        begins: Sequence[int] = (0,)
        if mover.within is not None:
            # Levels with faults are drawn, too: there, it may begin outside of its rectangle.
            begins = (cells.index(mover.start),) if mover.start in cells else range(len(cells))
        name = f"mover-{number}"
        yield Thing(
            "mover", mover, mover.name or "", cells, cells, begins, moves=True, usual_name=name
        )


_MAKERS: tuple[Callable[[LevelFields], Iterator[Thing]], ...] = (
    _drawn_exit,
    _items,
    _switches,
    _boxes,
    _targets,
    _robots,
    _movers,
)
"""Things in the order in which they count. Those that move by themselves come last."""


def _inert(thing: Thing) -> Thing:
    """Return a thing at which arrivals change nothing, and which nothing covers."""
    cells: tuple[Cell | None, ...] = (
        (None,) * thing.values if thing.kind == "target" else thing.cells
    )
    return replace(thing, after=(), at_start=False, cells=cells)


@dataclass(frozen=True, slots=True)
class Configuration(Telling, public=True):
    """What is where while the things of a level have certain values.

    Attributes:
        values: the value of each thing, in the order of `Things.names`.
        exits: the cells `(x, y)` that are exits in this episode.
        exit_is_open: whether an exit ends the episode: what it needs is held, or on.
        is_solved: whether all targets are covered, which ends the episode.
        items: for each item, the cell in which it lies, None while it is held.
        held: the names of the items that are held.
        on: for each thing of `Things.fixed`, whether it is on, or covered.
        boxes: the cells in which boxes stand, row by row.
        robots: for each of several robots but the first, the cell in which it is, or left.
        arrived: for each of several robots, whether it has arrived at its exit.
        movers: for each mover, the cell in which it stands.
        doors: for each door, whether it is closed.
    """

    values: Values
    exits: tuple[Cell, ...]
    exit_is_open: bool
    is_solved: bool
    items: tuple[Cell | None, ...]
    held: tuple[str, ...]
    on: tuple[bool, ...]
    boxes: tuple[Cell, ...]
    robots: tuple[Cell, ...]
    arrived: tuple[bool, ...]
    movers: tuple[Cell, ...]
    doors: tuple[bool, ...]


class Things(Telling, public=True):
    """The things of a level, and what their values mean.

    Args:
        level: the level.
        inert: the names of items and switches at which arrivals change nothing, and of targets that
            no box covers.

    Attributes:
        names: the name of each thing, each another: `exit` for a drawn exit; movers without a name
            are `mover-1`, `mover-2`, …. Where a thing has this name, they begin with `the-`.
        kinds: the kind of each thing, as in a drawing's legend: `"exit"`, `"item"`, `"mover"`, ….
        radices: how many values each thing has.
        fixed: the numbers of the things that stay in their cells: off or on, covered or not.
    """

    def __init__(self, level: LevelFields, inert: Collection[str] = ()):
        self.level = level
        self._each = tuple(
            _inert(thing) if thing.name in inert else thing
            for make in _MAKERS
            for thing in make(level)
        )
        taken = {thing.name for thing in self._each}

        def free(name: str) -> str:
            return free(f"the-{name}") if name in taken else name

        self.names = tuple(thing.name or free(thing.usual_name) for thing in self._each)
        self.kinds = tuple(thing.kind for thing in self._each)
        self.radices = tuple(thing.values for thing in self._each)
        self.fixed = tuple(
            n for n, thing in enumerate(self._each) if thing.met in ("on", "covered")
        )
        self.static = sum(not thing.moves for thing in self._each)
        self.needed = {
            name: (column, thing.is_met)
            for column, (name, thing) in enumerate(zip(self.names, self._each, strict=True))
            if thing.is_met is not None
        }

    def __len__(self) -> int:
        return len(self._each)

    def __iter__(self) -> Iterator[Thing]:
        return iter(self._each)

    def __getitem__(self, column: int) -> Thing:
        return self._each[column]

    @property
    def items(self) -> slice:
        """Where the values of items are."""
        return self.of_kind("item")

    def of_kind(self, kind: str) -> slice:
        """Return where the values of a kind of things are."""
        count = self.kinds.count(kind)
        first = self.kinds.index(kind) if count else 0
        return slice(first, first + count)

    def met(self, values: Sequence[int]) -> frozenset[str]:
        """Return the names of the things that are held or on."""
        return frozenset(
            name for name, (column, value) in self.needed.items() if values[column] == value
        )

    def closed(self, met: frozenset[str]) -> tuple[bool, ...]:
        """Return for each door whether it is closed, by the names of what is held or on."""
        return tuple(
            not met.issuperset(door.keys) or not met.isdisjoint(door.locks)
            for door in self.level.doors
        )

    def exits(self, values: Sequence[int]) -> tuple[Cell, ...]:
        """Return the exits of an episode, those that only one of several robots has included."""
        own = (robot.exit for robot in self.level.robots if robot.exit is not None)
        return tuple(dict.fromkeys((*self.common_exits(values), *own)))

    def common_exits(self, values: Sequence[int]) -> tuple[Cell, ...]:
        """Return the exits of an episode but those that only one of several robots has."""
        places = self.level.exit_one_of
        return self.level.common_exits if places is None else (places[values[0]],)

    def exit_is_open(self, values: Sequence[int]) -> bool:
        """Return whether an exit ends the episode: what it needs is held, or on.

        Args:
            values: the values of the things; those of movers may be missing.
        """
        return self.met(values).issuperset(self.level.exit_keys)

    def is_solved(self, values: Sequence[int]) -> bool:
        """Return whether all targets are covered, which ends the episode."""
        return self.level.ends_covered and all(values[self.of_kind("target")])

    def at(self, values: Sequence[int]) -> Configuration:
        """Return what is where while the things have these values, `[things]`."""
        values = tuple(int(value) for value in values)
        met = self.met(values)
        return Configuration(
            values=values,
            exits=self.exits(values),
            exit_is_open=self.exit_is_open(values),
            is_solved=self.is_solved(values),
            items=self._cells("item", values),
            held=tuple(name for name in self.names[self.items] if name in met),
            boxes=tuple(cell for cell in self._cells("box", values) if cell is not None),
            robots=self._robots(values),
            arrived=tuple(
                value >= thing.first_arrived
                for thing, value in zip(self._each, values, strict=True)
                if thing.kind == "robot"
            ),
            on=tuple(values[column] == self._each[column].is_met for column in self.fixed),
            movers=tuple(cell for cell in self._cells("mover", values) if cell is not None),
            doors=self.closed(met),
        )

    def _robots(self, values: Values) -> tuple[Cell, ...]:
        """Return where the robots but the first are, or were when they left."""
        width, height = self.level.size
        return tuple((at % width, at // width % height) for at in values[self.of_kind("robot")][1:])

    def _cells(self, kind: str, values: Values) -> tuple[Cell | None, ...]:
        """Return in which cell each thing of a kind is."""
        return tuple(
            thing.cells[value]
            for thing, value in zip(self._each, values, strict=True)
            if thing.kind == kind
        )

    def condition(self, values: Sequence[int]) -> str:
        """Return what is held and on, as words: `while key is held and lever is on`.

        It is empty where there is nothing that could be held or on.
        """
        met = self.told(values)
        if not met:
            return ""
        told = [
            f"{listed(names)} {'is' if len(names) == 1 else 'are'} {state}"
            for state, names in met.items()
            if names
        ]
        return "while " + (" and ".join(told) or f"nothing is {' or '.join(met)}")

    def told(self, values: Sequence[int]) -> dict[str, list[str]]:
        """Return the names of what is held and on: `{"held": ["key"], "on": []}`.

        Only what the level has something for is there.
        """
        met: dict[str, list[str]] = {}
        for name, (column, value) in self.needed.items():
            names = met.setdefault(self._each[column].met, [])
            names += [name] if values[column] == value else []
        return met

    def begins(self) -> list[Sequence[int]]:
        """Return for each thing its values at reset, before the robot takes anything."""
        return [thing.begins for thing in self._each]

    def draws(self) -> Iterator[Values]:
        """Yield the values with which episodes may begin, before the robot takes anything."""
        yield from product(*self.begins())

    def weight_of(self, values: Values) -> int:
        """Return how often an episode begins with some values, compared with others."""
        return self.level.weights_of_exits[values[0]] if self.level.exit_one_of else 1

    def beginnings(self) -> Iterator[tuple[Values, Cell, int]]:
        """Yield how episodes may begin: the values of things, the start, and its weight."""
        starts = [*zip(self.level.starts, self.level.weights_of_starts, strict=True)]
        for values in self.draws():
            for cell, weight in starts:
                yield self.taken_at_start(values, cell), cell, weight * self.weight_of(values)

    def taken_at_start(self, values: Values, cell: Cell) -> Values:
        """Return the values at reset: an item that lies under the start is held."""
        return tuple(
            thing.after[value] if thing.at_start and thing.cells[value] == cell else value
            for thing, value in zip(self._each, values, strict=True)
        )


def largest_radices(one: tuple[int, ...], other: tuple[int, ...]) -> tuple[int, ...]:
    """Return the larger value of each column; columns that only one has are kept."""
    count = min(len(one), len(other))
    return (*map(max, one[:count], other[:count]), *one[count:], *other[count:])


MAX_STATES = 2_000_000
"""The most states of a level with things; without, its size has a limit."""

MAX_OUTCOMES = 64
"""The most outcomes of one state and action of a level with things."""

MAX_WIDE_STATES = 5_000_000
"""The most states times the outcomes of the longest row: the tables keep that room."""

WAYS = 5
"""The most cells to which a mover in a rectangle may go in a step."""


def surely_fits(level: LevelFields) -> bool:
    """Return whether the fields alone show that the tables of a level are within the bounds.

    Then it can be compiled, unless doors or paths are cut by walls.
    """
    states, outcomes = level.size[0] * level.size[1], most_outcomes(level)
    if level.has_things:
        states *= _most_configurations(level)
        if states > most_states(level) or outcomes > MAX_OUTCOMES:
            return False
    return states * outcomes <= MAX_WIDE_STATES


def _most_configurations(level: LevelFields) -> int:
    """Return how many configurations there are at most, by the fields alone."""
    free = 0
    if level.boxes:
        is_blocked, (width, height) = blocked_cells(level), level.size
        free = sum(not is_blocked((x, y)) for y in range(height) for x in range(width))
    # Boxes are alike, each in another free cell, and decide which targets are covered.
    others = prod(thing.values for thing in Things(level) if thing.kind not in ("box", "target"))
    return comb(free, len(level.boxes)) * others


def most_states(level: LevelFields) -> int:
    """Return how many states a level with things may have."""
    return MAX_BOXED_STATES if level.boxes else MAX_STATES


def most_outcomes(level: LevelFields) -> int:
    """Return how many outcomes of an action there are at most, by the fields alone."""
    by_chance = (
        level.skid is not None
        or level.puddles
        or any(area.skid is not None for area in level.areas)
        or any(wall.pass_ for wall in level.walls)
    )
    wanderers = sum(mover.within is not None for mover in level.movers)
    shares = (level.moves if by_chance else 1) * len(gusts(level.wind)) * _most_leads(level)
    draws: int = _most_values(level) ** max(1, len(level.robots))
    return shares * prod([WAYS] * wanderers) * draws


def _most_values(level: LevelFields) -> int:
    """Return how many values a reward that is drawn has at most; 1 if there is none."""
    rewards = (area.reward for area in level.areas)
    return max((len(each.values) for each in rewards if isinstance(each, RandomReward)), default=1)


def _most_leads(level: LevelFields) -> int:
    """Return to how many ends warps lead from a cell at most, by the fields alone."""
    drawn = [
        warp for warp in level.warps if warp.probability < 1 or len(level.targets_of(warp)) > 1
    ]
    # A chain may end where any of them leads, or does not act, with the reward of any of them.
    ends = {cell for warp in drawn for cell in level.targets_of(warp)}
    ends |= {warp.at for warp in drawn if warp.probability < 1}
    if not drawn or all(isinstance(warp.to, str) and warp.probability == 1 for warp in drawn):
        return max(1, len(ends))
    leave = level.moves if any(warp.when == "leave" for warp in drawn) else 1
    ends |= {cell for warp in level.warps for cell in level.targets_of(warp)}
    return leave + len(ends) * (1 + len({warp.reward for warp in level.warps}))


def most_columns(level: LevelFields, states: int) -> int:
    """Return for how many outcomes tables of so many states have room while they are made."""
    most = int(min(MAX_WIDE_STATES, budget.entries()))
    return max(1, min(most_outcomes(level), most // states))


def check_room(level: LevelFields, states: int, width: int) -> None:
    """Check that tables do not need too much room.

    Raises:
        UnplayableError: they need more than those of any level may, or rows are too long.
        OverBudgetError: they need more than they may here.
    """
    if level.has_things and width > MAX_OUTCOMES:
        raise too_many_outcomes(level)
    if states * width <= MAX_WIDE_STATES:
        budget.check_tables(states, width, 1 + level.moves)
        return
    message = (
        f"the tables are too large: {states:,} states, and {width} outcomes of an action; "
        f"together at most {MAX_WIDE_STATES:,} are allowed"
    )
    field, help_text = "start", "use fewer starts, let warps lead to a cell, or use a smaller level"
    if not any(isinstance(warp.to, str) for warp in level.warps):
        field, help_text = "warps", "let warps lead to fewer cells, or use a smaller level"
    if _most_values(level) > 1:
        field, help_text = field_of(level, "areas"), "use fewer values of rewards"
    elif level.has_things:
        field = "movers" if level.movers else field_of(level, "items")
        help_text = "use fewer things that walk or skid at random, or a smaller level"
    raise UnplayableError([Issue("BR404", Key((field,)), message, help_text)])


def too_many_outcomes(level: LevelFields, ways: int = 0) -> UnplayableError:
    """Return the error that says why. `ways` is how many ways the movers alone have."""
    count = sum(mover.within is not None for mover in level.movers)
    wanderers = f"{count} mover{'s' * (count != 1)} in a rectangle"
    field, help_text = "movers", "use fewer movers, or let them walk a path"
    if ways:
        what = f"{wanderers} may go {ways:,} ways at once"
    elif count:
        what = f"those of a move, times the ways that {wanderers} may go"
    elif _most_values(level) > 1:
        what = "those of a move, times the values of rewards that are drawn"
        field, help_text = field_of(level, "areas"), "use fewer values"
    elif any(isinstance(warp.to, str) for warp in level.warps):
        what = f"a warp leads to one of {len(level.starts)} starts"
        field, help_text = "start", "use fewer starts, or let the warp lead to a cell"
    else:
        what = "warps lead to one of too many cells"
        field, help_text = "warps", "let them lead to fewer cells"
    message = f"an action has more than {MAX_OUTCOMES} outcomes: {what}"
    return UnplayableError([Issue("BR405", Key((field,)), message, help_text)])


def field_of(level: LevelFields, field: str) -> str:
    """Return the field that gives things: `legend` where they are drawn."""
    return "legend" if level._drawn.get(field) else field
