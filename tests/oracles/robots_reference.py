"""Several robots in the plainest way, written from the document alone, beside `things_reference`.

What the moves of one robot come to is asked of the reference for a level with one; everything that
robots do together is here: dictionaries, lists and loops. It takes valid levels without `map`.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from oracles.things_reference import (
    MOVES,
    STAY,
    Cell,
    Configuration,
    Landing,
    Reference,
    cell_of,
    cells_of,
    shares_of,
)

Place = tuple[Cell, bool]
"""Where a robot is, and whether it has arrived there."""


class Joint(NamedTuple):
    """A state: the values of things but robots, and the place of each robot."""

    configuration: Configuration
    places: tuple[Place, ...]


class Result(NamedTuple):
    """What a step of all leads to."""

    probability: float
    state: Joint
    shares: tuple[float, ...]
    over: bool


class _Alone(Reference):
    """A robot by itself: targets are told by their values, and end nothing."""

    def _search(self) -> None:
        pass

    def has(self, name: str, configuration: Configuration) -> bool:
        for index, target in enumerate(self.targets):
            if target.get("name") == name:
                return configuration[self.first_target + index] == 1
        return super().has(name, configuration)

    def solved(self, configuration: Configuration) -> bool:
        return False


class TeamReference:
    """The joint states of a level with several robots, and what steps come to."""

    def __init__(self, fields: Mapping[str, Any]) -> None:
        self.robots = fields["robots"]
        team = fields.get("team", {})
        self.meet = team.get("meet", "block")
        self.stays = team.get("arrived", "leave") == "stay"
        self.first_ends = team.get("ends", "all") == "first"
        common = fields.get("exit")
        given = iter(cells_of(fields.get("start")))
        if common is None and "exit_one_of" not in fields:
            has_all = all(robot.get("exit") for robot in self.robots)
            width, height = fields.get("size", (3, 3))
            corner = [width - 1, height - 1]
            common = "none" if has_all or fields.get("targets") else corner
        self.alone: list[_Alone] = []
        for robot in self.robots:
            own = {
                name: value
                for name, value in fields.items()
                if name not in ("robots", "team", "start", "exit", "exit_one_of", "exit_weights")
            }
            own["start"] = [*(cell_of(robot["start"]) if "start" in robot else next(given))]
            if robot.get("exit"):
                own["exit"] = robot["exit"]
            elif "exit_one_of" in fields:
                own["exit_one_of"] = fields["exit_one_of"]
            else:
                own["exit"] = common
            self.alone.append(_Alone(own))
        self.drawn = "exit_one_of" in fields
        self.rewards = fields.get("rewards", {})
        has_exits = any(each.exits or each.exit_places for each in self.alone) or self.drawn
        self.ends_covered = bool(fields.get("targets")) and not has_exits
        self.fields = fields
        self._search()

    def _own(self, robot: int, configuration: Configuration) -> Configuration:
        """Return a configuration as the level of one robot has it: with a drawn exit or without."""
        if self.drawn and not self.alone[robot].exit_places:
            return configuration[1:]
        return configuration

    def _columns(self) -> _Alone:
        """Return a level that has all columns."""
        return next((each for each in self.alone if each.exit_places), self.alone[0])

    @property
    def drawn_column(self) -> int:
        """How many columns come before those of the first level."""
        return 1 if self.drawn and not self._columns().exit_places else 0

    def present(self, place: Place) -> bool:
        """Return whether a robot is in the level."""
        return self.stays or not place[1]

    def settled(self, here: list[Cell], wants: list[Cell], present: list[bool]) -> set[int]:
        """Return who stays since another hinders it."""
        robots = [number for number in range(len(here)) if present[number]]
        goes = {number for number in robots if wants[number] != here[number]}
        stays: set[int] = set()
        for one, other in itertools.combinations(sorted(goes), 2):
            if wants[one] == here[other] and wants[other] == here[one]:
                stays |= {one, other}
            elif wants[one] == wants[other]:
                stays |= {other} if self.meet == "order" else {one, other}
        while True:
            kept = [number for number in robots if number not in goes - stays]
            taken = {here[number] for number in kept}
            more = {number for number in goes - stays if wants[number] in taken}
            if not more:
                return stays
            stays |= more

    def step(self, state: Joint, actions: tuple[int, ...]) -> Iterator[Result]:
        """Yield what actions of all lead to."""
        options: list[list[Landing]] = []
        for number, (place, action) in enumerate(zip(state.places, actions, strict=True)):
            if place[1]:
                options.append([Landing(1.0, place[0])])
            else:
                own = self._own(number, state.configuration)
                options.append([*self.alone[number].landings(own, place[0], action)])
        for landings in itertools.product(*options):
            if all(landing.probability > 0 for landing in landings):
                yield from self._landed(state, actions, landings)

    def _landed(
        self, state: Joint, actions: tuple[int, ...], landings: tuple[Landing, ...]
    ) -> Iterator[Result]:
        numbers = range(len(landings))
        here = [cell for cell, _ in state.places]
        away = [arrived for _, arrived in state.places]
        there = [landing.cell for landing in landings]
        present = [self.present(place) for place in state.places]
        kept: set[int] = set()
        collided: set[int] = set()
        if self.meet == "end":
            for one, other in itertools.combinations(numbers, 2):
                swap = there[one] == here[other] and there[other] == here[one]
                moved = there[one] != here[one]
                meets = there[one] == there[other] or (swap and moved)
                if present[one] and present[other] and meets:
                    collided |= {one, other}
            collided = {number for number in collided if not away[number]}
        elif self.meet != "pass":
            kept = self.settled(here, there, present)
            there = [here[number] if number in kept else there[number] for number in numbers]
        values, rewards = list(state.configuration), []
        for number in numbers:
            taken: float | None = None
            arrives = landings[number].sent or there[number] != here[number]
            if arrives and not away[number] and number not in kept:
                taken = self._arrives(number, values, there[number])
            rewards.append(taken)
        base = self._columns()
        shift = self.drawn_column
        before = base.covered(state.configuration[shift:])
        for index, target in enumerate(base.targets):
            values[shift + base.first_target + index] = int(
                any(
                    present[number] and there[number] == cell_of(target["at"]) for number in numbers
                )
            )
        now = base.covered(tuple(values)[shift:])
        added = 0.0
        if now != before:
            added = self.rewards.get("covered" if now > before else "uncovered") or 0.0
        moves = [
            base.mover_options(mover, state.configuration[shift:])
            for mover in range(len(base.movers))
        ]
        probability = 1.0
        for landing in landings:
            probability *= landing.probability
        for each in moves:
            probability /= len(each)
        for steps in itertools.product(*moves):
            after = (*values[: shift + base.first_mover], *steps)
            for share in self._drawn_in(there):
                chance = probability * share
                yield self._ended(
                    state, actions, landings, chance, there, after, rewards, added, kept, collided
                )

    def _drawn_in(self, cells: list[Cell]) -> Iterator[float]:
        """Let the cells of robots have each of the rewards that they may have for them."""
        if not cells:
            yield 1.0
            return
        for share in self.alone[len(cells) - 1].drawn_in(cells[-1]):
            for others in self._drawn_in(cells[:-1]):
                yield share * others

    def _arrives(self, robot: int, values: list[int], cell: Cell) -> float | None:
        """Let a robot arrive in a cell; return the reward of an item that it takes."""
        base, shift, found = self._columns(), self.drawn_column, None
        for index, places in enumerate(base.item_places):
            at, item = shift + base.first_item + index, base.items[index]
            may = item.get("robot") in (None, self.robots[robot]["name"])
            if may and values[at] < len(places) and places[values[at]] == cell:
                values[at] = len(places)
                if item.get("reward") is not None:
                    found = item["reward"]
        for index, switch in enumerate(base.switches):
            at = shift + base.first_switch + index
            flips = not switch.get("once", False) or values[at] == int(switch.get("on", False))
            if flips and cell_of(switch["at"]) == cell:
                values[at] = 1 - values[at]
        return found

    def _ended(
        self,
        state: Joint,
        actions: tuple[int, ...],
        landings: tuple[Landing, ...],
        probability: float,
        there: list[Cell],
        after: Configuration,
        taken: list[float | None],
        added: float,
        kept: set[int],
        collided: set[int],
    ) -> Result:
        base, shift = self._columns(), self.drawn_column
        solved = self.ends_covered and base.covered(after[shift:]) == len(base.targets)
        over, shares, places = solved or bool(collided), [], []
        arrived_now = False
        for number, (cell, away) in enumerate(state.places):
            alone, own = self.alone[number], self._own(number, after)
            if away:
                shares.append(0.0)
                places.append((cell, True))
                continue
            was = self._own(number, state.configuration)
            hit = alone.is_hit((was, cell), (own, there[number]))
            leaves = alone.exit_open(own, there[number])
            over |= there[number] in alone.ending or (hit and alone.hit_ends)
            arrived_now |= leaves
            meets = self.rewards.get("meet") if number in kept | collided else None
            plain = number in kept
            landing, action = landings[number], actions[number]
            share: float
            if hit:
                share = alone.hit_reward
            elif meets is not None:
                share = meets
            elif landing.warp_reward is not None and not plain:
                share = landing.warp_reward
            elif leaves or solved:
                share = alone.worth_of_exit(there[number])
            elif taken[number] is not None:
                share = taken[number] or 0.0
            elif plain:
                share = alone.cell_reward[there[number]]
            else:
                share = alone._reward(action, (was, cell), (own, there[number]), landing, [])
            bounced = landing.bounced and not plain
            shares.append(share + (alone.bounce_reward if bounced else 0.0) + added)
            places.append((there[number], leaves))
        waited = [
            places[number][1]
            for number in range(len(places))
            if self.alone[number].exits or self.alone[number].exit_places
        ]
        over |= arrived_now if self.first_ends else bool(waited) and all(waited)
        return Result(probability, Joint(after, tuple(places)), tuple(shares), over)

    def _beginnings(self) -> dict[Joint, float]:
        base, shift = self._columns(), self.drawn_column
        starts = [each.starts[0] for each in self.alone]
        draws: list[Any] = []
        if self.drawn:
            draws.append(range(len(self.fields["exit_one_of"])))
        draws += [range(len(places)) for places in base.item_places]
        draws += [[int(switch.get("on", False))] for switch in base.switches]
        draws += [[int(cell_of(target["at"]) in starts)] for target in base.targets]
        for mover, cells in zip(base.movers, base.mover_cells, strict=True):
            if "path" in mover:
                draws.append([0])
            elif mover.get("start") is None:
                draws.append(range(len(cells)))
            else:
                draws.append([cells.index(cell_of(mover["start"]))])
        combinations = [*itertools.product(*draws)]
        found: dict[Joint, float] = {}
        for drawn in combinations:
            values = list(drawn)
            for number, start in enumerate(starts):
                for index, places in enumerate(base.item_places):
                    at = shift + base.first_item + index
                    may = base.items[index].get("robot") in (None, self.robots[number]["name"])
                    if may and values[at] < len(places) and places[values[at]] == start:
                        values[at] = len(places)
            state = Joint(tuple(values), tuple((start, False) for start in starts))
            share = 1.0
            if self.drawn:
                places = [cell_of(each) for each in self.fields["exit_one_of"]]
                chances = shares_of(places, self.fields.get("exit_weights"))
                share = chances[places[drawn[0]]] * len(places)
            found[state] = found.get(state, 0.0) + share / len(combinations)
        return found

    def _search(self) -> None:
        self.start = self._beginnings()
        self.results: dict[Joint, dict[tuple[int, ...], dict[tuple[Any, ...], float]]] = {}
        waiting = deque(self.start)
        every = [*itertools.product((STAY, *MOVES), repeat=len(self.robots))]
        while waiting:
            state = waiting.popleft()
            if state in self.results:
                continue
            rows = self.results[state] = {}
            for actions in every:
                total: dict[tuple[Any, ...], float] = {}
                for probability, following, shares, over in self.step(state, actions):
                    key = following, shares, over
                    total[key] = total.get(key, 0.0) + probability
                    if not over:
                        waiting.append(following)
                rows[actions] = total

    def allowed(self, state: Joint, robot: int) -> set[int]:
        """Return the valid actions of a robot."""
        cell, away = state.places[robot]
        alone, own = self.alone[robot], self._own(robot, state.configuration)
        if away:
            return {STAY}
        if cell in alone.warps and alone.warps[cell].when == "leave":
            return {STAY, *MOVES}
        return {STAY} | {
            move
            for move in MOVES
            if alone.glass(own, cell, move) > 0 or not alone.never_goes(own, cell, move)
        }
