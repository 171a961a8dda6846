"""Fields and entries that are set, removed, moved and fixed: in the text, with its comments."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from support.gestures import done, drawn, refused, send

from babyrobot_levels.extensions.editor.session import Session

pytestmark = pytest.mark.usefixtures("put_off")

LOCKED = """\
version: 1
# A hall with two doors.
size: [5, 3]  # wide
start: [0, 0]
exit_needs: [lever, key]  # both
doors:
  # the first
  - {at: [1, 0], side: E, needs: key}
  - {at: [2, 0], side: E, needs: [key, lever]}  # the second
  - {at: [3, 0], side: E, unless: lever}
items:
  - {name: key, at: [0, 2]}  # a key
switches:
  - {name: lever, at: [1, 2]}
"""

DRAWN = """\
version: 1
# The way in.
map: |
  +---+---+---+
  | S   k : o |
  +- -+   +-/-+
  |###  E   d |
  +---+---+---+
legend:
  k: {item: key}  # opens
  d: {color: red}
walls:
  - {at: [1, 0], side: E, pass: 0.2}
doors:
  - {at: [2, 0], side: S, needs: key}  # the way out
"""


def level(*lines: str) -> Session:
    return Session("\n".join(["version: 1", *lines, ""]))


# -- set -----------------------------------------------------------------------------------


def test_set_makes_the_mapping_in_which_a_field_stands() -> None:
    session = level("size: [4, 3]", "max_steps: 9")
    text = done(session, "set", route=["rewards", "step"], value=-2)
    assert text == "version: 1\nsize: [4, 3]\nrewards: {step: -2}\nmax_steps: 9\n"


def test_fields_of_an_entry_stay_in_their_order() -> None:
    session = level("areas:", "  - {at: [1, 1], label: mud}  # deep")
    text = done(session, "set", route=["areas", 0, "reward"], value=-3)
    assert text.endswith("areas:\n  - {at: [1, 1], reward: -3, label: mud}  # deep\n")


def test_set_of_none_removes_a_field_and_the_mapping_that_is_left_empty() -> None:
    session = level("display: {robot: {speed: 2}}", "max_steps: 9  # few")
    text = done(session, "set", route=["display", "robot", "speed"], value=None)
    assert text == "version: 1\nmax_steps: 9  # few\n"


@pytest.mark.parametrize(
    ("before", "route", "value", "after"),
    [
        ("skid: 0.2", ["skid", "probability"], 0.5, "skid: 0.5"),
        ("skid: 0.2", ["skid", "to"], "sides", "skid: {probability: 0.2, to: sides}"),
        ("skid: {probability: 0.2, to: sides}", ["skid", "probability"], None, ""),
        ("max_steps: 5", ["skid", "probability"], 0.5, "skid: 0.5\nmax_steps: 5"),
        (
            "max_steps: 5",
            ["puddle_types", "large", "skid", "to"],
            "others",
            "puddle_types:\n  large:\n    skid: {probability: 0.6, to: others}\nmax_steps: 5",
        ),
        ("display: {side_panel: 90}", ["display", "side_panel", "width"], "none", None),
    ],
)
def test_short_forms_stay_short_as_long_as_they_can(
    before: str, route: list[str], value: Any, after: str | None
) -> None:
    after = "display: {side_panel: none}" if after is None else after
    text = done(level(before), "set", route=route, value=value)
    assert text == f"version: 1\n{after}\n".replace("\n\n", "\n")


def test_color_of_a_named_theme_is_set_among_its_others() -> None:
    session = level("theme: green")
    done(session, "set", route=["theme", "colors", "base"], value="gold")
    assert session.level is not None
    colors = session.level.resolved_theme.colors
    assert (colors.base, colors.exit, colors.puddle) == ("gold", "#00352a", "#bfe3fa")


@pytest.mark.slow
def test_one_name_is_no_list_and_none_is_no_field() -> None:
    session = Session(LOCKED)
    text = done(session, "set", route=["doors", 1, "needs"], value=["lever"])
    assert "{at: [2, 0], side: E, needs: lever}  # the second" in text
    text = done(session, "set", route=["exit_needs"], value=[])
    assert "exit_needs" not in text


@pytest.mark.slow
def test_item_is_renamed_wherever_it_is_needed() -> None:
    text = done(Session(LOCKED), "set", route=["items", 0, "name"], value="red-key")
    assert text == (
        LOCKED.replace("name: key", "name: red-key")
        .replace("needs: key}", "needs: red-key}")
        .replace("[key, lever]", "[red-key, lever]")
        .replace("[lever, key]", "[lever, red-key]")
    )


@pytest.mark.slow
def test_switch_is_renamed_wherever_it_is_needed() -> None:
    text = done(Session(LOCKED), "set", route=["switches", 0], value={"name": "bell", "at": [1, 2]})
    assert "lever" not in text
    assert "unless: bell" in text


def test_wrong_value_is_refused_with_the_message_of_the_level() -> None:
    session = Session(LOCKED)
    assert "at least 1" in refused(session, "set", route=["size"], value=[0, 3])
    assert "`colour`" in refused(session, "set", route=["items", 0, "colour"], value="red")
    assert "no item, switch or target `bell`" in refused(
        session, "set", route=["doors", 0, "needs"], value="bell"
    )
    assert "off the grid" in refused(session, "set", route=["items", 0, "at"], value=[9, 9])


@pytest.mark.parametrize(
    ("route", "value", "words"),
    [
        (["items", 7, "at"], [0, 0], "there is no `items[7]`"),
        (["items", "key", "at"], [0, 0], "there is no `items.key`"),
        (["start", 0, "x"], 3, "`start[0]` has no fields"),
        (["title", "words"], "a", "`title` must be a text"),
        (["items", 0, "color"], None, "there is no `items[0].color`"),
        ([0], 3, "there is no"),
        (["map", 0, 0], "S", "the drawing shows nothing at `map[0][0]`"),
        (["tags"], ["a"] * 100_001, "values"),
        (["wall"], {"a": [[[[[[[[{}]]]]]]]]}, "unknown field `wall`"),
    ],
)
def test_route_that_leads_nowhere_is_refused(route: list[Any], value: Any, words: str) -> None:
    assert words in refused(Session(LOCKED), "set", route=route, value=value)


@pytest.mark.slow
def test_value_that_is_nested_without_end_is_refused() -> None:
    value: Any = []
    for _ in range(5000):
        value = [value]
    assert "nested" in refused(Session(LOCKED), "set", route=["tags"], value=value)
    deep: Any = "a"
    for _ in range(60):
        deep = [deep]
    assert refused(Session(LOCKED), "set", route=["items", 0, "label"], value=deep)


# -- remove --------------------------------------------------------------------------------


@pytest.mark.slow
def test_entry_is_removed_and_comments_on_lines_of_their_own_stay() -> None:
    text = done(Session(LOCKED), "remove", route=["doors", 0])
    assert text == LOCKED.replace("  - {at: [1, 0], side: E, needs: key}\n", "")


@pytest.mark.slow
def test_item_that_is_removed_is_no_longer_needed_and_takes_its_doors_along() -> None:
    text = done(Session(LOCKED), "remove", route=["items", 0])
    assert "key" not in "".join(line.partition("#")[0] for line in text.splitlines())
    assert "# a key" in text
    assert "exit_needs: lever  # both" in text
    assert "  - {at: [2, 0], side: E, needs: lever}  # the second\n" in text
    assert "{at: [1, 0]" not in text


def test_exit_that_is_removed_is_none() -> None:
    assert "exit: none" in done(level("exit: [1, 1]"), "remove", route=["exit"])
    assert "exit: none" in done(level("exit: [[1, 1]]"), "remove", route=["exit", 0])


def test_last_start_cannot_be_removed() -> None:
    assert "start" in refused(level("start: [1, 1]"), "remove", route=["start"])
    assert "start" in refused(level("start: [[1, 1]]"), "remove", route=["start", 0])


@pytest.mark.parametrize(
    ("before", "route", "after"),
    [
        ("start: [[0, 0], [1, 0]]", ["start", 0], "start: [1, 0]"),
        ("start: [[0, 0], [1, 0], [0, 1]]", ["start", 0], "start: [[1, 0], [0, 1]]"),
        ("exit_one_of: [[1, 1], [2, 0]]", ["exit_one_of", 1], "exit: [1, 1]"),
        (
            "items:\n  - {name: key, one_of: [[1, 1], [2, 0]], reward: 2}",
            ["items", 0, "one_of", 0],
            "items:\n  - {name: key, at: [2, 0], reward: 2}",
        ),
    ],
)
def test_cell_that_is_left_alone_is_no_list(before: str, route: list[Any], after: str) -> None:
    assert done(level(before), "remove", route=route) == f"version: 1\n{after}\n"


# -- move ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("before", "route", "start", "to", "after"),
    [
        ("start: [0, 1]  # left", ["start"], [0, 1], [2, 0], "start: [2, 0]  # left"),
        ("max_steps: 9", ["start"], [0, 0], [1, 1], "start: [1, 1]\nmax_steps: 9"),
        (
            "warps:\n  - {at: [1, 1], to: [1, 0]}",
            ["warps", 0],
            [1, 0],
            [2, 0],
            "warps:\n  - {at: [1, 1], to: [2, 0]}",
        ),
        (
            "warps:\n  - {at: [1, 1], to: [1, 0]}",
            ["warps", 0],
            [1, 1],
            [2, 1],
            "warps:\n  - {at: [2, 1], to: [1, 0]}",
        ),
        (
            "movers:\n  - {path: [[1, 0], [1, 1]], back: true}  # round",
            ["movers", 0],
            [1, 1],
            [2, 1],
            "movers:\n  - {path: [[2, 0], [2, 1]], back: true}  # round",
        ),
        (
            "items:\n  - {name: key, one_of: [[1, 1], [2, 0]]}",
            ["items", 0],
            [2, 0],
            [1, 0],
            "items:\n  - {name: key, one_of: [[1, 1], [1, 0]]}",
        ),
        (
            "movers:\n  - {within: {at: [1, 0], size: [1, 2]}, start: [1, 1]}",
            ["movers", 0],
            [1, 0],
            [2, 0],
            "movers:\n  - {within: {at: [2, 0], size: [1, 2]}, start: [2, 1]}",
        ),
        (
            "walls:\n  - {at: [0, 0], side: E, length: 2}",
            ["walls", 0],
            [0, 1],
            [1, 2],
            "walls:\n  - {at: [1, 1], side: E, length: 2}",
        ),
    ],
)
def test_entry_is_moved_as_far_as_from_one_cell_to_the_other(
    before: str, route: list[Any], start: list[int], to: list[int], after: str
) -> None:
    text = done(level(before), "move", route=route, from_=start, to=to)
    assert text == f"version: 1\n{after}\n"


def test_nothing_is_moved_off_the_grid() -> None:
    session = level("items:", "  - {name: key, at: [0, 1]}")
    route = ["items", 0]
    assert "off the grid" in refused(session, "move", route=route, from_=[1, 1], to=[0, 1])
    assert "off the grid" in refused(session, "move", route=route, from_=[0, 1], to=[0, 3])


def test_what_has_no_cell_cannot_be_moved() -> None:
    assert "cannot be moved" in refused(
        level("max_steps: 3"), "move", route=["max_steps"], from_=[0, 0], to=[1, 1]
    )


# -- drawings ------------------------------------------------------------------------------


def test_drawn_item_is_moved_in_the_drawing_and_everything_else_stays() -> None:
    session = Session(DRAWN)
    done(session, "remove", route=["map", 0, 1])
    text = done(session, "move", route=["map", 1, 0], from_=[1, 0], to=[0, 1])
    assert text == DRAWN.replace("| S   k : o |", "| S     : o |").replace("|###", "| k ")


def test_drawn_cell_is_not_moved_onto_another_or_off_the_grid() -> None:
    session = Session(DRAWN)
    move = {"route": ["map", 1, 0], "from_": [1, 0]}
    assert "one thing" in refused(session, "move", to=[2, 0], **move)
    assert "off the grid" in refused(session, "move", to=[1, 2], **move)


def test_drawn_wall_is_moved_and_stays_within_the_outer_wall() -> None:
    session = Session(DRAWN)
    move = {"route": ["map", 0, 0, "S"], "from_": [0, 0]}
    assert "outer wall" in refused(session, "move", to=[0, 1], **move)
    assert "another wall" in refused(session, "move", to=[2, 0], **move)
    done(session, "move", to=[1, 0], **move)
    assert drawn(session)[2] == "+   +- -+-/-+"


def test_wall_of_a_drawing_of_one_row_is_moved() -> None:
    session = Session("version: 1\nmap: |\n  +---+---+---+\n  | S |     E |\n  +---+---+---+\n")
    done(session, "move", route=["map", 0, 0, "E"], from_=[0, 0], to=[1, 0])
    assert drawn(session)[1] == "| S     | E |"


def test_door_is_moved_in_the_drawing_too() -> None:
    session = Session(DRAWN)
    text = done(session, "move", route=["doors", 0], from_=[2, 0], to=[1, 0])
    assert drawn(session)[2] == "+- -+-/-+   +"
    assert "{at: [1, 0], side: S, needs: key}  # the way out" in text


def test_wall_with_an_entry_is_moved_in_the_drawing_too() -> None:
    session = Session(DRAWN)
    done(session, "move", route=["walls", 0], from_=[1, 0], to=[1, 1])
    assert drawn(session)[1] == "| S   k   o |"
    assert drawn(session)[3] == "|###  E : d |"


def test_drawn_item_that_is_removed_takes_its_legend_and_its_door_along() -> None:
    session = Session(DRAWN)
    text = done(session, "remove", route=["map", 1, 0])
    assert "key" not in text
    assert drawn(session)[1:3] == ["| S     : o |", "+- -+   +   +"]


def test_length_of_a_door_is_drawn() -> None:
    session = Session(DRAWN)
    done(session, "set", route=["doors", 0, "at"], value=[1, 0])
    done(session, "set", route=["doors", 0, "length"], value=2)
    assert drawn(session)[2] == "+- -+-/-+-/-+"
    assert "`length`" in refused(session, "set", route=["doors", 0, "length"], value="two")


@pytest.mark.parametrize("value", [[1], "here", None, [[1, 2], 3], [1, 99]])
def test_wrong_place_of_a_drawn_door_is_refused(value: Any) -> None:
    assert refused(Session(DRAWN), "set", route=["doors", 0, "at"], value=value)


def test_fields_of_what_is_drawn_are_set_in_the_legend() -> None:
    session = Session(DRAWN)
    text = done(session, "set", route=["map", 2, 1, "skid", "probability"], value=0.5)
    assert "  d: {color: red, skid: 0.5}\n" in text
    text = done(session, "set", route=["map", 1, 0, "name"], value="gem")
    assert "  k: {item: gem}  # opens\n" in text
    assert "needs: gem}" in text


def test_size_of_a_drawn_puddle_is_set_in_the_drawing() -> None:
    session = Session(DRAWN)
    done(session, "set", route=["map", 2, 0, "size"], value="large")
    assert drawn(session)[1] == "| S   k : O |"
    assert "size" in refused(session, "set", route=["map", 2, 0, "size"], value="huge")


@pytest.mark.parametrize(
    ("value", "line", "entry"),
    [
        (0, "+---+   +-/-+", None),
        (0.5, "+- -+   +-/-+", None),
        (0.75, "+- -+   +-/-+", "{at: [0, 0], side: S, pass: 0.75}"),
    ],
)
def test_pass_of_a_drawn_wall_is_drawn_or_written(
    value: float, line: str, entry: str | None
) -> None:
    session = Session(DRAWN)
    text = done(session, "set", route=["map", 0, 0, "S", "pass"], value=value)
    assert drawn(session)[2] == line
    assert entry is None or entry in text


def test_color_of_a_drawn_wall_is_written() -> None:
    text = done(Session(DRAWN), "set", route=["map", 0, 0, "S", "color"], value="red")
    assert "  - {at: [0, 0], side: S, color: red}\n" in text


def test_drawing_cannot_be_set_where_it_shows_something_else() -> None:
    session = Session(DRAWN)
    assert "change it there" in refused(session, "set", route=["map", 0, 0, "color"], value="red")
    assert "nothing at" in refused(session, "set", route=["map", 9, 9, "size"], value="large")


# -- fix -----------------------------------------------------------------------------------


FAULTY = """\
version: 1
size: [4, 4]
openings:
  - {at: [3, 0], side: S}  # for what?
  - {at: [0, 0], side: S}
# The end.
max_steps: 50
"""


def finding(session: Session, code: str) -> dict[str, Any]:
    findings = send(session, "state")["state"]["findings"]
    found = next(each for each in findings if each["code"] == code)
    return {name: found[name] for name in ("code", "line", "column")}


def test_fix_of_a_finding_is_applied_as_one_step() -> None:
    session = Session(FAULTY)
    text = done(session, "fix", **finding(session, "BR507"))
    assert text == FAULTY.replace("- {at: [3, 0], side: S}  # for what?\n", "# for what?\n")
    send(session, "undo")
    assert session.text == FAULTY


def test_fix_of_a_finding_that_is_gone_is_refused() -> None:
    session = Session(FAULTY)
    place = finding(session, "BR507")
    assert "no longer" in refused(session, "fix", **{**place, "column": 99})
    assert "no longer" in refused(session, "fix", **{**place, "code": "BR201"})


def test_gestures_wait_until_the_text_is_valid_again() -> None:
    session = Session(FAULTY)
    send(session, "text", text=FAULTY + "walls: 3\n")
    assert "errors" in refused(session, "remove", route=["openings", 0])


def test_a_misspelt_field_has_a_fix() -> None:
    session = Session("version: 1\nsize: [4, 3]\npuddels:\n  - {at: [1, 1], size: lrge}\n")
    send(session, "fix", **finding(session, "BR201"))
    text = done(session, "fix", **finding(session, "BR204"))
    assert text == "version: 1\nsize: [4, 3]\npuddles:\n  - {at: [1, 1], size: large}\n"


def test_a_field_that_others_give_in_another_way_has_no_fix() -> None:
    session = Session("version: 1\nsize: [4, 3]\nstep_reward: -1\n")
    (found,) = send(session, "state")["state"]["findings"]
    assert "did you mean" in found["message"]
    assert found["fix"] is None, "renamed, the value would not fit"


@pytest.mark.parametrize("name", ["bad-guard", "bad-hole"])
def test_an_end_that_is_better_than_the_exit_is_made_dearer(name: str) -> None:
    folder = Path("tests/linter/rules/exit-given-up")
    session = Session((folder / f"{name}.yaml").read_text("utf-8"))
    session.catch_up()
    done(session, "fix", **finding(session, "BR537"))
    session.catch_up()
    assert "BR537" not in {each.code for each in session.report.diagnostics}
