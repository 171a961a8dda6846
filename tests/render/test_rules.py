"""The rules and the goal of a level in words, and the box in which pictures show them."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.worlds import level

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import page_data
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.layout import Overlay
from babyrobot_levels.render.scene.panels import sample_shapes
from babyrobot_levels.render.scene.shapes import Ellipse, Path, Rect, Scene, Text
from babyrobot_levels.render.scene.walls import GLASS
from babyrobot_levels.render.words.describe import goal_of
from babyrobot_levels.render.words.phrases import chance, color_name, percent, ranges
from babyrobot_levels.render.words.rules import MOST, rules_of


def told(world: Level) -> list[str]:
    return [rule.text for rule in rules_of(world)]


def words(scene: Scene) -> list[str]:
    return [shape.text for shape in scene.shapes if isinstance(shape, Text)]


def shown(scene: Scene) -> str:
    return " ".join(words(scene))


WITH_RULES = Overlay(rules=True)


# -- texts ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("warp", "text"),
    [
        ({"to": [[3, 0], [4, 0]]}, "leads to [3, 0] or [4, 0]"),
        (
            {"to": [[3, 0], [4, 0]], "weights": [3, 1]},
            "leads to [3, 0] 3 times in 4 or [4, 0] 1 time in 4",
        ),
        ({"to": [3, 0], "probability": 0.5}, "5 times in 10 leads to [3, 0]"),
        ({"to": "start", "when": "leave"}, "every move leads back to a start"),
    ],
)
def test_warps_tell_how_often_they_lead_where(warp: dict[str, Any], text: str) -> None:
    world = level(size=[6, 1], start=[[0, 0], [2, 0]], warps=[{"at": [1, 0], **warp}])
    assert f"warp: {text}" in told(world)


@pytest.mark.parametrize(
    ("how", "text"),
    [
        ({"probability": 0.5}, "1 cell north in column 1, 5 times in 10"),
        ({"varies": True}, "1 cell north in column 1, a cell less or more 2 times in 3"),
    ],
)
def test_a_wind_by_chance_tells_how_often_it_blows(how: dict[str, Any], text: str) -> None:
    assert f"wind: pushes {text}" in told(level(wind={"north": [0, 1, 0], **how}))


def test_exits_that_pay_what_their_cells_do_have_a_rule_each() -> None:
    areas = [{"at": [0, 0], "reward": 1}, {"at": [4, 0], "reward": -10}]
    world = level(
        size=[5, 1], start=[2, 0], exit=[[0, 0], [4, 0]], areas=areas, rewards={"exit": "cell"}
    )
    rules = [rule for rule in rules_of(world) if rule.sample == "exit"]
    assert [(rule.text, rule.cells) for rule in rules] == [
        ("exit: ends the episode, pays 1", (0,)),
        ("exit: ends the episode, costs 10", (4,)),
    ]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        (
            "final-maze",
            [
                "exit: ends the episode, pays 0",
                "each step: costs 1",
                "small puddle: costs 2, skids 4 times in 10",
                "large puddle: costs 4, skids 6 times in 10",
                "the episode ends after 500 steps",
                "start: episodes begin here",
            ],
        ),
        (
            "gridworld-3-5",
            [
                "each step: pays 0",
                "A: pays 10, every move leads to [1, 4]",
                "B: pays 5, every move leads to [3, 2]",
                "bumping into a wall: costs 1",
                "the episode ends after 1,000 steps",
                "discount 0.9",
                "start: episodes begin here",
            ],
        ),
        (
            "drawbridge",
            [
                "exit: ends the episode, pays 0",
                "each step: costs 1",
                "lever: while on: opens the brown door",
                "lock: on at first, while on: closes the red door",
                "boatman: walks its path, meeting it costs 20",
                "blue cell: costs 3",
                "the episode ends after 200 steps",
                "blocked: cannot be entered",
                "start: episodes begin here",
            ],
        ),
    ],
)
def test_rules_of_the_gallery(name: str, expected: list[str]) -> None:
    assert told(load(name)) == expected


def test_an_area_that_is_covered_by_others_is_not_told() -> None:
    areas = [
        {"at": [0, 0], "size": [2, 1], "reward": -7, "label": "mud"},
        {"at": [0, 0], "size": [3, 1], "reward": -2, "label": "sand"},
    ]
    rules = told(level(size=[4, 1], start=[3, 0], exit="none", areas=areas))
    assert [rule for rule in rules if rule.startswith(("mud", "sand"))] == ["sand: costs 2"]


def test_warps_without_names_are_told_once() -> None:
    warps = [{"at": [1, 0], "to": [3, 0]}, {"at": [2, 0], "to": [0, 1]}]
    assert "warp: leads along its arrow" in told(level(size=[4, 2], warps=warps))
    assert "warp: leads to [3, 0]" in told(level(size=[4, 2], warps=warps[:1]))


def test_a_warp_pays_as_the_cell_to_which_it_leads_and_its_own_cell_when_it_is_entered() -> None:
    mud = {"areas": [{"at": [1, 0], "reward": -7}]}
    warp: dict[str, Any] = {"at": [1, 0], "to": [3, 0]}
    assert "warp: leads to [3, 0]" in told(level(size=[4, 2], warps=[warp], **mud))
    warp["when"] = "leave"
    expected = "warp: entering it costs 7, every move leads to [3, 0]"
    assert expected in told(level(size=[4, 2], warps=[warp], **mud))


def test_areas_and_warps_are_told_that_have_puddles_in_them() -> None:
    wet = {"size": [4, 2], "puddles": [{"at": [1, 0]}]}
    mud = {"at": [1, 0], "size": [2, 1], "reward": -7, "label": "mud"}
    assert "mud: costs 7" in told(level(**wet, areas=[mud]))
    assert "warp: leads to [3, 0]" in told(level(**wet, warps=[{"at": [1, 0], "to": [3, 0]}]))
    ends = told(level(**wet, areas=[mud | {"ends": True}]))
    assert {"mud: ends the episode, costs 7", "mud: ends the episode, costs 2"} <= {*ends}


def test_texts_of_strangers_are_short_and_printable() -> None:
    label = "\x1b[31m" + "x" * 10_000
    areas = [{"at": [x, 0], "reward": -2 - x, "label": f"{x}{label}"} for x in range(1, 40)]
    rules = told(level(size=[41, 1], areas=areas))
    assert len(rules) <= MOST
    assert all(rule.isprintable() and len(rule) < 80 for rule in rules)


def test_doors_that_cannot_be_told_apart_by_colour_are_told_by_place() -> None:
    doors = [
        {"at": [0, 0], "side": "E", "needs": "a", "color": "crimson"},
        {"at": [1, 0], "side": "E", "needs": "b", "color": "firebrick"},
    ]
    items = [{"name": "a", "at": [0, 1]}, {"name": "b", "at": [1, 1]}]
    rules = told(level(size=[3, 2], doors=doors, items=items))
    assert "a: opens the door east of [0, 0]" in rules


@pytest.mark.parametrize(
    ("probability", "text"),
    [
        (0.6, "6 times in 10"),
        (0.75, "3 times in 4"),
        (0.27, "27 %"),
        (0.004, "0.4 %"),
        (1.0, "always"),
    ],
)
def test_chances_are_told_in_tens_thirds_and_quarters_else_in_percent(
    probability: float, text: str
) -> None:
    assert chance(probability) == text


def test_ranges_of_columns() -> None:
    assert ranges([8, 3, 5, 4]) == "3 to 5 and 8"
    assert ranges([0, 1, 4]) == "0, 1 and 4"
    assert ranges([2]) == "2"


def test_colours_are_named_as_they_are_shown() -> None:
    default, paper = (BUILTIN_THEMES[name].colors for name in ("default", "print"))
    names = {color: color_name(color, default) for color in ("crimson", "#1b3a5c", "sienna", "tan")}
    assert names == {"crimson": "red", "#1b3a5c": "dark blue", "sienna": "brown", "tan": "beige"}
    assert color_name("crimson", paper) == "grey"


# -- the goal ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "goal"),
    [
        ("final-maze", "Move the robot to the exit."),
        ("treasure-chests", "Reach the gold."),
        ("gridworld-3-5", "Collect as much reward as you can in 1,000 steps."),
        ("first-key", "Fetch the key, then go to the exit."),
        ("three-gems", "Fetch the emerald, ruby and sapphire, then go to the exit."),
    ],
)
def test_goals_of_the_gallery(name: str, goal: str) -> None:
    assert goal_of(load(name)) == goal


@pytest.mark.parametrize(
    ("areas", "goal"),
    [
        ([], "Collect as much reward as you can."),
        ([{"at": [2, 0], "reward": -9, "ends": True}], "Reach the chest."),
        (
            [{"at": [2, 0], "reward": 5, "ends": True, "label": name} for name in ("left",)]
            + [{"at": [2, 2], "reward": 5, "ends": True, "label": "right"}],
            "Reach a cell that ends the episode and pays 5.",
        ),
    ],
)
def test_goals_without_exits(areas: list[dict[str, Any]], goal: str) -> None:
    assert goal_of(level(exit="none", areas=areas)) == goal


def test_an_end_that_pays_more_than_the_exit_is_the_goal() -> None:
    end = {"at": [2, 0], "ends": True, "label": "treasure"}
    assert goal_of(level(areas=[{**end, "reward": 5}])) == "Reach the treasure."
    pays_more = level(areas=[{**end, "reward": 5}], rewards={"exit": 10})
    assert goal_of(pays_more) == "Move the robot to the exit."


# -- samples -------------------------------------------------------------------------------------


@pytest.mark.parametrize("theme", BUILTIN_THEMES)
def test_samples_are_pictures_of_the_size_asked_for(theme: str) -> None:
    for name in ("final-maze", "drawbridge", "glass-wall", "river-crossing", "teleport-pads"):
        world = load(name).replace(theme=theme)
        for sample, _, _ in rules_of(world):
            shapes = sample_shapes(world, sample, 18)
            assert bool(shapes) == bool(sample)
            for shape in shapes:
                match shape:
                    case Rect():
                        assert 0 <= shape.x <= shape.x + shape.width <= 18.01
                    case Ellipse():
                        assert 0 <= shape.x - shape.rx <= shape.x + shape.rx <= 18.01
                    case Path():
                        points = [n for _, numbers in shape.commands for n in numbers]
                        assert -2 <= min(points) <= max(points) <= 20


def test_the_sample_of_glass_is_glass_and_that_of_a_wall_is_not() -> None:
    walls = [{"at": (0, 0), "side": "E", "pass": 0.5}, {"at": (0, 1), "side": "E"}]
    world = level(walls=walls)
    for sample in ("glass", "wall"):
        strokes = {
            shape.stroke for shape in sample_shapes(world, sample, 18) if isinstance(shape, Path)
        }
        assert (GLASS in strokes) == (sample == "glass")


# -- the box -------------------------------------------------------------------------------------


@settings(max_examples=settings().max_examples // 3)
@given(
    kinds=st.integers(0, 30),
    side=st.sampled_from([0, 80, 130, 200, 400]),
    bottom=st.sampled_from([0, 40, 60, 300]),
    size=st.tuples(st.integers(1, 6), st.integers(1, 6)),
)
def test_a_panel_shows_all_rules_or_none_and_the_box_all(
    kinds: int, side: int, bottom: int, size: tuple[int, int]
) -> None:
    cells = [(x, y) for x in range(size[0]) for y in range(size[1])][:kinds]
    areas = [
        {"at": [*cell], "reward": number + 2, "ends": number % 2 == 0, "label": f"kind {number}"}
        for number, cell in enumerate(cells)
    ]
    display = {"side_panel": side, "bottom_panel": bottom}
    world = level(size=[*size], start=[0, 0], exit="none", areas=areas[1:], display=display)
    every = " ".join(told(world))
    panel = build_scene(world)
    assert (every in shown(panel)) or not any(rule in shown(panel) for rule in told(world))
    asked = build_scene(world, overlay=WITH_RULES)
    assert every in shown(asked)
    assert max(text.y for text in asked.shapes if isinstance(text, Text)) < asked.height


def test_kinds_of_cells_and_rules_that_are_not_told_are_counted() -> None:
    areas = [{"at": [x, 0], "reward": -2 - x, "label": f"kind {x}"} for x in range(1, 40)]
    assert "33 further kinds of cells with effects of their own" in told(
        level(size=[41, 1], areas=areas)
    )
    keys = [{"name": f"key-{x}", "at": [x, 1]} for x in range(11)]
    doors = [{"at": [x, 0], "side": "S", "needs": f"key-{x}"} for x in range(11)]
    many = told(level(size=[12, 2], items=keys, doors=doors, areas=areas[:8]))
    assert len(many) == MOST
    assert many[-1].startswith("and ")


def test_panels_with_hardly_any_room_and_the_column_of_the_compass_show_none() -> None:
    for display in ({"side_panel": 80}, {"compass": True}, {"bottom_panel": 40}):
        text = shown(build_scene(level(display=display)))
        assert "step" not in text
        assert "…" not in text


def test_a_panel_with_room_for_all_rules_needs_no_box() -> None:
    world = load("final-maze")
    plain, asked = build_scene(world), build_scene(world, overlay=WITH_RULES)
    assert (asked.width, asked.height) == (plain.width, plain.height)
    lines = Overlay(rules=True, side_panel=["Episode 1"])
    assert build_scene(world, overlay=lines).height > plain.height


def test_a_level_of_one_column_is_widened_for_its_rules() -> None:
    world = level(size=[1, 4], exit=[0, 3])
    scene = build_scene(world, overlay=WITH_RULES)
    assert scene.width > build_scene(world).width
    assert all(rule in shown(scene) for rule in told(world))


# -- pages and the command line ------------------------------------------------------------------


def test_pages_have_the_rules_with_samples_and_cells() -> None:
    data = page_data(load("final-maze"))
    assert [text for _, text, _ in data["rules"]] == told(load("final-maze"))
    assert all(
        bool(sample) == ("episode ends after" not in text) for sample, text, _ in data["rules"]
    )
    assert data["goal"] == "Move the robot to the exit."


@pytest.mark.parametrize(
    ("probability", "text"),
    [
        (0, "0 %"),
        (1e-12, "0 %"),
        (1e-6, "under 0.01 %"),
        (0.17647, "17.6 %"),
        (0.99999, "over 99.9 %"),
        (1 - 1e-12, "100 %"),
    ],
)
def test_a_percentage_is_not_sure_of_what_is_not(probability: float, text: str) -> None:
    assert percent(probability) == text
