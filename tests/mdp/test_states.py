"""Configurations by what is held and on, and states in words."""

from __future__ import annotations

from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.mdp.states import configuration_with, initial_configuration, state_text

LOCKED: dict[str, Any] = {
    "version": 1,
    "size": [5, 2],
    "start": [1, 0],
    "exit": [4, 0],
    "exit_needs": ["gem", "lever"],
    "items": [{"name": "key", "at": [0, 0]}, {"name": "gem", "one_of": [[3, 0], [3, 1]]}],
    "switches": [{"name": "lever", "at": [0, 1]}],
    "doors": [{"at": [2, 0], "side": "E", "needs": "key", "length": 2}],
    "movers": [{"name": "guard", "path": [[1, 1], [2, 1]], "back": True}],
    "hit": {"ends": False},
}


@pytest.mark.parametrize(
    ("names", "held", "on"),
    [
        ([], (), False),
        (["key"], ("key",), False),
        (["lever", "key"], ("key",), True),
        (["key", "gem"], ("key", "gem"), False),
    ],
)
def test_the_configuration_with_some_names(
    names: list[str], held: tuple[str, ...], on: bool
) -> None:
    level = brl.load(LOCKED)
    number = configuration_with(level, names)
    found = level.configuration(number)
    assert (found.held, found.on) == (held, (on,))
    # The guard stands as at reset, and the gem, while it lies, in its first place.
    assert found.movers == ((1, 1),)
    assert found.items[1] == (None if "gem" in names else (3, 0))
    mdp = level.compile()
    alike = [
        other
        for other in map(level.configuration, range(mdp.num_configurations))
        if (other.held, other.on, other.movers) == (held, (on,), found.movers)
    ]
    assert alike[0] == found


def test_movers_stand_elsewhere_where_they_cannot_stand_as_at_reset() -> None:
    # The key is two steps away, and there and back takes the guard four.
    level = brl.load(
        {
            "version": 1,
            "size": [4, 2],
            "exit": [3, 0],
            "items": [{"name": "key", "at": [2, 0]}],
            "areas": [{"at": [2, 0], "ends": True}],
            "movers": [{"path": [[0, 1], [1, 1], [2, 1], [3, 1]], "back": True}],
        }
    )
    moved = level.configuration(configuration_with(level, ["key"]))
    assert moved.held == ("key",)
    assert level.configuration(configuration_with(level, [])).movers == ((0, 1),)


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (["kye"], "the level has no item, switch or target 'kye'; did you mean `key`?"),
        (["guard"], "no item, switch or target 'guard'; it has key, gem and lever"),
        (["gem"], r"exactly gem is held or on; possible are: nothing; lever; key; key,lever; "),
    ],
)
def test_names_that_no_configuration_has(names: list[str], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        configuration_with(brl.load(LOCKED), names)


def test_levels_without_items_and_switches() -> None:
    level = brl.load("final-maze")
    assert configuration_with(level, []) == initial_configuration(level) == 0
    with pytest.raises(ValueError, match="no 'key': it has no items, no switches and no targets"):
        configuration_with(level, ["key"])


def test_what_lies_under_the_start_is_held_at_first() -> None:
    level = brl.load(
        {**LOCKED, "start": [0, 0], "switches": [{"name": "lever", "at": [0, 1], "on": True}]}
    )
    first = level.configuration(initial_configuration(level))
    assert (first.held, first.on) == (("key",), (True,))


def test_states_in_words() -> None:
    level = brl.load(LOCKED)
    mdp = level.compile()

    def told(names: list[str]) -> str:
        return state_text(level.things(), mdp, configuration_with(level, names) * mdp.cells + 8)

    assert told([]) == "[3, 1] while nothing is held or on"
    assert told(["key"]) == "[3, 1] while key is held"
    assert told(["lever"]) == "[3, 1] while lever is on"
    assert told(["key", "gem", "lever"]) == "[3, 1] while key and gem are held and lever is on"
    turning = mdp.turning("E")
    assert state_text(level.things(), turning, 1 * mdp.cells + 8).startswith(
        "[3, 1] looking E while "
    )
    plain = brl.load("final-maze")
    assert state_text(plain.things(), plain.compile(), 9) == "[1, 1]"
