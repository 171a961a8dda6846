"""Levels made of other levels: by random edits, and by crossing two."""

import random
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from pydantic import ValidationError

from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.generation.candidates import Candidate, Maker
from babyrobot_levels.generation.edits import (
    EDITABLE,
    EDITED,
    Edits,
    Entry,
    Fields,
    changed,
    entries_in,
    flat_fields,
)
from babyrobot_levels.generation.search import UnsatisfiableError, find_level
from babyrobot_levels.language.documents import grown_from_mapping
from babyrobot_levels.language.kinds import LISTED, NAMED
from babyrobot_levels.language.ranges import bounds
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.language.things import as_names, hit_reward
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.drawn import inner_walls, wall_entries
from babyrobot_levels.mdp.grid import placement_issues
from babyrobot_levels.mdp.mazes.lattice import below
from babyrobot_levels.text import budget
from babyrobot_levels.text.words import check_choice, listed

MOST_DRAWN = 1_000
"""So many edits are drawn for one, of which most may not be valid."""

MOST_EDITS = 1_000

MUTANT_FIELDS = ("seed", "splits", "path_length", "dead_ends", "detour", "difficulty", "expect")
"""The fields of a suite that are conditions on mutants, or how they are drawn."""

ROOM = budget.Limits(1_000_000_000, 1_000_000)
"""Of a level with larger tables, another one is drawn."""

CHECK, ENTRY = 100, 5_000
"""Steps of work for a cell, and for an entry, of a level that is made and checked."""


def mutate(
    level: Any,
    *,
    seed: int,
    edits: int | str = 1,
    kinds: Sequence[str] = EDITED,
    solvable: bool = True,
    expect: Mapping[str, Any] | None = None,
) -> Level:
    """Return a level that differs from another by random edits.

    An edit adds, moves or removes one wall (of one cell), puddle, item (a coin), door (with a new
    key, unless there is an item or a switch of no use), guard, or line of wind; or it moves a start
    or an exit. Every level on the way is valid, and the last one is another MDP than the first.
    The same arguments give the same level, on every platform.

    Args:
        level: a name, a path, a mapping or a `Level`. Its texts and its own `expect` are left out
            of the mutant, and its maze becomes walls.
        seed: a whole number.
        edits: how many edits; a range such as `"1..5"` draws how many.
        kinds: what is edited, all equally often, by the names `wall`, `puddle`, `wind`, `item`,
            `door`, `mover`, `start`, `exit`, and beside these defaults `switch`, `box`, `target`,
            `warp`, `blocked`, and `area`, which are only moved and removed.
        solvable: whether the optimal policy must reach the exit with probability 1, unless `expect`
            has another `success`. Levels without an exit have none to reach.
        expect: what must be true of the metrics, as in `expect` of level files: `{"best_steps":
            "20..30"}`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, its maze has no seed, or `expect` is not valid.
        UnsatisfiableError: no mutant was found that meets the conditions.
        ValueError: another argument has an invalid value.
    """
    original = load(level)
    mutants = Mutants(original, edits, kinds, _conditions(seed, expect), solvable=solvable)
    return find_level(mutants, 0, is_new=lambda other: other.digest != original.digest).level


def crossover(
    first: Any,
    second: Any,
    *,
    seed: int,
    solvable: bool = True,
    expect: Mapping[str, Any] | None = None,
) -> Level:
    """Return a level with one part of a level, and of another of the same size the other part.

    A column or row is drawn at which they are cut. What stands in the cells of a part comes with
    it, doors only if what opens them does; a part without start or exit takes that of its level
    along. All that has no place (rewards, the discount, …) is of the first level.

    Args:
        first: a name, a path, a mapping or a `Level`.
        second: likewise.
        seed: a whole number.
        solvable: as in `mutate`.
        expect: as in `mutate`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, a maze has no seed, or `expect` is not valid.
        UnsatisfiableError: no level was found that meets the conditions.
        ValueError: the levels differ in size or have one cell, or the seed is no whole number.
    """
    one, other = load(first), load(second)
    if one.size == other.size == (1, 1):
        raise ValueError("levels of one cell have no parts that could be crossed")
    if one.size != other.size:
        sizes = " and ".join(f"{level.width}x{level.height}" for level in (one, other))
        raise ValueError(f"levels that are crossed must have the same size, not {sizes}")
    return find_level(Crossed(one, other, _conditions(seed, expect), solvable=solvable), 0).level


def _conditions(seed: int, expect: Mapping[str, Any] | None) -> SuiteFields:
    """Return conditions as a suite has them.

    Raises:
        ValueError: the seed is no whole number from 0 on.
        LevelError: `expect` is not valid.
    """
    seed = check_count("seed", seed, 0, 2**53)
    given = {"version": 1, "kind": "suite", "count": 1, "seed": seed}
    # With a guard, all metrics may be expected.
    return grown_from_mapping({**given, "guards": 1, "expect": dict(expect or {})})


class Mutant(Candidate):
    """A level made of others, as a candidate."""

    def __init__(self, level: Level) -> None:
        self._grown, self.size = level, level.size
        vars(self)["level"] = level

    is_placed = is_playable = True
    is_surely_won = False
    needs_its_doors = True

    @cached_property
    def has_room(self) -> bool:
        """Whether its tables are not too large."""
        return budget.fits(ROOM, self.level.compile)

    @property
    def path_length(self) -> int:
        """The length of a shortest path without things and wind; -1 if there is none."""
        length = self.metrics.path_length
        return -1 if length is None else length - self.detour

    @property
    def detour(self) -> int:
        """How many steps things and wind add to it."""
        return self.metrics.detour or 0

    @property
    def dead_ends(self) -> int:
        """The number of cells with exactly one open side."""
        return self.metrics.dead_ends


class Descendants(Maker):
    """Draws levels that are made of others.

    Args:
        level: the level whose exits and time limit they have.
        suite: the seed, the conditions and the splits.
        solvable: whether each must be won by its optimal policy.
        names: the names of the levels, as for `Maker`; empty for none.
        first: the index of the first level in its name.
    """

    is_made_of_others = True

    def __init__(
        self,
        level: Level,
        suite: SuiteFields,
        *,
        solvable: bool = True,
        names: str = "",
        first: int = 0,
    ) -> None:
        is_won = solvable and level.has_goal
        limit = level.max_steps if is_won else None
        fields = {"size": level.size, "max_steps": limit}
        super().__init__(suite.model_copy(update=fields), names, first=first)
        if not is_won:
            self.promised = {}

    def draw(self, number: int, attempt: int) -> Candidate:
        """Return a candidate for a level."""
        fields, made = self._made(self._rng(number, attempt))
        walls = [*wall_entries(inner_walls(made, made.grid()))]
        fields = changed(fields, {"walls": walls, "name": self.name(number) or None})
        level = valid(fields)
        assert level is not None
        return Mutant(level)

    def _made(self, rng: random.Random) -> tuple[Fields, Level]:
        """Return a level, and before it its fields."""
        raise NotImplementedError


class Mutants(Descendants):
    """Draws mutants of a level; see `mutate` for the arguments, and `Descendants` for others.

    Raises:
        LevelError: the maze of the level has no seed yet.
        ValueError: `edits` or `kinds` has an invalid value.
    """

    def __init__(
        self, level: Level, edits: int | str, kinds: Sequence[str], suite: SuiteFields, **more: Any
    ) -> None:
        kinds = [kinds] if isinstance(kinds, str) else kinds
        for kind in kinds:
            check_choice("kinds", kind, EDITABLE)
        if not kinds:
            raise ValueError("kinds must name at least one kind to edit")
        least, most = bounds(edits)
        if not all(type(number) is int for number in (least, most)):
            example = "a whole number or a range such as '1..5'"
            raise ValueError(f"edits must be {example}, not {edits!r}")
        if not 1 <= least <= most <= MOST_EDITS:
            raise ValueError(f"edits must be from 1 to {MOST_EDITS:,}, not {edits}")
        super().__init__(level, suite, **more)
        self._edits, self._kinds, self._fields = (least, most), [*kinds], flat_fields(level)
        self._hit = {"reward": hit_reward(level.rewards, level.size)}

    def _made(self, rng: random.Random) -> tuple[Fields, Level]:
        least, most = self._edits
        more = least - 1 + below(rng, most - least + 1)
        made = self._edited(self._fields, rng)
        for _ in range(more):
            made = self._edited(made[0], rng)
        return made

    def _edited(self, before: Fields, rng: random.Random) -> tuple[Fields, Level]:
        """Return a valid level with one edit more."""
        edits = Edits(before, rng)
        for _ in range(MOST_DRAWN):
            changes = edits.drawn(self._kinds[below(rng, len(self._kinds))])
            if not changes:
                continue
            if "movers" in changes and not {"movers", "hit"} & before.keys():
                # By default, a hit would cost less than the way.
                changes = {"hit": self._hit, **changes}
            fields = changed(before, changes)
            if (level := valid(fields)) is not None and fields != before:
                return fields, level
        reason = f"none of {MOST_DRAWN:,} edits of {listed(self._kinds, 'and')} is valid"
        raise UnsatisfiableError("edits", "", reason)


class Crossed(Descendants):
    """Draws crossings of two levels of the same size; see `crossover`."""

    def __init__(self, one: Level, other: Level, suite: SuiteFields, *, solvable: bool) -> None:
        super().__init__(one, suite, solvable=solvable)
        self._parents = flat_fields(one), flat_fields(other)

    def _made(self, rng: random.Random) -> tuple[Fields, Level]:
        for _ in range(MOST_DRAWN):
            fields = _cross(*self._parents, rng)
            if (level := valid(fields)) is not None:
                return fields, level
        raise UnsatisfiableError("", "", f"none of {MOST_DRAWN:,} crossings is valid")


def _cross(one: Fields, other: Fields, rng: random.Random) -> Fields:
    """Return one part of a level and the other part of another, which may not be valid."""
    line, is_below = below(rng, sum(one["size"]) - 2), bool(below(rng, 2))
    columns = one["size"][0] - 1
    axis, cut = (0, line) if line < columns else (1, line - columns)

    def is_first(cell: Any) -> bool:
        return bool(cell[axis] > cut) == is_below

    made: Fields = {}
    for kind in LISTED:
        made[kind.field] = [
            entry
            for fields, is_own in ((one, True), (other, False))
            for entry in fields.get(kind.field, [])
            if all(is_first(cell) == is_own for cell in _cells(entry))
        ]
    names: set[str] = set()
    for kind in NAMED:
        # Of two things with one name, the first stays.
        unique = {each.get("name", number): each for number, each in enumerate(made[kind.field])}
        made[kind.field] = [each for name, each in unique.items() if name not in names]
        names |= {name for name in unique if isinstance(name, str)}
    made["doors"] = [
        door
        for door in made["doors"]
        if names.issuperset((*as_names(door.get("needs", ())), *as_names(door.get("unless", ()))))
    ]
    for field in ("start", "exit"):
        if field in one and "none" not in (one[field], other.get(field, "none")):
            own, others = (_cells({"at": fields[field]}) for fields in (one, other))
            kept = [cell for cell in own if is_first(cell)]
            kept = kept or [cell for cell in others if not is_first(cell)] or own
            made[field] = kept if len(kept) > 1 else kept[0]
    return changed(one, made)


def _cells(entry: Entry) -> list[Any]:
    """Return the cells in which an entry stands, of a rectangle two corners."""
    entry = entry.get("within", entry)
    cells = entry.get("path") or entry.get("one_of") or entry["at"]
    if not isinstance(cells[0], int):
        return [*cells]
    size = entry.get("size")
    if not isinstance(size, list):
        # That of a puddle is a word.
        return [cells]
    return [cells, [at + count - 1 for at, count in zip(cells, size, strict=True)]]


def valid(fields: Fields) -> Level | None:
    """Return the level of some fields; None if it is not valid.

    Raises:
        OverBudgetError: to check it takes more work than is left.
    """
    width, height = fields["size"]
    budget.spend(CHECK * width * height + ENTRY * entries_in(fields))
    try:
        level = Level.model_validate(fields)
    except ValidationError:
        return None
    is_placed = not level.stands_on_grid or not placement_issues(level, level.grid())
    return level if is_placed else None
