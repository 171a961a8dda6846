"""A slow reference implementation of the language, with things, written from its documents alone.

It works on the plain data of a level, as `yaml.safe_load` gives it, and imports nothing of the
package. Everything is a dictionary, a list or a loop: it is meant to be checked by reading it, and
to be compared with the compiled tables. It takes valid levels without `map`, `legend` and `maze`,
and checks nothing.

The words are those of the document: a *thing* is the drawn exit, an item, a switch, a box, a
target or a mover; a
*configuration* is the value of every thing; a *pair* is a configuration and a cell.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

Cell = tuple[int, int]
Configuration = tuple[int, ...]
Pair = tuple[Configuration, Cell]
Side = frozenset[Cell]
"""The side between two neighbouring cells."""
Outcome = tuple[float, int, float, bool]
"""Probability, next state, reward, and whether the episode is over: as in the tables."""

STAY, NORTH, EAST, SOUTH, WEST, NORTH_EAST, SOUTH_EAST, SOUTH_WEST, NORTH_WEST = range(9)
LEFT, RIGHT, FORWARD = range(3)
MOVES = (NORTH, EAST, SOUTH, WEST)
STEPS: dict[int, Cell] = {NORTH: (0, -1), EAST: (1, 0), SOUTH: (0, 1), WEST: (-1, 0)}
AROUND = {
    NORTH_EAST: (NORTH, EAST),
    SOUTH_EAST: (SOUTH, EAST),
    SOUTH_WEST: (SOUTH, WEST),
    NORTH_WEST: (NORTH, WEST),
}
"""The two directions of a diagonal move."""
STEPS |= {NORTH_EAST: (1, -1), SOUTH_EAST: (1, 1), SOUTH_WEST: (-1, 1), NORTH_WEST: (-1, -1)}
OPPOSITE = {NORTH: SOUTH, SOUTH: NORTH, EAST: WEST, WEST: EAST}
SIDES = {"N": NORTH, "E": EAST, "S": SOUTH, "W": WEST}

PUDDLE_REWARD = {"small": -2, "large": -4}
PUDDLE_SKID = {"small": 0.4, "large": 0.6}


class Warp(NamedTuple):
    """A warp, with its targets and how likely each is, if it acts."""

    targets: dict[Cell, float]
    when: str
    reward: float | None
    probability: float


class Door(NamedTuple):
    """What opens a door, and what closes it: names of items and switches."""

    needs: list[str]
    unless: list[str]


class Landing(NamedTuple):
    """Where a step takes the robot (steps 1 to 7), and what matters there for the reward."""

    probability: float
    cell: Cell
    sent: bool = False  # by a warp
    warp_reward: float | None = None
    bumped: bool = False
    bounced: bool = False
    boxes: tuple[Cell, ...] = ()


class Result(NamedTuple):
    """What a step leads to, before states are numbered."""

    probability: float
    pair: Pair
    reward: float
    over: bool


def cell_of(value: Sequence[int]) -> Cell:
    """Return a cell as a tuple."""
    x, y = value
    return x, y


def cells_of(value: Any) -> list[Cell]:
    """Return the cells of a field that is a cell, a list of cells, or `none`."""
    if value is None or value == "none":
        return []
    if isinstance(value[0], int):
        return [cell_of(value)]
    return [cell_of(each) for each in value]


def names_of(value: Any) -> list[str]:
    """Return the names of a field that is a name or a list of names."""
    if value is None:
        return []
    return [value] if isinstance(value, str) else list(value)


def shares_of(cells: Sequence[Cell], weights: Sequence[float] | None) -> dict[Cell, float]:
    """Return how likely each of several cells is."""
    found: dict[Cell, float] = {}
    for cell, weight in zip(cells, weights or [1] * len(cells), strict=True):
        found[cell] = found.get(cell, 0.0) + weight / sum(weights or [1] * len(cells))
    return found


def stronger(push: int, more: int) -> int:
    """Return a push that is so many cells stronger, if there is one."""
    return push + more if push > 0 else push - more if push < 0 else 0


def rectangle(entry: Mapping[str, Any]) -> list[Cell]:
    """Return the cells of a rectangle, row by row."""
    x, y = entry["at"]
    width, height = entry.get("size", (1, 1))
    return [(x + dx, y + dy) for dy in range(height) for dx in range(width)]


def neighbour(cell: Cell, direction: int) -> Cell:
    """Return the cell beside another one, which may lie off the grid."""
    dx, dy = STEPS[direction]
    return cell[0] + dx, cell[1] + dy


def sides_of(entry: Mapping[str, Any]) -> list[Side]:
    """Return the sides that an entry of `walls`, `openings` or `doors` covers."""
    x, y = entry["at"]
    direction = SIDES[entry["side"]]
    dx, dy = (1, 0) if direction in (NORTH, SOUTH) else (0, 1)
    cells = [(x + dx * index, y + dy * index) for index in range(entry.get("length", 1))]
    return [frozenset((cell, neighbour(cell, direction))) for cell in cells]


def skid_of(value: Any) -> tuple[float, str]:
    """Return probability and rule of a skid."""
    if isinstance(value, Mapping):
        return value["probability"], value.get("to", "open")
    return value, "open"


def phases_of(mover: Mapping[str, Any]) -> list[Cell]:
    """Return where a mover with a path stands in each of its phases."""
    path = [cell_of(each) for each in mover["path"]]
    if mover.get("back", False):
        return path + path[-2:0:-1]
    return path


def merged(results: Sequence[Outcome]) -> list[Outcome]:
    """Add the probabilities of equal outcomes, and sort by next state, reward and the end."""
    total: dict[tuple[int, float, bool], float] = {}
    for probability, state, reward, over in results:
        if probability > 0:
            key = (state, reward, over)
            total[key] = total.get(key, 0.0) + probability
    return [(total[key], *key) for key in sorted(total)]


class Reference:
    """The tables of a level with things, computed in the plainest way.

    Attributes:
        names: The name of every thing, the most significant first; "exit" is the drawn exit.
        radices: The number of values of every thing.
        configurations: Those that can occur, in ascending order of their mixed-radix value.
        num_cells: Width times height.
        num_states: The number of configurations times that of cells.
        start: The probability of every state in which an episode may begin.
    """

    def __init__(self, fields: Mapping[str, Any]) -> None:
        self._read_ground(fields)
        self._read_things(fields)
        self._search()

    # Reading the level.

    def _read_ground(self, fields: Mapping[str, Any]) -> None:
        self.width: int
        self.height: int
        self.width, self.height = fields.get("size", (3, 3))
        self.num_cells = self.width * self.height
        self.moves = (*MOVES, *AROUND) if fields.get("moves") == 8 else MOVES
        self.cells = rectangle({"at": (0, 0), "size": (self.width, self.height)})
        self.starts = cells_of(fields.get("start", (0, 0)))
        self.start_shares = shares_of(self.starts, fields.get("start_weights"))
        self.exit_places = cells_of(fields.get("exit_one_of"))
        self.exit_shares = shares_of(self.exit_places, fields.get("exit_weights"))
        self.exits = (
            []
            if self.exit_places
            else cells_of(
                fields.get(
                    "exit", "none" if fields.get("targets") else (self.width - 1, self.height - 1)
                )
            )
        )
        self.exit_needs = names_of(fields.get("exit_needs"))
        self.blocked = {cell for entry in fields.get("blocked", []) for cell in rectangle(entry)}

        # The probability of getting through each wall: 0 is solid, more is glass.
        self.walls: dict[Side, float] = {}
        for entry in fields.get("walls", []):
            for side in sides_of(entry):
                self.walls[side] = entry.get("pass", self.walls.get(side, 0))
        for entry in fields.get("openings", []):
            for side in sides_of(entry):
                self.walls.pop(side, None)

        rewards = fields.get("rewards", {})
        self.step_reward: float = rewards.get("step", -1)
        self.exit_reward: float | str = rewards.get("exit", 0)
        self.bounce_reward: float = rewards.get("bounce", -1)
        self.stay_reward: float | None = rewards.get("stay")
        self.bump_reward: float | None = rewards.get("bump")
        self.closer_reward: float | None = rewards.get("closer")
        self.farther_reward: float | None = rewards.get("farther")
        # Those that are added; none is nothing.
        self.push_reward: float = rewards.get("push") or 0
        self.covered_reward: float = rewards.get("covered") or 0
        self.uncovered_reward: float = rewards.get("uncovered") or 0

        self.cell_reward: dict[Cell, float] = dict.fromkeys(self.cells, self.step_reward)
        # The values of those of which one is drawn, with their shares.
        self.lotteries: dict[Cell, list[tuple[float, float]]] = {}
        level_skid = fields.get("skid")
        self.skid = dict.fromkeys(self.cells, skid_of(0 if level_skid is None else level_skid))
        self.ending: set[Cell] = set()
        for area in fields.get("areas", []):
            for cell in rectangle(area):
                if area.get("reward") is not None:
                    self.lotteries.pop(cell, None)
                    self.cell_reward[cell] = area["reward"]
                if isinstance(area.get("reward"), dict):
                    values = area["reward"]["values"]
                    weights = area["reward"].get("weights") or [1] * len(values)
                    shares = [weight / sum(weights) for weight in weights]
                    self.lotteries[cell] = [*zip(values, shares, strict=True)]
                if area.get("skid") is not None:
                    self.skid[cell] = skid_of(area["skid"])
                if area.get("ends") is True:
                    self.ending.add(cell)
                if area.get("ends") is False:
                    self.ending.discard(cell)
        types = fields.get("puddle_types", {})
        for puddle in fields.get("puddles", []):
            cell, size = cell_of(puddle["at"]), puddle.get("size", "small")
            kind = types.get(size, {})
            self.lotteries.pop(cell, None)
            self.cell_reward[cell] = kind.get("reward", PUDDLE_REWARD[size])
            self.skid[cell] = skid_of(kind.get("skid", PUDDLE_SKID[size]))

        self.warps: dict[Cell, Warp] = {}
        for warp in fields.get("warps", []):
            to_start = warp["to"] == "start"
            self.warps[cell_of(warp["at"])] = Warp(
                self.start_shares
                if to_start
                else shares_of(cells_of(warp["to"]), warp.get("weights")),
                warp.get("when", "enter"),
                warp.get("reward"),
                warp.get("probability", 1),
            )

        wind = fields.get("wind") or {}
        columns, rows = [0] * self.width, [0] * self.height
        # How likely each wind is that may blow in a step, and where it pushes from each cell.
        self.winds: list[tuple[float, dict[Cell, Cell]]] = []
        blows = wind.get("probability", 1)
        for more in (-1, 0, 1) if wind.get("varies") else (0,):
            pushes: dict[Cell, Cell] = {}
            for x, y in self.cells:
                east = wind.get("east", rows)[y] - wind.get("west", rows)[y]
                south = wind.get("south", columns)[x] - wind.get("north", columns)[x]
                pushes[x, y] = (stronger(east, more), stronger(south, more))
            self.winds.append((blows / 3 if wind.get("varies") else blows, pushes))
        if blows < 1:
            self.winds.append((1 - blows, dict.fromkeys(self.cells, (0, 0))))
        self.wind = self.winds[0][1]

    def _read_things(self, fields: Mapping[str, Any]) -> None:
        self.items: list[Mapping[str, Any]] = fields.get("items", [])
        self.switches: list[Mapping[str, Any]] = fields.get("switches", [])
        self.boxes = [cell_of(box["at"]) for box in fields.get("boxes", [])]
        self.targets: list[Mapping[str, Any]] = fields.get("targets", [])
        self.movers: list[Mapping[str, Any]] = fields.get("movers", [])
        self.item_places = [
            cells_of(item["one_of"]) if "one_of" in item else [cell_of(item["at"])]
            for item in self.items
        ]
        # The cells of a mover's values: those of its phases, or those of its region.
        self.mover_cells = [
            phases_of(mover) if "path" in mover else rectangle(mover["within"])
            for mover in self.movers
        ]
        hit = fields.get("hit", {})
        self.hit_reward: float = hit.get("reward", -1)
        self.hit_ends: bool = hit.get("ends", True)

        self.doors: dict[Side, list[Door]] = {}
        for entry in fields.get("doors", []):
            door = Door(names_of(entry.get("needs")), names_of(entry.get("unless")))
            for side in sides_of(entry):
                self.doors.setdefault(side, []).append(door)

        drawn = 1 if self.exit_places else 0
        self.names = [
            *["exit"] * drawn,
            *(item["name"] for item in self.items),
            *(switch["name"] for switch in self.switches),
            *("" for _ in self.boxes),
            *(target.get("name", "") for target in self.targets),
            *(mover.get("name", "") for mover in self.movers),
        ]
        self.radices = [
            *[len(self.exit_places)] * drawn,
            *(len(places) + 1 for places in self.item_places),
            *(2 for _ in self.switches),
            *(self.num_cells for _ in self.boxes),
            *(2 for _ in self.targets),
            *(len(cells) for cells in self.mover_cells),
        ]
        # Where the values of each kind begin in a configuration.
        self.first_item = drawn
        self.first_switch = self.first_item + len(self.items)
        self.first_box = self.first_switch + len(self.switches)
        self.first_target = self.first_box + len(self.boxes)
        self.first_mover = self.first_target + len(self.targets)
        # No box may stand where a warp leads to.
        self.no_boxes = {target for warp in self.warps.values() for target in warp.targets}

    # What a configuration means.

    def has(self, name: str, configuration: Configuration) -> bool:
        """Return whether an item is held, or a switch is on."""
        for index, item in enumerate(self.items):
            if item["name"] == name:
                held = len(self.item_places[index])
                return configuration[self.first_item + index] == held
        for index, switch in enumerate(self.switches):
            if switch["name"] == name:
                return configuration[self.first_switch + index] == 1
        for target in self.targets:
            if target.get("name") == name:
                return cell_of(target["at"]) in self.boxes_in(configuration)
        raise KeyError(name)

    def exits_of(self, configuration: Configuration) -> list[Cell]:
        """Return the exits of an episode, whether they are open or not."""
        if self.exit_places:
            return [self.exit_places[configuration[0]]]
        return self.exits

    def exit_open(self, configuration: Configuration, cell: Cell) -> bool:
        """Return whether a cell is an exit whose needs are met."""
        return cell in self.exits_of(configuration) and all(
            self.has(name, configuration) for name in self.exit_needs
        )

    def won(self, configuration: Configuration, cell: Cell) -> bool:
        """Return whether an episode is over as it should be: at an exit, or all is covered."""
        return self.exit_open(configuration, cell) or self.solved(configuration)

    def over(self, configuration: Configuration, cell: Cell) -> bool:
        """Return whether an episode is over for where the robot stands."""
        return (
            cell in self.blocked
            or cell in self.ending
            or self.exit_open(configuration, cell)
            or self.solved(configuration)
        )

    def boxes_in(self, configuration: Configuration) -> tuple[Cell, ...]:
        """Return where the boxes stand, row by row."""
        values = configuration[self.first_box : self.first_target]
        return tuple((value % self.width, value // self.width) for value in values)

    def with_boxes(self, configuration: Configuration, boxes: tuple[Cell, ...]) -> Configuration:
        """Return the configuration with the boxes elsewhere: they are alike, so in order."""
        numbers = sorted(y * self.width + x for x, y in boxes)
        covered = [int(cell_of(target["at"]) in boxes) for target in self.targets]
        rest = configuration[self.first_mover :]
        return (*configuration[: self.first_box], *numbers, *covered, *rest)

    def covered(self, configuration: Configuration) -> int:
        """Return how many targets are covered."""
        return sum(configuration[self.first_target : self.first_mover])

    def solved(self, configuration: Configuration) -> bool:
        """Return whether the episode is over as all targets are covered: there is no exit."""
        ends = self.targets and not self.exits and not self.exit_places
        return bool(ends) and self.covered(configuration) == len(self.targets)

    def mover_cell(self, mover: int, configuration: Configuration) -> Cell:
        """Return where a mover stands."""
        return self.mover_cells[mover][configuration[self.first_mover + mover]]

    def door_open(self, door: Door, configuration: Configuration) -> bool:
        """Return whether a door is open."""
        return all(self.has(name, configuration) for name in door.needs) and not any(
            self.has(name, configuration) for name in door.unless
        )

    def closed(self, configuration: Configuration, cell: Cell, direction: int) -> bool:
        """Return whether a side is closed to the robot: also by a box that cannot be pushed.

        A diagonal move is closed if one of the two ways around the corner is.
        """
        if direction in AROUND:
            return any(
                self.shut(configuration, cell, one)
                or self.shut(configuration, neighbour(cell, one), other)
                for one, other in (AROUND[direction], AROUND[direction][::-1])
            )
        other = neighbour(cell, direction)
        return self.shut(configuration, cell, direction) or (
            other in self.boxes_in(configuration)
            and not self.slides(configuration, other, direction)
        )

    def slides(self, configuration: Configuration, box: Cell, direction: int) -> bool:
        """Return whether a box can be pushed: nothing is in its way, and it may stand there."""
        behind = neighbour(box, direction)
        return (
            not self.shut(configuration, box, direction)
            and behind not in self.boxes_in(configuration)
            and behind not in self.no_boxes
        )

    def shut(self, configuration: Configuration, cell: Cell, direction: int) -> bool:
        """Return whether a side of a cell is shut: by a wall, glass, a door, a blocked cell."""
        other = neighbour(cell, direction)
        side = frozenset((cell, other))
        return (
            other not in self.cells
            or other in self.blocked
            or side in self.walls
            or any(not self.door_open(door, configuration) for door in self.doors.get(side, []))
        )

    def glass(self, configuration: Configuration, cell: Cell, direction: int) -> float:
        """Return the probability of getting through the glass at a side; 0 without glass.

        There is none where a box behind it cannot be pushed.
        """
        other = neighbour(cell, direction)
        if direction in AROUND or other not in self.cells or other in self.blocked:
            return 0
        boxes = self.boxes_in(configuration)
        if other in boxes and not self.slides(configuration, other, direction):
            return 0
        return self.walls.get(frozenset((cell, other)), 0)

    # Steps 1 to 7: where the robot goes.

    def landings(self, configuration: Configuration, cell: Cell, action: int) -> Iterator[Landing]:
        """Give where an action takes the robot, with the sides that are closed before it."""
        boxes = self.boxes_in(configuration)
        if action == STAY:
            yield Landing(1.0, cell, boxes=boxes)
            return
        warp = self.warps.get(cell)
        if warp is not None and warp.when == "leave":
            yield from self.warped(Landing(warp.probability, cell, boxes=boxes), warp)
            for landing in self.unwarped(configuration, cell, action):
                yield landing._replace(probability=landing.probability * (1 - warp.probability))
            return
        yield from self.unwarped(configuration, cell, action)

    def unwarped(self, configuration: Configuration, cell: Cell, action: int) -> Iterator[Landing]:
        """Give where a move takes the robot that no warp sends away, in each wind."""
        for chance, wind in self.winds:
            self.wind = wind
            for landing in [*self.moved(configuration, cell, action)]:
                yield landing._replace(probability=landing.probability * chance)

    def moved(self, configuration: Configuration, cell: Cell, action: int) -> Iterator[Landing]:
        """Give where a move takes the robot in the wind that blows."""
        boxes = self.boxes_in(configuration)
        chance = self.glass(configuration, cell, action)
        if chance > 0 and self.pushes(cell, action):
            through = chance * (1 - self.skid[cell][0])
            target, after = self.blown(configuration, cell, action, through_glass=True)
            yield from self.settled(Landing(through, target, boxes=after))
            back = OPPOSITE[action]
            shut = self.closed(configuration, cell, back)
            target = cell if shut else neighbour(cell, back)
            after = boxes if shut else self.slid(boxes, target, back)
            yield from self.settled(Landing(1 - through, target, bounced=True, boxes=after))
            return
        for probability, direction in self.skids(configuration, cell, action):
            if direction == STAY:
                yield from self.settled(Landing(probability, cell, boxes=boxes))
            else:
                target, after = self.blown(configuration, cell, direction)
                bumped = self.refused(configuration, cell, direction)
                yield from self.settled(Landing(probability, target, bumped=bumped, boxes=after))

    def slid(self, boxes: tuple[Cell, ...], cell: Cell, direction: int) -> tuple[Cell, ...]:
        """Return the boxes after the robot came to a cell: one that stood there went on."""
        return tuple(neighbour(box, direction) if box == cell else box for box in boxes)

    def pushed(self, cell: Cell, direction: int) -> Cell:
        """Return the sum of a move and the wind."""
        dx, dy = STEPS[direction]
        east, south = self.wind[cell]
        return dx + east, dy + south

    def pushes(self, cell: Cell, direction: int) -> bool:
        """Return whether a move pushes: the wind along its axis does not cancel or outweigh it."""
        dx, dy = STEPS[direction]
        east, south = self.wind[cell]
        return direction in AROUND or 1 + dx * east + dy * south > 0

    def refused(self, configuration: Configuration, cell: Cell, direction: int) -> bool:
        """Return whether a move pushes against the closed side towards which it goes."""
        return self.pushes(cell, direction) and self.closed(configuration, cell, direction)

    def never_goes(self, configuration: Configuration, cell: Cell, direction: int) -> bool:
        """Return whether a move is refused in each wind that may blow."""
        found = []
        for _, wind in self.winds:
            self.wind = wind
            found.append(self.refused(configuration, cell, direction))
        return all(found)

    def skids(
        self, configuration: Configuration, cell: Cell, action: int
    ) -> list[tuple[float, int]]:
        """Return the directions that a move takes; STAY for staying without a push."""
        chance, rule = self.skid[cell]
        if rule == "open":
            if self.refused(configuration, cell, action):
                return [(1.0, action)]
            others = [
                each
                for each in self.moves
                if each != action and not self.closed(configuration, cell, each)
            ]
            if not others:
                return [(1 - chance, action), (chance, STAY)]
        elif rule == "sides":
            dx, dy = STEPS[action]
            others = [each for each in self.moves if dx * STEPS[each][0] + dy * STEPS[each][1] == 0]
        else:
            others = [each for each in self.moves if each != action]
        return [(1 - chance, action), *((chance / len(others), each) for each in others)]

    def blown(
        self, configuration: Configuration, cell: Cell, direction: int, through_glass: bool = False
    ) -> tuple[Cell, tuple[Cell, ...]]:
        """Travel the sum of a move and the wind: along the axis of the move, then along the other.

        A diagonal step comes first, then the wind: along the columns, then along the rows.
        A move that gets through glass is not stopped by the glass of its first step. This step, if
        it is the robot's own, pushes a box; all others end at one. Return where boxes are, too.
        """
        here, (dx, dy) = cell, self.pushed(cell, direction)
        if direction in AROUND:
            shut = self.closed(configuration, cell, direction)
            here, (dx, dy) = cell if shut else neighbour(cell, direction), self.wind[cell]
        level = [EAST if dx > 0 else WEST] * abs(dx)
        upright = [SOUTH if dy > 0 else NORTH] * abs(dy)
        legs = [level, upright] if direction in (EAST, WEST) else [upright, level]
        boxes = self.boxes_in(configuration)
        for number, leg in enumerate(legs):
            for step, each in enumerate(leg):
                own = number == 0 and step == 0 and each == direction
                if own and self.closed(configuration, here, each) and not through_glass:
                    break
                ahead = neighbour(here, each)
                if not own and (self.shut(configuration, here, each) or ahead in boxes):
                    break
                boxes = self.slid(boxes, ahead, each) if own else boxes
                here = ahead
        return here, boxes

    def settled(self, landing: Landing) -> Iterator[Landing]:
        """Follow the `enter` warps from where the robot would end up."""
        warp = self.warps.get(landing.cell)
        if warp is None or warp.when == "leave":
            yield landing
        else:
            yield from self.warped(
                landing._replace(probability=landing.probability * warp.probability), warp
            )
            yield landing._replace(probability=landing.probability * (1 - warp.probability))

    def warped(self, landing: Landing, warp: Warp) -> Iterator[Landing]:
        """Send the robot to the targets of a warp, and on from there."""
        reward = warp.reward if landing.warp_reward is None else landing.warp_reward
        for target, share in warp.targets.items():
            yield from self.settled(
                landing._replace(
                    probability=landing.probability * share,
                    cell=target,
                    sent=True,
                    warp_reward=reward,
                )
            )

    # Steps 8 to 12: what changes, and what it gives.

    def arrived(self, configuration: Configuration, cell: Cell) -> tuple[Configuration, list[int]]:
        """Take the item and flip the switch of a cell; return the items that were taken as well."""
        values = list(configuration)
        taken = []
        for index, places in enumerate(self.item_places):
            value = values[self.first_item + index]
            if value < len(places) and places[value] == cell:
                values[self.first_item + index] = len(places)
                taken.append(index)
        for index, switch in enumerate(self.switches):
            if cell_of(switch["at"]) == cell:
                value = values[self.first_switch + index]
                beginning = int(switch.get("on", False))
                if not switch.get("once", False) or value == beginning:
                    values[self.first_switch + index] = 1 - value
        return tuple(values), taken

    def mover_options(self, mover: int, configuration: Configuration) -> list[int]:
        """Return the values that a mover may have after a step; all are equally probable."""
        value = configuration[self.first_mover + mover]
        cells = self.mover_cells[mover]
        if "path" in self.movers[mover]:
            return [(value + 1) % len(cells)]
        here = cells[value]
        options = [value]
        for direction in MOVES:
            there = neighbour(here, direction)
            if there in cells and not self.shut(configuration, here, direction):
                options.append(cells.index(there))
        return options

    def is_hit(self, pair: Pair, next_pair: Pair) -> bool:
        """Return whether the robot stands where a mover stands, or both changed places."""
        before, here = pair
        after, there = next_pair
        for mover in range(len(self.movers)):
            was, now = self.mover_cell(mover, before), self.mover_cell(mover, after)
            if there == now or (there != here and there == was and here == now):
                return True
        return False

    def reward(
        self, action: int, pair: Pair, next_pair: Pair, landing: Landing, taken: list[int]
    ) -> float:
        """Return the reward of a step: the first that applies, and that of a bounce."""
        reward = self._reward(action, pair, next_pair, landing, taken)
        added = self.bounce_reward if landing.bounced else 0.0
        if {*landing.boxes} != {*self.boxes_in(pair[0])}:
            added += self.push_reward
        before, after = self.covered(pair[0]), self.covered(next_pair[0])
        if before != after:
            added += self.covered_reward if after > before else self.uncovered_reward
        return float(reward + added)

    def worth_of_exit(self, cell: Cell) -> float:
        """Return what it pays to end an episode as it should be, in a cell."""
        return self.cell_reward[cell] if self.exit_reward == "cell" else float(self.exit_reward)

    def _reward(
        self, action: int, pair: Pair, next_pair: Pair, landing: Landing, taken: list[int]
    ) -> float:
        _, here = pair
        configuration, there = next_pair
        if self.is_hit(pair, next_pair):
            return self.hit_reward
        if landing.warp_reward is not None:
            return landing.warp_reward
        if self.exit_open(configuration, there) or self.solved(configuration):
            return self.worth_of_exit(there)
        for index in taken:
            worth: float | None = self.items[index].get("reward")
            if worth is not None:
                return worth
        if action == STAY and self.stay_reward is not None:
            return self.stay_reward
        if landing.bumped and self.bump_reward is not None:
            return self.bump_reward
        exits = self.exits_of(configuration)
        if exits:
            # The squares of the distances, which are whole numbers, compare as the distances do.
            before = min((here[0] - x) ** 2 + (here[1] - y) ** 2 for x, y in exits)
            after = min((there[0] - x) ** 2 + (there[1] - y) ** 2 for x, y in exits)
            if after < before and self.closer_reward is not None:
                return self.closer_reward
            if after > before and self.farther_reward is not None:
                return self.farther_reward
        return self.cell_reward[there]

    def drawn_in(self, cell: Cell) -> Iterator[float]:
        """Let a cell have each of the rewards that it may have; yield how likely that is."""
        if cell not in self.lotteries:
            yield 1.0
        for value, share in self.lotteries.get(cell, ()):
            self.cell_reward[cell] = value
            yield share

    def step(self, pair: Pair, action: int) -> list[Result]:
        """Return what an action leads to from a pair in which the episode is not over."""
        configuration, cell = pair
        results = []
        for landing in self.landings(configuration, cell, action):
            if landing.probability <= 0:
                continue
            after = self.with_boxes(configuration, landing.boxes)
            taken: list[int] = []
            if landing.sent or landing.cell != cell:
                after, taken = self.arrived(after, landing.cell)
            options = [
                self.mover_options(mover, configuration) for mover in range(len(self.movers))
            ]
            for moved in itertools.product(*options):
                probability = landing.probability
                for each in options:
                    probability /= len(each)
                next_pair = ((*after[: self.first_mover], *moved), landing.cell)
                over = self.over(*next_pair) or (self.hit_ends and self.is_hit(pair, next_pair))
                for share in self.drawn_in(landing.cell):
                    reward = self.reward(action, pair, next_pair, landing, taken)
                    results.append(Result(probability * share, next_pair, reward, over))
        return results

    # States.

    def _beginnings(self) -> dict[Pair, float]:
        """Return the pairs in which an episode may begin, with their probabilities."""
        draws: list[Sequence[int]] = []
        if self.exit_places:
            draws.append(range(len(self.exit_places)))
        draws += [range(len(places)) for places in self.item_places]
        draws += [[int(switch.get("on", False))] for switch in self.switches]
        draws += [[number] for number in sorted(y * self.width + x for x, y in self.boxes)]
        draws += [[int(cell_of(target["at"]) in self.boxes)] for target in self.targets]
        for mover, cells in zip(self.movers, self.mover_cells, strict=True):
            if "path" in mover:
                draws.append([0])
            elif mover.get("start") is None:
                draws.append(range(len(cells)))
            else:
                draws.append([cells.index(cell_of(mover["start"]))])
        combinations = [
            (start, drawn) for start in self.starts for drawn in itertools.product(*draws)
        ]
        beginnings: dict[Pair, float] = {}
        for start, drawn in combinations:
            values = list(drawn)
            for index, places in enumerate(self.item_places):
                if places[values[self.first_item + index]] == start:
                    values[self.first_item + index] = len(places)
            pair = (tuple(values), start)
            share = self.start_shares[start] * len(self.starts)
            if self.exit_places:
                share *= self.exit_shares[self.exit_places[drawn[0]]] * len(self.exit_places)
            beginnings[pair] = beginnings.get(pair, 0.0) + share / len(combinations)
        return beginnings

    def _search(self) -> None:
        beginnings = self._beginnings()
        # What every action leads to, for the pairs from which an episode can go on.
        self.results: dict[Pair, list[list[Result]]] = {}
        reached = set(beginnings)
        waiting = deque(beginnings)
        if not self.radices:
            # Without things, cells that no episode reaches have rows as well.
            waiting.extend(((), cell) for cell in self.cells)
        while waiting:
            pair = waiting.popleft()
            if pair in self.results or self.over(*pair):
                continue
            self.results[pair] = [self.step(pair, action) for action in (STAY, *self.moves)]
            for result in itertools.chain.from_iterable(self.results[pair]):
                reached.add(result.pair)
                if not result.over:
                    waiting.append(result.pair)
        self.reached = reached
        self.configurations = sorted({configuration for configuration, _ in reached})
        self.numbers = {each: number for number, each in enumerate(self.configurations)}
        self.num_states = len(self.configurations) * self.num_cells
        self.start = {self.state(pair): value for pair, value in beginnings.items()}

    def state(self, pair: Pair) -> int:
        """Return the number of a pair."""
        configuration, (x, y) = pair
        return self.numbers[configuration] * self.num_cells + y * self.width + x

    def pair(self, state: int) -> Pair:
        """Return the pair with a number."""
        number, cell = divmod(state, self.num_cells)
        y, x = divmod(cell, self.width)
        return self.configurations[number], (x, y)

    def is_terminal(self, state: int) -> bool:
        """Return whether an episode is over in a state, or no episode goes on from it."""
        return self.pair(state) not in self.results

    def outcomes(self, state: int, action: int) -> list[Outcome]:
        """Return the distinct outcomes of an action, sorted by next state, reward and the end."""
        if self.is_terminal(state):
            return [(1.0, state, 0.0, True)]
        results = self.results[self.pair(state)][action]
        return merged(
            [(each.probability, self.state(each.pair), each.reward, each.over) for each in results]
        )

    def allowed(self, state: int) -> set[int]:
        """Return the valid actions of a state."""
        if self.is_terminal(state):
            return {STAY}
        configuration, cell = self.pair(state)
        if cell in self.warps and self.warps[cell].when == "leave":
            return {STAY, *self.moves}
        return {STAY} | {
            move
            for move in self.moves
            if self.glass(configuration, cell, move) > 0
            or not self.never_goes(configuration, cell, move)
        }


class TurningReference:
    """The same level with the actions left, right and forward, and a heading in the state.

    Configurations are those of the level, and so are the pairs from which no episode goes on.
    """

    def __init__(self, level: Reference, heading: str) -> None:
        self.level = level
        self.names = level.names
        self.radices = level.radices
        self.configurations = level.configurations
        self.num_cells = level.num_cells
        self.num_states = level.num_states * 4
        first = "NESW".index(heading)
        self.start = {
            self.headed(state, first): probability for state, probability in level.start.items()
        }

    def headed(self, state: int, heading: int) -> int:
        """Return the state of a pair and a heading."""
        configuration, cell = divmod(state, self.num_cells)
        return (configuration * 4 + heading) * self.num_cells + cell

    def split(self, state: int) -> tuple[int, int]:
        """Return the number of the pair, and the heading."""
        rest, cell = divmod(state, self.num_cells)
        configuration, heading = divmod(rest, 4)
        return configuration * self.num_cells + cell, heading

    def is_terminal(self, state: int) -> bool:
        """Return whether an episode is over in a state, or no episode goes on from it."""
        return self.level.is_terminal(self.split(state)[0])

    def outcomes(self, state: int, action: int) -> list[Outcome]:
        """Return the distinct outcomes of an action, sorted by next state, reward and the end."""
        if self.is_terminal(state):
            return [(1.0, state, 0.0, True)]
        pair, heading = self.split(state)
        if action == FORWARD:
            taken = (NORTH, EAST, SOUTH, WEST)[heading]
        else:
            taken = STAY
            heading = (heading + (1 if action == RIGHT else -1)) % 4
        return merged(
            [
                (probability, self.headed(next_state, heading), reward, over)
                for probability, next_state, reward, over in self.level.outcomes(pair, taken)
            ]
        )

    def allowed(self, state: int) -> set[int]:
        """Return the valid actions of a state: turning always is, as staying is."""
        pair, heading = self.split(state)
        move = (NORTH, EAST, SOUTH, WEST)[heading]
        return {LEFT, RIGHT} | ({FORWARD} if move in self.level.allowed(pair) else set())
