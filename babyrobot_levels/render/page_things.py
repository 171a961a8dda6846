"""What a page shows on its level's ground: things, values and optimal actions.

A thing has several values, and one of them in each configuration. A door is one, open or closed;
so is the exit, if it is drawn or locked. Their pictures are pieces of the scene, each packed once
as a *look*; the page's script shows those of the configuration at hand. What a cell shows of values
and optimal actions is a *mark*: shapes relative to the cell, packed once for all cells and states
that show the same.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from copy import copy
from itertools import repeat
from typing import Any, TypeVar

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.configurations import Configuration
from babyrobot_levels.mdp.grid import door_name, door_sides
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.numeric import is_numeric
from babyrobot_levels.render.colors import rim_on
from babyrobot_levels.render.page_format import BAR, Group, Palette, hexadecimal, length, pack
from babyrobot_levels.render.scene.build import Lengths, arrow_lengths, arrow_shapes, number_form
from babyrobot_levels.render.scene.heat import (
    Heat,
    legend_bar,
    legend_plate,
    legend_shapes,
    legend_texts,
    never_shapes,
    scale_of,
)
from babyrobot_levels.render.scene.icons import Spot
from babyrobot_levels.render.scene.layout import Layout, Overlay
from babyrobot_levels.render.scene.shapes import Shape
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.team import robot_color, teammate_shapes
from babyrobot_levels.render.scene.texts import busy_cells, form_of, number_shapes
from babyrobot_levels.render.scene.things import Piece, mover_shapes, pieces, thing_label
from babyrobot_levels.render.situation import look_of, situation_at


class Marks:
    """The marks of a page.

    Args:
        level: the level.
        layout: where its cells are.
        palette: the palette of the page's picture.
        slots: what stands where in its cells beside answers.
        overlays: everything that the page can show: all of it has one scale and form of numbers.

    Attributes:
        packed: the shapes of each mark.
        tiles: the colour of the cell below each mark, as the palette counts them; -1 for none.
        scale: the scale of the tiles.
        never: the mark of cells in which no robot can be, as far as there are any, else -1.
    """

    def __init__(
        self,
        level: GridWorld,
        layout: Layout,
        palette: Palette,
        slots: Slots,
        overlays: Iterable[Overlay],
    ) -> None:
        self._level, self._layout, self._palette, self._slots = level, layout, palette, slots
        self._set_scale(overlays)
        self._covered = busy_cells(level, layout, slots) | {*level.starts}
        self._numbers: dict[Hashable, int] = {}
        self._by_look: dict[tuple[str, int], int] = {}
        self.packed: list[list[Group]] = []
        self.tiles: list[int] = []
        self.never = -1

    def _set_scale(self, overlays: Iterable[Overlay]) -> None:
        heats = [Heat(self._level, self._layout, each, self._slots) for each in overlays]
        numbers = [value for heat in heats for value in heat.values.values()]
        self.scale = scale_of(numbers, self._level.resolved_theme.colors)
        self._precision = heats[0].overlay.precision if heats else 0
        self._form = number_form(numbers, self._precision)

    def on_own_scale(self, overlays: Iterable[Overlay]) -> Marks:
        """Return marks beside these, with the scale and the form of numbers of other overlays."""
        other = copy(self)
        other._numbers = {key: number for key, number in self._numbers.items() if key == "never"}
        other._set_scale(overlays)
        return other

    @property
    def legend(self) -> list[Group]:
        """The legend of the tiles; no groups where the picture has none."""
        if not self._layout.legend:
            return []
        bar, ends = legend_bar(self._layout), (self.scale.low, self.scale.high)
        box = map(length, (bar.left, bar.top, bar.width, bar.height))
        plate, texts = (
            pack(shapes, self._palette, self._layout.margin)
            for shapes in (
                [legend_plate(self._level, self._layout)],
                legend_texts(self._level, self._layout, self.scale, form_of(ends, self._precision)),
            )
        )
        colors = [BAR, -1, *box, *map(self.scale.step, ends)]
        return [*plate, [0, 0, [colors]], *texts]

    @property
    def drawn_legend(self) -> list[Group]:
        """The same in colours of its own, which are not those of the page's scale."""
        if not self._layout.legend:
            return []
        form = form_of((self.scale.low, self.scale.high), self._precision)
        shapes = legend_shapes(self._level, self._layout, self.scale, form)
        return pack(shapes, self._palette, self._layout.margin)

    def values(self, overlays: Iterable[Overlay]) -> list[int]:
        """Return the mark of each cell's value in each overlay in turn; -1 for none."""
        marks = []
        for overlay in overlays:
            values = Heat(self._level, self._layout, overlay, self._slots).values
            marks += [
                self._value(cell, values[cell]) if cell in values else self._blank(cell, overlay)
                for cell in self._layout.cells()
            ]
        return marks

    def actions(
        self, overlays: Iterable[Overlay], others: Iterable[Overlay] = repeat(Overlay())
    ) -> list[int]:
        """Return the mark of each cell's actions in each overlay in turn; -1 for none.

        Where there are any, those of another overlay are light arrows beside them.
        """
        marks = []
        for overlay, other in zip(overlays, others, strict=False):
            lengths, light = (
                dict(arrow_lengths(each, self._slots, self._layout)) for each in (overlay, other)
            )
            for cell in self._layout.cells():
                found, beside = lengths.get(cell), light.get(cell, {})
                marks.append(
                    self._actions(cell, found, beside) if found else self._blank(cell, overlay)
                )
        return marks

    def _blank(self, cell: Cell, overlay: Overlay) -> int:
        """Return the mark of a cell without answers."""
        if cell not in overlay.never:
            return -1
        if self.never < 0:
            shapes = never_shapes(self._level, Overlay(never=frozenset([cell])), self._layout)
            self._add("never", cell, shapes)
            self.never = self._numbers["never"]
        return self.never

    def _value(self, cell: Cell, value: float) -> int:
        box, color = self._slots.plan(cell).number, self.scale.color(value)
        key = "value", box, value, cell in self._covered
        if key not in self._numbers:
            ground = color if cell in self._covered else None
            box = box.moved(*self._layout.corner(*cell))
            shapes = number_shapes(value, self._form, box, rim_on([color]), ground)
            self._add(key, cell, shapes, self._palette.place(color))
        return self._numbers[key]

    def _actions(self, cell: Cell, lengths: Lengths, light: Lengths) -> int:
        parts = [light, lengths]
        key = "actions", self._slots.plan(cell).arrow, *(tuple(part.items()) for part in parts)
        if key not in self._numbers:
            color = self._level.resolved_theme.colors.arrows
            shapes = [
                shape
                for part, ink in zip(parts, (rim_on([color]), color), strict=True)
                for shape in arrow_shapes([(cell, part)], self._slots, self._layout, ink)
            ]
            self._add(key, cell, shapes)
        return self._numbers[key]

    def _add(self, key: Hashable, cell: Cell, shapes: Iterable[Shape], tile: int = -1) -> None:
        left, top = (length(edge) for edge in self._layout.corner(*cell))
        groups = pack(shapes, self._palette, self._layout.margin)
        mark = [[x - left, y - top, packed] for x, y, packed in groups]
        # Values that differ in what is not shown look the same.
        number = self._by_look.setdefault((repr(mark), tile), len(self.packed))
        self._numbers[key] = number
        if number == len(self.packed):
            self.packed.append(mark)
            self.tiles.append(tile)


Thing = dict[str, Any]

_Value = TypeVar("_Value", bound=Hashable)

_ONE_CELL = Layout(1, 1, 0.0, 0.0, 0.0)


def things_data(
    level: GridWorld, layout: Layout, palette: Palette
) -> tuple[list[Thing], list[list[Group]]]:
    """Return the things of a page, and the looks that they refer to.

    A thing has its `kind` and `name`, and its value in each configuration (`values`). What else it
    has depends on its kind:

    - `looks`: the looks of each value; that of a mover is its figure around (0, 0). The last value
      is that of a thing that is held or on, and of a door that is closed.
    - `cells` of things in cells: where they are, a list for each value.
    - `icon` of what can be held or on: the look that tells that it is, with the left and upper
      edges and the side of the square around it.
    - `sides` of doors: pairs of a cell and of the move that the closed door refuses there.
    - `exits` and `needs` of the exit: the cells at which the episode ends, and what opens them.
    - `cells` of boxes: the one of each value.
    - `label` of movers: the look of the label in the cell whose corner is (0, 0), -1 for none.
    - Of several robots, those but the first are like movers.

    Args:
        level: a level with things; a maze needs a seed.
        layout: where its cells are.
        palette: the palette of the page's picture.
    """
    return _Things(level, layout, palette).data()


def team_data(level: GridWorld) -> dict[str, Any]:
    """Return the robots of a level with several, and what is different on its page."""
    arrived = _arrivals(level) if is_numeric() else [[0]] * len(level.robots)
    robots = [
        {"name": robot.name, "color": hexadecimal(robot_color(level, number)), "arrived": found}
        for number, (robot, found) in enumerate(zip(level.robots, arrived, strict=True))
    ]
    return {"robots": robots, "ends_first": level.team.ends == "first", "learn": False}


def _arrivals(level: GridWorld) -> list[list[int]]:
    """Return for each of several robots whether it has arrived, 0 or 1, in each configuration."""
    things, columns = level.things(), level.things().of_kind("robot")
    configurations = level.compile().configurations
    return [
        (configurations[:, column] >= things[column].first_arrived).astype(int).tolist()
        for column in range(columns.start, columns.stop)
    ]


class _Things:
    def __init__(self, level: GridWorld, layout: Layout, palette: Palette) -> None:
        self.level, self.layout, self.palette = level, layout, palette
        self.things = level.things()
        # Without NumPy, the level is shown as it begins.
        self.configurations = (
            level.compile().configurations.tolist()
            if is_numeric()
            else [list(next(self.things.draws()))]
        )
        self.looks: list[list[Group]] = []
        self.pieces: dict[tuple[Any, ...], tuple[int, Piece]] = {}
        # Doors and exits depend on what is held and on, and not on movers.
        static = [tuple(values[: self.things.static]) for values in self.configurations]
        first = _first(static)
        self.found = [self.things.at(self.configurations[number]) for number in first.values()]
        numbers = {values: number for number, values in enumerate(first)}
        self.place = [numbers[values] for values in static]
        self.exits = list(dict.fromkeys(map(_exit_of, self.found)))
        self.add_looks([*first.values()])

    def add_looks(self, first: Sequence[int]) -> None:
        """Add the pieces of some configurations that show everything that there is."""
        shown: set[int] = set()
        for column in zip(*self.configurations, strict=True):
            shown.update(_first(column).values())
        seen: set[Any] = set()
        for number, configuration in zip(first, self.found, strict=True):
            kinds = {*enumerate(configuration.doors), _exit_of(configuration)}
            if not kinds <= seen:
                seen |= kinds
                shown.add(number)
        for number in sorted(shown):
            situation = situation_at(self.level, self.things.at(self.configurations[number]))
            for piece in pieces(self.level, self.layout, situation):
                if piece.name not in self.pieces:
                    self.pieces[piece.name] = self.add(piece.shapes), piece

    def add(self, shapes: Any) -> int:
        """Add a look and return its number."""
        self.looks.append(pack(shapes, self.palette, self.layout.margin))
        return len(self.looks) - 1

    def find(self, *names: tuple[Any, ...]) -> list[int]:
        """Return the looks of the pieces that there are."""
        return [self.pieces[name][0] for name in names if name in self.pieces]

    def icon(self, name: tuple[Any, ...]) -> list[int]:
        """Return a piece's look, and the square around it: left, top and side."""
        number, piece = self.pieces.get(name, (-1, None))
        if piece is None:
            return [-1, 0, 0, 0]
        left, top, right, _ = piece.box
        return [number, length(left), length(top), length(right - left)]

    def data(self) -> tuple[list[Thing], list[list[Group]]]:
        standing = [*self.exit(), *self.fixed(), *self.items(), *self.boxes(), *self.doors()]
        return [*standing, *self.movers(), *self.robots()], self.looks

    def exit(self) -> Iterator[Thing]:
        level = self.level
        if level.exit_one_of is None and not level.exit_keys:
            return
        numbers = [self.exits.index(_exit_of(configuration)) for configuration in self.found]
        yield {
            "kind": "exit",
            "name": "exit",
            "needs": list(level.exit_keys),
            "values": self.listed(numbers),
            "looks": [
                self.find(
                    *(("exit", cell, False) for cell in cells),
                    *(("lock", cell) for cell in cells if not is_open),
                )
                for cells, is_open in self.exits
            ],
            "exits": [
                [self.number_of(cell) for cell in cells] if is_open else []
                for cells, is_open in self.exits
            ],
        }

    def fixed(self) -> Iterator[Thing]:
        for number, column in enumerate(self.things.fixed):
            thing = self.things[column]
            yield {
                "kind": thing.kind,
                "name": self.things.names[column],
                "values": self.column(column),
                "looks": [self.find((thing.kind, number, is_on)) for is_on in (False, True)],
                "cells": [[self.number_of(thing.entry.at)]] * 2,
                "icon": self.icon((thing.kind, number, True)),
            }

    def items(self) -> Iterator[Thing]:
        for number, item in enumerate(self.level.items):
            yield {
                "kind": "item",
                "name": item.name,
                "values": self.column(self.things.items.start + number),
                "looks": [*(self.find(("item", number, cell, False)) for cell in item.places), []],
                "cells": [*([self.number_of(cell)] for cell in item.places), []],
                "icon": self.icon(("held", number, True)),
            }

    def boxes(self) -> Iterator[Thing]:
        """Yield the boxes; what one looks like depends on its cell alone."""
        boxes = self.things.of_kind("box")
        for column in range(boxes.start, boxes.stop):
            values = self.column(column)
            cells = [*self.layout.cells()]
            places = sorted({*values})
            number = {value: place for place, value in enumerate(places)}
            yield {
                "kind": "box",
                "name": self.things.names[column],
                "values": [number[value] for value in values],
                "looks": [self.find(("box", cells[value])) for value in places],
                "cells": [[value] for value in places],
            }

    def doors(self) -> Iterator[Thing]:
        sides: list[list[int]] = [[] for _ in self.level.doors]
        for cell, side, number in door_sides(self.level, self.level.grid()):
            sides[number] += cell, SIDES.index(side) + 1
        for number, door in enumerate(self.level.doors):
            yield {
                "kind": "door",
                "name": door_name(door),
                "values": self.listed([int(each.doors[number]) for each in self.found]),
                "looks": [
                    self.find(*(("door", number, cell, is_closed) for cell in sides_of(door)))
                    for is_closed in (False, True)
                ],
                "sides": sides[number],
            }

    def movers(self) -> Iterator[Thing]:
        level, static = self.level, self.things.static
        for number, mover in enumerate(level.movers):
            ways = [look_of(mover, phase) for phase in range(len(mover.phases))]
            figures = {way: self.add(mover_shapes(level, number, Spot(0, 0), way)) for way in ways}
            label = tuple(thing_label(level, _ONE_CELL, (0, 0), mover.label))
            yield {
                "kind": "mover",
                "name": self.things.names[static + number],
                "values": self.column(static + number),
                "looks": [[figures[way]] for way in ways],
                "cells": [[self.number_of(cell)] for cell in mover.phases],
                "label": self.add(label) if label else -1,
            }

    def robots(self) -> Iterator[Thing]:
        """Yield the robots but the first; what one looks like depends on whether it has arrived."""
        columns = self.things.of_kind("robot")
        for mate, column in enumerate(range(columns.start + 1, columns.stop), 1):
            thing, values = self.things[column], self.column(column)
            looks = [
                self.add(teammate_shapes(self.level, mate, Spot(0, 0), arrived=home))
                for home in (False, True)
            ]
            places = sorted({*values})
            number = {value: place for place, value in enumerate(places)}
            yield {
                "kind": "robot",
                "name": self.things.names[column],
                "values": [number[value] for value in values],
                "looks": [[looks[value >= thing.first_arrived]] for value in places],
                "cells": [[value % thing.first_arrived] for value in places],
                "label": -1,
            }

    def listed(self, values: list[int]) -> list[int]:
        """Return the value in each configuration of something that movers do not change."""
        return [values[place] for place in self.place]

    def column(self, number: int) -> list[int]:
        """Return the value of a thing in each configuration."""
        return [values[number] for values in self.configurations]

    def number_of(self, cell: Cell) -> int:
        return cell[1] * self.layout.columns + cell[0]


def _first(values: Iterable[_Value]) -> dict[_Value, int]:
    """Return the different ones of some values, each with the place of the first of its kind."""
    first: dict[_Value, int] = {}
    for place, value in enumerate(values):
        first.setdefault(value, place)
    return first


def _exit_of(configuration: Configuration) -> tuple[tuple[Cell, ...], bool]:
    """Return the exits of an episode, and whether they are open."""
    return configuration.exits, configuration.exit_is_open
