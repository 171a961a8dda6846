"""Things of a level: their values, what a configuration comes to, and the digest."""

from __future__ import annotations

import gc
import json
from typing import Any
from weakref import ref

import numpy as np
import pytest
from hypothesis import given
from support.things import thing_worlds
from support.worlds import World, level_of

import babyrobot_levels as brl
from babyrobot_levels.text.errors import LevelError

VAULT: World = {
    "version": 1,
    "size": [4, 3],
    "exit_one_of": [[3, 2], [0, 2]],
    "exit_needs": ["gem", "lever"],
    "items": [
        {"name": "key", "at": [1, 0]},
        {"name": "gem", "one_of": [[2, 0], [2, 1], [2, 2]], "reward": 3},
    ],
    "switches": [{"name": "lever", "at": [1, 2]}, {"name": "lamp", "at": [1, 1], "on": True}],
    "movers": [
        {"name": "guard", "path": [[3, 0], [3, 1]], "back": True},
        {"within": {"at": [0, 1], "size": [1, 2]}, "start": [0, 1]},
    ],
    "doors": [
        {"at": [1, 0], "side": "E", "needs": ["key", "lever"]},
        {"at": [0, 0], "side": "S", "unless": ["lamp", "key"]},
        {"at": [2, 2], "side": "E", "length": 1},
    ],
    "hit": {"ends": False},
}


def changed(**fields: Any) -> World:
    return {**VAULT, **fields}


def digest(**fields: Any) -> str:
    return level_of(changed(**fields)).digest


# -- values --------------------------------------------------------------------------------


def test_things_count_exits_items_switches_and_movers() -> None:
    things = level_of(VAULT).things()
    assert things.names == ("exit", "key", "gem", "lever", "lamp", "guard", "mover-2")
    assert things.radices == (2, 2, 4, 2, 2, 2, 2)
    assert len(things) == 7
    assert things.static == 5


def test_no_two_things_have_the_same_name() -> None:
    names = {"gem": "mover-2", "lever": "exit", "key": "the-exit"}
    text = json.dumps(VAULT)
    for name, other in names.items():
        text = text.replace(f'"{name}"', f'"{other}"')
    level, usual = level_of(json.loads(text)), level_of(VAULT)
    things = level.things()
    assert things.names == (
        *("the-the-exit", "the-exit", "mover-2", "exit", "lamp", "guard", "the-mover-2"),
    )
    assert things.kinds == ("exit", "item", "item", "switch", "switch", "mover", "mover")
    assert level.digest == usual.digest


def test_a_level_without_things_has_one_configuration() -> None:
    level = level_of({"version": 1})
    assert level.things().names == ()
    configuration = level.configuration(0)
    assert configuration.exits == ((2, 2),)
    assert configuration.exit_is_open
    assert level.grid_at(0) is level.grid()
    assert list(level.things().draws()) == [()]


def test_a_configuration_tells_what_is_where() -> None:
    at = level_of(VAULT).things().at([1, 0, 2, 0, 1, 1, 1])
    assert at.values == (1, 0, 2, 0, 1, 1, 1)
    assert at.exits == ((0, 2),)
    assert not at.exit_is_open
    assert at.items == ((1, 0), (2, 2))
    assert at.held == ()
    assert at.on == (False, True)
    assert at.movers == ((3, 1), (0, 2))
    assert at.doors == (True, True, False)


@pytest.mark.parametrize(
    ("values", "held", "doors", "is_open"),
    [
        ([0, 0, 0, 0, 0, 0, 0], (), (True, False, False), False),
        ([0, 1, 0, 0, 0, 0, 0], ("key",), (True, True, False), False),
        ([0, 1, 0, 1, 0, 0, 0], ("key",), (False, True, False), False),
        ([0, 0, 0, 0, 1, 0, 0], (), (True, True, False), False),
        ([0, 0, 3, 0, 0, 0, 0], ("gem",), (True, False, False), False),
        ([0, 0, 3, 1, 0, 0, 0], ("gem",), (True, False, False), True),
        ([0, 1, 3, 1, 1, 0, 0], ("key", "gem"), (False, True, False), True),
    ],
    ids=str,
)
def test_doors_and_exits_go_by_what_is_held_and_on(
    values: list[int], held: tuple[str, ...], doors: tuple[bool, ...], is_open: bool
) -> None:
    at = level_of(VAULT).things().at(values)
    assert (at.held, at.doors, at.exit_is_open) == (held, doors, is_open)


def test_episodes_begin_with_any_place_of_what_is_drawn() -> None:
    assert list(level_of(VAULT).things().draws()) == [
        (exit_, 0, gem, 0, 1, 0, 0) for exit_ in (0, 1) for gem in (0, 1, 2)
    ]
    wandering = level_of(changed(movers=[{"within": {"at": [0, 1], "size": [1, 2]}}]))
    assert len(list(wandering.things().draws())) == 2 * 3 * 2


def test_what_lies_under_a_start_is_held_from_the_beginning() -> None:
    things = level_of(changed(start=[[0, 0], [2, 1]])).things()
    assert things.taken_at_start((0, 0, 1, 0, 1, 0, 0), (2, 1)) == (0, 0, 3, 0, 1, 0, 0)
    assert things.taken_at_start((0, 0, 0, 0, 1, 0, 0), (2, 1)) == (0, 0, 0, 0, 1, 0, 0)


# -- configurations of the tables ----------------------------------------------------------


@given(thing_worlds())
def test_grids_have_walls_at_closed_doors_and_nothing_else(world: World) -> None:
    level = level_of(world)
    plain = level.grid()
    for number in range(min(level.compile().num_configurations, 8)):
        at, grid = level.configuration(number), level.grid_at(number)
        more = np.argwhere(plain.open & ~grid.open)
        assert not (grid.open & ~plain.open).any()
        # Two sides for each cell along a closed door.
        closed = [door for door, is_closed in zip(level.doors, at.doors, strict=True) if is_closed]
        assert len(more) == 2 * sum(door.length for door in closed)
        assert (grid.blocked == plain.blocked).all()
        assert grid.glass == plain.glass


def test_a_configuration_that_is_not_there() -> None:
    level = level_of(VAULT)
    with pytest.raises(IndexError):
        level.configuration(level.compile().num_configurations)
    with pytest.raises(IndexError):
        level.grid_at(10**6)


# -- bounds --------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_mapping_is_refused_where_it_is_compiled() -> None:
    items = [{"name": f"coin-{number}", "at": [number, 1]} for number in range(25)]
    level = level_of({"version": 1, "size": [25, 3], "items": items})
    with pytest.raises(LevelError, match="BR404") as caught:
        level.compile()
    assert "25 items (up to 33,554,432)" in str(caught.value)


def test_just_as_many_outcomes_as_there_may_be() -> None:
    # In the middle of its rectangle, each of the movers has four ways to go.
    mover = {"within": {"at": [0, 1], "size": [3, 2]}, "start": [1, 1]}
    fields: World = {"version": 1, "size": [3, 4], "movers": [mover] * 3}
    assert level_of(fields).compile().probability.shape[2] == 64
    for more in ({"skid": 0.5}, {"movers": [mover] * 4}):
        with pytest.raises(LevelError, match="BR405"):
            level_of({**fields, **more}).compile()


# -- digest --------------------------------------------------------------------------------


def renamed(value: Any) -> Any:
    """Return fields with other names for all things."""
    names = {"key": "a", "gem": "b", "lever": "c", "lamp": "d", "guard": "e"}
    if isinstance(value, dict):
        return {key: renamed(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [renamed(inner) for inner in value]
    return names.get(value, value) if isinstance(value, str) else value


def test_names_do_not_change_the_digest() -> None:
    assert level_of(renamed(VAULT)).digest == level_of(VAULT).digest


def test_looks_do_not_change_the_digest() -> None:
    looks = {
        field: [
            {**entry, "color": "red", **({} if field == "doors" else {"label": "x"})}
            for entry in VAULT[field]
        ]
        for field in ("items", "switches", "movers", "doors")
    }
    looks["items"][0]["shape"] = "box"
    looks["doors"][0]["width"] = 9
    assert digest(**looks) == digest()


@pytest.mark.parametrize(
    "fields",
    [
        {"doors": [*reversed(VAULT["doors"])]},
        {"doors": [{"at": [2, 0], "side": "W", "needs": ["lever", "key"]}, *VAULT["doors"][1:]]},
        {"exit_needs": ["lever", "gem"]},
        {"hit": {"reward": -1, "ends": False}},
        {"heading": "S"},
        # A door that is always open is none.
        {"doors": VAULT["doors"][:2]},
    ],
    ids=str,
)
def test_other_ways_of_writing_do_not_change_the_digest(fields: World) -> None:
    assert digest(**fields) == digest()


GEM = VAULT["items"][1]

CHANGES: dict[str, World] = {
    "another door": {"doors": [{"at": [1, 1], "side": "E", "needs": "key"}, *VAULT["doors"][1:]]},
    "no doors": {"doors": []},
    "fewer needs": {"doors": [{**VAULT["doors"][0], "needs": "key"}, *VAULT["doors"][1:]]},
    "other unless": {
        "doors": [VAULT["doors"][0], {**VAULT["doors"][1], "unless": "lamp"}, VAULT["doors"][2]]
    },
    "exit needs less": {"exit_needs": "gem"},
    "exits in another order": {"exit_one_of": [[0, 2], [3, 2]]},
    "one exit": {"exit_one_of": None, "exit": [3, 2]},
    "key elsewhere": {
        "items": [{"name": "key", "at": [2, 0]}, {**GEM, "one_of": [[1, 0], [2, 1]]}]
    },
    "fewer places": {"items": [VAULT["items"][0], {**GEM, "one_of": [[2, 0], [2, 1]]}]},
    "another reward": {"items": [VAULT["items"][0], {**GEM, "reward": 4}]},
    "items in another order": {"items": VAULT["items"][::-1]},
    "once": {"switches": [{**VAULT["switches"][0], "once": True}, VAULT["switches"][1]]},
    "off": {"switches": [VAULT["switches"][0], {"name": "lamp", "at": [1, 1]}]},
    "another path": {"movers": [{"path": [[3, 0], [2, 0]], "back": True}, VAULT["movers"][1]]},
    "no movers": {"movers": []},
    "a hit ends": {"hit": {"ends": True}},
    "a dearer hit": {"hit": {"ends": False, "reward": -2}},
}


@pytest.mark.slow
def test_every_change_of_the_game_changes_the_digest() -> None:
    fields = [
        {name: each for name, each in changed(**change).items() if each is not None}
        for change in ({}, *CHANGES.values())
    ]
    digests = [level_of(each).digest for each in fields]
    assert len({*digests}) == len(digests)


def test_a_door_that_changes_no_transition_changes_the_digest() -> None:
    """It stands between two cells in which no episode goes on."""
    fields: World = {"version": 1, "size": [4, 1], "exit": [[2, 0], [3, 0]]}
    fields["items"] = [{"name": "key", "at": [1, 0]}]
    doors = [{"at": [2, 0], "side": "E", "needs": "key"}]
    assert level_of({**fields, "doors": doors}).digest != level_of(fields).digest


@pytest.mark.slow
@pytest.mark.parametrize("things", [{}, {"items": [{"name": "key", "at": [1, 0]}]}])
def test_tables_end_with_their_level(things: dict[str, Any]) -> None:
    level = brl.load({"version": 1, "size": [4, 3], **things})
    values = brl.evaluate(level, "random").values
    tables, walls = ref(level.compile()), ref(level.grid())
    gc.collect()
    gc.disable()
    try:
        del level
        assert (tables(), walls(), values.size) == (None, None, values.size)
    finally:
        gc.enable()
