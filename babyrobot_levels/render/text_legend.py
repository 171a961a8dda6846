"""What the marks of a drawing in text mean, and what of a level it does not show."""

from __future__ import annotations

import string
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain, islice
from typing import NamedTuple

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.situation import Situation
from babyrobot_levels.render.text_plan import (
    BLOCK,
    BOX,
    CLOSED,
    GLASSY,
    ITEMS,
    LOCKED,
    MOVER,
    OFF,
    ON,
    ON_TARGET,
    OPEN,
    TARGET,
    WINDS,
    Palette,
    Position,
    Symbols,
    TextCells,
    TextMark,
    symbols_of,
    winds_to,
)
from babyrobot_levels.render.words import phrases
from babyrobot_levels.render.words.rules import MOST, Rule, spoken, ways_of

_TAKEN = {d.START, d.EXIT, d.SMALL, d.LARGE, LOCKED, "v", *"".join(ITEMS.values())}
"""Letters with a meaning of their own, which no kind of ground has."""

_ENDS = {"start": d.START, "exit": d.EXIT + LOCKED}

_MOST_MARKS = 8
"""How many marks of one kind, such as arrows of warps, a line shows."""


Marks = tuple[tuple[str, Position | None], ...]


class Entry(NamedTuple):
    """A line of a legend.

    Attributes:
        marks: the characters, each with a place where the drawing shows it; None for no such place.
        words: what they mean.
    """

    marks: Marks
    words: str


class Legend(NamedTuple):
    """What a drawing shows, and what it does not."""

    entries: list[Entry]
    not_drawn: list[str]

    def by_color(self, palette: Palette) -> Legend:
        """Return the legend of a picture that shows colours only."""
        found = Legend([], [*self.not_drawn])
        for marks, words in self.entries:
            seen = [
                place
                for mark, place in marks
                if place is not None and palette.style(*place, mark)[1] != palette.base
            ]
            if seen:
                found.entries.append(Entry(tuple((" ", place) for place in seen), words))
            else:
                found.not_drawn.append(words)
        return found


def marked_symbols(
    level: GridWorld, drawing: d.Drawing, rules: Sequence[Rule], *, plain: bool
) -> Symbols:
    """Return the symbols of the cells: each kind of ground without one gets a letter."""
    symbols = symbols_of(level, drawing, plain=plain)
    used = _TAKEN.union(*drawing.cells)
    for rule in rules:
        places = [divmod(cell, drawing.width) for cell in rule.cells]
        free = [(y, x) for y, x in places if symbols[y][x] in (d.PLAIN, *WINDS)]
        if not rule.sample.startswith("cell:") or not free:
            continue
        letters = filter(str.isascii, filter(str.isalpha, rule.text.partition(":")[0].upper()))
        letter = next(
            (
                each
                for each in (*letters, *string.ascii_uppercase, *string.ascii_lowercase)
                if each not in used
            ),
            "",
        )
        if not letter:
            break
        used.add(letter)
        for y, x in free:
            symbols[y][x] = letter
    return symbols


def legend_of(
    level: GridWorld,
    situation: Situation,
    rules: Sequence[Rule],
    symbols: Symbols,
    marks: Mapping[Position, TextMark],
    cells: TextCells,
    *,
    plain: bool,
) -> Legend:
    """Return the legend of a drawing.

    Args:
        level: the level.
        situation: what is where.
        rules: its rules.
        symbols: the symbols that cells show.
        marks: what shows things.
        cells: where the cells are.
        plain: whether the drawing is in ASCII.
    """
    return _Reader(level, situation, symbols, marks, cells, plain).legend(rules)


class _Reader:
    def __init__(
        self,
        level: GridWorld,
        situation: Situation,
        symbols: Symbols,
        marks: Mapping[Position, TextMark],
        cells: TextCells,
        plain: bool,
    ) -> None:
        self._level, self._situation, self._plain = level, situation, plain
        self._cells = cells
        self._things = {mark.character: place for place, mark in reversed([*marks.items()])}
        self._shown = [[*row] for row in symbols]
        for (line, column), mark in marks.items():
            y, x = line // 2, (column - 1) // (cells.width + 1)
            # The lines and columns between cells are those of walls.
            if column % (cells.width + 1) and cells.position(x, y) == (line, column):
                self._shown[y][x] = mark.character
        self._count = Counter(chain.from_iterable(self._shown))

    def legend(self, rules: Sequence[Rule]) -> Legend:
        found = Legend([], [])
        for rule in rules:
            marks, where = self._in_cells(rule) if rule.cells else (self._marks(rule), "")
            name, _, effects = rule.text.partition(": ")
            words = f"{name}{where}: {effects}" if where else rule.text
            if rule.sample == "exit" and self._situation.is_locked:
                words += "; it is locked"
            if marks:
                found.entries.append(Entry(marks, words))
            else:
                found.not_drawn.append(words)
        found.entries.extend(self._others(found.entries))
        found.not_drawn.extend(self._undrawn())
        return found

    def _in_cells(self, rule: Rule) -> tuple[Marks, str]:
        """Return the marks of a rule's cells, and where it holds without a mark of its own."""
        cells = [divmod(cell, self._level.size[0])[::-1] for cell in rule.cells]
        shown = [self._shown[y][x] for x, y in cells]
        count = Counter(shown)
        others = {d.PLAIN, d.START, d.EXIT, *self._things} - {TARGET[self._plain]}
        if rule.sample in _ENDS:
            others = {*count}.difference(_ENDS[rule.sample])
        first = {mark: cells[shown.index(mark)] for mark in count if mark not in others}
        own = {mark for mark in first if count[mark] == self._count[mark]}
        hidden = [cell for cell, mark in zip(cells, shown, strict=True) if mark not in own]
        is_elsewhere = rule.sample == "exit" and not {*hidden}.intersection(self._situation.exits)
        also = ", else" if is_elsewhere else ", also"
        where = f"{also if own else ''} {_at(hidden)}" if hidden else ""
        # Kinds of ground that share a mark are told apart by their cells.
        told = own or {*first}.difference(_TAKEN)
        marks = (self._mark(mark, cell) for mark, cell in first.items() if mark in told)
        return tuple(islice(marks, _MOST_MARKS)), where

    def _mark(self, symbol: str, cell: Cell) -> tuple[str, Position]:
        is_block = symbol == d.BLOCKED and not self._plain
        return BLOCK if is_block else symbol, self._cells.position(*cell)

    def _marks(self, rule: Rule) -> Marks:
        """Return the marks that the drawing has for a rule that is about more than cells."""
        kind, _, name = rule.sample.partition(":")
        column, glass = int(self._plain), self._level.grid().glass
        if kind == "box":
            return self._of_things(BOX[column], ON_TARGET[column])
        if kind in ("item", "switch"):
            return self._of_things(self._marks_of_things[name])
        if kind == "start":
            # Several robots: the drawing has the first letter of each.
            return self._of_things(rule.text[0].upper())
        if kind == "mover":
            return self._of_things(MOVER[column])
        if kind == "glass" and glass:
            return ((GLASSY[column], None),)
        if kind == "wind":
            rows = {mark: y for y, row in enumerate(self._shown) for mark in row if mark in WINDS}
            found = [(mark, (self._shown[rows[mark]].index(mark), rows[mark]))
                     for mark in winds_to(name) if mark in rows]  # fmt: skip
            return tuple(self._mark(*each) for each in found)
        return ()

    def _of_things(self, *marks: str) -> Marks:
        return tuple((mark, self._things[mark]) for mark in marks if mark in self._things)

    @cached_property
    def _marks_of_things(self) -> dict[str, str]:
        """The marks of items and switches, by their names."""
        level, things = self._level, self._level.things()
        marks = {item.name: ITEMS[item.picture][self._plain] for item in level.items}
        for column, is_on in zip(things.fixed, self._situation.on, strict=True):
            if things.kinds[column] == "switch":
                marks[things.names[column]] = ON if is_on else OFF
        return marks

    def _others(self, entries: Sequence[Entry]) -> Iterator[Entry]:
        """Yield where things are that share a mark, or lie somewhere; and what doors are."""
        level, situation = self._level, self._situation
        told = {mark for entry in entries for mark, _ in entry.marks}
        where: dict[str, list[str]] = {}
        lying = {item.name: at for item, at in zip(level.items, situation.items, strict=True)}
        lying |= {switch.name: switch.places for switch in level.switches}
        for name, mark in self._marks_of_things.items():
            if places := lying[name]:
                at = _at(places)
                at = f"{at.replace(' ', ' one of ', 1)}, drawn at reset" if len(places) > 1 else at
                where.setdefault(mark, []).append(f"{spoken([name])} {at}")
        for mark, names in where.items():
            if len(names) > 1 or "one of" in names[0] or mark not in told:
                more = f"; and {len(names) - MOST:,} more" if len(names) > MOST else ""
                yield Entry(self._of_things(mark), "; ".join(names[:MOST]) + more)
        if not all(self._situation.doors):
            also = " or a glass wall" if self._plain and level.grid().glass else ""
            yield Entry(((OPEN[self._plain], None),), f"an open door{also}")
        if any(self._situation.doors):
            yield Entry(((CLOSED[self._plain], None),), "a closed door")

    def _undrawn(self) -> Iterator[str]:
        yield from ways_of(self._level)
        if self._level.heading != "E":
            names = {side: name for name, side in SIDE_NAMES.items()}
            yield f"a robot that turns looks {names[self._level.heading]} at first"


def _at(cells: Sequence[Cell]) -> str:
    if len(cells) <= _MOST_MARKS:
        return f"at {phrases.cells(cells)}"
    return f"in {len(cells):,} cells"
