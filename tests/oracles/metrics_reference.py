"""Metrics computed a second time, slowly and by their definitions, from `things_reference`.

A state is a pair of configuration and cell. A path is one of states: each can follow the one before
it, with whatever probability, unless that step ends the episode by a hit.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

from oracles.things_reference import Cell, Configuration, Pair, Reference


class Inert(Reference):
    """A level in which arriving at the items and switches of some names changes nothing."""

    def __init__(self, fields: Mapping[str, Any], inert: Collection[str] = ()) -> None:
        self.inert = inert
        super().__init__(fields)

    def _kept(self, before: Configuration, after: Configuration) -> Configuration:
        values = zip(self.names, before, after, strict=True)
        return tuple(old if name in self.inert else new for name, old, new in values)

    def arrived(self, configuration: Configuration, cell: Cell) -> tuple[Configuration, list[int]]:
        after, taken = super().arrived(configuration, cell)
        here = [index for index in taken if self.items[index]["name"] not in self.inert]
        return self._kept(configuration, after), here

    def _beginnings(self) -> dict[Pair, float]:
        """Return the beginnings, with what lies under a start still there."""
        found: dict[Pair, float] = {}
        for (values, start), chance in super()._beginnings().items():
            lying = list(values)
            for column, places in enumerate(self.item_places, self.first_item):
                if start in places and values[column] == len(places):
                    lying[column] = places.index(start)
            found[self._kept(tuple(lying), values), start] = chance
        return found


class SlowMetrics:
    """The metrics of a level without a maze, from its fields."""

    def __init__(self, fields: Mapping[str, Any], inert: Collection[str] = ()) -> None:
        self.fields = fields
        self.level = Inert(fields, inert)
        self.starts = [self.level.pair(state) for state in self.level.start]
        self.things = [*self.level.items, *self.level.switches]

    # -- paths -----------------------------------------------------------------------------

    def following(self, pair: Pair) -> set[Pair]:
        """Return the states that can follow a state, without those after hits that end."""
        return {
            result.pair
            for results in self.level.results.get(pair, ())
            for result in results
            if not result.over or result.pair not in self.level.results
        }

    def from_some(self, pairs: Iterable[Pair]) -> set[Pair]:
        """Return the states to which a path leads from some states, these included."""
        found, waiting = {*pairs}, [*pairs]
        while waiting:
            new = self.following(waiting.pop()) - found
            found |= new
            waiting += new
        return found

    def occurring(self) -> set[Pair]:
        """Return the states in which an episode begins, goes on, or ends."""
        return self.from_some(self.starts)

    def has_path(self, start: Pair) -> bool:
        """Return whether a path leads from a state to an open exit."""
        return any(self.level.exit_open(*pair) for pair in self.from_some([start]))

    # -- what is needed --------------------------------------------------------------------

    def had(self) -> set[str]:
        """Return the names of the items that are held in some state, and of switches flipped."""
        pairs = self.occurring()
        items = {item["name"] for item in self.level.items}
        return {
            thing["name"]
            for thing in self.things
            for configuration, _ in pairs
            if self.level.has(thing["name"], configuration)
            != (thing["name"] not in items and thing.get("on", False))
        }

    def needs(self) -> tuple[str, ...] | None:
        """Return the names of things without which no exit can be reached from some start."""
        if not all(map(self.has_path, self.starts)):
            return None
        without = {
            thing["name"]: SlowMetrics(self.fields, [thing["name"]]) for thing in self.things
        }
        needed = (
            name for name, other in without.items() if not all(map(other.has_path, other.starts))
        )
        return (*sorted(needed),)

    def dependencies(self) -> int | None:
        """Return the length of the longest chain of things of which each needs the one before."""
        needs = self.needs()
        if needs is None:
            return None
        before = {
            name: [other for other in needs if name not in SlowMetrics(self.fields, [other]).had()]
            for name in needs
        }

        def length(name: str) -> int:
            return 1 + max((length(other) for other in before[name] if other != name), default=0)

        return max(map(length, needs), default=0)
