"""Gestures of the editor on levels as sets: what each must come to, by the simplest means."""

from __future__ import annotations

from random import Random
from typing import Any

from babyrobot_levels.language.things import as_names
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.library.level import Level

Cell = tuple[int, int]
Edge = tuple[int, int, str]
"""The E or S side of a cell."""

Message = dict[str, Any]

STEPS = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}
BITS = {"E": 2, "S": 4}


class Refused(Exception):
    """The gesture is against a rule of the editor."""


def gesture(rng: Random, level: Level) -> Message:
    """Return a random gesture at a level, now and then against the rules."""
    width, height = level.size

    cells = busy_cells(level)
    sides = [(*wall.at, wall.side) for wall in (*level.walls, *level.openings, *level.doors)]

    def cell() -> list[int]:
        if cells and rng.random() < 0.5:
            return [*rng.choice(cells)]
        return [rng.randrange(width), rng.randrange(height)]

    kind = rng.choices(["walls", "paint", "fill", "resize", "wind", "resolve"], [9, 9, 3, 2, 2, 1])[
        0
    ]
    brushes = ["small", "large", "blocked", "area", "erase"]
    traits: Message = {"color": rng.choice(["red", "gold"])}
    traits |= rng.choice([{}, {"reward": -3}, {"label": "here"}, {"ends": True, "skid": 0.5}])
    match kind:
        case "walls":
            fields: Message = {"at": cell(), "side": rng.choice("NESW")}
            if sides and rng.random() < 0.5:
                x, y, fields["side"] = rng.choice(sides)
                fields["at"] = [x, y]
            fields |= {"length": rng.choice([1, 1, 1, 2, 3])}
            fields |= {"to": rng.choice(["next", "next", "none", "wall", "glass", "door"])}
            fields |= rng.choice([{}, {"pass": 0.2}, {"pass": 0}, {"pass": 1}])
        case "paint":
            fields = {"brush": rng.choice([*brushes, "start", "exit"])}
            fields |= {"cells": [cell() for _ in range(rng.choice([1, 1, 2, 3]))]}
            fields |= {"rectangle": rng.random() < 0.3, "add": rng.random() < 0.3}
        case "fill":
            fields = {"brush": rng.choice(brushes), "at": cell()}
        case "resize":
            size = [min(9, max(1, old + rng.randint(-1, 2))) for old in level.size]
            fields = {"size": size, "shift": [rng.randint(-1, 1), rng.randint(-1, 1)]}
        case "wind":
            fields = {"side": rng.choice("NESW"), "index": rng.randrange(max(level.size))}
            fields |= {"strength": rng.randrange(3)}
        case _:
            fields = {}
    if fields.get("brush") == "area":
        fields["fields"] = traits
    return {"do": kind, **fields}


def busy_cells(level: Level) -> list[Cell]:
    """Return the cells in which something stands."""
    cells = [*level.starts, *level.exits]
    for entries in (level.puddles, level.warps, level.switches, level.blocked, level.doors):
        cells += [entry.at for entry in entries]
    cells += [cell for item in level.items for cell in item.places]
    cells += [cell for mover in level.movers for cell in walked(given(mover))[:2]]
    return cells + [cell for area in level.areas for cell in inside(area.at, area.size)[-2:]]


def expected(level: Level, message: Message) -> Level:
    """Return the level that a gesture must make of a level, in whatever words.

    Raises:
        Refused: the gesture is against a rule.
        LevelError: there is no such level.
    """
    plan = Plan(level)
    DOES[message["do"]](plan, message)
    return plan.level()


class Plan:
    """A level as sets of cells and sides."""

    def __init__(self, level: Level) -> None:
        self.before, self.is_drawn = level, level.map is not None
        self.size = level.size
        self.starts, self.exits = [*level.starts], [*level.exits]
        self.by_lot = level.exit_one_of is not None
        self.blocked = {cell for each in level.blocked for cell in inside(each.at, each.size)}
        self.puddles: dict[Cell, str] = {each.at: each.size for each in level.puddles}
        # Of an area, whether it is drawn.
        self.areas: list[Any] = [
            (
                cell,
                given(area, "at", "size", "label"),
                number < level._drawn.get("areas", 0),
            )
            for number, area in enumerate(level.areas)
            for cell in inside(area.at, area.size)
        ]
        self.items: list[Any] = [
            [given(item, "at", "one_of"), [*item.places]] for item in level.items
        ]
        self.switches: list[Any] = [[given(switch, "at"), switch.at] for switch in level.switches]
        self.warps = [given(warp) for warp in level.warps]
        self.movers = [given(mover) for mover in level.movers]
        self.walls: dict[Edge, float | None] = {}
        for wall in level.walls:
            for edge in self.inner(edges(wall)):
                known = "pass_" in wall.model_fields_set
                self.walls[edge] = wall.pass_ if known else self.walls.get(edge) or 0
        for opening in level.openings:
            self.walls |= dict.fromkeys(self.inner(edges(opening)), None)
        self.doors: list[Any] = [
            [edges(door), given(door, "at", "side", "length", "color", "width")]
            for door in level.doors
        ]
        self.wind = {} if level.wind is None else given(level.wind)

    def level(self) -> Level:
        """Return the level that all this is."""
        told = {"map", "legend", "size", "start", "exit", "exit_one_of", "walls", "openings"}
        told |= {"doors", "items", "switches", "movers", "puddles", "areas", "blocked", "warps"}
        told |= {"wind"}
        data = {name: value for name, value in self.before.to_dict().items() if name not in told}
        data |= {"size": self.size, "start": self.starts, "wind": self.wind}
        if self.by_lot and len(self.exits) > 1:
            data["exit_one_of"] = self.exits
        else:
            data["exit"] = self.exits or "none"
        data["walls"] = [
            entry(edge) | {"pass": chance}
            for edge, chance in self.walls.items()
            if chance is not None
        ]
        data["openings"] = [entry(edge) for edge, chance in self.walls.items() if chance is None]
        data["blocked"] = [{"at": cell} for cell in self.blocked]
        data["puddles"] = [{"at": cell, "size": size} for cell, size in self.puddles.items()]
        data["areas"] = [{"at": cell, **traits} for cell, traits, _ in self.areas]
        data["items"] = [
            item | ({"at": cells[0]} if len(cells) == 1 else {"one_of": cells})
            for item, cells in self.items
            if cells
        ]
        data["switches"] = [switch | {"at": cell} for switch, cell in self.switches]
        names = {thing["name"] for thing in (*data["items"], *data["switches"])}

        def known(needed: Any) -> list[str]:
            return [name for name in as_names(needed) if name in names]

        data["doors"] = [
            entry(edge) | {name: known(names) for name, names in needs.items()}
            for sides, needs in self.doors
            # A door that is left without names would always be open.
            if any(map(known, needs.values())) or not any(needs.values())
            for edge in sides
            if not any(needs.values()) or any(map(known, needs.values()))
        ]
        data["exit_needs"] = known(self.before.exit_needs)
        data |= {"warps": self.warps, "movers": self.movers}
        return Level.from_fields(data)

    # -- sides -----------------------------------------------------------------------------

    def inner(self, sides: list[Edge]) -> list[Edge]:
        """Return those sides that are not of the outer wall."""
        width, height = self.size
        last = {"E": (width - 1, height), "S": (width, height - 1)}
        return [
            (x, y, side)
            for x, y, side in sides
            if 0 <= x < last[side][0] and 0 <= y < last[side][1]
        ]

    def kind(self, edge: Edge) -> str:
        """Return what a side is in the level before."""
        level = self.before
        if level.has_random_maze:
            level = level.replace(maze=None)
        x, y, side = edge
        cell = y * self.size[0] + x
        if any(edge in sides for sides, _ in self.doors):
            return "door"
        if (cell, side) in level.grid().glass:
            return "glass"
        return "wall" if level.grid().wall_bits[cell] & BITS[side] else "none"

    def build(self, message: Message) -> None:
        """Build walls."""
        (x, y), side, length = message["at"], message["side"], message["length"]
        along = range(length)
        places = [(x + i, y) if side in "NS" else (x, y + i) for i in along]
        run = [normal(place, side) for place in places]
        if self.inner(run) != run:
            raise Refused
        to, chance = message["to"], message.get("pass", 0.5)
        if to == "next":
            turns = ["none", "wall", "glass"]
            turns += ["door"] if self.items or self.switches else []
            kind = self.kind(run[0])
            to = turns[(turns.index(kind) + 1) % len(turns)] if kind in turns else "none"
        if to == "glass" and not chance:
            to = "wall"
        if to == "door" and all(self.kind(edge) == "door" for edge in run):
            return
        if to == "wall" and all(self.kind(edge) == "wall" for edge in run):
            return
        most = {"none": 2, "wall": 1, "glass": 0, "door": 0}[to]
        run = [edge for edge in run if len(self.blocked.intersection(cells_at(edge))) <= most]
        if not run:
            raise Refused
        kept = None
        for part in parts(run):
            kept = next((door for door in self.doors if door[0] == part), None)
            new = kept or [part, {"needs": self.need()}] if to == "door" else None
            for door in self.doors:
                door[0] = [edge for edge in door[0] if edge not in part]
            if new is not None:
                self.doors = [*(door for door in self.doors if door[0]), [part, new[1]]]
            self.walls |= dict.fromkeys(part, {"wall": 0.0, "glass": chance}.get(to))

    def need(self) -> str:
        """Return the name of what opens a new door."""
        names = [item["name"] for item, _ in self.items]
        names += [switch["name"] for switch, _ in self.switches]
        if not names:
            raise Refused
        used = {*as_names(self.before.exit_needs)}
        for door in self.before.doors:
            used |= {*door.keys, *door.locks}
        idle = [name for name in names if name not in used]
        return str((idle or names)[-1])

    # -- cells -----------------------------------------------------------------------------

    def paint(self, message: Message) -> None:
        """Paint cells."""
        cells = [*dict.fromkeys(map(tuple, message["cells"]))]
        if message["rectangle"]:
            (x1, y1), (x2, y2) = cells[0], cells[-1]
            xs, ys = range(min(x1, x2), max(x1, x2) + 1), range(min(y1, y2), max(y1, y2) + 1)
            cells = [(x, y) for y in ys for x in xs]
        brush = message["brush"]
        if brush in ("start", "exit"):
            self.put_ends(brush, cells, message["add"])
        elif brush == "erase":
            stay = self.spare(cells, exits_too=False)
            before = repr(vars(self))
            self.erase(cells)
            if {*cells} <= {*stay} and repr(vars(self)) == before:
                raise Refused
        else:
            self.ground(brush, cells, message.get("fields", {}))

    def put_ends(self, what: str, cells: list[Cell], add: bool) -> None:
        """Make cells starts or exits."""
        starts = [cell for cell in self.starts if cell not in cells]
        exits = [cell for cell in self.exits if cell not in cells]
        if what == "start":
            if self.exits and not exits:
                raise Refused
            self.starts = [*self.starts, *cells] if add else cells
            self.by_lot = self.by_lot and len(exits) > 1
            self.exits = exits
            self.areas = [
                area for area in self.areas if area[0] not in cells or not area[1].get("ends")
            ]
            self.warps = [
                warp
                for warp in self.warps
                if warp["at"] not in cells or warp.get("when", "enter") != "enter"
            ]
        else:
            if not starts:
                raise Refused
            self.starts = starts
            self.exits = [*self.exits, *cells] if add else cells
            self.by_lot = self.by_lot and add
            self.remove_things(cells)
            self.warps = [warp for warp in self.warps if warp["at"] not in cells]
        self.starts, self.exits = [*dict.fromkeys(self.starts)], [*dict.fromkeys(self.exits)]
        self.blocked -= {*cells}
        self.cover_ends()

    def cover_ends(self) -> None:
        """Let the drawing show starts and exits, and nothing else in their cells."""
        if self.is_drawn:
            is_drawn_by_lot = self.by_lot and len(self.exits) > 1
            self.draw_over([*self.starts, *(() if is_drawn_by_lot else self.exits)])

    def draw_over(self, cells: list[Cell]) -> None:
        """Remove what a drawing shows in cells."""
        drawn = self.before._drawn
        for cell in cells:
            self.puddles.pop(cell, None)
        self.areas = [area for area in self.areas if area[0] not in cells or not area[2]]
        for number, item in enumerate(self.items):
            if number < drawn.get("items", 0):
                item[1] = [cell for cell in item[1] if cell not in cells]
        self.switches = [
            switch
            for number, switch in enumerate(self.switches)
            if number >= drawn.get("switches", 0) or switch[1] not in cells
        ]

    def ground(self, brush: str, cells: list[Cell], fields: dict[str, Any]) -> None:
        """Paint puddles, blocked cells or areas."""
        if brush == "area":
            traits = {name: value for name, value in fields.items() if name != "label"}
            self.areas += [(cell, traits, False) for cell in cells]
        elif brush == "blocked":
            stay = self.spare(cells, exits_too=True)
            cells = [cell for cell in cells if cell not in stay]
            if not cells:
                raise Refused
            areas = self.areas
            self.erase(cells)
            self.areas = [area for area in areas if area[0] not in cells or not area[2]]
            self.blocked |= {*cells}
            for door in self.doors:
                door[0] = [edge for edge in door[0] if not {*cells} & {*cells_at(edge)}]
        else:
            if self.is_drawn:
                ends = [*self.starts, *(() if self.by_lot else self.exits)]
                cells = [cell for cell in cells if cell not in ends]
                if not cells:
                    raise Refused
                self.draw_over(cells)
            self.blocked -= {*cells}
            self.puddles |= dict.fromkeys(cells, brush)

    def spare(self, cells: list[Cell], *, exits_too: bool) -> list[Cell]:
        """Remove starts and exits, and return those cells in which they have to stay."""
        starts = [cell for cell in self.starts if cell not in cells]
        exits = [cell for cell in self.exits if cell not in cells]
        stay = [] if starts else [*self.starts]
        stay += self.exits if exits_too and not exits else []
        self.starts = starts or self.starts
        self.exits = exits if exits or not exits_too else self.exits
        self.cover_ends()
        return stay

    def erase(self, cells: list[Cell]) -> None:
        """Take everything but starts and exits out of cells."""
        self.blocked -= {*cells}
        for cell in cells:
            self.puddles.pop(cell, None)
        self.areas = [area for area in self.areas if area[0] not in cells]
        self.remove_things(cells)
        self.warps = [
            warp for warp in self.warps if warp["at"] not in cells and warp["to"] not in cells
        ]
        self.movers = [mover for mover in self.movers if not {*cells} & {*walked(mover)}]

    def remove_things(self, cells: list[Cell]) -> None:
        """Remove items and switches from cells."""
        for item in self.items:
            item[1] = [cell for cell in item[1] if cell not in cells]
        self.switches = [switch for switch in self.switches if switch[1] not in cells]

    def fill(self, message: Message) -> None:
        """Paint cells that are alike."""
        cells = self.alike(tuple(message["at"]))
        ends = [*self.starts, *self.exits]
        if message["brush"] == "erase":
            self.erase([cell for cell in cells if cell not in ends])
        else:
            if message["brush"] == "blocked":
                cells = [cell for cell in cells if cell not in ends]
            self.ground(message["brush"], cells, message.get("fields", {}))

    def alike(self, first: Cell) -> list[Cell]:
        """Return the cells like a cell that can be reached from it."""

        def ground(cell: Cell) -> Any:
            areas = [area for area in self.before.areas if cell in inside(area.at, area.size)]
            traits = [given(area, "at", "size") for area in areas]
            return cell in self.blocked, self.puddles.get(cell), traits

        found, new = [first], [first]
        while new:
            x, y = new.pop()
            for side, (dx, dy) in STEPS.items():
                cell, edge = (x + dx, y + dy), normal((x, y), side)
                if not self.inner([edge]) or cell in found or self.kind(edge) != "none":
                    continue
                if ground(cell) == ground(first):
                    found.append(cell)
                    new.append(cell)
        return found

    # -- the whole -------------------------------------------------------------------------

    def resize(self, message: Message) -> None:
        """Give it another size."""
        old, (width, height), (dx, dy) = self.size, message["size"], message["shift"]

        def moved(cells: Any) -> list[Cell]:
            shifted = [(x + dx, y + dy) for x, y in cells]
            return [(x, y) for x, y in shifted if 0 <= x < width and 0 <= y < height]

        given_ends = {*self.before.to_dict()} & {"exit", "exit_one_of", "map"}
        exits = moved(self.exits) if given_ends else [(width - 1, height - 1)]
        if not moved(self.starts) or (self.exits and not exits):
            raise Refused
        self.starts, self.exits = moved(self.starts), exits
        self.blocked = {*moved(self.blocked)}
        self.puddles = {cell: size for at, size in self.puddles.items() for cell in moved([at])}
        self.areas = [(cell, *rest) for at, *rest in self.areas for cell in moved([at])]
        self.items = [[item, moved(cells)] for item, cells in self.items]
        self.switches = [[switch, cell] for switch, at in self.switches for cell in moved([at])]
        self.warps = [
            {**warp, "at": moved([warp["at"]])[0]}
            | ({} if warp["to"] == "start" else {"to": moved([warp["to"]])[0]})
            for warp in self.warps
            if moved([warp["at"]]) and (warp["to"] == "start" or moved([warp["to"]]))
        ]
        self.movers = [new for mover in self.movers for new in moved_mover(mover, moved)]
        self.size = (width, height)
        self.walls = {
            edge: chance
            for (x, y, side), chance in self.walls.items()
            for edge in self.inner([(x + dx, y + dy, side)])
        }
        for door in self.doors:
            door[0] = self.inner([(x + dx, y + dy, side) for x, y, side in door[0]])
        for side, values in self.wind.items():
            shift, new, count = (
                (dx, width, old[0]) if side in ("north", "south") else (dy, height, old[1])
            )
            if values is not None:
                self.wind[side] = [
                    values[i - shift] if 0 <= i - shift < count else 0 for i in range(new)
                ]
        self.cover_ends()

    def blow(self, message: Message) -> None:
        """Set the wind."""
        names = {"N": "north", "E": "east", "S": "south", "W": "west"}
        side, index, strength = message["side"], message["index"], message["strength"]
        count = self.size[0 if side in "NS" else 1]
        if index >= count:
            raise Refused
        for each, value in ((side, strength), ("SWNE"["NESW".index(side)], 0)):
            if each == side or strength:
                values = [*(self.wind.get(names[each]) or [0] * count)]
                values[index] = value
                self.wind[names[each]] = values

    def resolve(self, message: Message) -> None:
        """Write the maze out, which changes nothing."""
        if self.before.maze is None or self.before.has_random_maze:
            raise Refused


def given(model: Any, *without: str) -> dict[str, Any]:
    """Return the given fields of a model as they are in a file."""
    fields: dict[str, Any] = model.model_dump(by_alias=True, exclude_unset=True)
    return {name: value for name, value in fields.items() if name not in without}


def inside(at: Cell, size: Cell) -> list[Cell]:
    """Return the cells of a rectangle."""
    (x, y), (columns, rows) = at, size
    return [(x + i, y + j) for j in range(rows) for i in range(columns)]


def walked(mover: dict[str, Any]) -> list[Cell]:
    """Return the cells to which a mover comes."""
    within = mover.get("within")
    return inside(within["at"], within.get("size", (1, 1))) if within else [*mover["path"]]


def moved_mover(mover: dict[str, Any], moved: Any) -> list[dict[str, Any]]:
    """Return a mover with its cells moved, or nothing where it is cut off."""
    cells = moved(walked(mover))
    new = {name: value for name, value in mover.items() if name != "start"}
    if mover.get("start") and moved([mover["start"]]):
        new["start"] = moved([mover["start"]])[0]
    if mover.get("within"):
        if not cells:
            return []
        (left, top), (right, bottom) = min(cells), max(cells)
        return [
            {**new, "within": {"at": (left, top), "size": (right - left + 1, bottom - top + 1)}}
        ]
    return [{**new, "path": cells}] if len(cells) == len(mover["path"]) else []


def normal(cell: Cell, side: str) -> Edge:
    """Return a side as the E or S side of a cell."""
    x, y = cell
    return {"E": (x, y, "E"), "S": (x, y, "S"), "W": (x - 1, y, "E"), "N": (x, y - 1, "S")}[side]


def edges(opening: Any) -> list[Edge]:
    """Return the sides of a wall, an opening or a door."""
    return [normal(cell, opening.side) for cell in sides_of(opening)]


def entry(edge: Edge) -> dict[str, Any]:
    """Return the entry of one side."""
    x, y, side = edge
    return {"at": (x, y), "side": side}


def cells_at(edge: Edge) -> list[Cell]:
    """Return the two cells at a side."""
    x, y, side = edge
    return [(x, y), (x + 1, y) if side == "E" else (x, y + 1)]


def parts(run: list[Edge]) -> list[list[Edge]]:
    """Return the parts of a run of sides that have no gap."""
    found: list[list[Edge]] = []
    for edge in run:
        x, y, side = edge
        before = (x, y - 1, side) if side == "E" else (x - 1, y, side)
        if found and found[-1][-1] == before:
            found[-1].append(edge)
        else:
            found.append([edge])
    return found


DOES = {
    "walls": Plan.build,
    "paint": Plan.paint,
    "fill": Plan.fill,
    "resize": Plan.resize,
    "wind": Plan.blow,
    "resolve": Plan.resolve,
}
