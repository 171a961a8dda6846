"""Which things differ between two levels."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from babyrobot_levels.analysis.changes import Change, Changes
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.kinds import LOOKS, NEEDED, Kind
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.walls import sides_of
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.gridworld import GridWorld

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
            found[f"{kind.field}.{thing.name}", None] = _thing(kind, thing)
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
