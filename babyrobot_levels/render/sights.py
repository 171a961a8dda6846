"""What a player sees who gets a level as text: its rules, and the state of an episode.

There are three sights of text: the whole drawing (`map`), what can be seen around the robot
(`view`), or only sentences about the cells beside it (`words`). With a fourth one (`picture`), what
is where is left to the picture that goes with the text.
"""

import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.cells import as_skid
from babyrobot_levels.language.geometry import Cell, show_cell
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.configurations import Configuration
from babyrobot_levels.mdp.grid import BIT, door_sides
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.situation import look_of
from babyrobot_levels.render.text import PLAIN_ROBOT, TextPainter
from babyrobot_levels.render.text_plan import BOX, ITEMS, LOCKED, MOVER, ON_TARGET, TARGET
from babyrobot_levels.render.words import phrases
from babyrobot_levels.render.words.describe import around, goal_of, way_to_exit
from babyrobot_levels.render.words.rules import Rule, mover_names, rules_of, spoken, ways_of
from babyrobot_levels.text.words import listed

SIGHTS = ("map", "view", "words")

PICTURE = "picture"
"""The sight whose text does not tell what is where: a picture shows it."""

MAX_PICTURE = 64
"""The most columns, and rows, of a level that is seen as a picture."""

RADIUS = 3
"""How many cells far a view goes, and movers are told of in words."""

MAX_MAP = 64 * 64
"""The most cells of a level whose whole drawing is shown."""

_FEW = 8
"""So many cells of a kind are told one by one; more are told row by row."""

Seen = Callable[[int], frozenset[Cell]]
"""Returns the cells that the robot sees in a state."""

_SKIDS = {
    "open": "goes in another direction that is open, each equally often",
    "sides": "goes to the left or to the right of its direction, each equally often",
    "others": "goes in one of the three other directions, each equally often",
}


def robot_cells(level: GridWorld, state: int) -> tuple[Cell, ...]:
    """Return the cell of each robot in a state, as in `level.compile()`."""
    numbering = level.numbering()
    number = numbering.configuration(state)
    return (numbering.cell(state), *level.configuration(number).robots)


def check_sight(level: GridWorld, sight: str) -> None:
    """Check that a level is small enough for a sight.

    Raises:
        ValueError: its drawing, or its picture, is too large to be shown.
    """
    columns, rows = level.size
    if sight == "map" and columns * rows > MAX_MAP:
        raise ValueError(
            f"a level of {columns} x {rows} cells is too large for sight='map', which has "
            f"{MAX_MAP:,} cells at most; use sight='view'"
        )
    if sight == PICTURE and max(columns, rows) > MAX_PICTURE:
        raise ValueError(
            f"a level of {columns} x {rows} cells is too large for sight='picture', in which "
            f"cells are told apart up to {MAX_PICTURE} a side; use sight='view'"
        )


class Narrator:
    """Tells the rules of a level, and the states of its episodes.

    Args:
        level: the level; a maze needs a seed.
        sight: one of `SIGHTS`, or `PICTURE`.
        seen: for `view`, which cells the robot sees.
        robot: the number of the one to which it is told, of several.

    Raises:
        ValueError: the level is too large for its drawing, or its picture, to be shown.
    """

    def __init__(self, level: GridWorld, sight: str, seen: Seen, robot: int = 0) -> None:
        check_sight(level, sight)
        self._level, self._sight, self._seen, self._robot = level, sight, seen, robot
        self._painter = TextPainter(level, plain=True)
        self._rules = rules_of(level, drawn=sight == PICTURE)
        self._grounds = dict(self._named_cells())

    # -- rules -----------------------------------------------------------------------------

    def rules(self) -> str:
        """Return what there is to know of the level before an episode."""
        level = self._level
        columns, rows = level.size
        acting = "all robots act at once: each" if level.robots else "the robot"
        directions = [str(action) for action in [*Action][1 : 1 + level.moves]]
        lines = [
            f"{self._who()} on a grid of {phrases.counted(columns, 'column')} and "
            f"{phrases.counted(rows, 'row')}. Cells are [x, y]: x is the column, counted from 0 in "
            "the west, and y the row, counted from 0 in the north.",
            f"Goal: {goal_of(level)} What counts is the sum of all rewards{self._discounted()}.",
            f"In each step {acting} moves {listed(directions, 'or')}, or waits.",
            "Rules:",
            *(f"- {each}" for each in self._told_rules()),
        ]
        if self._sight in ("map", "view"):
            lines += ["Signs:", *(f"- {sign}  {what}" for sign, what in self._signs().items())]
        return "\n".join(lines)

    def _who(self) -> str:
        """Return which robots there are."""
        if not self._level.robots:
            return "A robot"
        own = spoken([self._level.robots[self._robot].name])
        return f"You are the robot {own}, with {listed(self._others())},"

    def _others(self) -> list[str]:
        """Return the names of the other robots."""
        names = [spoken([robot.name]) for robot in self._level.robots]
        return names[: self._robot] + names[self._robot + 1 :]

    def _discounted(self) -> str:
        rate = self._level.discount
        return "" if rate == 1 else f", each {rate:g} times what it would be one step earlier"

    def _told_rules(self) -> Iterator[str]:
        level = self._level
        for rule in self._rules:
            is_ground = rule.sample.startswith("cell:")
            if self._sight == "map" and is_ground:
                yield f"{rule.text} ({self._places(rule)})"
            elif rule.sample != "start" and not rule.text.startswith("discount "):
                yield rule.text
        yield self._precedence()
        what = "a wall or a closed door" if level.doors else "a wall"
        yield f"{what} refuses a move: the robot stays, and it counts as a step"
        given = [level.skid, *(area.skid for area in level.areas)]
        given += [getattr(level.puddle_types, each.size).skid for each in level.puddles]
        skids = [as_skid(skid) for skid in given if skid is not None]
        kinds = {skid.to for skid in skids if skid.probability}
        for kind in sorted(kinds):
            yield f"a move that skids{' sideways' * (kind == 'sides')} {_SKIDS[kind]}"
        if kinds:
            yield "whether a move skids depends on the cell that the robot leaves"
        if level.wind is not None:
            yield "the wind of the cell that the robot leaves pushes every move on"
        if level.items:
            yield "the robot takes what lies in a cell by coming there"
        if level.switches:
            yield "the robot flips a switch by coming to its cell"
        if level.boxes:
            yield (
                "the robot pushes a box by moving to its cell, if the cell behind it is free; "
                "else the box is a wall"
            )
        if level.movers:
            yield (
                "movers move in each step, after the robot, which meets those that are in its "
                "cell then, and those with which it has changed places"
            )
        paths = sys.maxsize if self._sight == "map" else 0
        walks = zip(level.movers, ways_of(level, longest=paths), strict=True)
        if self._sight != PICTURE:
            yield from (way for mover, way in walks if mover.within is not None or paths)

    def _precedence(self) -> str:
        """Return which of several rewards counts."""
        level, rewards = self._level, self._level.rewards
        known = {
            "meeting a mover": level.movers,
            "a warp": any(warp.reward is not None for warp in level.warps),
            "the exit": level.exits,
            "covering the last target": level.ends_covered,
            "an item": any(item.reward is not None for item in level.items),
            "waiting": rewards.stay is not None,
            "a refused move": rewards.bump is not None,
            "coming closer or going farther": (rewards.closer, rewards.farther) != (None, None),
        }
        told = [what for what, is_there in known.items() if is_there]
        order = [f"that of {what}" for what in told] + ["that of the cell in which it ends"]
        return f"a step has one reward, the first that applies: {', else '.join(order)}"

    def _signs(self) -> dict[str, str]:
        """Return what the characters of drawings mean."""
        level = self._level
        symbols = self._painter.symbols
        used = {sign for row in symbols for sign in row}
        signs = {PLAIN_ROBOT: "the robot"}
        signs |= {name[0].upper(): f"the robot {name}" for name in self._others()}
        if level.exits:
            signs[d.EXIT] = "the exit" if len(level.exits) == 1 else "an exit"
        if level.exit_keys:
            signs[LOCKED] = "an exit that is still locked"
        known = {d.START: "a start", d.SMALL: "a small puddle", d.LARGE: "a large puddle"}
        known[d.BLOCKED] = "a blocked cell"
        signs |= {sign: words for sign, words in known.items() if sign in used}
        for rule in self._rules:
            found = {symbols[y][x] for x, y in self._cells(rule)}
            is_own = len(found) == 1 and not found & {d.PLAIN, *known}
            if is_own and rule.sample.startswith("cell:"):
                signs.setdefault(found.pop(), _a(self._grounds[rule.cells[0]][0]))
        items: dict[str, list[str]] = defaultdict(list)
        for item in level.items:
            items[ITEMS[item.picture][1]].append(item.name)
        signs |= {sign: f"the {spoken(names)}" for sign, names in items.items()}
        if level.switches:
            signs |= {"0": "a switch that is off", "1": "a switch that is on"}
        if level.boxes:
            signs[BOX[1]] = "a box"
        if level.targets:
            what = "robot" if level.robots else "box"
            signs |= {TARGET[1]: "a target", ON_TARGET[1]: f"a {what} on a target"}
        if level.movers:
            pictures = dict.fromkeys(_a(mover.picture) for mover in level.movers)
            signs[MOVER[1]] = listed([*pictures], "or")
        signs["| ---"] = "a wall"
        if level.grid().glass:
            signs[": - -"] = "a glass wall"
        if level.doors:
            signs["/ -/-"] = "a closed door"
            also = " or a glass wall" if level.grid().glass else ""
            signs[": - -"] = f"an open door{also}"
        if self._sight == "view":
            signs["?"] = "a cell that is not seen"
        return signs

    def _places(self, rule: Rule) -> str:
        """Return where cells are: one by one, or row by row."""
        cells = self._cells(rule)
        if len(cells) <= _FEW:
            return f"at {phrases.cells(cells)}"
        rows: dict[int, list[int]] = defaultdict(list)
        for x, y in cells:
            rows[y].append(x)
        return "; ".join(f"row {y}: columns {phrases.ranges(xs)}" for y, xs in rows.items())

    def _cells(self, rule: Rule) -> list[Cell]:
        width = self._level.size[0]
        return [(cell % width, cell // width) for cell in rule.cells]

    def _named_cells(self) -> Iterator[tuple[int, list[str]]]:
        """Yield the cells that are not plain, with the names of what is there from the start."""
        told = [rule for rule in self._rules if rule.cells and rule.sample not in ("start", "exit")]
        names = Counter(rule.text.partition(":")[0] for rule in told)
        found: dict[int, list[str]] = defaultdict(list)
        for rule in told:
            name, _, effects = rule.text.partition(": ")
            is_clear = names[name] == 1 and name != "some cells"
            called = {"some cells": "cell", "blocked": "blocked cell"}.get(name, name)
            for cell in rule.cells:
                found[cell].append(called if is_clear else f"{called} ({effects})")
        yield from found.items()

    # -- states ----------------------------------------------------------------------------

    def scene(self, state: int) -> str:
        """Return what the robot sees in a state.

        Args:
            state: the configuration and the cell of the robot, as in `level.compile()`.
        """
        level = self._level
        now = level.configuration(level.numbering().configuration(state))
        told = level.things().told(now.values)
        has = [f"{met}: {spoken(names) or 'nothing'}" for met, names in told.items()]
        if self._sight == PICTURE:
            return "\n".join(["The picture shows what is where.", *has])
        cell = robot_cells(level, state)[self._robot]
        if self._sight == "map":
            lines = [
                *self._place(cell, now),
                *self._drawn(state),
                *_told("there", {at: self._contents(at, now) for at in self._covered(now)}),
                *self._movers(now, lambda _: True),
                *self._met(state, now, lambda _: True),
            ]
        elif self._sight == "view":
            seen = self._seen(state)
            in_order = sorted(seen, key=lambda at: (at[1], at[0]))
            lines = [
                *self._place(cell, now),
                *self._window(state, cell, seen),
                *_told("seen", {at: self._contents(at, now) for at in in_order}),
                *self._movers(now, seen.__contains__),
                *self._met(state, now, seen.__contains__),
            ]
        else:
            x, y = cell

            def is_near(at: Cell) -> bool:
                return abs(at[0] - x) + abs(at[1] - y) <= RADIUS

            lines = [
                *self._beside(cell, now),
                *self._movers(now, is_near),
                *self._met(state, now, is_near),
            ]
        own = level.robots[self._robot].exit if level.robots else None
        lines.append(way_to_exit(level, cell, now if own is None else replace(now, exits=(own,))))
        return "\n".join([*lines, *has])

    def _place(self, cell: Cell, now: Configuration) -> Iterator[str]:
        """Yield where the robot is, and what it hides in a drawing."""
        yield f"The robot is at {show_cell(cell)}, {around(self._level, cell, now)}."
        if here := self._contents(cell, now):
            yield f"here: {listed(here)}"

    def _drawn(self, state: int) -> list[str]:
        """Return the lines of the drawing, in which the robot has the mark of the only one."""
        if not self._robot:
            return self._painter.lines(state, held=False)
        level, number = self._level, self._level.numbering().configuration(state)
        lines = self._painter.lines(None, configuration=number, held=False)
        first, *_ = cells = robot_cells(level, state)
        marks = {first: level.robots[0].name[0].upper(), cells[self._robot]: PLAIN_ROBOT}
        if level.team.arrived == "leave" and level.configuration(number).arrived[0]:
            del marks[first]
        for (x, y), mark in marks.items():
            row, at = lines[2 * y + 1], 4 * x + 2
            lines[2 * y + 1] = f"{row[:at]}{mark}{row[at + 1 :]}"
        return lines

    def _met(self, state: int, now: Configuration, is_told: Callable[[Cell], bool]) -> list[str]:
        """Return where the other robots are."""
        cells = zip(self._level.robots, robot_cells(self._level, state), strict=False)
        return [
            f"{spoken([robot.name])} {'has arrived' if home else 'is'} at {show_cell(cell)}"
            for number, ((robot, cell), home) in enumerate(zip(cells, now.arrived, strict=True))
            if number != self._robot and is_told(cell)
        ]

    def _movers(self, now: Configuration, is_told: Callable[[Cell], bool]) -> Iterator[str]:
        """Yield where movers are, and where those on a path go next."""
        level = self._level
        phases = now.values[level.things().static :]
        movers = zip(level.movers, mover_names(level), now.movers, phases, strict=True)
        for mover, name, at, phase in movers:
            if not is_told(at):
                continue
            ahead = ""
            if mover.within is None:
                dx, dy = look_of(mover, phase)
                ahead = f", next at {show_cell((at[0] + dx, at[1] + dy))}"
            yield f"{name} is at {show_cell(at)}{ahead}"

    def _things(self, cell: Cell, now: Configuration) -> Iterator[str]:
        """Yield the items, switches, boxes and targets in a cell."""
        things = self._level.things()
        if cell in now.boxes:
            yield "a box"
        for item, at in zip(self._level.items, now.items, strict=True):
            if at == cell:
                yield f"the {spoken([item.name])}"
        for column, is_on in zip(things.fixed, now.on, strict=True):
            thing = things[column]
            if thing.entry.at == cell:
                yield f"the {spoken([things.names[column]])} ({thing.states[is_on]})"

    def _contents(self, cell: Cell, now: Configuration) -> list[str]:
        """Return what is in a cell, the robot and movers left out; nothing for a plain one."""
        found = [*self._things(cell, now)]
        if cell in now.exits:
            is_open = now.exit_is_open or not self._level.exit_keys
            found.insert(0, "the exit" if is_open else "the locked exit")
        number = cell[1] * self._level.size[0] + cell[0]
        return [*found, *map(_a, self._grounds.get(number, ()))]

    def _beside(self, cell: Cell, now: Configuration) -> Iterator[str]:
        """Yield what is in the robot's cell, and on its four sides."""
        level, grid = self._level, self._level.grid()
        place = cell[1] * grid.width + cell[0]
        doors = {side: now.doors[door] for at, side, door in door_sides(level, grid) if at == place}
        yield f"The robot is at {show_cell(cell)}."
        yield f"here: {listed(self._contents(cell, now)) or 'nothing'}"
        for name, side in SIDE_NAMES.items():
            before, other = "", grid.neighbour(place, side)
            if doors.get(side):
                yield f"{name}: a closed door"
                continue
            if (place, side) in grid.glass:
                before = "a glass wall, and behind it "
            elif other is None or not grid.open_bits[place] & BIT[side]:
                yield f"{name}: a wall"
                continue
            elif side in doors:
                before = "an open door, and behind it "
            assert other is not None
            y, x = divmod(other, grid.width)
            yield f"{name}: {before}{listed(self._contents((x, y), now)) or 'a free cell'}"

    def _window(self, state: int, cell: Cell, seen: frozenset[Cell]) -> Iterator[str]:
        """Yield the part of the drawing that is seen."""
        ranges = [
            range(max(0, at - RADIUS), min(size, at + RADIUS + 1))
            for at, size in zip(cell, self._level.size, strict=True)
        ]
        columns, rows = ranges
        yield f"columns {columns[0]} to {columns[-1]}, rows {rows[0]} to {rows[-1]}:"
        lines = self._drawn(state)
        for row in range(2 * rows.start, 2 * rows.stop + 1):
            shown = [*("  ? " if row % 2 else "    ") * columns.stop, " "]
            for x in {x for x, y in seen if y in ((row - 1) // 2, row // 2)}:
                span = slice(4 * x, 4 * x + 5)
                shown[span] = lines[row][span]
            if told := "".join(shown[4 * columns.start :]).rstrip():
                yield told

    def _covered(self, now: Configuration) -> Iterable[Cell]:
        """Return the cells whose sign in a drawing is that of a thing, which may hide others."""
        things = self._level.things()
        lying = [at for at in now.items if at is not None]
        switches = [things[column].entry.at for column in things.fixed]
        return dict.fromkeys([*lying, *switches, *now.boxes, *now.movers])


def _told(where: str, contents: Mapping[Cell, Iterable[str]]) -> Iterator[str]:
    """Yield a line that tells what is in some cells, if anything is."""
    places: dict[str, list[Cell]] = defaultdict(list)
    for cell, found in contents.items():
        for what in found:
            places[what].append(cell)
    if places:
        told = (f"{what} at {phrases.cells(cells)}" for what, cells in places.items())
        yield f"{where}: {'; '.join(told)}"


def _a(name: str) -> str:
    """Return a name with its article."""
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"
