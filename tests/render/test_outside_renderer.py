"""An outside SVG renderer (resvg) and our own raster paint the same picture.

Both get the same font: the one that Pillow brings. It has no bold face, and where our raster
thickens its regular one, by a 32nd of the text's size, resvg is told to draw an outline of that
width. A pixel differs if one of its channels differs by more than 32 of 255: most edges that are
smoothed in another way stay below that, and nothing that is missing or in another place does.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import resvg_py
from PIL import Image, ImageFont
from support.each import for_each
from support.places import GALLERY_FOLDER

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import MOVES, Action
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.info import overlay_from
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.situation import Mood, Pose
from babyrobot_levels.render.svg import to_svg

BOLD = re.compile(r'font-size="([\d.]+)" font-weight="bold"(.*?)fill="(.*?)"')

CHANNEL = 32
SHARE = 0.02

GALLERY = [
    path
    for path in sorted(GALLERY_FOLDER.rglob("*.yaml"))
    if path.parent.name not in ("themes", "suites")
]


@dataclass(frozen=True)
class Font:
    file: str
    family: str


@pytest.fixture(scope="session")
def font(tmp_path_factory: pytest.TempPathFactory) -> Font:
    """The font of our raster, as a file."""
    ours: Any = ImageFont.load_default(10)
    file = tmp_path_factory.mktemp("font") / "font.ttf"
    file.write_bytes(ours.font_bytes)
    return Font(str(file), ours.getname()[0])


def outside(scene: Scene, font: Font) -> np.ndarray[Any, np.dtype[np.uint8]]:
    png = resvg_py.svg_to_bytes(
        svg_string=BOLD.sub(outlined, to_svg(scene)),
        background="white",
        skip_system_fonts=True,
        font_files=[font.file],
        sans_serif_family=font.family,
    )
    with Image.open(io.BytesIO(bytes(png))) as image:
        return np.array(image.convert("RGB"))


def outlined(found: re.Match[str]) -> str:
    size, between, fill = found.groups()
    width = 2 * float(size) / 32
    return f'font-size="{size}"{between}fill="{fill}" stroke="{fill}" stroke-width="{width}"'


def difference(scene: Scene, font: Font) -> float:
    """Return the share of pixels that differ."""
    theirs = outside(scene, font)
    ours = to_rgb(scene, (theirs.shape[1], theirs.shape[0]))
    return float((np.abs(ours.astype(int) - theirs).max(axis=2) > CHANNEL).mean())


def little_of_all(theme: str) -> Level:
    return Level.from_fields(
        {
            "version": 1,
            "theme": theme,
            "size": [6, 5],
            "start": [[0, 0], [0, 4]],
            "exit": [5, 4],
            "maze": {"seed": 4, "loops": 1.0},
            "walls": [
                {"at": [1, 0], "side": "S", "pass": 0.5, "length": 2},
                {"at": [3, 2], "side": "S", "color": "crimson", "width": 8, "fit": True},
            ],
            "puddles": [{"at": [1, 1], "size": "large"}, {"at": [3, 1]}],
            "areas": [{"at": [1, 3], "size": [2, 1], "color": "#ffffff66", "label": "meadow"}],
            "blocked": [{"at": [5, 0]}],
            "warps": [{"at": [2, 0], "to": [0, 2]}, {"at": [4, 4], "to": "start", "when": "leave"}],
            "wind": {"east": [0, 0, 2, 0, 0]},
            "display": {"compass": True, "side_panel": 120},
        }
    )


def overlays() -> Iterator[dict[str, Any]]:
    rng = np.random.default_rng(0)
    # Without signs: the font has no minus, which only our raster draws.
    values = rng.normal(40, 9, (5, 6))
    values[0, :3] = np.inf, -np.inf, np.nan
    policy = rng.integers(-1, 5, (5, 6))
    yield {"values": values, "policy": policy}
    yield {"action_values": rng.normal(40, 9, (5, 6, 5)), "policy": policy, "precision": 1}
    yield {"visits": rng.poisson(3, (5, 6)), "coordinates": True}
    yield {
        "text": [((2, 2), "here"), ((4.5, 0.5), "between", "gold")],
        "side_panel": ["Episode 12", "a line that is so long that it has to be broken"],
        "bottom_panel": ["steps 42"],
    }


@pytest.mark.sweep
@for_each("path", GALLERY)
def test_levels_of_the_gallery(path: Path, font: Font) -> None:
    level = load(str(path))
    level = level.with_maze_seed(1) if level.has_random_maze else level
    # Letters differ most, and those of rules are small and many in a panel.
    assert difference(build_scene(level), font) < SHARE * (1.5 if level.display.side_panel else 1)


@pytest.mark.parametrize(
    ("info", "theme"),
    [
        pytest.param(
            info,
            theme,
            id=f"{'-'.join(info)}-{theme}",
            marks=() if theme == shown else pytest.mark.sweep,
        )
        for shown, info in zip(BUILTIN_THEMES, overlays(), strict=False)
        for theme in BUILTIN_THEMES
    ],
)
def test_themes_and_overlays(theme: str, info: dict[str, Any], font: Font) -> None:
    level = little_of_all(theme)
    scene = build_scene(level, state=14, overlay=overlay_from(info, level))
    # The fine diagonals between values of actions are smoothed in another way.
    assert difference(scene, font) < SHARE * (2.5 if "action_values" in info else 1)


# What a theme changes of the robot is seen above.
@pytest.mark.parametrize("theme", ["default", "high_contrast"])
@for_each("mood", Mood)
@for_each("facing", (Action.STAY, *MOVES))
def test_poses(theme: str, mood: Mood, facing: Action, font: Font) -> None:
    ends = {"start_text": False, "exit_text": False}
    level = Level.from_fields({"version": 1, "size": [2, 1], "theme": theme, "display": ends})
    for phase in (0.0, 0.25, 0.6):
        pose = Pose(facing, mood, phase)
        # Most of so small a picture are edges.
        scene = build_scene(level, state=0, pose=pose, cells_only=True)
        assert difference(scene, font) < 3 * SHARE


def test_what_differs_is_seen(font: Font) -> None:
    # The tests above would be content with a comparison that finds nothing.
    level = little_of_all("default")
    theirs = outside(build_scene(level, state=14), font)
    without = to_rgb(build_scene(level, robot=False), (theirs.shape[1], theirs.shape[0]))
    cell = (slice(3 + 128, 3 + 192), slice(3 + 128, 3 + 192))
    share = (np.abs(without.astype(int) - theirs).max(axis=2) > CHANNEL)[cell].mean()
    assert share > 0.2
