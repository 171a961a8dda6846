"""Texts have a contrast of 4.5:1 and graphics of 3:1 to what is below them, in all themes."""

from __future__ import annotations

import io
from collections.abc import Collection, Iterable, Iterator
from functools import cache
from itertools import combinations, cycle, product
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence
from support.contrasts import faint_parts
from support.playing import GALLERY, level_named
from support.worlds import level

import babyrobot_levels as brl
from babyrobot_levels.language.looks import BUILTIN_THEMES, Colors
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.colors import (
    GRAPHICS,
    TEXT,
    contrast,
    gray,
    ink_on,
    mixed,
    plate_for,
    rgba,
    rim_on,
)
from babyrobot_levels.render.frames import FramePainter
from babyrobot_levels.render.gif import Step, to_gif
from babyrobot_levels.render.page import common_data, page_data
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.info import overlay_from
from babyrobot_levels.render.scene.layout import Note, Overlay
from babyrobot_levels.render.scene.shapes import Shape
from babyrobot_levels.render.situation import Mood, Pose

EACH = (
    "areas",
    "bat-cave",
    "blocked-shapes",
    "cliff-walking",
    "drawbridge",
    "frozen-lake",
    "glass-wall",
    "gridworld-3-5",
    "river-crossing",
    "shell-game",
    "teleport-pads",
    "treasure-chests",
)
"""Levels that have everything there is to see."""

OVERLAID = ("teleport-pads",)
FAINT = ("glasshouse", "high_contrast")
"""A wall of glass has a colour of its own there, which is near that of the ground."""

MORE_OVERLAID = (
    "areas",
    "bat-cave",
    "blocked-shapes",
    "cliff-walking",
    "drawbridge",
    "final-maze",
    "frozen-lake",
    "glass-wall",
    "gridworld-3-5",
    "river-crossing",
    "shell-game",
    "treasure-chests",
)


@cache
def resolved(name: str) -> Level:
    found = level_named(name)
    return found.replace(maze={"seed": 1}) if found.has_random_maze else found


@cache
def solved(name: str) -> Any:
    return brl.solve(resolved(name))


# -- the gallery ---------------------------------------------------------------------------------


def in_turn(names: Iterable[str], count: int) -> list[tuple[str, str]]:
    """Return each level with so many of the themes, which take turns."""
    themes = cycle(BUILTIN_THEMES)
    return [(name, next(themes)) for name in names for _ in range(count)]


def first_and_others(
    first: Collection[str], count: int, others: Iterable[str]
) -> pytest.MarkDecorator:
    """Parametrise a test by levels and themes: all of the first ones, and two of each other.

    Only so many themes of each of the first levels are fast.
    """
    fast = in_turn(first, count)
    slow = [each for each in product(first, BUILTIN_THEMES) if each not in fast]
    more = [each for each in slow + in_turn(others, 2) if each != FAINT]
    sweep = [pytest.param(*each, marks=pytest.mark.sweep) for each in more]
    return pytest.mark.parametrize(("name", "theme"), [*fast, *sweep])


@first_and_others(EACH, 1, [name for name in GALLERY if name not in EACH])
def test_what_a_level_shows_stands_out(name: str, theme: str) -> None:
    assert faint_parts(resolved(name).replace(theme=theme)) == []


@pytest.mark.parametrize("theme", BUILTIN_THEMES)
def test_coordinates_are_readable_on_all_grounds(theme: str) -> None:
    for name in ("areas", "puddle-test"):
        shown = resolved(name).replace(theme=theme)
        faint = faint_parts(shown, Overlay(coordinates=True))
        assert [part for part in faint if "text" in part[0]] == []


ANSWERS = (
    ("values", False),
    ("values policy", True),
    ("action_values", True),
    ("action_values policy", False),
    ("visits", True),
    ("policy", True),
    ("visits values", False),
    ("visits values", True),
)
"""What a picture shows, and whether it shows coordinates as well."""


@pytest.mark.slow
@first_and_others(OVERLAID, 1, MORE_OVERLAID)
def test_answers_stand_out(name: str, theme: str) -> None:
    shown = resolved(name).replace(theme=theme)
    solution = solved(name)
    faint = {}
    for keys, coordinates in ANSWERS:
        info: dict[str, Any] = {key: solution for key in keys.split() if key != "visits"}
        if "visits" in keys:
            width, height = shown.size
            info["visits"] = [[7 * x * y * y for x in range(width)] for y in range(height)]
        overlay = overlay_from(info | {"coordinates": coordinates}, shown)
        faint[keys, coordinates] = faint_parts(shown, overlay)
    assert {key: parts for key, parts in faint.items() if parts} == {}


# -- colours of a level's own --------------------------------------------------------------------


@pytest.mark.parametrize("ground", ["black", "#777777", "rgba(0, 0, 0, 0.5)"])
@pytest.mark.parametrize("ink", ["black", "gold"])
def test_any_colours_can_be_combined(ground: str, ink: str) -> None:
    names = ("base", "start", "exit", "text_bg", "puddle", "blocked")
    inks = ("start_text", "exit_text", "text_fg", "walls", "border", "arrows")
    world = level(
        size=[4, 3],
        theme={"colors": dict.fromkeys(names, ground) | dict.fromkeys(inks, ink)},
        walls=[{"at": [1, 1], "side": "E"}, {"at": [2, 2], "side": "N", "pass": 0.5}],
        warps=[{"at": [2, 0], "to": [0, 2]}, {"at": [3, 0], "to": "start"}],
        puddles=[{"at": [1, 1], "size": "large"}],
        areas=[{"at": [2, 1], "label": "here", "color": ink}],
        blocked=[{"at": [1, 2]}],
        display={
            "coordinates": True,
            "compass": True,
            "side_panel": {"width": 150, "color": ground, "text_color": ink},
        },
    )
    overlay = Overlay(side_panel=["beside"], notes=[Note(3, 1, "note", ink)])
    assert faint_parts(world, overlay) == []


# -- inks ------------------------------------------------------------------------------------------


def test_an_ink_is_the_preferred_one_if_it_can_be_read() -> None:
    assert ink_on(["white"], "navy") == "navy"
    assert ink_on(["black"], "navy") == "#ffffff"
    assert ink_on(["white", "#bbbbbb"], "#707070") == "#000000"
    assert ink_on(["#bbbbbb"], "#606060", GRAPHICS) == "#606060"


@pytest.mark.parametrize("shade", [0, 90, 120, 255])
def test_black_or_white_is_readable_on_any_ground(shade: int) -> None:
    ground = f"rgb({shade}, {shade}, {shade})"
    assert contrast(rim_on([ground]), ground) >= TEXT
    for below in ("black", "white"):
        assert contrast("gold", mixed(plate_for("gold", ground), below)) >= TEXT


@pytest.mark.parametrize(
    ("ink", "ground", "ratio"),
    # By the definition of WCAG 2.2, "contrast ratio" and "relative luminance".
    [("black", "white", 21), ("#767676", "white", 4.542), ("#0a0a0a", "black", 1.0607)],
)
def test_a_contrast_is_that_of_the_guidelines(ink: str, ground: str, ratio: float) -> None:
    assert contrast(ink, ground) == pytest.approx(ratio, abs=1e-3)


# -- greys -----------------------------------------------------------------------------------------


def colors_of(shapes: tuple[Shape, ...]) -> Iterator[str]:
    for shape in shapes:
        for color in (shape.fill, getattr(shape, "stroke", None)):
            if color is not None:
                yield color


@pytest.mark.parametrize("color", ["#8fd0f5", "rgba(200, 30, 60, 0.5)"])
def test_a_grey_has_the_contrasts_of_its_colour(color: str) -> None:
    red, green, blue, alpha = rgba(gray(color))
    assert red == green == blue
    assert alpha == pytest.approx(rgba(color)[3], abs=0.01)
    if alpha == 1:
        assert contrast(gray(color), "black") == pytest.approx(contrast(color, "black"), rel=0.05)


COLORFUL: dict[str, Any] = {
    "size": [4, 2],
    "theme": "print",
    "walls": [
        {"at": [0, 0], "side": "E", "pass": 0.5},
        {"at": [1, 0], "side": "E", "color": "red"},
    ],
    "areas": [{"at": [2, 0], "color": "gold", "label": "here"}],
    "puddles": [{"at": [1, 1], "size": "large"}],
    "items": [{"name": "key", "at": [2, 1], "color": "lime"}],
    "movers": [{"name": "bat", "within": {"at": [0, 1], "size": [2, 1]}}],
    "skid": 0.3,
    "display": {"compass": True, "side_panel": {"width": 90, "color": "navy"}},
}


def is_gray_picture(pixels: Any) -> bool:
    return bool((pixels == pixels[..., :1]).all())


def test_a_theme_of_greys_turns_everything_into_greys() -> None:
    world = level(**COLORFUL)
    solution = brl.solve(world)
    info = {"values": solution, "text": [((1, 1), "note", "crimson")], "side_panel": ["beside"]}
    overlay = overlay_from(info, world)
    scene = build_scene(world, overlay=overlay, pose=Pose(Action.EAST, Mood.SLIP))
    for color in colors_of(scene.shapes):
        red, green, blue, _ = rgba(color)
        assert red == green == blue
    assert is_gray_picture(to_rgb(scene))
    painter = FramePainter(world, overlay=overlay)
    assert is_gray_picture(painter.frame(int(world.compile().start.argmax()), Pose(mood=Mood.SLIP)))
    page = page_data(world)
    # All colours of the robot, its own as well: the page knows them by their places.
    assert len(page["robot"]) == len(common_data()["robot"])
    for color in (*page["robot"], *page["picture"]["palette"]):
        red, green, blue, _ = rgba(color)
        assert red == green == blue


def test_one_colour_makes_a_theme_colourful() -> None:
    grays = BUILTIN_THEMES["print"].colors.model_dump()
    world = level(**COLORFUL | {"theme": {"colors": grays | {"exit": "green"}}})
    assert {"red", "gold", "lime", "green"} <= {*colors_of(build_scene(world).shapes)}
    assert len(page_data(world)["robot"]) == 2


def test_films_of_a_theme_of_greys_are_grey() -> None:
    world = level(**COLORFUL)
    first = int(world.compile().start.argmax())
    steps = [Step(first, Action.SOUTH, first + 4, -1.0)]
    with Image.open(io.BytesIO(to_gif(world, steps))) as film:
        for frame in ImageSequence.Iterator(film):
            assert is_gray_picture(np.asarray(frame.convert("RGB")))


# -- themes ----------------------------------------------------------------------------------------


def faint(colors: Colors, bound: float) -> set[str]:
    """Return what does not stand out from the ground."""
    parts = ("start", "exit", "robot", "walls", "border", "arrows", "puddle", "blocked")
    return {part for part in parts if contrast(getattr(colors, part), colors.base) < bound}


def test_contrast_is_that_of_the_standard() -> None:
    assert contrast("white", "black") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("name", BUILTIN_THEMES)
def test_what_matters_stands_out_from_the_ground(name: str) -> None:
    colors = BUILTIN_THEMES[name].colors
    assert faint(colors, GRAPHICS) == set()
    # Then one of an arrow and its rim stands out from any ground.
    assert contrast(colors.arrows, rim_on([colors.arrows])) >= GRAPHICS**2
    for text, ground in (
        (colors.start_text, colors.start),
        (colors.exit_text, colors.exit),
        (colors.text_fg, colors.text_bg),
    ):
        assert contrast(text, ground) >= TEXT


def test_high_contrast_is_what_it_says() -> None:
    colors = BUILTIN_THEMES["high_contrast"].colors
    assert faint(colors, 9) == {"border", "blocked"}
    assert contrast(colors.lines, colors.base) >= TEXT
    # The outer wall is seen on the page as well.
    assert min(contrast(colors.border, page) for page in ("white", "black")) >= GRAPHICS


# -- colour blindness ------------------------------------------------------------------------------

BLINDNESS = {
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
"""What linear RGB becomes to people who lack one kind of cone (Machado et al. 2009)."""

TO_XYZ = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]

UNLIKE = 7.0
"""The least difference of two grounds in CIELAB; of 2.3, half of all people see one."""


def lab(color: str, matrix: Any) -> Any:
    """Return a colour in CIELAB, as it is seen through a matrix of linear RGB."""
    shares = np.array(rgba(color)[:3]) / 255
    linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    seen = np.clip(matrix @ linear, 0, 1)
    xyz = np.array(TO_XYZ) @ seen / [0.9505, 1.0, 1.089]
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("name", [name for name in BUILTIN_THEMES if name != "print"])
@pytest.mark.parametrize("kind", BLINDNESS)
def test_grounds_are_told_apart_by_people_who_are_colour_blind(name: str, kind: str) -> None:
    colors = BUILTIN_THEMES[name].colors
    parts = ["base", "start", "exit", "blocked"]
    parts += ["puddle"] if name in ("default", "dark") else []
    seen = {part: lab(getattr(colors, part), np.array(BLINDNESS[kind])) for part in parts}
    alike = [
        (one, other, float(np.linalg.norm(seen[one] - seen[other])))
        for one, other in combinations(seen, 2)
        if np.linalg.norm(seen[one] - seen[other]) < UNLIKE
    ]
    assert alike == []


@pytest.mark.parametrize("name", sorted({*BUILTIN_THEMES} - {"babyrobot", "print"}))
def test_starts_are_blue_and_exits_green_in_all_themes(name: str) -> None:
    colors = BUILTIN_THEMES[name].colors
    assert max(range(3), key=rgba(colors.start).__getitem__) == 2
    assert max(range(3), key=rgba(colors.exit).__getitem__) == 1


def test_the_orange_of_the_articles_is_a_theme() -> None:
    colors = BUILTIN_THEMES["babyrobot"].colors
    assert (colors.base, colors.start, colors.exit) == ("orange", "#c61414", "#007200")
    assert brl.load("default").replace(theme="babyrobot").digest == brl.load("default").digest
