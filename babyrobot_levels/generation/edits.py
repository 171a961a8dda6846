"""Random edits of a level: something is added, moved or removed, by the table of kinds."""

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from babyrobot_levels.generation.locks import COIN_REWARD, GUARD_CELLS, KEY_COLORS
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.language.kinds import KIND, LISTED, NAMED, NEEDED
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.drawn import inner_walls
from babyrobot_levels.mdp.gridworld import check_one_robot
from babyrobot_levels.mdp.mazes.lattice import below

Entry = dict[str, Any]
Fields = dict[str, Any]
"""The fields of a level as plain data; of changes, None for a field that goes."""

_OF_THE_FORM = ("map", "legend", "maze", "walls", "openings")
_OF_THE_ORIGINAL = ("name", *fields_with(Role.TEXT, Role.EXPECTATION))
"""What is said of a level that need not be true of one that is made of it."""


def flat_fields(level: Level) -> Fields:
    """Return a level as lists of entries, without a drawing or a maze; each wall is of one cell.

    Texts, `expect` and the name are left out.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    check_one_robot(level, "edits at random")
    left_out = {*_OF_THE_FORM, *_OF_THE_ORIGINAL}
    fields = {
        name: value for name, value in level.to_dict(whole=True).items() if name not in left_out
    }
    fields |= {"size": plain(level.size), "start": plain(level.start)}
    if level.exit_one_of is None:
        fields["exit"] = plain(level.exit)
    for kind in LISTED:
        if kind.field not in _OF_THE_FORM:
            entries = kind.of(level)
            fields[kind.field] = [
                plain(entry.model_dump(by_alias=True, exclude_unset=True)) for entry in entries
            ]
    fields["walls"] = [
        {"at": [x, y], "side": side, **traits}
        for (side, x, y), traits in inner_walls(level, level.grid()).items()
    ]
    return {name: value for name, value in fields.items() if value != []}


def changed(fields: Fields, changes: Fields) -> Fields:
    """Return fields with changes."""
    return {name: value for name, value in {**fields, **changes}.items() if value not in (None, [])}


def entries_in(fields: Fields) -> int:
    """Return how many entries lists have, and the lists in these."""
    listed = [value for value in fields.values() if isinstance(value, list)]
    within = (
        part
        for value in listed
        for entry in value
        if isinstance(entry, dict)
        for part in entry.values()
        if isinstance(part, list)
    )
    return sum(map(len, listed)) + sum(max(0, len(part) - 2) for part in within)


class Edits:
    """Draws edits of a level, which may turn out not to be valid.

    Args:
        fields: the level, as `flat_fields` has it.
        rng: what is drawn is drawn from here.
    """

    def __init__(self, fields: Fields, rng: random.Random) -> None:
        self.fields, self.rng = fields, rng
        self.width, self.height = fields["size"]

    def drawn(self, kind: str) -> Fields | None:
        """Return the fields that an edit of a kind changes; None if there is nothing to edit."""
        if kind == "wind":
            return self._wind()
        if kind in ("start", "exit"):
            return self._other_end(kind)
        if KIND[kind].where == "side" and self.width * self.height == 1:
            return None
        how = below(self.rng, 3)
        if how == 0:
            return _ADDED[kind](self) if kind in _ADDED else None
        entries = [*filter(self._is_within, self.fields.get(KIND[kind].field, []))]
        if not entries:
            return None
        entry = self._one_of(entries)
        return self._replaced(kind, entry, self._moved(kind, entry) if how == 1 else None)

    # -- entries ---------------------------------------------------------------------------

    def _added(self, kind: str, entry: Entry) -> Fields:
        field = KIND[kind].field
        return {field: [*self.fields.get(field, []), entry]}

    def _replaced(self, kind: str, old: Entry, new: Entry | None) -> Fields:
        field = KIND[kind].field
        entries = (new if each is old else each for each in self.fields[field])
        return {field: [each for each in entries if each is not None]}

    def _moved(self, kind: str, entry: Entry) -> Entry:
        """Return an entry in another place."""
        if KIND[kind].where == "side":
            return {**entry, **self._side()}
        if "path" in entry:
            return {**entry, **self._patrol()}
        if "within" in entry:
            within = {**entry["within"], "at": self._cell()}
            return {**{name: entry[name] for name in entry if name != "start"}, "within": within}
        if "one_of" in entry:
            return {**entry, "one_of": self._exchanged(entry["one_of"])}
        return {**entry, "at": self._cell()}

    def _is_within(self, entry: Entry) -> bool:
        """Return whether an entry is no part of the outer wall, which always stays."""
        if "side" not in entry:
            return True
        (x, y), side = entry["at"], entry["side"]
        return bool(
            (x + (side == "E")) in range(side == "W", self.width)
            and (y + (side == "S")) in range(side == "N", self.height)
        )

    def _other_end(self, kind: str) -> Fields | None:
        """Return another start, or another exit."""
        field = next(name for name in KIND[kind].fields[::-1] if name in self.fields)
        value = self.fields[field]
        if value == "none":
            return None
        return {field: self._cell() if isinstance(value[0], int) else self._exchanged(value)}

    def _exchanged(self, cells: Sequence[Any]) -> list[Any]:
        """Return cells, one of which is another."""
        place = below(self.rng, len(cells))
        return [self._cell() if number == place else cell for number, cell in enumerate(cells)]

    def _wind(self) -> Fields | None:
        """Return the wind with one more or one less column or row, or with another one."""
        columns, rows = ("north", "south"), ("west", "east")
        given = self.fields.get("wind") or {}
        wind = {
            side: [*(given.get(side) or [0] * count)]
            for sides, count in ((columns, self.width), (rows, self.height))
            for side in sides
        }
        lines = [(sides, n) for sides in (columns, rows) for n in range(len(wind[sides[0]]))]
        windy = [line for line in lines if any(wind[side][line[1]] for side in line[0])]
        still = [line for line in lines if line not in windy]
        how = below(self.rng, 3)
        if how:
            if not windy:
                return None
            sides, number = self._one_of(windy)
            for side in sides:
                wind[side][number] = 0
        if how < 2:
            if not still:
                return None
            sides, number = self._one_of(still)
            wind[self._one_of(sides)][number] = 1
        blows = {side: pushes for side, pushes in wind.items() if any(pushes)}
        kept = {name: given[name] for name in ("varies", "probability") if name in given}
        return {"wind": {**blows, **kept} if blows else None}

    # -- what is drawn ---------------------------------------------------------------------

    def _one_of(self, choices: Sequence[Any]) -> Any:
        return choices[below(self.rng, len(choices))]

    def _cell(self) -> list[int]:
        return [below(self.rng, self.width), below(self.rng, self.height)]

    def _side(self) -> Entry:
        """Draw a side between two cells, all equally likely."""
        upright = (self.width - 1) * self.height
        number = below(self.rng, upright + self.width * (self.height - 1))
        if number < upright:
            y, x = divmod(number, self.width - 1)
            return {"at": [x, y], "side": "E"}
        y, x = divmod(number - upright, self.width)
        return {"at": [x, y], "side": "S"}

    def _patrol(self) -> Entry:
        """Draw a way to walk there and back, which walls may cut, so that it is not valid."""
        fewest, most = GUARD_CELLS
        path = [self._cell()]
        for _ in range(fewest - 1 + below(self.rng, most - fewest + 1)):
            x, y = path[-1]
            path.append(self._one_of([[x, y - 1], [x + 1, y], [x, y + 1], [x - 1, y]]))
        return {"path": path, "back": True}

    def _unused(self, name: str) -> str:
        """Return a name that no thing has."""
        used = {each.get("name") for kind in NAMED for each in self.fields.get(kind.field, [])}
        numbered = (f"{name}-{number}" for number in range(2, len(used) + 3))
        return next(each for each in (name, *numbered) if each not in used)

    # -- what is added ---------------------------------------------------------------------

    def _new_door(self) -> Fields:
        """Return a door; what opens it is there already and of no use yet, or is a new key."""
        entries = [each for kind in NEEDED for each in self.fields.get(kind.field, [])]
        needed = [each["name"] for each in entries if each.get("name") is not None]
        doors, exits = self.fields.get("doors", []), self.fields.get("exit_needs", ())
        used = str([doors, exits])
        if free := [name for name in needed if f"'{name}'" not in used]:
            return self._added("door", {**self._side(), "needs": self._one_of(free)})
        color = [*KEY_COLORS.values()][len(doors) % len(KEY_COLORS)]
        name = self._unused("key")
        key = {"name": name, "at": self._cell(), "shape": "key", "color": color}
        door = {**self._side(), "needs": name, "color": color}
        return self._added("item", key) | self._added("door", door)

    def _new_coin(self) -> Fields:
        coin = {"name": self._unused("coin"), "at": self._cell(), "shape": "coin"}
        return self._added("item", {**coin, "reward": COIN_REWARD})


_ADDED: Mapping[str, Callable[[Edits], Fields]] = {
    "wall": lambda edits: edits._added("wall", edits._side()),
    "puddle": lambda edits: edits._added(
        "puddle", {"at": edits._cell(), "size": edits._one_of(["small", "large"])}
    ),
    "item": Edits._new_coin,
    "door": Edits._new_door,
    "mover": lambda edits: edits._added(
        "mover", {"name": edits._unused("guard"), **edits._patrol()}
    ),
    "switch": lambda edits: edits._added(
        "switch", {"name": edits._unused("switch"), "at": edits._cell()}
    ),
    "box": lambda edits: edits._added("box", {"at": edits._cell()}),
    "target": lambda edits: edits._added("target", {"at": edits._cell()}),
    "warp": lambda edits: edits._added("warp", {"at": edits._cell(), "to": edits._cell()}),
    "blocked": lambda edits: edits._added("blocked", {"at": edits._cell()}),
}
"""How an entry of a kind is added."""

EDITED = ("wall", "puddle", "wind", "item", "door", "mover", "start", "exit")
"""The kinds that are edited by default."""

EDITABLE = tuple(name for name in KIND if name not in ("opening", "robot"))
"""The kinds that can be edited: a wall that is removed is an opening."""
