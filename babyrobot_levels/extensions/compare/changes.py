"""Changes: what differs in one place of two levels; those of transitions, and those of things."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.results import action_names
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.language.cells import sides_of
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.kinds import LOOKS, NEEDED, Kind
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.states import occurring, situation
from babyrobot_levels.mdp.tables import Ints, Mdp


@dataclass(frozen=True, slots=True)
class Change:
    """One thing that differs.

    Attributes:
        before: its value before, as plain data.
        after: its value after.
        cell: its cell, `(x, y)`; None for what is not in one cell.
        name: the side, action, field or thing.
        things: what each thing is, by name, where the change is of one configuration; see
            `situation`.
    """

    before: Any
    after: Any
    cell: tuple[int, int] | None = None
    name: str | None = None
    things: dict[str, Any] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data, without what does not apply."""
        return {
            **({"cell": list(self.cell)} if self.cell is not None else {}),
            **({"name": self.name} if self.name is not None else {}),
            **({"things": self.things} if self.things is not None else {}),
            "before": self.before,
            "after": self.after,
        }


@dataclass(frozen=True, slots=True)
class Changes:
    """Changes of one kind: `count` of `total` places differ; `first` lists the first of them."""

    count: int
    total: int
    first: tuple[Change, ...]

    @classmethod
    def of(
        cls, places: list[Any], total: int, describe: Callable[[Any], Change], limit: int | None
    ) -> Changes:
        """Return the changes at some places, of which only the first `limit` are described."""
        return cls(len(places), total, tuple(map(describe, islice(places, limit))))

    def to_dict(self) -> dict[str, Any]:
        """Return them as plain data."""
        first = [change.to_dict() for change in self.first]
        return {"count": self.count, "total": self.total, "first": first}


NO_CHANGES = Changes(0, 0, ())


_BLOCK = 1 << 16
"""About how many states are compared at a time."""


def transition_changes(
    before: GridWorld, after: GridWorld, cells: tuple[Ints, Ints], limit: int | None
) -> Changes:
    """Return the states and actions that have other outcomes.

    With things, only states in which an episode goes on in both levels are compared, and only by
    what both levels have. With other robots, or in another order, joint actions have other
    meanings, and none are compared.

    Args:
        before: a level.
        after: another one.
        cells: the numbers, in each of the levels, of the cells that both have.
        limit: how many of them are described, None for all.
    """
    levels = (before, after)
    names = [[robot.name for robot in level.robots] for level in levels]
    if names[0] != names[1]:
        return NO_CHANGES
    mdps = (before.compile(), after.compile())
    numbers, codes = _common_configurations(before, after)
    count = len(cells[0])
    per_block = max(1, _BLOCK // count)
    goes_on = [_goes_on(level, mdp) for level, mdp in zip(levels, mdps, strict=True)]
    differ = [np.zeros((0, 2), np.intp)]
    for first in range(0, len(numbers[0]), per_block):
        states = [
            _states(mdp, some[first : first + per_block], where)
            for mdp, some, where in zip(mdps, numbers, cells, strict=True)
        ]
        rows = map(_rows, mdps, states, codes)
        both = goes_on[0][states[0]] & goes_on[1][states[1]]
        found = np.argwhere(_differ(*rows) & both[:, None])
        found[:, 0] += first * count
        differ.append(found)
    width = min(before.size[0], after.size[0])
    actions = action_names("all", mdps[0])

    def describe(place: list[int]) -> Change:
        pair, cell = divmod(place[0], count)
        one, two = (
            _outcome_data(level, mdp, int(some[pair]) * mdp.cells + int(where[cell]), place[1])
            for level, mdp, some, where in zip(levels, mdps, numbers, cells, strict=True)
        )
        things = situation(before, int(numbers[0][pair])) if before.has_things else None
        return Change(one, two, (cell % width, cell // width), actions[place[1]], things)

    total = len(numbers[0]) * count * len(actions)
    return Changes.of(np.concatenate(differ).tolist(), total, describe, limit)


def _common_configurations(
    before: GridWorld, after: GridWorld
) -> tuple[tuple[Ints, Ints], list[Ints]]:
    """Return the configurations that both levels have, and codes by which these are alike.

    Things are alike if they have the same kind, name and number of values, movers also the same
    cells. All others must be as at the beginning, and are no part of the codes: what becomes of
    them is not compared.

    Returns:
        For each level the numbers of the configurations, in the same order; and for each level
        the code of each of its configurations.
    """
    things = [level.things() for level in (before, after)]
    keys = [[*zip(each.kinds, each.names, strict=True)] for each in things]
    values_of = [
        dict(zip(key, (*each.radices[: each.static], *phases), strict=True))
        for key, each, phases in zip(keys, things, (_phases(before), _phases(after)), strict=True)
    ]
    common = [key for key, values in values_of[0].items() if values_of[1].get(key) == values]
    tables, begins = [], []
    for level, each, key in zip((before, after), things, keys, strict=True):
        values = level.compile().configurations
        tables.append(values[:, [key.index(each) for each in common]])
        others = [column for column, name in enumerate(key) if name not in common]
        first = [each.begins()[column][0] for column in others]
        begins.append(np.flatnonzero((values[:, others] == first).all(axis=1)))
    # The constant column is for levels that have no things in common.
    rows = np.concatenate(tables)
    rows = np.concatenate([np.zeros((len(rows), 1), rows.dtype), rows], axis=1)
    inverse = np.unique(rows, axis=0, return_inverse=True)[1].reshape(-1)
    one, two = np.split(inverse, [len(tables[0])])
    _, here, there = np.intersect1d(
        one[begins[0]], two[begins[1]], assume_unique=True, return_indices=True
    )
    return (begins[0][here], begins[1][there]), [one, two]


def _phases(level: GridWorld) -> list[tuple[tuple[int, int], ...]]:
    return [mover.phases for mover in level.movers]


def _goes_on(level: GridWorld, mdp: Mdp) -> NDArray[np.bool_]:
    """Return in which states an episode goes on, `[states]`; without things, in all.

    The rows of other pairs of configuration and cell say nothing about the level.
    """
    if not level.has_things:
        return np.ones(mdp.num_states, np.bool_)
    return occurring(mdp).ravel() & ~mdp.is_terminal


def _states(mdp: Mdp, numbers: Ints, cells: Ints) -> Ints:
    """Return the states of some cells in some configurations, one configuration after the other."""
    return (numbers[:, None] * mdp.cells + cells).ravel()


def _rows(mdp: Mdp, states: Ints, codes: Ints) -> NDArray[np.float64]:
    """Return all outcomes, `[states, actions, outcomes, 4]`, with states numbered alike for all.

    Outcomes are in the order of these numbers. Those that are alike are one.
    """
    configuration, cell = np.divmod(mdp.next_state[states], mdp.cells)
    y, x = np.divmod(cell, mdp.width)
    place = (codes[configuration] * MAX_SIZE + y) * MAX_SIZE + x
    parts = [mdp.probability[states], place, mdp.reward[states], mdp.terminal[states]]
    happens = mdp.probability[states] > 0
    rows = np.stack([np.where(happens, part, 0).astype(np.float64) for part in parts], axis=-1)
    return rows if mdp.num_configurations == 1 else _merged(rows)


def _merged(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return outcomes in order, with those that differ in their probability only added up."""
    rows = _ordered(rows)
    is_first = np.ones(rows.shape[:3], np.bool_)
    is_first[..., 1:] = (rows[..., 1:, 1:] != rows[..., :-1, 1:]).any(axis=-1)
    firsts = np.flatnonzero(is_first)
    sums = np.zeros(is_first.size)
    sums[firsts] = np.add.reduceat(rows[..., 0].ravel(), firsts)
    # Sums of the same probabilities in another order may differ in their last digit.
    rows[..., 0] = np.round(sums.reshape(is_first.shape), 12)
    rows[rows[..., 0] == 0] = 0
    return _ordered(rows)


def _ordered(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return outcomes in the order of their next states, with those that cannot happen last."""
    cannot = rows[..., 0] == 0
    order = np.lexsort([rows[..., 3], rows[..., 2], rows[..., 1], cannot], axis=-1)
    return np.take_along_axis(rows, order[..., None], axis=2)


def _differ(one: NDArray[np.float64], two: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return where rows of outcomes differ, `[states, actions]`."""
    most = max(one.shape[2], two.shape[2])
    one, two = (
        np.pad(row, ((0, 0), (0, 0), (0, most - row.shape[2]), (0, 0))) for row in (one, two)
    )
    differ: NDArray[np.bool_] = (one != two).any(axis=(2, 3))
    return differ


def _outcome_data(level: GridWorld, mdp: Mdp, state: int, action: int) -> list[dict[str, Any]]:
    return [
        {
            "cell": list(mdp.cell(next_state)),
            **(
                {"things": situation(level, mdp.configuration(next_state))}
                if level.has_things
                else {}
            ),
            "probability": probability,
            "reward": reward,
            "ends": terminal,
        }
        for probability, next_state, reward, terminal in mdp.outcomes(state, action)
    ]


Place = tuple[str, tuple[int, int] | None]
"""A thing by its kind and name, or a door by its side, E or S, and cell."""


def thing_changes(before: GridWorld, after: GridWorld, limit: int | None) -> Changes:
    """Return the things that differ: doors by their side, others by name.

    A change is named by the list and the name (`items.key`), or by the side of a door (`doors.E`).
    `before` and `after` are its fields without looks, and None where it does not exist. Where only
    the order differs, by which things count, the change has the name `things`.
    """
    one, two = _things(before), _things(after)
    places = list(dict.fromkeys([*one, *two]))
    differing = [place for place in places if one.get(place) != two.get(place)]

    def describe(place: Place) -> Change:
        name, cell = place
        return Change(one.get(place), two.get(place), cell, name)

    changes = Changes.of(differing, len(places), describe, limit)
    names = [list(Things(level).names) for level in (before, after)]
    if names[0] != names[1] and sorted(names[0]) == sorted(names[1]):
        order = Change(names[0], names[1], name="things")
        return Changes(changes.count + 1, changes.total + 1, (*changes.first, order))
    return changes


def _things(level: LevelFields) -> dict[Place, dict[str, Any]]:
    """Return what each thing of a level is, apart from its looks."""
    found: dict[Place, dict[str, Any]] = {}
    for kind in NEEDED:
        for thing in kind.of(level):
            # What has no name is told apart by its cell.
            cell = None if thing.name else thing.at
            found[f"{kind.field}.{thing.name or ''}", cell] = _thing(kind, thing)
    for box in level.boxes:
        found["boxes.", box.at] = {"at": box.at}
    for robot, start in level.team_starts:
        found[f"robots.{robot.name}", None] = {"start": start, "exit": robot.exit}
    names = Things(level).names
    for name, mover in zip(names[len(names) - len(level.movers) :], level.movers, strict=True):
        way: dict[str, Any] = {"path": mover.path, "back": mover.back}
        if mover.within is not None:
            way = {"within": mover.within.model_dump(), "start": mover.start}
        found[f"movers.{name}", None] = way
    return {place: plain(fields) for place, fields in found.items()} | dict(_doors(level))


def _thing(kind: Kind, thing: Any) -> dict[str, Any]:
    """Return where a thing lies and what it does."""
    fields = {each: getattr(thing, each) for each in kind.properties if each not in LOOKS}
    del fields["name"]
    if "one_of" in fields:
        del fields["at"], fields["one_of"]
        return {"in": thing.places, **fields}
    return fields


def _doors(level: LevelFields) -> Iterator[tuple[Place, dict[str, Any]]]:
    """Yield the sides with doors, and what opens and closes them."""
    for door in level.doors:
        for x, y in sides_of(door):
            cell = (x - (door.side == "W"), y - (door.side == "N"))
            side = "E" if door.side in ("E", "W") else "S"
            fields = {"needs": sorted(door.keys), "unless": sorted(door.locks)}
            yield (f"doors.{side}", cell), fields
