"""Things in films, in texts, and under overlays that differ between configurations."""

from __future__ import annotations

import copy
import io
import os
import pickle
import re
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from PIL import Image
from support.golden import FOLDER
from support.scenes import without_legend
from support.worlds import level

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.mdp.states import configuration_with, initial_configuration
from babyrobot_levels.render.frames import FramePainter
from babyrobot_levels.render.gif import Step, to_gif
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.info import overlay_from
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.situation import Mood, Pose
from babyrobot_levels.render.terminal import ALL_COLORS
from babyrobot_levels.render.text import TextPainter

VAULT = load(str(FOLDER / "things.yaml"))


CORRIDOR = level(
    size=[5, 1],
    items=[{"name": "key", "at": [1, 0]}],
    doors=[{"at": [2, 0], "side": "E", "needs": "key"}],
    switches=[{"name": "lever", "at": [2, 0]}],
    movers=[{"path": [[4, 0], [3, 0]]}],
    exit="none",
    hit={"ends": False},
)


def episode(world: Any, actions: str) -> list[Step]:
    """Return the steps of an episode without chance."""
    mdp = world.compile()
    state, steps = int(mdp.start.argmax()), []
    for letter in actions:
        action = ".NESW".index(letter)
        following = int(mdp.next_state[state, action, 0])
        steps.append(Step(state, action, following, float(mdp.reward[state, action, 0])))
        state = following
    return steps


# -- films -----------------------------------------------------------------------------------


def film(world: Any, steps: list[Step]) -> list[Any]:
    with Image.open(io.BytesIO(to_gif(world, steps))) as image:
        frames = []
        for index in range(image.n_frames):
            image.seek(index)
            frames.append(np.array(image.convert("RGB")))
    return frames


def test_a_film_ends_with_the_pictures_of_its_states() -> None:
    steps = episode(CORRIDOR, "EE.")
    frames = film(CORRIDOR, steps)
    arrivals = [frames[5 * count] for count in range(1, 4)]
    for step, frame in zip(steps, arrivals, strict=True):
        pose = Pose(Action(step.action))
        expected = to_rgb(build_scene(CORRIDOR, state=step.next_state, pose=pose)).astype(int)
        assert np.abs(frame - expected).mean() < 2.5
    first = to_rgb(build_scene(CORRIDOR, state=steps[0].state)).astype(int)
    assert np.abs(frames[0] - first).mean() < 2.5


def test_a_thing_is_taken_on_arrival_and_movers_glide() -> None:
    frames = film(CORRIDOR, episode(CORRIDOR, "E"))
    key, guard = np.s_[20:50, 75:120], np.s_[10:60, 200:320]
    assert len(frames) == 6
    # The door is still closed while the robot is on its way, and the guard between its cells.
    door = np.s_[24:44, 190:202]
    assert (frames[4][door] == frames[0][door]).all()
    assert (frames[5][door] != frames[0][door]).any()
    places = [
        np.argwhere((frame[guard] == (255, 93, 115)).all(axis=2))[:, 1].mean() for frame in frames
    ]
    assert all(later < earlier for earlier, later in pairwise(places))
    assert (frames[0][key] != frames[5][key]).any()


@pytest.mark.parametrize("display", [{"side_panel": 140}, {"bottom_panel": 44}, {}])
def test_what_is_held_is_seen_in_films(display: dict[str, Any]) -> None:
    world = CORRIDOR.replace(display=display)
    steps = episode(world, "E")
    last = film(world, steps)[-1].astype(int)
    scene = build_scene(world, state=steps[0].next_state, pose=Pose(Action.EAST))
    before = build_scene(world, state=steps[0].state)
    outside = np.ones(last.shape[:2], bool)
    outside[:70, :330] = False
    expected, other = (to_rgb(each).astype(int)[outside] for each in (scene, before))
    # The score is in the film only.
    assert np.abs(last[outside] - expected).mean() < np.abs(last[outside] - other).mean()


def test_the_robot_cheers_only_at_an_open_exit() -> None:
    world = level(
        size=[3, 1],
        start=[1, 0],
        items=[{"name": "gem", "at": [0, 0]}],
        exit_needs="gem",
    )
    for actions, cheers in (("E", False), ("WEE", True)):
        steps = episode(world, actions)
        last = film(world, steps)[-1].astype(int)
        cheering = to_rgb(
            build_scene(world, state=steps[-1].next_state, pose=Pose(mood=Mood.CHEER))
        )
        assert (np.abs(last - cheering).mean() < 2.5) == cheers


# -- texts -----------------------------------------------------------------------------------


def test_the_level_as_a_whole_in_unicode() -> None:
    assert "\n".join([*TextPainter(VAULT).lines(None, held=False), ""]) == (
        "┌───────────────────┬───────┐\n"
        "│ S           ¢     │     Ω │\n"
        "│   ·   ·   ·   ·   │   ·   │\n"
        "│                   │ ♦     │\n"
        "│   ·   ·   ·   ·   ╵   ·   │\n"
        "│         0   1     ┃       │\n"
        "├───╴━━━╶───────╴   ╷   ·   │\n"
        "│                   │ ♦ : X │\n"
        "│   ·   ·   ·   ·   │   ·   │\n"
        "│ ♀       Ω         │     X │\n"
        "└───────────────────┴───────┘\n"
    )


@pytest.mark.parametrize(
    ("plain", "heading", "expected"),
    [
        (
            False,
            None,
            "┌───────────────────┬───────┐\n"
            "│ S           ¢     │     Ω │\n"
            "│   ·   ·   ·   ·   │   ·   │\n"
            "│                   │ ♦     │\n"
            "│   ·   ·   ·   ·   ╵   ·   │\n"
            "│         ☻1  1     :       │\n"
            "├───╴╴ ╶╶───────╴   ╷   ·   │\n"
            "│                   │   ┃   │\n"
            "│   ·   ·   ·   ·   │   ·   │\n"
            "│         Ω         │     X │\n"
            "└───────────────────┴───────┘\n"
            "\n"
            "held: key",
        ),
        (
            True,
            1,
            "+---+---+---+---+---+---+---+\n"
            "| S           c     |     & |\n"
            "+   +   +   +   +   +   +   +\n"
            "|                   | g     |\n"
            "+   +   +   +   +   +   +   +\n"
            "|         >1  1     :       |\n"
            "+---+- -+---+---+   +   +   +\n"
            "|                   |   /   |\n"
            "+   +   +   +   +   +   +   +\n"
            "|         &         |     X |\n"
            "+---+---+---+---+---+---+---+\n"
            "\n"
            "held: key",
        ),
    ],
)
def test_a_state_as_text(plain: bool, heading: int | None, expected: str) -> None:
    state = configuration_with(VAULT, ["key", "lever", "plate"]) * 35 + 2 * 7 + 2
    assert "\n".join(TextPainter(VAULT, plain=plain).lines(state, heading=heading)) == expected


def test_nothing_is_held_at_first_and_the_line_can_be_left_out() -> None:
    painter = TextPainter(CORRIDOR)
    assert painter.lines(0)[-2:] == ["", "held: nothing"]
    assert painter.lines(0, held=False)[-1].startswith("└")
    assert TextPainter(level(size=[3, 1])).lines(0)[-1].startswith("└")


def test_arrows_leave_room_for_things_beside_them() -> None:
    overlay = Overlay(actions=[[(2,), (2,), (2,), (), ()]])
    painter = TextPainter(CORRIDOR, plain=True, overlay=overlay)
    assert painter.lines(None, configuration=0, held=False) == [
        "+---+---+---+---+---+",
        "| >   >k  >0/     & |",
        "+---+---+---+---+---+",
    ]


def test_characters_of_things_have_colors_that_are_seen() -> None:
    state = initial_configuration(CORRIDOR) * 5
    line = TextPainter(CORRIDOR).lines(state, colors=ALL_COLORS)[1]
    # The key on its own colour, and the door on that of the key.
    escapes = re.findall(r"\x1b\[38;2;\d+;\d+;\d+;48;2;(\d+);(\d+);(\d+)m([^\x1b]*)", line)
    grounds = {text: (red, green, blue) for red, green, blue, text in escapes}
    assert grounds["♀"] == grounds["┃"] == ("255", "194", "26")
    assert grounds["Ω"] == ("255", "93", "115")


def test_a_small_terminal_shows_the_part_around_the_robot() -> None:
    lines = TextPainter(VAULT).lines(0, room=os.terminal_size((12, 5)))
    assert len(lines) == 5
    assert lines[-1] == "held: nothin"


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
    assert "\n".join(TextPainter(CORRIDOR, overlay=overlay).lines(0)).endswith(
        "0.00  1.00  2.00  3.00  4.00"
    )


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
