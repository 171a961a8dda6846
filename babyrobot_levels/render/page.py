"""The page painter: one HTML file that shows a level and plays it, by itself and without a network.

What the page plays are the compiled tables. Its chance comes from the generator that the
environments use: a seed and the same actions give the same episode there and here.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING, Any, Literal

from babyrobot_levels.render.playable import PHASES, playable
from babyrobot_levels.render.svg import FONT, elements, escaped, number, to_svg
from babyrobot_levels.scene.build import build_layers
from babyrobot_levels.scene.layout import CELL
from babyrobot_levels.scene.overlays import Overlay
from babyrobot_levels.scene.pose import Pose
from babyrobot_levels.scene.robot import robot_shapes
from babyrobot_levels.scene.shapes import Scene

if TYPE_CHECKING:
    from babyrobot_levels.level import Level

MAX_CELLS = 16_384
"""The most cells of a level on a page: 128 by 128."""

Walker = Literal["best", "random"]


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


def to_html(
    level: Level,
    *,
    guide: Guide | None = None,
    walker: Walker = "best",
    seed: int = 0,
    values: bool = False,
    arrows: bool = False,
) -> str:
    """Return a page on which the level is played with keys, buttons and touch.

    Args:
        level: the level; a maze needs a seed.
        guide: the best that can be done, if it is known.
        walker: who walks when the player watches; without a guide there is no best.
        seed: what chance is drawn from at first.
        values: whether the values of cells are shown at once.
        arrows: whether the best actions are shown at once.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: the level is too large for a page.
    """
    width, height = level.size
    if width * height > MAX_CELLS:
        raise ValueError(
            f"a level of {width} x {height} cells is too large for a page, "
            f"which has room for {MAX_CELLS:,}"
        )
    # The page itself has a place for what would stand in panels.
    display = {"side_panel": "none", "bottom_panel": "none", "compass": False}
    level = level.model_copy(update={"display": level.display.model_copy(update=display)})
    watched = walker if guide is not None or walker == "random" else None
    tables, poses = playable(level)
    data = {
        **tables,
        "seed": str(seed),
        "walker": watched,
        "policy": list(guide.policy) if guide is not None else None,
    }
    style = _static("page.css")
    script = f'"use strict";\n{_static("random.js")}\n{_static("page.js")}'
    icon = to_svg(Scene(CELL, CELL, robot_shapes(level.colors_and_widths, 0, 0)))
    title = level.title or level.name or "Level"
    return Template(_static("page.html")).substitute(
        title=escaped(title),
        description=_paragraph(level.description),
        policy=_security_policy(style, script),
        icon="data:image/svg+xml;base64," + base64.b64encode(icon.encode()).decode(),
        style=style,
        script=script,
        picture=_picture(level, guide, poses, values=values, arrows=arrows),
        best=_best(guide),
        controls="\n".join(_controls(watched, guide, values=values, arrows=arrows)),
        facts="\n".join(_facts(level)),
        data=embedded_json(data),
    )


def embedded_json(data: Any) -> str:
    """Return data as JSON that can stand in a script element: nothing in it can end that."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _picture(
    level: Level, guide: Guide | None, poses: Sequence[Pose], *, values: bool, arrows: bool
) -> str:
    """Return the scene, its layers as groups, and the robot in all poses that the tables need."""
    overlay = guide.overlay if guide is not None else None
    layers = build_layers(level, robot=False, overlay=overlay)
    scene = layers["base"]
    parts = [
        f'<svg viewBox="0 0 {number(scene.width)} {number(scene.height)}" '
        f'width="{number(scene.width)}" height="{number(scene.height)}" role="img" '
        f'font-family="{FONT}" stroke-linejoin="round">',
        f"<title>{escaped(scene.title)}</title>",
        "<defs>",
        *_sprites(level, poses),
        "</defs>",
        elements(layers["base"].shapes),
        elements(layers["grid"].shapes),
    ]
    for name, layer, is_shown in (("policy", "underlay", arrows), ("values", "overlay", values)):
        hidden = "" if is_shown else ' class="hidden"'
        parts += [f'<g id="{name}"{hidden}>', elements(layers[layer].shapes), "</g>"]
    parts.append('<g id="robot"><use width="64" height="64"/></g>')
    parts.append("</svg>")
    return "\n".join(part for part in parts if part)


def _sprites(level: Level, poses: Sequence[Pose]) -> Iterator[str]:
    for index, pose in enumerate(poses):
        for phase in range(PHASES):
            shown = Pose(pose.facing, pose.mood, phase / PHASES)
            shapes = robot_shapes(level.colors_and_widths, 0, 0, shown)
            yield f'<symbol id="pose-{index}-{phase}">\n{elements(shapes)}\n</symbol>'


def _controls(
    walker: Walker | None, guide: Guide | None, *, values: bool, arrows: bool
) -> Iterator[str]:
    if walker is not None:
        label = "Watch the best policy" if walker == "best" else "Watch a random walk"
        yield (
            '<button type="button" class="wide" id="watch" data-control="watch" '
            f'aria-pressed="false">{label} <kbd>P</kbd></button>'
        )
    if guide is not None:
        for name, label, key, shown in (
            ("values", "Values", "V", values),
            ("policy", "Best moves", "B", arrows),
        ):
            yield (
                f'<button type="button" id="show-{name}" data-control="{name}" '
                f'aria-pressed="{str(shown).lower()}">{label} <kbd>{key}</kbd></button>'
            )


def _best(guide: Guide | None) -> str:
    if guide is None or not math.isfinite(guide.expected_return):
        return ""
    told = number(guide.expected_return).replace("-", "\N{MINUS SIGN}")
    return f'<div class="best"><dt>Best average</dt><dd>{told}</dd></div>'


def _facts(level: Level) -> Iterator[str]:
    width, height = level.size
    facts = {
        "Level": level.name,
        "Size": f"{width} × {height}",
        "Author": level.author,
        "Source": level.source,
        "License": level.license,
        "Time limit": f"{level.max_steps} steps" if level.max_steps is not None else None,
        "Digest": level.digest,
    }
    for name, text in facts.items():
        if text:
            yield f"<dt>{name}</dt><dd><bdi>{escaped(text)}</bdi></dd>"


def _paragraph(text: str | None) -> str:
    return f"<p><bdi>{escaped(text.strip())}</bdi></p>" if text and text.strip() else ""


def _security_policy(style: str, script: str) -> str:
    """Return the policy under which only our own style and script count, and nothing is loaded."""
    style_hash, script_hash = (
        base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        for text in (style, script)
    )
    return (
        f"default-src 'none'; img-src data:; style-src 'sha256-{style_hash}'; "
        f"script-src 'sha256-{script_hash}'; base-uri 'none'; form-action 'none'"
    )


def _static(name: str) -> str:
    return files("babyrobot_levels.render").joinpath("static", name).read_text("utf-8")
