"""Setups of PyPI babyrobot: they become the MDPs that the package plays."""

from __future__ import annotations

import json
import re
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.conversions import level_of_world, world_of
from support.places import TESTS
from support.worlds import level_of

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats import setup_walls, setups
from babyrobot_levels.extensions.formats.conversion import ConversionError, file_text
from babyrobot_levels.extensions.formats.setups import read_setup

RECORD = json.loads((TESTS / "oracles" / "babyrobot.json").read_text(encoding="utf-8"))["levels"]

Setup = dict[str, Any]


def lost(setup: Setup) -> dict[str, str]:
    """Return the messages of what a level does not keep of a setup, by name."""
    return {each.field: each.message for each in read_setup(setup).lost}


def fields(setup: Setup) -> dict[str, Any]:
    return read_setup(setup).fields


# -- recorded worlds of the package ----------------------------------------------------------


@pytest.mark.slow
def test_recorded_setups_are_the_recorded_levels() -> None:
    assert len(RECORD) == 200
    for number, record in enumerate(RECORD):
        level = brl.from_setup(record["setup"])
        assert level.digest == level_of(record["level"]).digest, number


# -- keyword by keyword ----------------------------------------------------------------------


def test_an_empty_setup_is_a_grid_of_three_by_three() -> None:
    level = brl.from_setup({})
    assert (level.size, level.starts, level.exits) == ((3, 3), ((0, 0),), ((2, 2),))
    assert level.rewards.exit == -1


def test_numpy_values_and_tuples_are_accepted() -> None:
    setup = {"width": np.int64(4), "start": (np.int32(1), 0), "puddles": [((2, 2), np.int8(2))]}
    assert brl.from_setup(setup).puddles[0].size == "large"


@pytest.mark.parametrize("is_there", [True, False])
def test_an_entry_toggles_a_wall(is_there: bool) -> None:
    maze = {"width": 8, "height": 5, "end": [5, 4], "add_maze": True, "maze_seed": 42}
    side = ((2, 0), "E") if is_there else ((5, 2), "E")
    found = fields({**maze, "walls": [side]})
    entry = {"at": [*side[0]], "side": "E"}
    assert found.get("openings") == ([entry] if is_there else None)
    assert found.get("walls") == (None if is_there else [entry])


def test_toggling_twice_changes_only_the_properties_of_a_wall() -> None:
    maze = {"width": 8, "height": 5, "add_maze": True, "maze_seed": 42}
    twice = [((2, 0), "E"), ((3, 0), "W")]
    assert brl.from_setup({**maze, "walls": twice}).digest == brl.from_setup(maze).digest
    glass = [((2, 0), "E"), ((3, 0), "W", {"prob": 0.3})]
    found = fields({**maze, "walls": glass})
    assert found["walls"] == [{"at": [3, 0], "side": "W", "pass": 0.3}]


def test_the_robot_bounces_off_glass_of_probability_zero() -> None:
    # The level of the article on Monte Carlo methods, with the values that the package prints.
    look = {"color": "#00a9ff", "width": 10, "fit": True}
    setup = {
        **{"width": 3, "height": 4, "start": [0, 1], "end": [1, 3], "puddles": [((1, 0), 2)]},
        "base_areas": [(0, 0, 1, 1), (0, 2, 1, 2), (2, 0, 1, 1), (2, 3, 1, 1)],
        "walls": [((1, 1), "S", {**look, "prob": 0.0})],
    }
    assert list(lost(setup)) == ["walls[0] prob"]
    level = brl.load(fields(setup))
    values = brl.evaluate(level, "random", actions="moves").values
    nan = float("nan")
    expected = [[nan, -108.0, nan], [-102.0, -101.0, -75.0], [nan, -17.0, -47.0], [nan, 0.0, nan]]
    assert np.allclose(values, expected, atol=1e-5, equal_nan=True)


def test_one_entry_may_add_and_remove_walls() -> None:
    walls = [((1, 1), "S"), ((0, 1, 3), "S", {"color": "Blue", "width": 6, "fit": False})]
    found = fields({"walls": walls})
    look = {"color": "blue", "width": 6, "fit": True}
    assert found["walls"] == [
        {"at": [0, 1], "side": "S", **look},
        {"at": [2, 1], "side": "S", **look},
    ]
    assert "openings" not in found


def test_the_outer_wall_and_edges_off_the_grid_are_not_toggled() -> None:
    setup = {"walls": [((0, 0), "W"), ((1, 2, 9), "N"), ((7, 7), "N")]}
    assert brl.load(fields(setup)).grid().open[0, 0].tolist() == [False, True, True, False]
    assert list(lost(setup)) == ["walls[0]", "walls[1]", "walls[2]"]


@pytest.mark.parametrize("blocked", [True, False])
def test_a_maze_that_a_level_would_generate_differently_becomes_walls(blocked: bool) -> None:
    # The package grows its maze through cells that are off the grid, and from `start`.
    maze: Setup = {"width": 6, "height": 5, "add_maze": True, "maze_seed": 3, "start": [2, 2]}
    other: Setup = {"base_areas": [(4, 1)]} if blocked else {"initial_pos": [0, 0]}
    level = brl.load(fields({**maze, **other, "walls": [((2, 2), "N")]}))
    plain = brl.load(fields({**maze, "walls": [((2, 2), "N")]}))
    assert level.maze is None
    same = level.grid().open == plain.grid().open
    near = np.zeros((5, 6), bool)
    if blocked:
        near[1, 3:6] = near[0:3, 4] = True
    assert same[~near].all()
    assert level.starts == (((2, 2),) if blocked else ((0, 0),))


@pytest.mark.parametrize(
    "puddles",
    [
        [((1, 1), 2), ((2, 0), 1)],
        [[0, 0, 1], [0, 2, 0], [0, 0, 0]],
        [((1, 1), 2), ((2, 0), 1), ((1, 1), 2), ((0, 2), 0)],
    ],
    ids=["list", "table", "repeated"],
)
def test_puddles_are_a_list_or_a_table(puddles: Any) -> None:
    level = brl.from_setup({"puddles": puddles})
    assert {(puddle.at, puddle.size) for puddle in level.puddles} == {
        ((1, 1), "large"),
        ((2, 0), "small"),
    }


def test_a_puddle_on_the_exit_gives_the_exits_reward() -> None:
    setup = {"puddles": [((2, 2), 1)], "puddle_props": {"small_reward": -7}}
    assert brl.from_setup(setup).rewards.exit == -7


def test_of_two_puddles_in_a_cell_the_first_one_counts() -> None:
    setup = {"puddles": [((1, 1), 1), ((2, 1), 2), ((1, 1), 2), ((2, 1), 2)]}
    assert fields(setup)["puddles"] == [
        {"at": [1, 1], "size": "small"},
        {"at": [2, 1], "size": "large"},
    ]
    assert [*lost(setup)] == ["puddles[2]"]


def test_puddle_properties_are_probabilities_of_not_skidding() -> None:
    props = {"large_reward": -10, "large_prob": 0.1, "small_reward": -5, "small_prob": 0.2}
    types = brl.from_setup({"puddle_props": props}).puddle_types
    assert (types.large.reward, types.large.skid) == (-10, 0.9)
    assert (types.small.reward, types.small.skid) == (-5, 0.8)


def test_rewards_lose_their_fractions_as_in_the_package() -> None:
    setup = {"grid_areas": [((1, 1), "Red", -2.7)], "puddle_props": {"large_reward": -0.5}}
    assert fields(setup)["areas"] == [{"at": [1, 1], "color": "red", "reward": -2}]
    assert lost(setup) == {
        "puddle_props large_reward": "the package counts -0.5 as 0",
        "grid_areas[0]": "the package counts -2.7 as -2",
    }


@pytest.mark.parametrize("reward", [1e300, -1e300, 2**53, -(10**300)])
def test_large_rewards_come_back_as_files(reward: float) -> None:
    setup = {"grid_areas": [((1, 1), "red", reward)], "puddle_props": {"large_reward": reward}}
    world = read_setup(setup)
    written = file_text(world, schema=None, name=None, title="Imported")
    assert brl.loads(written).digest == level_of_world(world).digest
    assert max(map(len, re.findall(r"\d+", written))) < 40


@pytest.mark.parametrize(
    ("limit", "setup", "message"),
    [
        ("MAX_TOGGLES", {"walls": [((0, 0, 3), "S"), ((0, 1, 2), "S")]}, "walls toggle more than"),
        ("MAX_BLOCKED", {"base_areas": [(0, 0, 2, 2), (1, 0)]}, "base_areas cover more than"),
    ],
)
def test_the_work_for_a_setup_is_bounded(
    limit: str, setup: Setup, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = setup_walls if limit == "MAX_TOGGLES" else setups
    monkeypatch.setattr(module, limit, 5)
    read_setup(setup)
    monkeypatch.setattr(module, limit, 4)
    with pytest.raises(ConversionError, match=message):
        read_setup(setup)


def test_areas_are_cut_at_the_edge_of_the_grid() -> None:
    setup = {"grid_areas": [((1, 2, 5, 5), "gold", -4), ((9, 9), "gold", 1)]}
    assert fields(setup)["areas"] == [{"at": [1, 2], "size": [2, 1], "color": "gold", "reward": -4}]
    assert list(lost(setup)) == ["grid_areas[1]"]


def test_base_areas_are_blocked_in_all_their_forms() -> None:
    setup = {
        "width": 6,
        "base_areas": [
            (2, 0, 2, 2),
            ((0, 2, 1, 1), "Gray"),
            ((5, 0), "gray", [("E"), ("W", "Red")]),
        ],
    }
    found = fields(setup)
    assert found["blocked"] == [{"at": [2, 0], "size": [2, 2]}, {"at": [0, 2]}, {"at": [5, 0]}]
    assert found["theme"] == {"colors": {"blocked": "gray"}}
    assert list(lost(setup)) == ["base_areas[2] borders"]


def test_looks_are_kept() -> None:
    setup = {
        "add_compass": True,
        "show_start_text": False,
        "show_end_text": False,
        "side_panel": {"width": 150, "color": "#644242", "text_fg": "Yellow", "height": 9},
        "bottom_panel": 60,
        "grid": {
            "colors": {"base": "Aquamarine", "lines": "no colour", "zero_fg": "red"},
            "widths": {"walls": 7, "padding": 3},
        },
        "robot": {"show": False, "sleep": 0.035, "initial_sprite": 3},
    }
    found = fields(setup)
    assert found["display"] == {
        "compass": True,
        "start_text": False,
        "exit_text": False,
        "side_panel": {"width": 150, "color": "#644242", "text_color": "yellow"},
        "bottom_panel": 60,
        "robot": {"show": False, "speed": 2.0},
    }
    assert found["theme"] == {
        "colors": {"base": "aquamarine"},
        "widths": {"walls": 7, "padding": 3},
    }
    assert set(lost(setup)) == {
        "side_panel height",
        "grid colors lines",
        "grid colors zero_fg",
        "robot initial_sprite",
    }


@pytest.mark.parametrize("theme", ["black_orange", "blue_green", "green"])
def test_themes_are_kept_by_their_names(theme: str) -> None:
    level = brl.from_setup({"grid": {"theme": theme, "colors": {"base": "red"}}})
    assert level.theme == theme


def test_an_unknown_theme_is_lost() -> None:
    assert list(lost({"grid": {"theme": "mine"}})) == ["grid theme"]


@pytest.mark.parametrize("end", [[-1, -1], [9, 9]])
def test_an_end_off_the_grid_is_no_exit(end: list[int]) -> None:
    assert fields({"end": end})["exit"] == "none"
    assert ("end" in lost({"end": end})) == (end != [-1, -1])


def test_keywords_about_playing_name_their_replacements() -> None:
    told = lost({"seed": 3, "render_mode": "human", "action_space": "discrete"})
    assert "env.reset" in told["seed"]
    assert "level.make" in told["render_mode"]
    assert "level.make" in told["action_space"]


def test_an_unknown_keyword_suggests_a_known_one() -> None:
    assert "did you mean `puddles`?" in lost({"puddels": []})["puddels"]


def test_from_setup_warns_of_what_it_cannot_keep() -> None:
    with pytest.warns(brl.ConversionWarning, match=r"^seed: "):
        brl.from_setup({"seed": 1})


INVALID: dict[str, Setup] = {
    "width": {"width": "3"},
    "width and height": {"width": 2000},
    "start": {"start": [3, 0]},
    "end": {"end": 4},
    "puddles[1]": {"puddles": [((1, 1), 2), ((1, 1), 3)]},
    "puddles[0]": {"puddles": [5]},
    "walls[0]": {"walls": [((1, 1), "X")]},
    "walls[1]": {"walls": [((1, 1), "E"), ((-1, 1), "E")]},
    "walls[0] prob": {"walls": [((1, 1), "E", {"prob": 2})]},
    "grid_areas[0]": {"grid_areas": [((1, 1, 3), "red")]},
    "base_areas[0]": {"base_areas": ["red"]},
    "maze_seed": {"add_maze": True, "maze_seed": "x"},
    "puddle_props small_prob": {"puddle_props": {"small_prob": -1}},
    "grid_areas": {"grid_areas": {"at": 1}},
    "robot": {"robot": 3},
    "the setup": [],  # type: ignore[dict-item]
}


@pytest.mark.parametrize("name", INVALID)
def test_errors_name_the_value_in_the_setup(name: str) -> None:
    with pytest.raises(ConversionError) as caught:
        brl.from_setup(INVALID[name])
    assert str(caught.value).startswith(name)


def test_a_setup_that_is_not_a_valid_level_is_an_error() -> None:
    with pytest.raises(brl.LevelError, match="start"):
        brl.from_setup({"start": [2, 2]})


# -- texts -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "{'width': 5, 'walls': [((1, 1), 'E')], 'add_compass': True}",
        "# my first world\nsetup = {\n  'width': 5,\n  'walls': [((1, 1), 'E')],\n"
        "  'add_compass': True,\n}\n",
        '{"width": 5, "walls": [[[1, 1], "E"]], "add_compass": true}',
    ],
    ids=["literal", "assigned", "json"],
)
def test_a_setup_is_read_from_a_literal_and_from_json(text: str) -> None:
    level = level_of_world(world_of(text, "babyrobot"))
    assert (level.size[0], len(level.walls), level.display.compass) == (5, 1, True)


def test_nothing_in_a_setup_is_run(tmp_path: Path) -> None:
    text = f"{{'width': __import__('pathlib').Path({str(tmp_path / 'made')!r}).write_text('x')}}"
    with pytest.raises(ConversionError, match=r"world.txt:1:11: error: .*neither JSON nor"):
        world_of(text, "babyrobot")
    assert list(tmp_path.iterdir()) == []


keywords = st.sampled_from(
    [
        *("width", "height", "start", "end", "initial_pos", "puddles", "puddle_props", "walls"),
        *("base_areas", "grid_areas", "add_maze", "maze_seed", "max_steps", "grid", "robot"),
        *("add_compass", "side_panel", "bottom_panel", "seed", "offset", "nonsense"),
    ]
)
anything: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 9) | st.floats() | st.sampled_from(["E", "red"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from("ab"), inner),
    max_leaves=8,
)


@given(st.dictionaries(keywords, anything, max_size=6))
def test_any_setup_is_a_level_or_a_level_error(setup: Setup) -> None:
    # Any other exception is a bug.
    with suppress(brl.LevelError):
        assert brl.load(fields(setup)).digest.startswith("sha256:")
