"""Pages of levels with things: their tables, what is where, and what is shown of a solution."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.playground import guide
from support.vault import vault

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.tables import hits_of
from babyrobot_levels.render import page as pages
from babyrobot_levels.render import page_tables
from babyrobot_levels.render.page import Guide, link_fragment, page_data, to_html
from babyrobot_levels.render.page_format import EVENTS, TooLargeError
from babyrobot_levels.render.scene.heat import STEPS
from babyrobot_levels.render.scene.layout import Overlay

VAULT = vault()


@cache
def told() -> Any:
    """Return the data of the vault with its solution, as a page reads them."""
    return json.loads(json.dumps(page_data(VAULT, guide=guide(VAULT))))


def outcomes(data: Any, state: int, action: int) -> list[list[Any]]:
    """Return the outcomes of an action, six numbers each."""
    row = data["rows"][data["table"][5 * state + action]]
    return [row[at : at + 6] for at in range(0, len(row), 6)]


def thing(data: Any, name: str) -> Any:
    (found,) = [thing for thing in data["things"] if thing["name"] == name]
    return found


# -- tables ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "level",
    [
        pytest.param(VAULT, marks=pytest.mark.slow),
        *map(load, ("shell-game", "final-maze", "windy-gridworld")),
    ],
    ids=str,
)
def test_the_tables_are_the_compiled_ones(level: Level) -> None:
    mdp, data = level.compile(), json.loads(json.dumps(page_data(level)))
    hits = hits_of(level, mdp)
    assert (data["width"], data["height"]) == level.size
    assert data["starts"] == np.flatnonzero(mdp.start).tolist()
    assert len(data["table"]) == NUM_ACTIONS * mdp.num_states
    for state in range(mdp.num_states):
        for action in range(NUM_ACTIONS):
            assert data["possible"][state] >> action & 1 == mdp.action_mask[state, action]
            if mdp.is_terminal[state]:
                assert data["table"][5 * state + action] == -1
                continue
            found = outcomes(data, state, action)
            assert [(p, state + s, r, bool(t)) for p, s, r, t, _, _ in found] == mdp.outcomes(
                state, action
            )
            told = [event >= len(EVENTS) for *_, event, _ in found]
            assert told == hits[state, action, : len(found)].tolist()


def test_an_event_names_the_mover_that_hits() -> None:
    level = Level.from_fields(
        {
            "version": 1,
            "size": [4, 2],
            "movers": [{"path": [[3, 1]], "name": "far"}, {"path": [[1, 0]], "name": "near"}],
            "exit": "none",
        }
    )
    data = page_data(level)
    ((_, _, _, _, event, _),) = outcomes(data, 0, 2)
    assert divmod(event, len(EVENTS)) == (2, EVENTS.index("move"))
    ((_, _, _, _, event, _),) = outcomes(data, 0, 3)
    assert divmod(event, len(EVENTS)) == (0, EVENTS.index("move"))


def test_of_many_movers_the_one_that_hits_is_told() -> None:
    far = [{"path": [[x, y]]} for y in range(1, 5) for x in range(7)]
    fields = {"version": 1, "size": [7, 5], "exit": [6, 0]}
    level = Level.from_fields({**fields, "movers": [*far, {"path": [[1, 0]]}]})
    ((_, _, _, _, event, _),) = outcomes(page_data(level), 0, 2)
    assert divmod(event, len(EVENTS)) == (29, EVENTS.index("move"))


# -- what is where -----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("level", [VAULT, load("shell-game")])
def test_things_are_what_the_configurations_tell(level: Level) -> None:
    width, data = level.size[0], page_data(level)

    def number(cell: tuple[int, int]) -> int:
        return cell[1] * width + cell[0]

    kinds = [[thing for thing in data["things"] if thing["kind"] == kind] for kind in KINDS]
    exits, switches, items, doors, movers = kinds
    for index in range(level.compile().num_configurations):
        now = level.configuration(index)
        for each in exits:
            found = each["exits"][each["values"][index]]
            assert found == [number(cell) for cell in now.exits if now.exit_is_open]
            # The exit of the episode, and its lock.
            count = (level.exit_one_of is not None) + (not now.exit_is_open)
            assert len(each["looks"][each["values"][index]]) == count * len(now.exits)
        assert [each["values"][index] == 1 for each in switches] == list(now.on)
        for each, cell in zip(items, now.items, strict=True):
            value = each["values"][index]
            assert each["cells"][value] == ([] if cell is None else [number(cell)])
            # What lies has a picture, and what is held has none in its cell.
            assert len(each["looks"][value]) == (cell is not None)
        for each, is_closed in zip(doors, now.doors, strict=True):
            assert each["values"][index] == is_closed
            assert each["looks"][is_closed]
        for each, cell in zip(movers, now.movers, strict=True):
            assert each["cells"][each["values"][index]] == [number(cell)]


KINDS = ("exit", "switch", "item", "door", "mover")


@pytest.mark.slow
def test_things_are_called_as_in_the_level() -> None:
    data = told()
    assert [(thing["kind"], thing["name"]) for thing in data["things"]] == [
        ("exit", "exit"),
        ("switch", "lever"),
        ("item", "key"),
        ("item", "coin"),
        ("item", "gem"),
        ("door", "door east of [4, 2]"),
        ("mover", "guard"),
        ("mover", "bat"),
    ]
    assert thing(data, "exit")["needs"] == ["gem"]
    # The door refuses the way east in [4, 2], and the way west in [5, 2].
    assert thing(data, "door east of [4, 2]")["sides"] == [18, 2, 19, 4]


@pytest.mark.slow
def test_every_look_is_there_and_none_twice() -> None:
    data = told()
    looks = data["picture"]["looks"]
    named = [
        number
        for thing in data["things"]
        for number in (
            *(number for found in thing.get("looks", ()) for number in found),
            *thing.get("icon", ())[:1],
            *(thing["label"] for _ in range(thing.get("label", -1) >= 0)),
        )
    ]
    assert set(named) <= set(range(len(looks)))
    assert all(looks[number] for number in named)
    assert thing(data, "guard")["label"] == -1
    label = looks[thing(data, "bat")["label"]]
    assert "Bo" in json.dumps(label)
    states = [json.dumps(looks[number]) for (number,) in thing(data, "lever")["looks"]]
    assert states[0] != states[1]


def test_a_level_without_things_has_none() -> None:
    data = page_data(load("final-maze"))
    assert {"things", "marks", "turns"}.isdisjoint(data)
    assert set(data["picture"]) == {"width", "height", "layers", "palette"}


@pytest.mark.slow
def test_the_picture_without_scripts_shows_things() -> None:
    # The label of the bat, which is a mover, and nothing of what is held: that is a strip below.
    html = to_html(VAULT)
    picture = html[html.index("<svg viewBox") : html.index("</svg>")]
    assert ">Bo</text>" in picture


# -- solutions ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_values_and_actions_are_those_of_each_configuration() -> None:
    best = guide(VAULT)
    data = told()
    marks, mdp = data["picture"]["marks"], VAULT.compile()
    for state in range(mdp.num_states):
        number, cell = divmod(state, mdp.cells)
        y, x = divmod(cell, mdp.width)
        shown = best.overlay.at(number)
        assert shown.values is not None
        assert (data["marks"]["values"][state] == -1) == (shown.values[y][x] is None)
        assert (data["marks"]["policy"][state] == -1) == (best.policy[state] < 0)
    start = data["starts"][0]
    number = data["marks"]["values"][start]
    ((_, _, shapes),) = marks[number]
    assert [shape[4] for shape in shapes if shape[0] == 3] == ["\N{MINUS SIGN}10"]
    # Below it is a tile of its colour, which is one of the scale.
    tiles = data["picture"]["tiles"]
    assert len(tiles) == len(marks)
    assert -2 - STEPS <= tiles[number] <= -2
    assert {tiles[mark] for mark in data["marks"]["policy"] if mark >= 0} == {-1}


def test_what_cannot_occur_has_a_mark_of_its_own() -> None:
    level = load("first-key")
    data = page_data(level, guide=guide_of(level))
    picture, mdp = data["picture"], level.compile()
    behind = [0, *(5 * y + x for y in range(3) for x in (3, 4))]
    for name in ("values", "policy"):
        marks = np.array(data["marks"][name])
        assert np.flatnonzero(marks == picture["never"]).tolist() == behind
        # Exits have no action, but episodes come to them.
        assert set(np.flatnonzero(marks == -1)) <= {mdp.cells + 9}
    assert picture["tiles"][picture["never"]] == -1
    maze = load("final-maze")
    assert "never" not in page_data(maze, guide=guide_of(maze))["picture"]


@pytest.mark.slow
def test_equal_marks_are_there_once() -> None:
    picture = told()["picture"]
    marks = [*zip(picture["marks"], picture["tiles"], strict=True)]
    assert len({json.dumps(mark) for mark in marks}) == len(marks)


# -- turning -----------------------------------------------------------------------------------


def test_a_robot_can_turn_if_the_level_has_a_heading_or_if_asked() -> None:
    plain = Level.from_fields({"version": 1, "size": [3, 1]})
    looking = Level.from_fields({"version": 1, "size": [3, 1], "heading": "S"})
    assert "turns" not in page_data(plain)
    assert page_data(looking)["turns"] == {"on": False, "heading": 2, "policy": None, "best": ""}
    assert page_data(plain, turns=True)["turns"]["on"]
    assert page_data(plain, turns=True)["turns"]["heading"] == 1


def test_a_robot_that_turns_has_a_policy_and_values_of_its_own() -> None:
    items = [{"name": "key", "at": [0, 1]}]
    level = Level.from_fields({"version": 1, "size": [3, 2], "items": items, "heading": "S"})
    best, turning = guide(level), guide(level, "turns")
    both = Guide(best.policy, best.overlay, best.expected_return, turning)
    data = page_data(level, guide=both, turns=True)
    mdp = level.compile().turning("S")
    assert data["turns"]["policy"] == list(turning.policy)
    assert len(data["turns"]["marks"]["values"]) == mdp.num_states
    assert data["best"] != data["turns"]["best"]


# -- limits ------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_level_of_too_many_states_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    states = VAULT.compile().num_states
    monkeypatch.setattr(pages, "MAX_STATES", states)
    assert json.loads(json.dumps(page_data(VAULT)))["table"] == told()["table"]
    monkeypatch.setattr(pages, "MAX_STATES", states - 1)
    with pytest.raises(TooLargeError, match=f"a level of {states:,} states is too large"):
        page_data(VAULT)


@pytest.mark.slow
def test_tables_that_are_too_large_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = sum(map(len, told()["rows"]))
    monkeypatch.setattr(page_tables, "MAX_NUMBERS", numbers - 1)
    with pytest.raises(TooLargeError, match=f"their rows have {numbers:,} numbers"):
        page_data(VAULT)


# -- links -------------------------------------------------------------------------------------


@pytest.mark.slow
def test_links_of_levels_that_older_pages_cannot_play_have_version_2() -> None:
    plain = Level.from_fields({"version": 1, "size": [3, 1]})
    looking = Level.from_fields({"version": 1, "size": [3, 1], "heading": "S"})
    for level, version in ((plain, 1), (looking, 2), (VAULT, 2)):
        fragment = link_fragment(level, level)
        assert fragment.partition("~")[2].partition(".")[0] == str(version)
        assert load(fragment).digest == level.digest


def test_the_values_of_an_overlay_without_any_are_no_marks() -> None:
    data = page_data(VAULT, guide=Guide([-1] * VAULT.compile().num_states, Overlay(), 0.0))
    assert set(data["marks"]["values"]) == set(data["marks"]["policy"]) == {-1}
