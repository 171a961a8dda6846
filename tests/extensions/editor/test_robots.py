"""Several robots: added, moved, named, given exits of their own, and removed."""

from __future__ import annotations

from typing import Any

import pytest
from support.gestures import done, places, refused, send

from babyrobot_levels.extensions.editor.forms import forms
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.state import state_of

pytestmark = pytest.mark.usefixtures("put_off")

ALONE = "version: 1\nsize: [4, 3]\n"

TWO = """\
version: 1
size: [4, 3]
robots:
  - {name: red, start: [0, 0], exit: [3, 0]}
  - {name: blue, start: [3, 2]}
exit: [0, 2]
items:
  - {name: key, at: [1, 1], robot: red}
"""

DRAWN = """\
version: 1
map: |
  +---+---+---+
  | S     /   |
  +   +   +   +
  | S   p   E |
  +---+---+---+
legend:
  p: {target: pad}
doors:
  - {at: [1, 0], side: E, needs: pad}
robots:
  - {name: red}
  - {name: blue}
"""


def robots(session: Session) -> list[dict[str, Any]]:
    """Return name, start and own exit of each robot of a level."""
    assert session.level is not None
    return [
        {"name": robot.name, "start": start} | ({"exit": robot.exit} if robot.exit else {})
        for robot, start in session.level.team_starts
    ]


def lost(session: Session) -> str:
    told: str = state_of(session)["lost"]
    return told


# -- added ---------------------------------------------------------------------------------


def test_second_robot_makes_a_level_of_several() -> None:
    session = Session(ALONE)
    text = done(session, "robot", at=[0, 2])
    assert text == ALONE + (
        "robots:\n  - {name: robot, start: [0, 0]}\n  - {name: robot-2, start: [0, 2]}\n"
    )
    session.undo()
    assert session.text == ALONE


def test_robot_that_is_dragged_to_a_cell_leaves_there() -> None:
    session = Session(TWO)
    done(session, "robot", at=[2, 2], to=[2, 0])
    done(session, "robot", at=[3, 2], to=[3, 1])
    assert robots(session)[1:] == [
        {"name": "blue", "start": (3, 2), "exit": (3, 1)},
        {"name": "robot", "start": (2, 2), "exit": (2, 0)},
    ]


def test_first_of_several_starts_stays_and_the_others_are_told_to_go() -> None:
    session = Session(ALONE + "start: [[0, 0], [1, 0]]\nstart_weights: [1, 2]\n")
    done(session, "robot", at=[0, 2])
    assert lost(session) == "a start"
    assert [each["start"] for each in robots(session)] == [(0, 0), (0, 2)]


def test_drawn_start_stays_that_of_the_first_robot() -> None:
    text = DRAWN.partition("robots:")[0].replace("| S   p", "|     p")
    session = Session(text)
    assert done(session, "robot", at=[0, 1]).startswith(text)
    assert [each["start"] for each in robots(session)] == [(0, 0), (0, 1)]


@pytest.mark.parametrize(
    ("text", "fields", "said"),
    [
        (TWO, {"at": [0, 0]}, "a robot begins in [0, 0]: put another one into another cell"),
        (ALONE, {"at": [0, 0], "to": [1, 0]}, "a robot begins in [0, 0]: put another one into"),
        (TWO, {"at": [9, 0]}, "off the grid"),
        (ALONE + "boxes: [{at: [1, 1]}]\n", {"at": [0, 1]}, "several robots cannot push boxes"),
    ],
)
def test_robot_that_cannot_be_added_is_refused(
    text: str, fields: dict[str, Any], said: str
) -> None:
    assert said in refused(Session(text), "robot", **fields)


# -- moved and changed ---------------------------------------------------------------------


@pytest.mark.slow
def test_robots_and_their_exits_are_places_and_starts_are_none() -> None:
    for text, cells in ((TWO, [[0, 0], [3, 2]]), (DRAWN, [[0, 0], [0, 1]])):
        session = Session(text)
        assert [each["cells"] for each in places(session, "robot")] == [[cell] for cell in cells]
        assert places(session, "start") == []
    assert [each["label"] for each in places(Session(TWO), "exit")] == ["exit", "exit of red"]


@pytest.mark.slow
def test_robot_and_its_exit_are_moved() -> None:
    session = Session(TWO)
    done(session, "move", route=["robots", 0], from_=[0, 0], to=[1, 0])
    done(session, "move", route=["robots", 0, "exit"], from_=[3, 0], to=[2, 0])
    assert robots(session)[0] == {"name": "red", "start": (1, 0), "exit": (2, 0)}


@pytest.mark.slow
def test_robot_that_is_moved_in_a_drawing_begins_where_nothing_is_drawn() -> None:
    session = Session(DRAWN)
    text = done(session, "move", route=["robots", 0], from_=[0, 0], to=[1, 1])
    assert "  |       /   |\n" in text
    assert "{name: red, start: [1, 1]}" in text
    assert [each["start"] for each in robots(session)] == [(1, 1), (0, 1)]


def test_renamed_robot_still_takes_its_items() -> None:
    session = Session(TWO)
    text = done(session, "set", route=["robots", 0, "name"], value="green")
    assert "{name: key, at: [1, 1], robot: green}" in text


@pytest.mark.slow
def test_start_that_is_given_to_a_robot_takes_the_place_of_a_drawn_one() -> None:
    session = Session(DRAWN)
    done(session, "set", route=["robots", 1, "start"], value=[0, 1])
    done(session, "set", route=["robots", 1, "color"], value="gold")
    assert "{name: blue, start: [0, 1], color: gold}" in session.text
    assert "  |     p   E |\n" in session.text


@pytest.mark.slow
@pytest.mark.parametrize("field", [field["name"] for field in forms()["robot"]])
def test_each_field_of_a_robot_can_be_set_and_reset(field: str) -> None:
    session = Session(TWO)
    values = {"name": "green", "color": "gold", "start": [1, 0], "exit": [2, 0]}
    route = ["robots", 0, field]
    text = done(session, "set", route=route, value=values[field])
    assert places(session, "robot")[0]["fields"][field] == values[field]
    if field in ("name", "start"):
        assert refused(session, "set", route=route, value=None)
    else:
        assert done(session, "set", route=route, value=None) != text


def test_exits_are_painted_for_all_robots_and_starts_for_none() -> None:
    session = Session(TWO)
    assert "drag the robot there" in refused(session, "paint", brush="start", cells=[[1, 0]])
    # Who has another exit begins at that of the others.
    done(session, "paint", brush="exit", cells=[[0, 0]])
    assert session.level is not None
    assert session.level.common_exits == ((0, 0),)
    assert len(robots(session)) == 2


# -- removed -------------------------------------------------------------------------------


def test_robot_that_is_left_alone_has_the_start_and_exit_of_the_level() -> None:
    session = Session(TWO)
    text = done(session, "remove", route=["robots", 1])
    assert text == (
        "version: 1\nsize: [4, 3]\nstart: [0, 0]\nexit: [3, 0]\n"
        "items:\n  - {name: key, at: [1, 1]}\n"
    )
    assert lost(session) == "an exit"


def test_exit_that_goes_with_a_robot_is_told() -> None:
    session = Session(TWO)
    done(session, "remove", route=["robots", 0])
    assert lost(session) == "an exit"
    assert session.level is not None
    assert (session.level.starts, session.level.exits) == (((3, 2),), ((0, 2),))


@pytest.mark.slow
def test_eraser_takes_robots_and_their_exits_and_leaves_one() -> None:
    session = Session(TWO)
    done(session, "paint", brush="erase", cells=[[3, 0]])
    assert robots(session)[0] == {"name": "red", "start": (0, 0)}
    done(session, "paint", brush="erase", cells=[[0, 0], [3, 2]], rectangle=True)
    assert session.level is not None
    assert (session.level.robots, session.level.starts) == ((), ((0, 0),))
    drawn = Session(DRAWN)
    text = done(drawn, "paint", brush="erase", cells=[[0, 1]])
    assert "  |     p   E |\n" in text
    assert "robots" not in text


def test_blocked_cells_leave_robots_and_their_exits() -> None:
    session = Session(TWO)
    done(session, "paint", brush="blocked", cells=[[0, 0], [3, 0]], rectangle=True)
    assert session.level is not None
    assert [tuple(each.at) for each in session.level.blocked] == [(1, 0)]
    assert session.level.blocked[0].size == (2, 1)


@pytest.mark.slow
@pytest.mark.parametrize("text", [TWO, DRAWN])
def test_robots_stay_in_a_level_that_shrinks(text: str) -> None:
    session = Session(text)
    done(session, "resize", size=[3, 2])
    found = robots(session)
    assert [each["name"] for each in found] == ["red", "blue"]
    assert len({each["start"] for each in found}) == 2
    done(session, "resize", size=[5, 3], shift=[1, 1])
    after = [(each["start"][0] - 1, each["start"][1] - 1) for each in robots(session)]
    assert after == [each["start"] for each in found]


def test_copied_region_leaves_robots_out() -> None:
    session = Session(TWO)
    send(session, "lift", cells=[[0, 0], [1, 1]])
    done(session, "stamp", at=[1, 1])
    assert state_of(session)["left"] == "a robot"
    assert len(robots(session)) == 2


def test_level_of_many_joint_actions_waits_for_a_pause() -> None:
    state = state_of(Session(TWO.replace("exit: [0", "  - {name: third, start: [2, 2]}\nexit: [0")))
    assert "is drawn when you pause" in state["too_large"]
