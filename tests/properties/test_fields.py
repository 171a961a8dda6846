"""No field that changes the tables is forgotten: by words, references, exporters, or a compiler.

A field is named by where it stands: `puddle_types.small.skid.to`. A field of the entries of a list
is named by the list: `walls.pass`. Which fields there are comes from the models of the language.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import chain, islice
from random import Random
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from oracles.random_teams import random_team
from oracles.random_things import add_diagonals, random_level
from pydantic import BaseModel
from support.things import FIELDS as OF_THINGS
from support.worlds import World, level_of, worlds

from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.language.cells import ADDED, PRECEDENCE, Rewards
from babyrobot_levels.language.fields import LevelFields, Role, fields_with
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.compiler import compile_cells
from babyrobot_levels.mdp.compiler.things import compile_things
from babyrobot_levels.render.words.rules import rules_of
from babyrobot_levels.text.errors import LevelError

LOOKS = {"color", "label", "shape", "fit", "doors.width", "walls.width"}
DRAWINGS = {"map", "legend"}
NEEDED = {"items.at", "items.one_of", "movers.path", "movers.within"}
"""Optional fields of which an entry needs one."""

ELSEWHERE = {
    "heading": "it only matters to a robot that turns",
    "robots.start": "without it there is no level",
    **dict.fromkeys(("movers.name", "targets.name"), "names change no tables"),
    **dict.fromkeys(("areas.size", "doors.length", "movers.within.size"), "a place"),
    **dict.fromkeys(("movers.back", "movers.start"), "a way: pictures show it"),
}
"""Fields that change no tables, or only where something is."""

NOT_IN_WORDS = {"switches": "those that nothing needs, which alone can be left out, are not told"}

LOST_WITH = {"rewards.bounce": "walls"}
"""Fields that matter only to something that is lost too, under its name."""

STORED = {"maze.algorithm", "maze.loops"}
"""Mazes are held against stored ones; the reference only grows those of the usual algorithm."""


def models_of(annotation: Any) -> set[type[BaseModel]]:
    """Return the models that a type names anywhere."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {annotation}
    return {model for each in get_args(annotation) for model in models_of(each)}


def fields_of(model: type[BaseModel], within: str = "") -> Iterator[tuple[str, bool]]:
    """Yield where the fields of a model stand, fields in them too, and whether each is needed."""
    for name, field in model.model_fields.items():
        where = within + (field.alias or name)
        if name not in LOOKS and where not in LOOKS:
            yield where, field.is_required() or where in NEEDED
            for inner in models_of(field.annotation):
                yield from fields_of(inner, f"{where}.")


def playing(*roles: Role) -> dict[str, bool]:
    """Return the fields of some roles that may change tables, and whether each is needed."""
    names = {*fields_with(*roles)} - DRAWINGS
    return {
        where: needed for where, needed in fields_of(LevelFields) if where.split(".")[0] in names
    }


def given_in(data: Any, within: str = "") -> Iterator[str]:
    """Yield where the fields stand that some data gives."""
    for each in data if isinstance(data, list) else [data]:
        for name, value in each.items() if isinstance(each, dict) else ():
            yield within + name
            yield from given_in(value, f"{within}{name}.")


def without(data: Any, where: str) -> Any:
    """Return data without a field, in all entries of lists."""
    if isinstance(data, list):
        return [without(each, where) for each in data]
    name, _, rest = where.partition(".")
    if not isinstance(data, dict) or name not in data:
        return data
    if not rest:
        return {key: value for key, value in data.items() if key != name}
    return {**data, name: without(data[name], rest)}


@cache
def drawn_levels() -> list[tuple[World, set[str], Level]]:
    """Return random levels: as data, and the fields that they give."""
    found = [{"version": 1, **random_level(Random(seed))} for seed in range(300)]
    for seed in range(40):
        random = Random(seed)
        add_diagonals(random, fields := {"version": 1, **random_level(random)})
        found.append(fields)
    teams = [random_team(Random(seed)) for seed in range(120)]
    found += [{"version": 1, **fields} for fields in teams if fields is not None]
    return [(world, {*given_in(world)}, Level.from_fields(world)) for world in found]


def contrasts(where: str) -> Iterator[tuple[Level, Level]]:
    """Yield levels, and the same without a field, where that changes the tables.

    Teams, whose tables take longest, are only asked where no level of one robot shows it.
    """
    is_shown = False
    for world, fields, level in drawn_levels():
        if is_shown and "robots" in fields:
            return
        if where in fields:
            try:
                other = Level.from_fields(without(world, where))
                is_changed = level.digest != other.digest
            except LevelError:
                continue
            if is_changed:
                is_shown = True
                yield level, other


@cache
def contrasts_of(where: str) -> list[tuple[Level, Level]]:
    """Return the first of the contrasts of a field."""
    return [*islice(contrasts(where), 3)]


PLAYING = sorted(
    where
    for where, is_needed in playing(Role.DYNAMICS, Role.REWARD).items()
    if not is_needed and where not in ELSEWHERE
)


WRITTEN = [name for name, each in FORMATS.items() if each.is_written and name != "maz"]
"""The formats that levels of all sizes are written in."""

# -- words and exporters --------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("where", PLAYING)
def test_rules_in_words_tell_what_changes_the_tables(where: str) -> None:
    assert contrasts_of(where), "no random level shows what it changes"
    found = chain(contrasts_of(where), islice(contrasts(where), 3, 6))
    is_told = any(rules_of(level) != rules_of(other) for level, other in found)
    assert is_told == (where not in NOT_IN_WORDS)


@pytest.mark.slow
@pytest.mark.parametrize("name", WRITTEN)
def test_exporters_write_or_report_what_changes_the_tables(name: str) -> None:
    silent = []
    for where in PLAYING:
        written = [
            (FORMATS[name].write(level), FORMATS[name].write(other))
            for level, other in contrasts_of(where)
        ]
        reported = [{lost.field for lost in one.warnings} for one, _ in written]
        if all(
            one == other and fields.isdisjoint({*within(where), LOST_WITH.get(where)})
            for (one, other), fields in zip(written, reported, strict=True)
        ):
            silent.append(where)
    assert not silent


def within(where: str) -> set[str]:
    """Return a field, and those in which it stands."""
    parts = where.split(".")
    return {".".join(parts[:count]) for count in range(1, len(parts) + 1)}


# -- references -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_random_levels_with_things_have_every_field() -> None:
    drawn = {where for _, fields, _ in drawn_levels() for where in fields}
    expected = playing(Role.GEOMETRY, Role.DYNAMICS, Role.REWARD).keys()
    assert {where for where in expected - drawn if not where.startswith("maze")} == set()


@pytest.mark.sweep
def test_random_levels_without_things_have_every_field() -> None:
    drawn: set[str] = set()

    @settings(max_examples=250, derandomize=True, database=None, phases=[Phase.generate])
    @given(worlds(4))
    def draw(world: World) -> None:
        drawn.update(given_in(world))

    draw()
    expected = playing(Role.GEOMETRY, Role.DYNAMICS, Role.REWARD).keys()
    left = {where for where in expected - drawn if where.split(".")[0] not in (*OF_THINGS, "moves")}
    assert left == STORED


# -- compilers ------------------------------------------------------------------------------------


def test_every_reward_has_a_precedence() -> None:
    assert {*Rewards.model_fields} <= {*PRECEDENCE, *ADDED}


@given(worlds(5))
@pytest.mark.slow
def test_a_level_without_things_has_the_same_tables_by_both_compilers(world: World) -> None:
    level = level_of(world)
    grid = level.grid()
    one, other = compile_cells(level, grid), compile_things(level, grid)
    assert other.configurations.shape == (1, 0)
    assert (one.start == other.start).all()
    # What no episode reaches has no tables in levels with things.
    for state in np.flatnonzero(~other.is_terminal).tolist():
        assert not one.is_terminal[state]
        for table in ("action_mask", "intended_next_state", "obstruction"):
            assert (getattr(one, table)[state] == getattr(other, table)[state]).all()
        for action in range(5):
            assert one.outcomes(state, action) == other.outcomes(state, action)
