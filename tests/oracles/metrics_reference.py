"""Metrics computed a second time, slowly and by their definitions, from `things_reference`.

Optimal values are those of many sweeps, for levels with a discount well below 1. A state is a pair
of configuration and cell. A path is one of states: each can follow the one before it, with whatever
probability, unless that step ends the episode by a hit.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

from oracles.things_reference import Cell, Configuration, Pair, Reference, Result

THINGS = ("items", "doors", "switches", "movers", "exit_needs", "wind")
SWEEPS = 120
TOLERANCE = 2e-9
"""Which values are the same; actual ones that differ by less are rare."""


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
        return any(self.level.won(*pair) for pair in self.from_some([start]))

    def path_length(self) -> int | None:
        """Return the steps to the nearest exit from the start from which they are the most."""
        if not all(map(self.has_path, self.starts)):
            return None
        lengths = []
        for start in self.starts:
            length, there = 0, {start}
            while not any(self.level.won(*pair) for pair in there):
                length, there = length + 1, there.union(*map(self.following, there))
            lengths.append(length)
        return max(lengths)

    def detour(self) -> int | None:
        """Return how many steps more there are than without doors, movers, needs and wind."""
        kept = {name: value for name, value in self.fields.items() if name not in THINGS}
        length, direct = self.path_length(), SlowMetrics(kept).path_length()
        return None if length is None or direct is None else length - direct

    def reachable(self) -> float:
        """Return the share of the cells in which an episode can be."""
        free = {*self.level.cells} - {*self.level.blocked}
        return len({cell for _, cell in self.occurring()}) / len(free)

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

    def distractors(self) -> int:
        """Return how many things that are had can stay without effect, from last to first."""
        idle: list[str] = []
        had, best = self.had(), self.optimum()
        for thing in reversed(self.things):
            name = thing["name"]
            without = SlowMetrics(self.fields, [*idle, name]).optimum()
            if name in had and without >= best - TOLERANCE * max(1, abs(best)):
                idle.append(name)
        return len(idle)

    # -- optimal policies, and mistakes ------------------------------------------------------

    def expected(self, results: Iterable[Result], values: Mapping[Pair, float]) -> float:
        """Return what is expected of an action, by the values of states."""
        discount = self.fields["discount"]
        return sum(
            each.probability * (each.reward + (0 if each.over else discount * values[each.pair]))
            for each in results
        )

    @cached_property
    def values(self) -> dict[Pair, float]:
        """The optimal value of each state from which an episode goes on."""
        table = self.level.results
        values = dict.fromkeys(table, 0.0)
        for _ in range(SWEEPS):
            values = {
                pair: max(self.expected(each, values) for each in table[pair]) for pair in table
            }
        return values

    def at_start(self, values: Mapping[Pair, float]) -> float:
        """Return what is expected of an episode, by the values of states."""
        chances = self.level.start
        return sum(chances[state] * values.get(self.level.pair(state), 0.0) for state in chances)

    def optimum(self) -> float:
        """Return the optimal return."""
        return self.at_start(self.values)

    def best_actions(self, pair: Pair) -> list[int]:
        """Return the optimal actions in a state, ties included."""
        ahead = [self.expected(results, self.values) for results in self.level.results[pair]]
        return [action for action, value in enumerate(ahead) if value >= max(ahead) - TOLERANCE]

    @cached_property
    def optimal(self) -> tuple[set[Pair], set[Pair]]:
        """The states that some optimal policy comes to, and those at which a hit may end it."""
        found, waiting, hits = {*self.starts}, [*self.starts], set[Pair]()
        table = self.level.results
        while waiting:
            pair = waiting.pop()
            for action in self.best_actions(pair) if pair in table else ():
                for result in table[pair][action]:
                    if result.over and result.pair in table:
                        hits.add(result.pair)
                    elif result.pair not in found:
                        found.add(result.pair)
                        waiting.append(result.pair)
        return found, hits

    def is_optimal(self, result: Result) -> bool:
        """Return whether a step comes to what some optimal policy comes to as well."""
        states, hits = self.optimal
        return result.pair in (
            hits if result.over and result.pair in self.level.results else states
        )

    def irreversible(self) -> float:
        """Return the share of states from which nothing can be reached that is optimal."""
        table, occurring = self.level.results, self.occurring()
        lost = [
            pair
            for pair in occurring
            if pair not in self.optimal[0]
            and not any(
                self.is_optimal(result)
                for each in self.from_some([pair])
                for results in table.get(each, ())
                for result in results
            )
        ]
        return len(lost) / len(occurring)

    def decisions(self) -> int:
        """Return in how many states of optimal policies a valid action may lead elsewhere."""
        table = self.level.results
        return sum(
            not all(
                self.is_optimal(result)
                for action in self.level.allowed(self.level.state(pair))
                for result in table[pair][action]
            )
            for pair in self.optimal[0]
            if pair in table
        )

    def fragility(self) -> float:
        """Return the least that optimal policies lose if one of ten steps is any valid one."""
        return self.optimum() - self.expected_return(
            {pair: self.best_actions(pair) for pair in self.level.results}, mistakes=0.1
        )

    def expected_return(self, choices: Mapping[Pair, Sequence[int]], mistakes: float) -> float:
        """Return what is expected of the best choices if a share of the steps is any valid one."""
        table = self.level.results
        valid = {pair: self.level.allowed(self.level.state(pair)) for pair in table}
        values = dict.fromkeys(table, 0.0)
        for _ in range(SWEEPS):
            ahead = {
                pair: [self.expected(each, values) for each in results]
                for pair, results in table.items()
            }
            values = {
                pair: (1 - mistakes) * max(ahead[pair][action] for action in choices[pair])
                + mistakes * sum(ahead[pair][action] for action in valid[pair]) / len(valid[pair])
                for pair in table
            }
        return self.at_start(values)

    def success(self, policy: Mapping[Pair, int], steps: int) -> tuple[float, float]:
        """Return how likely a policy is at an exit after some steps, and how likely still going."""
        going = {self.level.pair(state): chance for state, chance in self.level.start.items()}
        arrived = 0.0
        for _ in range(steps):
            after: dict[Pair, float] = {}
            for pair, chance in going.items():
                for result in self.level.results[pair][policy[pair]] if pair in policy else ():
                    share = chance * result.probability
                    if self.level.won(*result.pair):
                        arrived += share
                    elif not result.over:
                        after[result.pair] = after.get(result.pair, 0.0) + share
            going = after
        return arrived, sum(going.values())
