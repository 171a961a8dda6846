"""What users ask to be shown, in the forms that they have it in."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from support.scenes import CORRIDOR, without_legend
from support.worlds import level

import babyrobot_levels as brl
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.render.frames import FramePainter
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.info import overlay_from
from babyrobot_levels.render.scene.layout import CELL, Note, Overlay, caption_lines, layout_of
from babyrobot_levels.render.scene.shapes import Path, Scene, Text
from babyrobot_levels.render.text import TextPainter

N, E, S, W, STAY = Action.NORTH, Action.EAST, Action.SOUTH, Action.WEST, Action.STAY

LEVEL: Any = Level.from_fields({"version": 1, "size": [3, 2]})


def read(**info: Any) -> Overlay:
    return overlay_from(info, LEVEL)


def test_nothing_is_shown_where_nothing_is_asked_for() -> None:
    assert overlay_from({}, LEVEL) == Overlay()
    assert read(values=None, policy=None, text=None, precision=None) == Overlay()


# -- numbers -------------------------------------------------------------------------------


@pytest.mark.parametrize("form", [np.array, list, tuple, lambda rows: tuple(map(tuple, rows))])
def test_values_are_arrays_or_lists(form: Callable[[Any], Any]) -> None:
    told = form([[1, 2.5, math.nan], [-math.inf, 0, math.inf]])
    assert read(values=told).values == [[1, 2.5, None], [-math.inf, 0, math.inf]]


def test_none_and_masked_entries_are_nothing() -> None:
    assert read(values=[[None, 1, 2], [3, 4, 5]]).values == [[None, 1, 2], [3, 4, 5]]
    masked = np.ma.masked_less(np.arange(6.0).reshape(2, 3), 1)
    assert read(values=masked).values == [[None, 1, 2], [3, 4, 5]]


def test_visits_are_counts() -> None:
    counts = np.array([[3, 0, 1], [0, 0, 2]])
    assert read(visits=counts).visits == counts.tolist()
    for wrong in (-1, math.inf):
        with pytest.raises(ValueError, match="`visits` must be counts"):
            read(visits=[[0, 0, wrong], [0, 0, 0]])


def test_values_of_the_moves_alone_are_values_of_actions_without_stay() -> None:
    of_moves = np.arange(24.0).reshape(2, 3, 4)
    five = np.concatenate([np.full((2, 3, 1), np.nan), of_moves], axis=2)
    assert read(action_values=of_moves) == read(action_values=five)
    assert read(action_values=five).action_values[1][2] == [None, 20, 21, 22, 23]  # type: ignore[index]


@pytest.mark.parametrize(
    ("key", "told", "message"),
    [
        ("values", np.zeros((3, 3)), r"shape \(3, 3\); for this level it must be \(2, 3\)$"),
        (
            "values",
            np.zeros((3, 2)),
            r"\(3, 2\).* must be \(2, 3\); arrays are indexed by \[y, x\]",
        ),
        ("values", np.zeros(6), r"\(6,\).* must be \(2, 3\); reshape it with `.reshape\(2, 3\)`"),
        ("values", np.zeros((2, 3, 5)), r"use `action_values` for values of actions"),
        ("values", [[1, 2, 3], [4, 5]], r"has the shape \(2,\)"),
        ("values", [["a", 1, 2], [3, 4, 5]], "`values` must be numbers, not 'a'"),
        ("values", [[10**400, 1, 2], [3, 4, 5]], "`values` must be numbers"),
        ("action_values", np.zeros((2, 3, 3)), r"\(2, 3, 3\).* be \(2, 3, 5\) or \(2, 3, 4\)$"),
        ("policy", np.zeros((2, 3, 7)), r"`policy` has the shape \(2, 3, 7\)"),
    ],
)
def test_what_does_not_fit_is_refused_with_what_would(key: str, told: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        overlay_from({key: told}, LEVEL)


@pytest.mark.parametrize("precision", [-1, 7, 1.5, True, "2", [2]])
def test_precision_is_a_small_number(precision: Any) -> None:
    assert read(precision=0).precision == 0
    with pytest.raises(ValueError, match="`precision` must be 0 to 6"):
        read(precision=precision)


# -- policies ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        (2, (E,)),
        (-1, ()),
        (math.nan, ()),
        ("N", (N,)),
        ("s", (S,)),
        ("south", (S,)),
        ([4, 1], (N, W)),
        ({N, "west"}, (N, W)),
    ],
)
def test_a_cell_of_a_policy_is_told_in_many_ways(told: Any, expected: Any) -> None:
    actions = read(policy=[[told, 0, 0], [0, 0, 0]]).actions
    assert actions is not None
    assert actions[0][0] == expected
    assert actions[1][2] == (STAY,)


def test_of_probabilities_the_largest_count() -> None:
    shares = np.zeros((2, 3, 5))
    shares[0, 0] = 0.2
    shares[0, 1] = 0.1, 0.3, 0.3, 0.2, 0.1
    shares[0, 2] = np.nan
    shares[1, 0, 3] = 1
    actions = read(policy=shares).actions
    assert actions == [[(STAY, N, E, S, W), (N, E), ()], [(S,), (), ()]]
    of_moves = read(policy=shares[:, :, 1:] > 0.25).actions
    assert of_moves == [[(), (N, E), ()], [(S,), (), ()]]


@pytest.mark.parametrize("wrong", [5, 1.5, "up", math.inf, [1, 9], object()])
def test_what_is_no_action_is_refused(wrong: Any) -> None:
    with pytest.raises(ValueError, match="policy"):
        read(policy=[[wrong, 0, 0], [0, 0, 0]])


def test_probabilities_are_not_negative() -> None:
    with pytest.raises(ValueError, match="must not be negative"):
        read(policy=np.full((2, 3, 4), -1.0))


@pytest.mark.parametrize("actions", ["all", "moves"])
def test_a_solution_stands_for_its_arrays(actions: str) -> None:
    solution = brl.solve(LEVEL, actions=actions)
    whole = read(values=solution, policy=solution, action_values=solution)
    parts = read(
        values=solution.values, policy=solution.fastest, action_values=solution.action_values
    )
    assert whole == parts
    assert whole.actions is not None
    assert whole.actions[0] == [(E, S), (E, S), (S,)]
    assert whole.actions[1][2] == ()


def test_the_policy_of_a_solution_knows_that_its_actions_are_moves() -> None:
    solution = brl.solve(LEVEL, actions="moves")
    actions = read(policy=solution.policy).actions
    assert actions is not None
    assert actions[0][2] == (S,)


def test_a_result_stands_for_its_arrays() -> None:
    found = brl.solve(LEVEL)
    assert read(values=found) == read(values=found.values)
    actions = read(policy=found).actions
    assert actions is not None
    assert actions[1] == [(E,), (E,), ()]


# -- texts ---------------------------------------------------------------------------------


def test_texts_have_their_places_and_perhaps_colours() -> None:
    overlay = read(text=[((0, 1), "a"), ([1.5, 0], "b", "gold"), (np.array([2, 1]), 0.12345)])
    assert overlay.notes == (Note(0, 1, "a"), Note(1.5, 0, "b", "gold"), Note(2, 1, "0.12"))


@pytest.mark.parametrize(
    ("told", "message"),
    [
        ([((3, 0), "off")], r"'off' is at \[3, 0\], which is not on the level"),
        ([((math.nan, 0), "off")], "not on the level"),
        ([((0, 0), "a", "reddish")], "invalid CSS colour: 'reddish'"),
        ([((0, 0), "a", "red\n")], "colour"),
        ([((0, 0), "a", "red", 7)], r"expected \(\(x, y\), text\)"),
        ([(0, 0, "a")], r"expected \(\(x, y\), text\)"),
        ("hello", r"expected \(\(x, y\), text\)"),
        (np.zeros((2, 3)), "use `values` for an array of numbers"),
    ],
)
def test_texts_that_are_none_are_refused(told: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read(text=told)


def test_panels_hold_a_text_or_lines() -> None:
    overlay = read(side_panel="one", bottom_panel=["two", "three"])
    assert (overlay.side_panel, overlay.bottom_panel) == (("one",), ("two", "three"))
    with pytest.raises(ValueError, match="`side_panel` must be a list of texts; 7 is not a text"):
        read(side_panel=["one", 7])


@pytest.mark.parametrize("key", ["side_panel", "bottom_panel", "text"])
def test_a_mapping_is_refused_where_texts_are_expected(key: str) -> None:
    with pytest.raises(ValueError, match=f"`{key}` must be a"):
        read(**{key: {"text": "lost", "width": 200}})


# -- keys ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "hint"),
    [
        ("value", "did you mean `values`"),
        ("sidepanel", "did you mean `side_panel`"),
        ("coords", "use `coordinates`"),
        ("side_info", "use `side_panel`"),
        ("xyzzy", "the keys are values, policy"),
    ],
)
def test_unknown_keys_are_told_of_known_ones(key: Any, hint: str) -> None:
    with pytest.raises(ValueError, match=hint):
        overlay_from({key: True}, LEVEL)


@pytest.mark.parametrize("told", [5, "values", [("values", 1)]])
def test_what_is_no_mapping_is_refused(told: Any) -> None:
    with pytest.raises(ValueError, match="must be a mapping"):
        overlay_from(told, brl.load("default"))


# -- overlays --------------------------------------------------------------------------------

COUNT = CORRIDOR.compile().num_configurations


def test_arrays_by_configuration_show_that_at_hand() -> None:
    values = np.arange(COUNT * 5.0).reshape(COUNT, 1, 5)
    overlay = overlay_from({"values": values, "visits": values}, CORRIDOR)
    for number in range(COUNT):
        assert overlay.at(number).values == values[number].tolist()
        assert overlay.at(number).visits == values[number].tolist()
    begin = initial_configuration(CORRIDOR)
    assert overlay.values == overlay.at(None).values == values[begin].tolist()


def test_arrays_of_cells_are_shown_in_all_configurations() -> None:
    overlay = overlay_from({"values": [[1, 2, 3, 4, 5]], "policy": [["E"] * 5]}, CORRIDOR)
    assert overlay.at(3) is overlay
    assert overlay.values == [[1, 2, 3, 4, 5]]


def test_policies_by_configuration() -> None:
    table = np.full((COUNT, 1, 5), -1)
    table[2, 0, 1] = Action.WEST
    overlay = overlay_from({"policy": table}, CORRIDOR)
    assert overlay.at(2).actions == [[(), (Action.WEST,), (), (), ()]]
    assert overlay.at(1).actions == [[()] * 5]
    flags = np.zeros((COUNT, 1, 5, 4))
    flags[2, 0, 1, 3] = 1
    assert overlay_from({"policy": flags}, CORRIDOR).at(2).actions == overlay.at(2).actions


def test_pictures_of_an_overlay_by_configuration_differ() -> None:
    values = np.arange(COUNT * 5.0).reshape(COUNT, 1, 5)
    overlay = overlay_from({"values": values}, CORRIDOR)
    painter = FramePainter(CORRIDOR, overlay=overlay)
    for number in (0, 1):
        scene = without_legend(CORRIDOR, state=number * 5, overlay=overlay)
        expected = to_rgb(scene).astype(int)
        assert np.abs(painter.frame(number * 5) - expected).mean() < 0.3
    *_, numbers, _, told = TextPainter(CORRIDOR, overlay=overlay).lines(0)
    assert numbers == "0.00  1.00  2.00  3.00  4.00"
    assert told == "╱ cannot occur while nothing is held or on, with mover-1 at [4, 0]"


@pytest.mark.parametrize("kind", ["values", "policy"])
def test_what_cannot_occur_is_hatched_and_told(kind: str) -> None:
    level = brl.load("first-key")
    overlay = overlay_from({kind: brl.solve(level)}, level)
    behind = {(x, y) for x in (3, 4) for y in range(3)}
    # Whoever is in the cell of the key holds it.
    hatched, whole = [
        build_scene(level, configuration=number, overlay=overlay, robot=False) for number in (0, 1)
    ]
    assert overlay.at(0).never == behind | {(0, 0)}
    assert "hatched: cannot occur while nothing is held" in texts_of(hatched)
    assert overlay.at(1).never == set()
    assert "shown while key is held" in texts_of(whole)
    assert hatched.height == whole.height
    lines = [
        shape.commands
        for shape in hatched.shapes
        if isinstance(shape, Path) and shape not in whole.shapes and 0 < shape.opacity < 0.5
    ]
    margin = layout_of(level, overlay=overlay).margin
    cells = {
        tuple(int((place - margin) // CELL) for place in middle_of(line, end))
        for commands in lines
        for line, end in zip(commands[::2], commands[1::2], strict=True)
    }
    assert cells == overlay.at(0).never


def middle_of(start: Any, end: Any) -> list[float]:
    return [(one + other) / 2 for one, other in zip(start[1], end[1], strict=True)]


def texts_of(scene: Scene) -> list[str]:
    return [shape.text for shape in scene.shapes if isinstance(shape, Text)]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("two-levers", "hatched: cannot occur while nothing is on"),
        ("night-watch", "shown with watchman at [7, 1]"),
        ("shell-game", "hatched: cannot occur while nothing is on, with exit at [0, 0]"),
        ("frozen-lake", ""),
    ],
)
def test_a_picture_says_which_configuration_it_shows(name: str, words: str) -> None:
    level = brl.load(name)
    overlay = overlay_from({"values": brl.solve(level)}, level)
    assert (overlay.caption, overlay.parts is None) == (words, not words)


def test_a_long_caption_takes_lines_and_no_more_than_there_is_room_for() -> None:
    overlay = Overlay(values=[[1.0] * 5], caption="cannot occur while all is held " * 20)
    layout = layout_of(CORRIDOR, overlay=overlay)
    lines = caption_lines(overlay.caption, layout)
    assert (len(lines), lines[-1][-1]) == (4, "…")
    assert layout.top_height == layout.legend_top + layout.legend + layout.caption


def test_overlays_can_be_pickled_and_copied() -> None:
    values = np.arange(COUNT * 5.0).reshape(COUNT, 1, 5)
    overlay = overlay_from({"values": values}, CORRIDOR)
    for other in (pickle.loads(pickle.dumps(overlay)), copy.deepcopy(overlay)):
        assert other.at(3).values == overlay.at(3).values


def test_an_array_of_another_size_is_refused() -> None:
    with pytest.raises(ValueError, match=rf"with an axis of {COUNT} configurations before"):
        overlay_from({"values": np.zeros((COUNT + 1, 1, 5))}, CORRIDOR)


PLAIN = level(size=[3, 2])


def test_turning_arrays_show_the_heading_at_hand_or_the_largest_value() -> None:
    values = np.arange(24.0).reshape(4, 2, 3)
    overlay = overlay_from({"values": values, "visits": values}, PLAIN)
    assert overlay.at(None, 2).values == values[2].tolist()
    assert overlay.values == values.max(axis=0).tolist()
    assert overlay.visits == values.sum(axis=0).tolist()


def test_turns_are_shown_as_the_moves_to_where_the_robot_then_looks() -> None:
    policy = np.full((4, 2, 3), int(Turn.LEFT))
    policy[1] = Turn.FORWARD
    policy[1, 0, 0] = -1
    overlay = overlay_from({"policy": policy}, PLAIN)
    north, east = (overlay.at(None, heading).actions for heading in (0, 1))
    assert north == [[(Action.WEST,)] * 3] * 2
    assert east == [[(), (Action.EAST,), (Action.EAST,)], [(Action.EAST,)] * 3]
    # Without a heading, the ways in which the robot goes forward.
    assert overlay.actions == east


def test_values_of_turns_are_beside_the_side_to_which_they_lead() -> None:
    values = np.zeros((4, 2, 3, 3))
    values[3, 0, 0] = (1, 2, 3)
    overlay = overlay_from({"action_values": values}, PLAIN)
    shown = overlay.at(None, 3).action_values
    assert shown is not None
    # Looking west, left is south and right is north.
    assert shown[0][0] == [None, 2, None, 1, 3]
    assert overlay.action_values is not None
    assert overlay.action_values[0][0] == [None, 0, 0, 0, 3]


def test_turning_arrays_by_configuration() -> None:
    values = np.arange(COUNT * 20.0).reshape(COUNT, 4, 1, 5)
    overlay = overlay_from({"values": values}, CORRIDOR)
    assert overlay.at(2, 1).values == values[2, 1].tolist()
    assert overlay.at(2).values == values[2].max(axis=0).tolist()
