"""What a page knows of a level: its texts, its tables, its picture, and the best way through it.

One mapping that JSON can hold. A page carries that of its own level, a link that of another one:
the page's script plays and paints either, and knows nothing of levels beside.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from babyrobot_levels.language.looks import Colors, Theme
from babyrobot_levels.render.packed import Palette, hexadecimal, pack
from babyrobot_levels.render.playable import CHEER, EVENTS, PHASES, POSES, playable
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import CELL, layout_of
from babyrobot_levels.render.scene.overlays import Overlay
from babyrobot_levels.render.scene.pose import Pose
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.svg import number

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

MAX_CELLS = 16_384
"""The most cells of a level on a page: 128 by 128."""

LAYERS = {"base": "base", "grid": "grid", "policy": "underlay", "values": "overlay"}
"""The layers of a page's picture, and which of a scene's they are; the robot is not one of them."""

Walker = Literal["best", "random"]

_ROBOT_COLORS = ("robot", "puddle")
"""The colours of a theme that the robot's pictures have: his body's, and the splashes'."""


class TooLargeError(ValueError):
    """A level that is too large for a page, or for a link to one."""


@dataclass(frozen=True, slots=True)
class Guide:
    """The best that can be done in a level, as the page tells it.

    Attributes:
        policy: the best action of each state, as `Action`s, `[states]`; -1 where there is none.
        overlay: the values and best actions of the cells, which the page shows when asked.
        expected_return: what the policy is worth from the starts; it may be infinite.
    """

    policy: Sequence[int]
    overlay: Overlay
    expected_return: float


def without_panels(level: GridWorld) -> GridWorld:
    """Return the level without what the page itself has a place for: panels and compass.

    Raises:
        TooLargeError: the level is too large for a page.
    """
    width, height = level.size
    if width * height > MAX_CELLS:
        raise TooLargeError(
            f"a level of {width} x {height} cells is too large for a page, "
            f"which has room for {MAX_CELLS:,}"
        )
    display = {"side_panel": "none", "bottom_panel": "none", "compass": False}
    return level.model_copy(update={"display": level.display.model_copy(update=display)})


def page_data(
    level: GridWorld,
    *,
    guide: Guide | None = None,
    walker: Walker = "best",
    seed: int = 0,
    values: bool = False,
    arrows: bool = False,
) -> dict[str, Any]:
    """Return all that a page needs to show and play a level.

    Args and errors are those of `to_html`.
    """
    level = without_panels(level)
    colors = level.resolved_theme.colors
    return {
        "title": title_of(level),
        "description": (level.description or "").strip(),
        "facts": list(facts(level)),
        **playable(level),
        "robot": [hexadecimal(getattr(colors, name)) for name in _ROBOT_COLORS],
        "picture": _picture(level, guide),
        "seed": str(seed),
        "walker": walker if guide is not None or walker == "random" else None,
        "shown": [name for name, shown in (("policy", arrows), ("values", values)) if shown],
        "policy": list(guide.policy) if guide is not None else None,
        "best": _best(guide),
    }


def common_data() -> dict[str, Any]:
    """Return what is the same for all levels: how the robot looks, and what the numbers mean."""
    palette = Palette(_ROBOT_COLORS)
    theme = Theme.model_construct(colors=Colors.model_construct(robot="robot", puddle="puddle"))
    sprites = [
        [
            pack(robot_shapes(theme, 0, 0, Pose(pose.facing, pose.mood, phase / PHASES)), palette)
            for phase in range(PHASES)
        ]
        for pose in POSES
    ]
    return {
        "cell": round(CELL),
        "events": EVENTS,
        "cheer": CHEER,
        "phases": PHASES,
        "max_cells": MAX_CELLS,
        "robot": _ROBOT_COLORS,
        "palette": palette.colors,
        "sprites": sprites,
    }


def title_of(level: GridWorld) -> str:
    """Return what stands at the top of a level's page."""
    return level.title or level.name or "Level"


def facts(level: GridWorld) -> Iterator[tuple[str, str]]:
    """Yield what is known of a level, each with its name."""
    width, height = level.size
    told = {
        "Level": level.name,
        "Size": f"{width} × {height}",
        "Author": level.author,
        "Source": level.source,
        "License": level.license,
        "Time limit": f"{level.max_steps} steps" if level.max_steps is not None else None,
        "Digest": level.digest,
    }
    yield from ((name, text) for name, text in told.items() if text)


def _picture(level: GridWorld, guide: Guide | None) -> dict[str, Any]:
    overlay = guide.overlay if guide is not None else None
    layers = build_layers(level, robot=False, overlay=overlay)
    margin, palette = layout_of(level).margin, Palette()
    return {
        "width": round(layers["base"].width),
        "height": round(layers["base"].height),
        "layers": {
            name: pack(layers[layer].shapes, palette, margin) for name, layer in LAYERS.items()
        },
        "palette": palette.colors,
    }


def _best(guide: Guide | None) -> str:
    if guide is None or not math.isfinite(guide.expected_return):
        return ""
    return number(guide.expected_return).replace("-", "\N{MINUS SIGN}")
