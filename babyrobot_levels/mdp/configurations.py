"""Configurations: the value of every thing of a level, and what they come to. Needs no NumPy.

Things count in this order: the drawn exit, items, switches, movers, each as listed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.things import Item, Mover, Switch
from babyrobot_levels.text.words import listed

Cell = tuple[int, int]
Values = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Configuration:
    """What is where while the things of a level have certain values.

    Attributes:
        values: the value of each thing, in the order of `Things.names`.
        exits: the cells `(x, y)` that are exits in this episode.
        exit_is_open: whether an exit ends the episode: what it needs is held, or on.
        items: for each item, the cell in which it lies, None while it is held.
        held: the names of the items that are held.
        on: for each switch, whether it is on.
        movers: for each mover, the cell in which it stands.
        doors: for each door, whether it is closed.
    """

    __module__ = "babyrobot_levels"

    values: Values
    exits: tuple[Cell, ...]
    exit_is_open: bool
    items: tuple[Cell | None, ...]
    held: tuple[str, ...]
    on: tuple[bool, ...]
    movers: tuple[Cell, ...]
    doors: tuple[bool, ...]


class Things:
    """The things of a level, and what their values mean.

    Attributes:
        names: the name of each thing, each another: `exit` for a drawn exit; movers without a name
            are `mover-1`, `mover-2`, …. Where a thing has this name, they begin with `the-`.
        kinds: `"exit"`, `"item"`, `"switch"` or `"mover"`, for each thing.
        radices: how many values each thing has.
    """

    __module__ = "babyrobot_levels"

    def __init__(self, level: LevelFields):
        self.level = level
        named: list[Item | Switch | Mover] = [*level.items, *level.switches, *level.movers]
        taken = {thing.name for thing in named}

        def free(name: str) -> str:
            return free(f"the-{name}") if name in taken else name

        exits = () if level.exit_one_of is None else ((free("exit"), len(level.exit_one_of)),)
        self._items = len(exits)
        self._switches = self._items + len(level.items)
        self._movers = self._switches + len(level.switches)
        self._phases = [mover.phases for mover in level.movers]
        columns = [
            *exits,
            *((item.name, len(item.places) + 1) for item in level.items),
            *((switch.name, 2) for switch in level.switches),
            *(
                (mover.name or free(f"mover-{number}"), len(phases))
                for number, (mover, phases) in enumerate(
                    zip(level.movers, self._phases, strict=True), 1
                )
            ),
        ]
        self.names: tuple[str, ...] = tuple(name for name, _ in columns)
        self.radices: tuple[int, ...] = tuple(count for _, count in columns)
        counts = (len(exits), len(level.items), len(level.switches), len(level.movers))
        kinds = zip(("exit", "item", "switch", "mover"), counts, strict=True)
        self.kinds: tuple[str, ...] = tuple(kind for kind, count in kinds for _ in range(count))

    def __len__(self) -> int:
        return len(self.names)

    @property
    def static(self) -> int:
        """The number of things other than movers, which come first."""
        return self._movers

    @property
    def switches(self) -> slice:
        """Where the values of switches are."""
        return slice(self._switches, self._movers)

    @property
    def items(self) -> slice:
        """Where the values of items are."""
        return slice(self._items, self._switches)

    def met(self, values: Sequence[int]) -> frozenset[str]:
        """Return the names of the items that are held and of the switches that are on."""
        held = {
            item.name
            for item, value in zip(self.level.items, values[self.items], strict=True)
            if value == len(item.places)
        }
        on = {
            switch.name
            for switch, value in zip(self.level.switches, values[self.switches], strict=True)
            if value
        }
        return frozenset(held | on)

    def closed(self, met: frozenset[str]) -> tuple[bool, ...]:
        """Return for each door whether it is closed, by the names of what is held or on."""
        return tuple(
            not met.issuperset(door.keys) or not met.isdisjoint(door.locks)
            for door in self.level.doors
        )

    def exits(self, values: Sequence[int]) -> tuple[Cell, ...]:
        """Return the exits of an episode."""
        places = self.level.exit_one_of
        return self.level.exits if places is None else (places[values[0]],)

    def exit_is_open(self, values: Sequence[int]) -> bool:
        """Return whether an exit ends the episode: what it needs is held, or on.

        Args:
            values: the values of the things; those of movers may be missing.
        """
        return self.met(values).issuperset(self.level.exit_keys)

    def at(self, values: Sequence[int]) -> Configuration:
        """Return what is where while the things have these values, `[things]`."""
        values = tuple(int(value) for value in values)
        met = self.met(values)
        items = self.level.items
        return Configuration(
            values=values,
            exits=self.exits(values),
            exit_is_open=self.exit_is_open(values),
            items=tuple(
                (*item.places, None)[value]
                for item, value in zip(items, values[self.items], strict=True)
            ),
            held=tuple(item.name for item in items if item.name in met),
            on=tuple(value == 1 for value in values[self.switches]),
            movers=tuple(
                phases[value]
                for phases, value in zip(self._phases, values[self.static :], strict=True)
            ),
            doors=self.closed(met),
        )

    def condition(self, values: Sequence[int]) -> str:
        """Return what is held and on, as words: `while key is held and lever is on`.

        It is empty where there is nothing that could be held or on.
        """
        met = self.met(values)
        items = [item.name for item in self.level.items]
        switches = [switch.name for switch in self.level.switches]
        if not items and not switches:
            return ""
        told = [
            f"{listed(names)} {'is' if len(names) == 1 else 'are'} {state}"
            for state, all_names in (("held", items), ("on", switches))
            if (names := [name for name in all_names if name in met])
        ]
        states = ["held"] * bool(items) + ["on"] * bool(switches)
        return "while " + (" and ".join(told) or f"nothing is {' or '.join(states)}")

    def begins(self) -> list[Sequence[int]]:
        """Return for each thing its values at reset, before the robot takes anything."""
        begins: list[Sequence[int]] = []
        if self.level.exit_one_of is not None:
            begins.append(range(len(self.level.exit_one_of)))
        begins += [range(len(item.places)) for item in self.level.items]
        begins += [(int(switch.on),) for switch in self.level.switches]
        for mover, phases in zip(self.level.movers, self._phases, strict=True):
            if mover.within is None:
                begins.append((0,))
            elif mover.start is None:
                begins.append(range(len(phases)))
            else:
                begins.append((phases.index(mover.start),))
        return begins

    def draws(self) -> Iterator[Values]:
        """Yield the values with which episodes may begin, before the robot takes anything."""
        yield from product(*self.begins())

    def taken_at_start(self, values: Values, cell: Cell) -> Values:
        """Return the values at reset: an item that lies under the start is held."""
        taken = list(values)
        for column, item in enumerate(self.level.items, self._items):
            if cell in item.places and item.places[values[column]] == cell:
                taken[column] = len(item.places)
        return tuple(taken)


def largest_radices(one: tuple[int, ...], other: tuple[int, ...]) -> tuple[int, ...]:
    """Return the larger value of each column; columns that only one has are kept."""
    count = min(len(one), len(other))
    return (*map(max, one[:count], other[:count]), *one[count:], *other[count:])
