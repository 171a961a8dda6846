"""Pictures, films and pages from Python: those of the command line, and of what else one has."""

from __future__ import annotations

import io
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.analysis import guides, pictures
from babyrobot_levels.render.scene.shapes import Path as ShapePath
from babyrobot_levels.text.budget import COMMAND, OverBudgetError, within

ENDLESS = brl.loads("version: 1\nsize: [3, 1]\nexit: none\n")
CANCELLING = brl.loads(
    "version: 1\nsize: [3, 1]\nstart: [1, 0]\nexit: none\nblocked: [{at: [2, 0]}]\n"
    "rewards: {stay: -9, bump: -9}\n"
    "areas: [{at: [0, 0], reward: 1}, {at: [1, 0], reward: -1}]\n"
)


def svg_texts(svg: str) -> list[str]:
    root = ET.fromstring(svg)
    return [element.text or "" for element in root.iter("{http://www.w3.org/2000/svg}text")]


@pytest.mark.parametrize(
    ("fields", "steps"),
    [
        ("doors: [{at: [0, 0], side: E, length: 100}]", 5_000_000),
        ("wind: {north: [9, 9, 9]}", 900_000),
        ("skid: 0.2", 400_000),
        (f"puddles: {[{'at': [1, y]} for y in range(100)]}", 2_000_000),
        ("display: {coordinates: true}", 200_000),
    ],
)
def test_shapes_count_as_work(fields: str, steps: int) -> None:
    level = brl.loads(f"version: 1\nsize: [3, 100]\n{fields}\n")
    assert level.to_svg()
    with (
        within(replace(COMMAND, steps=steps)),
        pytest.raises(OverBudgetError, match="too many shapes") as caught,
    ):
        level.to_svg()
    assert caught.value.help == "show it as text, or use a smaller level"


def test_to_paint_pixels_counts_as_work_of_its_own() -> None:
    level = brl.loads("version: 1\nsize: [9, 9]\nwind: {north: [1, 1, 1, 1, 1, 1, 1, 1, 1]}\n")
    with within(replace(COMMAND, steps=300_000)):
        assert level.to_svg()
    with (
        within(replace(COMMAND, steps=300_000)),
        pytest.raises(OverBudgetError, match="too many shapes"),
    ):
        level.to_png(scale=0.1)


# -- the same as the command line --------------------------------------------------------------

SAME: list[tuple[str, str, str, dict[str, Any]]] = [
    ("final-maze", "--values --policy", "svg", {"values": True, "policy": "best"}),
    ("frozen-lake", "--policy --theme print", "svg", {"policy": True, "theme": "print"}),
    ("maze", "--coordinates --scale 0.5", "svg", {"coordinates": True, "scale": 0.5}),
    ("first-key", "--values --held key", "svg", {"values": True, "held": ["key"]}),
    ("two-levers", "--held nothing", "svg", {"held": []}),
    ("first-box", "--values --lost", "svg", {"values": True, "lost": True}),
    ("puddles", "--values --cell 32", "png", {"values": True, "scale": 0.5}),
    ("puddles", "--policy random --cell 16", "gif", {"policy": "random", "scale": 0.25}),
    (
        "first-key",
        "--values --policy --seed 2",
        "html",
        {"values": True, "policy": True, "seed": 2},
    ),
    ("puddles", "--policy random --theme print", "html", {"policy": "random", "theme": "print"}),
]


@pytest.mark.parametrize(("name", "options", "kind", "keywords"), SAME)
def test_python_makes_the_pictures_of_the_command_line(
    name: str, options: str, kind: str, keywords: dict[str, Any], tmp_path: Path
) -> None:
    written, saved = tmp_path / f"cli.{kind}", tmp_path / f"python.{kind}"
    call = ["preview", name, *options.split(), "-o", str(written)]
    assert run_here(call, environment(tmp_path)).status == 0
    made = getattr(brl.load(name), f"to_{kind}")(saved, **keywords)
    data = made.encode("utf-8") if isinstance(made, str) else made
    assert data == written.read_bytes() == saved.read_bytes()


# -- what is shown -----------------------------------------------------------------------------


def test_a_solution_and_its_arrays_are_shown_as_the_optimum_is() -> None:
    level = brl.load("frozen-lake")
    best = brl.solve(level)
    picture = level.to_svg(values=True, policy="best", action_values=True)
    assert picture == level.to_svg(values=best, policy=best, action_values=best)
    assert picture == level.to_svg(
        values=best.values, policy=best.fastest, action_values=best.action_values
    )
    assert picture != level.to_svg(values=brl.solve(level, 0.9), policy=best, action_values=best)
    assert level.to_svg(values=False, policy=None) == level.to_svg()


def test_counts_of_visits_are_shown() -> None:
    level = brl.load("maze")
    visits = np.zeros((5, 8), int)
    visits[2, 3] = 41
    assert "41" in svg_texts(level.to_svg(visits=visits))


def test_where_a_guard_has_caught_the_robot_there_is_no_value() -> None:
    level = brl.load("night-watch")
    mdp, best = level.compile(), brl.solve(level)
    configuration = mdp.configuration(int(mdp.start.argmax()))
    over = mdp.is_terminal.reshape(mdp.shape)[configuration]
    goes_on = (~mdp.is_terminal.reshape(mdp.shape)).any(axis=0)
    assert (over & goes_on).any()
    blank = np.where(over, np.nan, best.values[configuration])
    given = guides.overlay_of(level, {"values": best})
    assert given is not None
    shown = [[np.nan if each is None else each for each in row] for row in given.at().values or ()]
    np.testing.assert_array_equal(shown, blank)


def test_cells_from_which_boxes_are_lost_are_crossed() -> None:
    level = brl.load("first-box")
    crosses = [
        shape
        for shape in pictures.still(level, lost=True).shapes
        if isinstance(shape, ShapePath) and shape.width == 3 and shape.opacity < 1
    ]
    # Two lines in each cell at a wall along which there is no target.
    assert sum(len(shape.commands) for shape in crosses) == 2 * 2 * len(guides.lost_of(level))
    assert "crossed: from here, a box can reach no target" in svg_texts(level.to_svg(lost=True))
    assert brl.load("final-maze").to_svg(lost=True) == brl.load("final-maze").to_svg()


def test_coordinates_can_be_left_out() -> None:
    level = brl.load("maze").replace(display={"coordinates": True})
    assert level.to_svg(coordinates=False) == brl.load("maze").to_svg()


def test_what_does_not_fit_is_refused() -> None:
    level = brl.load("first-key")
    with pytest.raises(ValueError, match="a still picture cannot show a random policy"):
        level.to_svg(policy="random")
    with pytest.raises(ValueError, match="there is no agent 'bset'; did you mean `best`"):
        level.to_png(policy="bset")
    with pytest.raises(ValueError, match="next_page must be the address of a page"):
        level.to_html(next_page="javascript:alert(1)")
    with pytest.raises(ValueError, match="there is no agent 'bset'"):
        level.to_html(policy="bset")
    with pytest.raises(ValueError, match="no item, switch or target 'kye'; did you mean `key`"):
        level.to_svg(held=["kye"])
    with pytest.raises(ValueError, match="scale must be above 0 and at most 100, not 0"):
        level.to_svg(scale=0)
    with pytest.raises(ValueError, match="`values` has the shape"):
        level.to_svg(values=[[1, 2]])
    with pytest.raises(brl.LevelError, match="nowhere"):
        level.to_svg(theme="nowhere")
    with pytest.raises(brl.UndefinedReturnError):
        CANCELLING.to_svg(values=True)


# -- films -------------------------------------------------------------------------------------


def test_a_film_follows_any_policy() -> None:
    level = brl.load("puddles")
    best = brl.solve(level)
    film = level.to_gif(scale=0.25)
    assert film == level.to_gif(policy=best, scale=0.25)
    assert film == level.to_gif(policy=best.policy, scale=0.25)
    moves = brl.solve(level, actions="moves")
    assert film == level.to_gif(policy=moves, scale=0.25)
    chances = np.eye(4)[np.maximum(moves.policy, 0)]
    assert film == level.to_gif(policy=chances, scale=0.25)
    around = level.to_gif(policy="uniform", seed=1, scale=0.25)
    assert around == level.to_gif(policy="uniform", seed=1, scale=0.25) != film


def test_a_film_of_a_robot_that_turns_is_refused() -> None:
    level = brl.load("puddles")
    with pytest.raises(ValueError, match="cannot show a robot that turns"):
        level.to_gif(policy=brl.solve(level, actions="turns"))


@pytest.mark.slow
def test_a_film_that_is_cut_and_a_page_without_a_solution_warn() -> None:
    with pytest.warns(UserWarning, match="does not end within 500 steps") as found:
        film = ENDLESS.to_gif(policy="random", scale=0.1)
    assert [each.filename for each in found] == [__file__]
    with Image.open(io.BytesIO(film)) as image:
        assert image.n_frames > 400
    with pytest.warns(UserWarning, match="the page shows no optimal moves: around"):
        CANCELLING.to_html()
    with pytest.raises(brl.UndefinedReturnError):
        CANCELLING.to_html(values=True)


# -- progress ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("make", [pictures.to_png, pictures.to_gif])
def test_progress_is_told_while_a_picture_is_made(make: Any) -> None:
    level = brl.Level(version=1, size=(15, 15), maze={"seed": 1})
    told: list[tuple[int, int]] = []
    made = make(level, values=True, scale=0.1, progress=lambda *each: told.append(each))
    assert made == make(level, values=True, scale=0.1)
    assert len({total for _, total in told}) == 1
    shares = [done / total for done, total in told]
    assert shares == sorted(shares)
    assert 0.5 < shares[-1] <= 1
