"""The page painter: one HTML file that shows a level and plays it, by itself and without a network.

What the page plays are the compiled tables. Its chance comes from the generator that the
environments use: a seed and the same actions give the same episode there and here. Opened with a
link's play part behind a `#`, it shows and plays that level instead.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterator
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.share_code import VERSION
from babyrobot_levels.language.share_dictionary import PLAY_DICTIONARY_1
from babyrobot_levels.render.link import MAX_UNPACKED, PLAY_VERSION
from babyrobot_levels.render.pagedata import (
    LAYERS,
    Guide,
    Walker,
    common_data,
    facts,
    page_data,
    title_of,
    without_panels,
)
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.svg import FONT, elements, escaped, number, to_svg

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

SCRIPTS = ("random.js", "checks.js", "link.js", "game.js", "paint.js", "picture.js", "page.js")
"""The page's script, in the order in which its parts need each other."""


def to_html(
    level: GridWorld,
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
        TooLargeError: the level is too large for a page.
    """
    level = without_panels(level)
    data = page_data(level, guide=guide, walker=walker, seed=seed, values=values, arrows=arrows)
    common = {
        **common_data(),
        "code_version": VERSION,
        "play_version": PLAY_VERSION,
        "max_unpacked": MAX_UNPACKED,
        "dictionary": PLAY_DICTIONARY_1.decode("utf-8"),
    }
    style = _static("page.css")
    script = "\n".join(['"use strict";', *map(_static, SCRIPTS)])
    icon = to_svg(Scene(CELL, CELL, robot_shapes(level.resolved_theme, 0, 0)))
    return Template(_static("page.html")).substitute(
        title=escaped(title_of(level)),
        description=escaped(data["description"]),
        policy=_security_policy(style, script),
        icon="data:image/svg+xml;base64," + base64.b64encode(icon.encode()).decode(),
        style=style,
        script=script,
        picture=_picture(level, guide, data["shown"]),
        facts="\n".join(_fact_rows(level)),
        common=embedded_json(common),
        data=embedded_json(data),
    )


def embedded_json(data: Any) -> str:
    """Return data as JSON that can stand in a script element: nothing in it can end that."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _picture(level: GridWorld, guide: Guide | None, shown: list[str]) -> str:
    """Return the picture that is seen where no script runs."""
    overlay = guide.overlay if guide is not None else None
    layers = build_layers(level, robot=False, overlay=overlay)
    scene = layers["base"]
    names = ["base", "grid", *(LAYERS[name] for name in shown)]
    parts = [
        f'<svg viewBox="0 0 {number(scene.width)} {number(scene.height)}" '
        f'width="{number(scene.width)}" height="{number(scene.height)}" role="img" '
        f'font-family="{FONT}" stroke-linejoin="round">',
        f"<title>{escaped(scene.title)}</title>",
        *(elements(layers[name].shapes) for name in names),
        "</svg>",
    ]
    return "\n".join(part for part in parts if part)


def _fact_rows(level: GridWorld) -> Iterator[str]:
    for name, text in facts(level):
        yield f"<dt>{name}</dt><dd><bdi>{escaped(text)}</bdi></dd>"


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
