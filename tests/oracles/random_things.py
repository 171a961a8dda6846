"""Random small levels with things, as plain data: valid by the rules of the language.

A level is made from the inside out, so that it is valid as it is made and nothing has to be tried:
first the cells that are not part of it, exits and starts, then ground, walls and warps, then things
on the cells that are left, and doors on the sides that are left. Only random walks that are to come
back to where they began are tried a few times.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import comb
from random import Random
from typing import Any

from support.values import fields_of

from babyrobot_levels.language.base import Model
from babyrobot_levels.language.cells import (
    Area,
    LargePuddle,
    Puddle,
    Rewards,
    SmallPuddle,
    Wall,
    Warp,
)
from babyrobot_levels.language.fields import LevelFields, Role, fields_with
from babyrobot_levels.language.things import Door, Hit, Item, Mover, Switch, Target

Cell = tuple[int, int]
Side = frozenset[Cell]
Fields = dict[str, Any]

STEPS = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}
ITEM_NAMES = ("key", "coin", "gem", "red-key", "box")
SWITCH_NAMES = ("lever", "plate", "lamp")
TARGET_NAMES = ("pad", "spot")
MOVER_NAMES = ("guard", "bat", "ghost")
MOST_OUTCOMES = 64
"""Levels with more outcomes of one state and action are errors."""


def neighbour(cell: Cell, side: str) -> Cell:
    """Return the cell beside another one."""
    dx, dy = STEPS[side]
    return cell[0] + dx, cell[1] + dy


def run_of(cell: Cell, side: str, length: int) -> list[Side]:
    """Return the sides of an entry with a length."""
    dx, dy = (1, 0) if side in "NS" else (0, 1)
    cells = [(cell[0] + dx * index, cell[1] + dy * index) for index in range(length)]
    return [frozenset((each, neighbour(each, side))) for each in cells]


def at(cell: Cell) -> list[int]:
    """Return a cell as it is written."""
    return list(cell)


def one_or_list(random: Random, values: Sequence[Any]) -> Any:
    """Write a list of one value as a list, or as the value."""
    return values[0] if len(values) == 1 and random.random() < 0.6 else list(values)


class _Maker:
    def __init__(self, random: Random, things: bool) -> None:
        self.random = random
        self.things = things
        self.fields: Fields = {"version": 1}
        # The product of the radices stays below this.
        self.budget = random.choice((24, 48, 96, 200, 400)) if things else 1
        self.walls: set[Side] = set()
        self.doors: set[Side] = set()
        self.enter: dict[Cell, Cell | str] = {}
        self.ground()
        self.walls_and_glass()
        self.warps()
        self.weather()
        if things:
            self.items_and_switches()
            self.boxes_and_targets()
            self.doors_on_free_sides()
            self.moving()
            self.needs_of_exits()
            if self.chance(0.2):
                self.fields["heading"] = random.choice("NESW")
        self.openings()

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def some(self, model: type[Model], share: float, *without: str) -> Fields:
        """Draw fields of a model that stand for themselves, each with a probability."""
        return {
            name: self.random.choice(values)
            for name, values in fields_of(model).items()
            if name not in without and self.chance(share)
        }

    def sample(self, cells: Iterable[Cell], most: int) -> list[Cell]:
        """Draw up to so many cells, in random order."""
        ordered = sorted(cells)
        return self.random.sample(ordered, min(most, len(ordered)))

    def rectangle(self) -> tuple[list[Cell], Fields]:
        """Draw a small rectangle on the grid: its cells, and as it is written."""
        x, y = self.random.randrange(self.width), self.random.randrange(self.height)
        width = min(self.random.choice((1, 1, 2, 3)), self.width - x)
        height = min(self.random.choice((1, 1, 2, 3)), self.height - y)
        entry: Fields = {"at": [x, y]}
        if (width, height) != (1, 1) or self.chance(0.2):
            entry["size"] = [width, height]
        return [(x + dx, y + dy) for dy in range(height) for dx in range(width)], entry

    def ground(self) -> None:
        """Make the grid with its blocked cells, exits and starts, areas and puddles."""
        random, fields = self.random, self.fields
        if self.chance(0.1):
            self.width, self.height = random.choice(((1, 2), (2, 1), (3, 1), (1, 4), (5, 1)))
        else:
            self.width, self.height = random.choice((2, 3, 3, 4, 4, 5)), random.choice((2, 3, 3, 4))
        if (self.width, self.height) != (3, 3) or self.chance(0.5):
            fields["size"] = [self.width, self.height]
        cells = {(x, y) for y in range(self.height) for x in range(self.width)}
        self.cells = cells

        self.blocked: set[Cell] = set()
        if self.chance(0.35):
            entries = []
            for _ in range(random.randint(1, 2)):
                covered, entry = self.rectangle()
                if len(cells - self.blocked - set(covered)) >= max(2, len(cells) // 2):
                    self.blocked |= set(covered)
                    entries.append(entry)
            if entries:
                fields["blocked"] = entries
        free = cells - self.blocked

        corner = (self.width - 1, self.height - 1)
        kind = random.choice(("default", "one", "one", "several", "none", "drawn", "drawn"))
        self.exits: list[Cell] = []
        if kind == "drawn" and self.things and len(free) >= 3:
            self.exits = self.sample(free, random.randint(2, min(3, len(free) - 1)))
            self.budget = max(self.budget, 2 * len(self.exits))
            fields["exit_one_of"] = [at(each) for each in self.exits]
        elif kind == "none":
            fields["exit"] = "none"
        elif kind == "default" and corner in free:
            self.exits = [corner]
        else:
            most = 1 if kind != "several" else min(3, len(free) - 1)
            self.exits = self.sample(free, most)
            fields["exit"] = one_or_list(random, [at(each) for each in self.exits])
            if len(self.exits) == 1:
                fields["exit"] = at(self.exits[0])
        self.drawn_exits = len(self.exits) if "exit_one_of" in fields else 1

        inside = free - set(self.exits)
        if (0, 0) in inside and self.chance(0.2):
            self.starts = [(0, 0)]
        else:
            self.starts = self.sample(inside, random.choice((1, 1, 1, 2, 3)))
            starts = [at(each) for each in self.starts]
            alone = len(starts) == 1 and self.chance(0.7)
            fields["start"] = starts[0] if alone else starts

        self.areas(free)
        if self.chance(0.35):
            fields["puddles"] = [
                {"at": at(cell)} | self.some(Puddle, 0.6)
                for cell in self.sample(free, random.randint(1, 3))
            ]
            if self.chance(0.5):
                types = {"small": SmallPuddle, "large": LargePuddle}
                sizes = random.sample((*types,), random.randint(1, 2))
                fields["puddle_types"] = {size: self.some(types[size], 0.5) for size in sizes}

    def areas(self, free: set[Cell]) -> None:
        """Lay areas; where one would end the episode on a start, a later one takes that back."""
        if not self.chance(0.5):
            return
        entries: list[Fields] = []
        ending: set[Cell] = set()
        for _ in range(self.random.randint(1, 3)):
            covered, entry = self.rectangle()
            entry |= self.some(Area, 0.5, "ends")
            if self.chance(0.3) and len(covered) <= len(free) / 3:
                entry["ends"] = self.chance(0.85)
                ending = ending | set(covered) if entry["ends"] else ending - set(covered)
            entries.append(entry)
        entries += [{"at": at(each), "ends": False} for each in self.starts if each in ending]
        self.fields["areas"] = entries

    def inner_runs(self, longest: int) -> tuple[Cell, str, int]:
        """Draw cell, side and length of sides inside the grid."""
        while True:
            cell = self.random.choice(sorted(self.cells))
            side = self.random.choice("NESW")
            if neighbour(cell, side) in self.cells:
                break
        left = self.width - cell[0] if side in "NS" else self.height - cell[1]
        return cell, side, self.random.randint(1, min(left, longest))

    def walls_and_glass(self) -> None:
        """Build walls, a third of them of glass."""
        if len(self.cells) < 2 or not self.chance(0.65):
            return
        entries = []
        for _ in range(self.random.randint(1, max(1, len(self.cells) // 3))):
            cell, side, length = self.inner_runs(longest=2)
            entry: Fields = {"at": at(cell), "side": side}
            if length > 1 or self.chance(0.1):
                entry["length"] = length
            entries.append(entry | self.some(Wall, 0.4))
            self.walls |= set(run_of(cell, side, length))
        self.fields["walls"] = entries

    def openings(self) -> None:
        """Take a part of some walls away again."""
        walls = self.fields.get("walls", [])
        if not walls or not self.chance(0.3):
            return
        entries = []
        for wall in self.random.sample(walls, self.random.randint(1, len(walls))):
            entry: Fields = {"at": wall["at"], "side": wall["side"]}
            if "length" in wall and self.chance(0.5):
                entry["length"] = wall["length"]
            entries.append(entry)
        self.fields["openings"] = entries

    def warps(self) -> None:
        """Place warps that do not form circles."""
        free = self.cells - self.blocked
        sites = self.sample(free - set(self.exits), self.random.randint(1, 3))
        if not sites or not self.chance(0.4):
            return
        entries = []
        for cell in sites:
            when = self.random.choice(("enter", "enter", "leave"))
            if cell in self.starts:
                when = "leave"
            target: Cell | str = "start"
            if when == "leave" and self.chance(0.25):
                target = cell
            elif self.chance(0.75):
                target = self.random.choice(sorted(free - {cell}))
                if when == "enter" and self.circles(cell, target):
                    target = "start"
            entry: Fields = {
                "at": at(cell),
                "to": "start" if isinstance(target, str) else at(target),
            }
            if when == "leave" or self.chance(0.3):
                entry["when"] = when
            if when == "enter":
                self.enter[cell] = target
            entries.append(entry | self.some(Warp, 0.4, "when", "probability"))
        self.fields["warps"] = entries

    def circles(self, cell: Cell, target: Cell) -> bool:
        """Return whether a chain of warps from the target comes back to the cell."""
        here: Cell | str = target
        while not isinstance(here, str) and here in self.enter:
            here = self.enter[here]
        return here == cell

    def weather(self) -> None:
        """Add wind, a skid of the level and rewards."""
        random, fields = self.random, self.fields
        if self.chance(0.3):
            wind = {}
            for name in ("north", "east", "south", "west"):
                if self.chance(0.4):
                    count = self.width if name in ("north", "south") else self.height
                    wind[name] = [random.choice((0, 0, 1, 1, 2)) for _ in range(count)]
            if wind:
                fields["wind"] = wind
        others = {*fields_of(LevelFields)} - {*fields_with(Role.DYNAMICS, Role.REWARD)}
        fields |= self.some(LevelFields, 0.3, *others, "heading")
        if self.chance(0.6):
            fields["rewards"] = self.some(Rewards, 0.4)

    # Things.

    def spend(self, radix: int) -> bool:
        """Return whether a thing of so many values still fits, and count it if so."""
        if self.values * radix > self.budget:
            return False
        self.values *= radix
        return True

    def items_and_switches(self) -> None:
        """Lay items and switches on cells of their own."""
        random = self.random
        self.values = self.drawn_exits
        places = sorted(self.cells - self.blocked - set(self.exits) - set(self.enter))
        random.shuffle(places)
        items, switches = [], []
        names = list(ITEM_NAMES)
        if self.chance(0.5):
            random.shuffle(names)
        for name in names[: random.choice((0, 1, 1, 1, 2, 2, 3))]:
            count = random.choice((1, 1, 1, 2, 2, 3))
            if len(places) < count or not self.spend(count + 1):
                continue
            lies = [at(places.pop()) for _ in range(count)]
            item: Fields = {"name": name}
            item |= {"at": lies[0]} if count == 1 else {"one_of": lies}
            items.append(item | self.some(Item, 0.5))
        for name in SWITCH_NAMES[: random.choice((0, 0, 1, 1, 2))]:
            if not places or not self.spend(2):
                continue
            switches.append({"name": name, "at": at(places.pop())} | self.some(Switch, 0.6))
        if items:
            self.fields["items"] = items
        if switches:
            self.fields["switches"] = switches
        self.names = [each["name"] for each in (*items, *switches)]

    def boxes_and_targets(self) -> None:
        """Place boxes and targets; without an exit, not all targets are covered at first."""
        if not self.chance(0.35):
            return
        sent = {
            cell
            for warp in self.fields.get("warps", [])
            for cell in (self.starts if warp["to"] == "start" else [tuple(warp["to"])])
        }
        places = self.cells - self.blocked
        taken = {
            tuple(cell)
            for each in (*self.fields.get("items", []), *self.fields.get("switches", []))
            for cell in each.get("one_of", [each.get("at")])
        }
        boxes = self.sample(places - sent - set(self.starts), self.random.choice((1, 1, 2, 3)))
        while boxes and not self.spend(comb(len(places), len(boxes))):
            boxes.pop()
        free = places - taken - set(self.exits) - set(self.enter)
        targets = self.sample(free, self.random.choice((0, 1, 1, 2)))
        if targets and not self.exits and set(targets) <= set(boxes):
            targets = []
        if boxes:
            self.fields["boxes"] = [{"at": at(cell)} for cell in boxes]
        if not targets:
            return
        entries: list[Fields] = [
            {"at": at(cell)} | self.some(Target, 0.3, "name") for cell in targets
        ]
        for entry, name in zip(entries, TARGET_NAMES, strict=False):
            if self.chance(0.5):
                entry["name"] = name
                self.names.append(name)
        self.fields["targets"] = entries
        if self.exits and "exit" not in self.fields and "exit_one_of" not in self.fields:
            self.fields["exit"] = at(self.exits[0])

    def some_names(self, most: int) -> Any:
        """Draw names of items, switches and targets, as they are written."""
        count = self.random.randint(1, min(most, len(self.names)))
        return one_or_list(self.random, self.random.sample(self.names, count))

    def doors_on_free_sides(self) -> None:
        """Hang doors where there is no wall, glass or blocked cell."""
        if not self.names:
            return
        entries = []
        for _ in range(self.random.choice((0, 1, 1, 2, 2, 3))):
            cell, side, length = self.inner_runs(longest=3)
            sides = run_of(cell, side, length)
            taken = self.walls | self.doors
            if any(each in taken or each & self.blocked for each in sides):
                continue
            door: Fields = {"at": at(cell), "side": side}
            if length > 1 or self.chance(0.1):
                door["length"] = length
            kind = self.random.choice(("needs", "needs", "needs", "unless", "both"))
            if kind in ("needs", "both"):
                door["needs"] = self.some_names(2)
            if kind in ("unless", "both"):
                door["unless"] = self.some_names(2)
            entries.append(door | self.some(Door, 0.4))
            self.doors |= set(sides)
        if entries:
            self.fields["doors"] = entries

    def steps_from(self, cell: Cell) -> list[Cell]:
        """Return where a path may go on: the cell itself, and neighbours with nothing between."""
        others = [neighbour(cell, side) for side in STEPS]
        return [cell] + [
            other
            for other in others
            if other in self.cells - self.blocked
            and frozenset((cell, other)) not in self.walls | self.doors
        ]

    def walk(self, length: int) -> list[Cell]:
        """Draw a walk that rarely stays."""
        walk = [self.random.choice(sorted(self.cells - self.blocked))]
        while len(walk) < length:
            steps = self.steps_from(walk[-1])
            if len(steps) > 1 and self.chance(0.85):
                steps = steps[1:]
            walk.append(self.random.choice(steps))
        return walk

    def path(self) -> tuple[Fields, int]:
        """Draw a path, and return how many phases it has."""
        if self.chance(0.5):
            for _ in range(20):
                walk = self.walk(self.random.choice((1, 2, 3, 4, 4, 6)))
                if walk[0] in self.steps_from(walk[-1]):
                    mover: Fields = {"path": [at(each) for each in walk]}
                    if self.chance(0.2):
                        mover["back"] = False
                    return mover, len(walk)
        walk = self.walk(self.random.choice((1, 2, 2, 3, 3, 4)))
        return {"path": [at(each) for each in walk], "back": True}, max(1, 2 * len(walk) - 2)

    def region(self) -> tuple[Fields, int] | None:
        """Draw a region without blocked cells, and return how many cells it has."""
        for _ in range(5):
            covered, entry = self.rectangle()
            if not self.blocked & set(covered) and (len(covered) > 1 or self.chance(0.2)):
                mover: Fields = {"within": entry}
                if self.chance(0.5):
                    mover["start"] = at(self.random.choice(covered))
                return mover, len(covered)
        return None

    def moving(self) -> None:
        """Let movers loose, as long as no action can have too many outcomes."""
        to_start = any(warp["to"] == "start" for warp in self.fields.get("warps", []))
        outcomes = 4 * (len(self.starts) if to_start else 1)
        movers = []
        for name in MOVER_NAMES[: self.random.choice((0, 0, 1, 1, 1, 2))]:
            made = self.region() if self.chance(0.5) else None
            mover, radix = made or self.path()
            options = min(5, radix) if "within" in mover else 1
            if outcomes * options > MOST_OUTCOMES or not self.spend(radix):
                continue
            outcomes *= options
            made_up = self.some(Mover, 0.4, "back")
            movers.append(({"name": name} if self.chance(0.7) else {}) | mover | made_up)
        if not movers:
            return
        self.fields["movers"] = movers
        if self.chance(0.65):
            self.fields["hit"] = self.some(Hit, 0.7)

    def needs_of_exits(self) -> None:
        """Let the exits need something."""
        if self.exits and self.names and self.chance(0.5):
            self.fields["exit_needs"] = self.some_names(2)


def add_weights(random: Random, fields: Fields) -> None:
    """Draw starts and exits with weights, and let warps lead to several cells, and by chance."""

    def weigh(entry: Fields, name: str, count: int) -> None:
        if count > 1 and random.random() < 0.7:
            entry[name] = [random.choice((1, 2, 5, 3)) for _ in range(count)]

    starts = fields.get("start", [0, 0])
    if isinstance(starts[0], list) and "robots" not in fields:
        weigh(fields, "start_weights", len(starts))
    weigh(fields, "exit_weights", len(fields.get("exit_one_of", ())))
    leads = {tuple(warp["at"]) for warp in fields.get("warps", []) if "when" not in warp}
    leads |= {tuple(warp["at"]) for warp in fields.get("warps", []) if warp.get("when") == "enter"}
    for warp in fields.get("warps", []):
        if isinstance(warp["to"][0], int) and random.random() < 0.6:
            more = [cell for cell in _targets(fields) if tuple(cell) not in leads]
            warp["to"] = [warp["to"], *random.sample(more, min(len(more), random.randint(1, 2)))]
            weigh(warp, "weights", len(warp["to"]))
        if random.random() < 0.6:
            warp["probability"] = random.choice((0.25, 0.5, 0.9))


def add_gusts(random: Random, fields: Fields) -> None:
    """Let a wind blow by chance, or vary; where there is none, let one blow."""
    width, height = fields.get("size", (3, 3))
    if "wind" not in fields:
        side, count = random.choice((("north", width), ("east", height), ("south", width)))
        fields["wind"] = {side: [random.choice((0, 1, 1, 2)) for _ in range(count)]}
    fields["wind"] = {**fields["wind"], "varies": random.random() < 0.6}
    if random.random() < 0.6:
        fields["wind"]["probability"] = random.choice((0.25, 0.5, 0.9))


def add_diagonals(_random: Random, fields: Fields) -> None:
    """Let the robot move diagonally, and leave out what does not go with that."""
    targets = {target.get("name") for target in fields.pop("targets", [])}
    fields.pop("boxes", None)
    fields.pop("heading", None)
    fields["moves"] = 8
    for entry in [fields, *fields.get("doors", [])]:
        for name in ("exit_needs", "needs", "unless"):
            _without(entry, name, targets)


def add_draws(random: Random, fields: Fields) -> None:
    """Let the rewards of some areas be drawn, and let exits pay what their cells do."""
    width, height = fields.get("size", (3, 3))
    areas = fields.setdefault("areas", [])
    if not areas or random.random() < 0.5:
        areas.insert(0, {"at": [0, 0], "size": [width, height]})
    for area in areas:
        if random.random() < 0.7:
            count = random.randint(2, 3)
            area["reward"] = {"values": random.sample((-3, -1, -0.5, 0, 0.1, 2, 10), count)}
            if random.random() < 0.7:
                area["reward"]["weights"] = [random.choice((1, 2, 3, 10)) for _ in range(count)]
    if random.random() < 0.5:
        fields["rewards"] = {**fields.get("rewards", {}), "exit": "cell"}


def _without(entry: Fields, name: str, left_out: set[Any]) -> None:
    names = entry.get(name, [])
    names = [
        each for each in ([names] if isinstance(names, str) else names) if each not in left_out
    ]
    if names:
        entry[name] = names
    else:
        entry.pop(name, None)


def _targets(fields: Fields) -> list[list[int]]:
    """Return cells to which a warp may lead: neither blocked, nor where a box stands."""
    width, height = fields.get("size", (3, 3))
    closed = [tuple(box["at"]) for box in fields.get("boxes", [])]
    for entry in fields.get("blocked", []):
        (x, y), (columns, rows) = entry["at"], entry.get("size", (1, 1))
        closed += [(x + dx, y + dy) for dx in range(columns) for dy in range(rows)]
    return [[x, y] for y in range(height) for x in range(width) if (x, y) not in closed]


def random_level(random: Random, things: bool = True) -> Fields:
    """Return the fields of a random valid level, at most 5 cells wide and 4 high.

    Args:
        random: The generator that decides.
        things: Whether the level may have things that change during an episode.
    """
    fields = _Maker(random, things).fields
    wanders = any("within" in mover for mover in fields.get("movers", []))
    if not wanders and random.random() < 0.35:
        random.choice((add_weights, add_gusts, add_draws))(random, fields)
    return fields
