"""What the canvas painter draws, in a browser, is the picture that the SVG painter draws there."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page
from support.canvases import STYLES, recorded
from support.pictures import Pixels, unlike

import babyrobot_levels as brl
from babyrobot_levels.render.notebook.canvas import LayeredCanvas
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_layers, build_scene
from babyrobot_levels.render.scene.layout import Note, Overlay
from babyrobot_levels.render.scene.shapes import screen_scale
from babyrobot_levels.render.situation import Mood, Pose
from babyrobot_levels.render.svg import to_svg

RICH = brl.loads(
    """\
version: 1
size: [8, 5]
maze: {seed: 7, loops: 0.6}
start: [[0, 0], [3, 3]]
exit: [7, 4]
puddles: [{at: [2, 2], size: large}, {at: [5, 1]}]
blocked: [{at: [4, 3], size: [2, 1]}]
walls:
  - {at: [1, 1], side: S, pass: 0.4}
  - {at: [6, 2], side: W, length: 2, color: "rgba(200,20,200,0.5)", width: 9}
areas: [{at: [0, 3], size: [2, 2], color: "rgba(0,120,255,0.35)", label: "ice  <b>&amp; cold"}]
warps: [{at: [3, 0], to: [6, 3]}, {at: [0, 4], to: start, when: leave}]
wind: {north: [0, 0, 1, 2, 0, 0, 0, 0]}
display: {compass: true, side_panel: 220, bottom_panel: 60}
"""
)
WRITTEN = Overlay(
    values=[[-1.5 * x * y if (x + y) % 3 else float("-inf") for x in range(8)] for y in range(5)],
    actions=[[[(x + y) % 5, x * y % 5] for x in range(8)] for y in range(5)],
    visits=[[x * y for x in range(8)] for y in range(5)],
    coordinates=True,
    notes=[Note(2.5, 1, "two   words"), Note(6, 0, "red", "beige")],
    side_panel=["one", "two & <three>"],
    bottom_panel=["below"],
)
LARGE = brl.Level.model_validate(
    {"version": 1, "size": (100, 100), "maze": {"seed": 1}, "puddles": [{"at": (3, 7)}]}
)

DRAW = """([layers, width, height]) => {
    const all = document.createElement("canvas");
    [all.width, all.height] = [width, height];
    const onto = all.getContext("2d");
    onto.fillStyle = "white";
    onto.fillRect(0, 0, width, height);
    for (const commands of layers) {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [width, height];
        const context = canvas.getContext("2d");
        for (const [name, args] of commands) {
            if (name === "set") context[args[0]] = args[1];
            else context[name](...args);
        }
        onto.drawImage(canvas, 0, 0);
    }
    return all.toDataURL();
}"""
"""Does with commands what ipycanvas does with those that we use: a canvas for each layer."""

SHOW = """async ([svg, width, height]) => {
    const image = new Image();
    image.src = "data:image/svg+xml;base64," + svg;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [width, height];
    const context = canvas.getContext("2d");
    context.fillStyle = "white";
    context.fillRect(0, 0, width, height);
    context.drawImage(image, 0, 0);
    return canvas.toDataURL();
}"""


def pixels(url: str) -> Pixels:
    png = base64.b64decode(url.partition(",")[2])
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def compare(level: brl.Level, page: Page, **what: Any) -> tuple[float, float]:
    """Return the share of pixels in which the canvas is unlike the SVG, and unlike our raster."""
    with recorded() as sent:
        widget = LayeredCanvas(build_layers(level, **what)).widget
    layers = [
        [
            (name, [STYLES[given[0]], given[1]] if name == "set" else given)
            for name, given in commands
        ]
        for commands in sent.seen_on(widget)
    ]
    size = widget.width, widget.height
    drawn = pixels(page.evaluate(DRAW, [layers, *size]))
    scene = build_scene(level, **what)
    svg = to_svg(scene, screen_scale(scene)).encode()
    shown = pixels(page.evaluate(SHOW, [base64.b64encode(svg).decode(), *size]))
    assert len(np.unique(drawn.reshape(-1, 3), axis=0)) > 4
    return float(unlike(drawn, shown).mean()), float(unlike(drawn, to_rgb(scene, size)).mean())


@pytest.mark.sweep
def test_levels_of_the_gallery_look_as_their_svgs(page: Page) -> None:
    unlike_svg, unlike_raster = {}, {}
    for name in [known.name for known in brl.levels()][::3]:
        level = brl.load(name)
        if level.has_random_maze:
            level = level.with_maze_seed(3)
        unlike_svg[name], unlike_raster[name] = compare(level, page)
    assert {name: share for name, share in unlike_svg.items() if share > 0.0005} == {}
    # A panel is full of text, for which the raster has a font of its own.
    assert {name: share for name, share in unlike_raster.items() if share > 0.05} == {}


@pytest.mark.parametrize("theme", ["default", "black_orange"])
def test_everything_at_once_looks_as_its_svg_in_each_theme(theme: str, page: Page) -> None:
    from_svg, from_raster = compare(
        RICH.replace(theme=theme),
        page,
        state=9,
        pose=Pose(brl.Action.EAST, Mood.SLIP),
        overlay=WRITTEN,
    )
    assert from_svg < 0.0005
    # It is full of texts, for which the raster has a font of its own.
    assert from_raster < 0.06


@pytest.mark.sweep
def test_a_large_level_is_made_smaller_as_its_svg_is(page: Page) -> None:
    from_svg, from_raster = compare(LARGE, page, state=5050, pose=Pose(mood=Mood.CHEER))
    assert from_svg < 0.0005
    assert from_raster < 0.06
