"""The page painter: one HTML file that shows a level and plays it, on its own and offline.

The page plays the compiled tables. Its random numbers come from the generator that the
environments use: a seed and the same actions give the same episode there and here. Opened with a
link's play part after a `#`, it shows and plays that level instead.

The play part of a link follows the level's share code. It is `~1.` (`~2.` for a level with things
or a heading), the number of characters after the next `.`, that `.`, and base64url without
padding. Its bytes are a CRC-32 of the share code and of the packed data (four bytes, big-endian)
and the packed data: the page's data as JSON in UTF-8, as a raw deflate stream with a preset
dictionary.
"""

from __future__ import annotations

import base64
import hashlib
import json
import zlib
from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.play import program
from babyrobot_levels.language.share_code import PLAY_DICTIONARY_1, PLAY_MARK, VERSION, encode
from babyrobot_levels.render.page_data import (
    Guide,
    TooLargeError,
    WatchedPolicy,
    common_data,
    facts,
    page_data,
    title_of,
    without_panels,
)
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Scene, toned
from babyrobot_levels.render.scripts import put_together
from babyrobot_levels.render.svg import (
    FONT,
    elements,
    label_elements,
    labelled,
    number,
    to_svg,
)
from babyrobot_levels.render.templates import as_html, embedded_json, html
from babyrobot_levels.render.words.describe import describe
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

PLAY_VERSIONS = (1, 2)
"""The versions of play parts that a page reads: 2 is for levels with things or a heading."""

MAX_LINK = 30_000
"""The most characters of a link after its `#` that browsers and chats handle reliably."""

MAX_UNPACKED = 4 << 20
"""The most bytes that a page decompresses."""


def to_html(
    level: GridWorld,
    *,
    guide: Guide | None = None,
    policy: WatchedPolicy = "best",
    seed: int = 0,
    values: bool = False,
    arrows: bool = False,
    turns: bool = False,
) -> str:
    """Return a page on which the level can be played with keys, buttons and touch.

    Args:
        level: the level; a maze needs a seed.
        guide: the solution of the level, if it is known.
        policy: the policy that can be watched; without a guide there is no best one.
        seed: the random seed of the first episode.
        values: whether the values of cells are shown at first.
        arrows: whether the optimal actions are shown at first.
        turns: whether the robot turns at first. The page can switch between turning and moving
            if it does, or if the level sets a `heading`.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        TooLargeError: the level is too large for a page.
    """
    whole, level = level, without_panels(level)
    data = page_data(
        level, guide=guide, policy=policy, seed=seed, values=values, arrows=arrows, turns=turns
    )
    # Without a code, which only a level of a file's size has, a page has no plays to download.
    with suppress(LevelError):
        data["code"] = encode(whole.to_dict(whole=True))
    common = {
        **common_data(),
        "made_by": program(),
        "code_versions": [VERSION],
        "play_versions": PLAY_VERSIONS,
        "max_unpacked": MAX_UNPACKED,
        "dictionary": PLAY_DICTIONARY_1.decode("utf-8"),
    }
    style, script = _style(), _script()
    theme = level.resolved_theme
    icon = to_svg(Scene(CELL, CELL, toned(robot_shapes(theme, 0, 0), theme.colors)))
    return html(
        "render/static/page.html",
        title=title_of(level),
        description=data["description"],
        policy=as_html(_security_policy(style, script)),
        icon="data:image/svg+xml;base64," + base64.b64encode(icon.encode()).decode(),
        style=as_html(style),
        script=as_html(script),
        picture=as_html(_picture(level, guide, data["shown"])),
        facts=facts(level),
        common=embedded_json(common),
        data=embedded_json(data),
    )


def common_module(data: dict[str, Any]) -> dict[str, str]:
    """Return the module of what is the same for all levels with its data in it, by its path."""
    return {"render/static/common.js": f"export const COMMON = {embedded_json(data)};"}


def _picture(level: GridWorld, guide: Guide | None, shown: list[str]) -> str:
    """Return the picture that is shown without JavaScript."""
    overlay = Overlay()
    if guide is not None:
        answers = guide.overlay.at()
        overlay = Overlay(
            values=answers.values if "values" in shown else None,
            actions=answers.actions if "policy" in shown else None,
        )
    layers = build_layers(level, robot=False, overlay=overlay)
    scene = replace(layers["base"], description=describe(level, robot=False))
    parts = [
        f'<svg viewBox="0 0 {number(scene.width)} {number(scene.height)}" '
        f'width="{number(scene.width)}" height="{number(scene.height)}" {labelled(scene)} '
        f'font-family="{FONT}" stroke-linejoin="round">',
        label_elements(scene),
        *(elements(layer.shapes) for layer in layers.values()),
        "</svg>",
    ]
    return "\n".join(part for part in parts if part)


@cache
def _style() -> str:
    return put_together("render/static/page.css")


@cache
def _script() -> str:
    return f'"use strict";\n{put_together("render/static/page.js")}'


def _security_policy(style: str, script: str) -> str:
    """Return a content security policy that allows this style and script only, and no loading."""
    style_hash, script_hash = (
        base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        for text in (style, script)
    )
    return (
        f"default-src 'none'; img-src data:; style-src 'sha256-{style_hash}'; "
        f"script-src 'sha256-{script_hash}'; base-uri 'none'; form-action 'none'"
    )


def link_fragment(level: GridWorld, played: GridWorld, guide: Guide | None = None) -> str:
    """Return the part of a link after its `#`: a share code, and the data that a page plays.

    Args:
        level: the level of the share code.
        played: the same level with a maze seed, if the level's maze is random.
        guide: the solution of the level, if it is known.

    Raises:
        LevelError: the level exceeds the size limit of level files.
        TooLargeError: the level is too large for a link.
    """
    code = encode(level.to_dict(whole=True))
    content = page_data(played, guide=guide)
    if played is not level:
        content["code"] = encode(played.to_dict(whole=True))
    version = PLAY_VERSIONS["things" in content or "turns" in content]
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    data = text.encode("utf-8")
    if len(data) > MAX_UNPACKED:
        raise TooLargeError(
            f"the level is too large for a link: its data has {len(data):,} bytes, "
            f"and the limit is {MAX_UNPACKED:,}"
        )
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9, zdict=PLAY_DICTIONARY_1)
    packed = packer.compress(data) + packer.flush()
    checksum = zlib.crc32(packed, zlib.crc32(code.encode("ascii")))
    body = base64.urlsafe_b64encode(checksum.to_bytes(4, "big") + packed).decode().rstrip("=")
    fragment = f"{code}{PLAY_MARK}{version}.{len(body)}.{body}"
    if len(fragment) > MAX_LINK:
        raise TooLargeError(
            f"the level is too large for a link: it would have {len(fragment):,} characters, "
            f"and the limit is {MAX_LINK:,}"
        )
    return fragment
