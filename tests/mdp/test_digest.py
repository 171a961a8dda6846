"""The digest: pinned for ever, blind to the way of writing, awake to every change of the game."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from support.worlds import World, decorated_worlds, level_of, level_of_text, worlds

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.grid import Grid

PINS = {
    "smallest": (
        "version: 1\n",
        "sha256:ea0853c83746c0b0aaf648ec2ffc830de849bc468c9b6d60dad8bb6cdab47d14",
    ),
    "maze": (
        "version: 1\nsize: [7, 5]\nmaze: {seed: 42}\n",
        "sha256:6d9b3c2593164fc1aa0b5cc564313550589e808938df5e54db0d0044aefd0f07",
    ),
    "braided": (
        "version: 1\nsize: [7, 5]\nmaze: {seed: 42, loops: 0.5}\n",
        "sha256:954072b154b145395ebfe73982fc169401ffaecd5a0343b6ede7b9238c1d092d",
    ),
    "slippery": (
        "version: 1\nsize: [4, 4]\nskid: {probability: 0.75, to: sides}\n"
        "areas: [{at: [1, 1], ends: true, reward: -1}]\nrewards: {step: 0, exit: 1}\n",
        "sha256:109863f4acc771a215d82ad8ca57cf71982199a3af144809bc06e2368919c0af",
    ),
    "everything": (
        "version: 1\n"
        "map: |\n"
        "  +---+---+---+---+\n"
        "  | S   o :   | S |\n"
        "  +   +- -+   +   +\n"
        "  |### ###| O   ~ |\n"
        "  +---+---+   +---+\n"
        "  |       |     E |\n"
        "  +---+---+---+---+\n"
        "legend: {'~': {skid: {probability: 0.25, to: others}, reward: -0.5}}\n"
        "walls: [{at: [1, 0], side: E, pass: 0.25}]\n"
        "warps: [{at: [2, 2], to: start, reward: -10}, {at: [0, 2], to: [3, 2], when: leave}]\n"
        "wind: {east: [0, 1, 0]}\n"
        "rewards: {bump: -3, bounce: -2, closer: 0.5, stay: -0.25}\n",
        "sha256:d1ad7efa8a9e40808f2230e3663cfc0a8987689e4b73d8b46da2c51cd24eb7ab",
    ),
}


@pytest.mark.parametrize("name", PINS)
def test_digests_are_pinned(name: str) -> None:
    """What changes one of these changes the digest of every level: it needs a new version."""
    text, expected = PINS[name]
    assert level_of_text(text).digest == expected


def digest(**fields: Any) -> str:
    return level_of({"version": 1, **fields}).digest


# -- what does not change it -------------------------------------------------------------------


@pytest.mark.slow
@given(decorated_worlds())
def test_texts_looks_and_limits_do_not_change_it(world: World) -> None:
    game = {
        name: value
        for name, value in world.items()
        if name
        not in {
            "name",
            "title",
            "description",
            "author",
            "license",
            "source",
            "tags",
            "discount",
            "max_steps",
            "theme",
            "display",
        }
    }
    assert level_of(world).digest == level_of(game).digest


@given(worlds())
@pytest.mark.slow
def test_a_maze_written_out_as_walls_is_the_same_game(world: World) -> None:
    level = level_of(world)
    fields = {name: value for name, value in world.items() if name not in ("maze", "openings")}
    assert level_of({**fields, "walls": written_out(level.grid())}).digest == level.digest


def written_out(grid: Grid) -> list[World]:
    """Return every inner wall of a grid as an entry of its own."""
    return [
        {"at": [cell % grid.width, cell // grid.width], "side": side}
        | ({"pass": grid.glass[cell, side]} if (cell, side) in grid.glass else {})
        for cell, bits in enumerate(grid.wall_bits)
        for index, side in enumerate(SIDES)
        if bits & (1 << index) and grid.neighbour(cell, side) is not None
    ]


def test_a_drawing_and_its_fields_are_the_same_game() -> None:
    drawing = "+---+---+\n| S : o |\n+---+   +\n|###  E |\n+---+---+\n"
    fields = digest(
        size=[2, 2],
        start=[0, 0],
        exit=[1, 1],
        walls=[{"at": [1, 0], "side": "W", "pass": 0.5}, {"at": [0, 1], "side": "N"}],
        puddles=[{"at": [1, 0]}],
        blocked=[{"at": [0, 1]}],
    )
    assert digest(map=drawing) == fields


WALLS: list[World] = [
    {"at": [1, 0], "side": "S"},
    {"at": [0, 0], "side": "E", "pass": 0.5},
    {"at": [2, 1], "side": "W"},
    {"at": [0, 1], "side": "S"},
    {"at": [1, 1], "side": "S"},
]


def test_the_order_and_the_form_of_walls_do_not_change_it() -> None:
    expected = digest(walls=WALLS)
    assert digest(walls=WALLS[::-1]) == expected
    assert digest(walls=[*WALLS[:3], {"at": [0, 1], "side": "south", "length": 2}]) == expected
    other_side = {"at": [1, 1], "side": "N"}
    assert digest(walls=[other_side, *WALLS[1:]]) == expected
    assert digest(walls=[*WALLS, WALLS[0]]) == expected
    painted = {**WALLS[0], "color": "red", "width": 9, "fit": True}
    assert digest(walls=[painted, *WALLS[1:]]) == expected


def test_an_opened_wall_was_never_there() -> None:
    assert digest(walls=WALLS[:1], openings=[WALLS[0]]) == digest()


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({}, {"size": [3, 3], "start": [0, 0], "exit": [2, 2]}),
        ({"exit": [2, 2]}, {"exit": [[2, 2]]}),
        ({"start": [[0, 0], [1, 0]]}, {"start": [[1, 0], [0, 0]]}),
        ({"skid": 0.5}, {"skid": {"probability": 0.5}}),
        ({"skid": 0.5}, {"skid": {"probability": 0.5, "to": "open"}}),
        ({"skid": 0}, {"skid": {"probability": 0, "to": "sides"}}),
        ({}, {"rewards": {"step": -1.0, "exit": 0, "bounce": -1}}),
        ({}, {"rewards": {"step": -1, "exit": -0.0}}),
        ({}, {"rewards": {"bump": -1}}),
        ({}, {"wind": {"north": [0, 0, 0]}}),
        ({"wind": {"north": [1, 0, 2]}}, {"wind": {"north": [2, 0, 3], "south": [1, 0, 1]}}),
        ({}, {"areas": [{"at": [1, 1], "color": "red", "label": "here"}]}),
        (
            {"areas": [{"at": [0, 0], "reward": -5}, {"at": [0, 0], "size": [2, 2], "reward": -3}]},
            {"areas": [{"at": [0, 0], "size": [2, 2], "reward": -3}]},
        ),
        ({"puddles": [{"at": [1, 1]}]}, {"areas": [{"at": [1, 1], "reward": -2, "skid": 0.4}]}),
        ({}, {"puddle_types": {"small": {"reward": -9}}}),
        (
            {"blocked": [{"at": [0, 1], "size": [2, 1]}]},
            {"blocked": [{"at": [1, 1]}, {"at": [0, 1]}], "walls": [{"at": [0, 1], "side": "E"}]},
        ),
    ],
)
def test_other_ways_of_writing_do_not_change_it(one: World, other: World) -> None:
    assert digest(**one) == digest(**other)


def test_comments_order_and_style_do_not_change_it() -> None:
    plain = "version: 1\nsize: [4, 2]\nskid: 0.5\n"
    other = "# a comment\nskid: 5e-1 # half\n\nsize:\n- 4\n- 0x2\n'version': 1.0\n"
    assert level_of_text(plain).digest == level_of_text(other).digest


# -- what changes it ---------------------------------------------------------------------------


BASE: World = {
    "size": [3, 3],
    "walls": [{"at": [0, 0], "side": "E"}, {"at": [1, 1], "side": "E", "pass": 0.5}],
    "puddles": [{"at": [0, 1]}],
}

CHANGES: dict[str, World] = {
    "size": {"size": [3, 4]},
    "turned": {"size": [4, 3]},
    "start": {"start": [1, 0]},
    "two starts": {"start": [[0, 0], [1, 0]]},
    "exit": {"exit": [2, 1]},
    "two exits": {"exit": [[2, 2], [2, 1]]},
    "no exit": {"exit": "none"},
    "one wall less": {"walls": BASE["walls"][1:]},
    "one wall more": {"walls": [*BASE["walls"], {"at": [2, 2], "side": "W"}]},
    "an opening": {"openings": [{"at": [1, 1], "side": "E"}]},
    "solid for glass": {"walls": [BASE["walls"][0], {"at": [1, 1], "side": "E"}]},
    "other glass": {"walls": [BASE["walls"][0], {"at": [1, 1], "side": "E", "pass": 0.25}]},
    "sure glass": {"walls": [BASE["walls"][0], {"at": [1, 1], "side": "E", "pass": 1}]},
    "maze": {"maze": {"seed": 1}},
    "larger puddle": {"puddles": [{"at": [0, 1], "size": "large"}]},
    "no puddle": {"puddles": []},
    "puddle type": {"puddle_types": {"small": {"skid": 0.5}}},
    "skid": {"skid": 0.1},
    "skid to sides": {"skid": {"probability": 0.1, "to": "sides"}},
    "skid to others": {"skid": {"probability": 0.1, "to": "others"}},
    "blocked": {"blocked": [{"at": [2, 0]}]},
    "area reward": {"areas": [{"at": [1, 1], "reward": -3}]},
    "area skid": {"areas": [{"at": [1, 1], "skid": 0.01}]},
    "area ends": {"areas": [{"at": [1, 1], "ends": True}]},
    "warp": {"warps": [{"at": [1, 1], "to": [2, 1]}]},
    "warp back": {"warps": [{"at": [1, 1], "to": "start"}]},
    "warp away": {"warps": [{"at": [1, 1], "to": [2, 1], "when": "leave"}]},
    "paid warp": {"warps": [{"at": [1, 1], "to": [2, 1], "reward": 0.5}]},
    "wind": {"wind": {"north": [0, 1, 0]}},
    "step": {"rewards": {"step": -1.0000000001}},
    "exit's reward": {"rewards": {"exit": 1}},
    "bump": {"rewards": {"bump": -2}},
    "bounce": {"rewards": {"bounce": -2}},
    "stay": {"rewards": {"stay": -3}},
    "closer": {"rewards": {"closer": 0}},
    "farther": {"rewards": {"farther": -4}},
}


def test_every_change_of_the_game_changes_it() -> None:
    digests = {"base": digest(**BASE)} | {
        name: digest(**{**BASE, **change}) for name, change in CHANGES.items()
    }
    assert len(set(digests.values())) == len(digests)


def test_a_wall_that_changes_no_transition_still_changes_it() -> None:
    """A wall between two cells in which no episode goes on is seen, though never met."""
    exits: World = {"size": [3, 1], "exit": [[1, 0], [2, 0]]}
    assert digest(**exits) != digest(**exits, walls=[{"at": [1, 0], "side": "E"}])
