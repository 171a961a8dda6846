"""What notebooks show: pictures as MIME bundles, and small HTML with tables of facts beside them.

HTML has no colours of its own, so that it suits light and dark notebooks, and no scripts. All texts
are escaped, because levels may be by strangers.
"""

import base64
import math
import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from html import escape
from typing import Any

from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.shapes import Scene, screen_scale
from babyrobot_levels.render.svg import to_svg

Bundle = dict[str, Any]
"""The same content by MIME types; a front end shows the one that it prefers."""

HTML = "text/html"
MARKDOWN = "text/markdown"
PNG = "image/png"
SVG = "image/svg+xml"
TEXT = "text/plain"
WIDGET = "application/vnd.jupyter.widget-view+json"

MAX_PIXELS = 1_000_000
"""The most pixels of a PNG, which is only a substitute; larger pictures are scaled down."""

PNG_COLORS = 128
"""The colours of a PNG; the reduction is hardly visible and saves two thirds of the size."""

WIDEST = 800
"""The width in pixels above which an SVG picture is as wide as its cell; few cells are narrower.

JupyterLab and nbconvert show SVG in a way that no style of the picture itself can restrict.
"""

MAX_CELLS = 40_000
"""The largest level that is shown as a picture; others would add megabytes to a notebook."""


def picture_mimebundle(scene: Scene, text: str) -> Bundle:
    """Return a picture as SVG, PNG and text.

    JupyterLab shows SVG only in trusted notebooks. The text is shown where pictures cannot be.
    """
    scale = min(1.0, math.sqrt(MAX_PIXELS / (scene.width * scene.height)))
    size = max(1, int(scale * scene.width)), max(1, int(scale * scene.height))
    shown = screen_scale(scene)
    return {
        SVG: to_svg(scene, shown if shown * scene.width <= WIDEST else None),
        PNG: base64.b64encode(to_png(scene, size, colors=PNG_COLORS)).decode(),
        TEXT: text,
    }


def level_mimebundle(level: GridWorld, include: Any = None, exclude: Any = None) -> Bundle:
    """Return the bundle of a level as the last line of a cell: its picture and its drawing.

    A random maze is shown with seed 0.
    """
    if is_too_large(level):
        return in_words(level)
    if level.has_random_maze:
        level = level.with_maze_seed(0)
    return picture_mimebundle(build_scene(level), level.draw())


def is_too_large(level: GridWorld) -> bool:
    """Return whether a level has more than `MAX_CELLS` cells."""
    columns, rows = level.size
    return columns * rows > MAX_CELLS


def in_words(level: GridWorld) -> Bundle:
    """Return the substitute for the picture of a level that is too large."""
    columns, rows = level.size
    name = level.title or level.name or "a level"
    return {TEXT: f"{name}: {columns} × {rows} cells, too many for a notebook"}


MAX_SVG = 200_000
"""The most characters of an SVG document in HTML; larger pictures are PNG files."""

_GAP = 16
"""The space between two pictures, in pixels."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture in a file format.

    Attributes:
        data: the file.
        kind: its MIME type.
        width: its width on a screen in pixels, where there is room for it.
        height: its height, likewise.
        title: what it shows, in words.
    """

    data: bytes
    kind: str
    width: float
    height: float
    title: str = ""

    @property
    def address(self) -> str:
        """The picture as a `data:` address."""
        return f"data:{self.kind};base64,{base64.b64encode(self.data).decode()}"

    def html(self, width: float | None = None) -> str:
        """Return it as an element that is at most as wide as its place.

        Args:
            width: another width, in pixels.
        """
        shown = round(self.width if width is None else width)
        return (
            f'<img src="{self.address}" alt="{escape(self.title)}" width="{shown}" '
            'style="max-width: 100%; height: auto">'
        )


def picture_of(scene: Scene, width: float | None = None) -> Picture:
    """Return a scene as a picture: an SVG document, or a PNG file where that would be too large.

    Args:
        scene: the scene.
        width: its width on a screen; by default its own, or less for a large one.
    """
    scale = screen_scale(scene) if width is None else min(1.0, width / scene.width)
    size = scale * scene.width, scale * scene.height
    svg = to_svg(scene)
    if len(svg) <= MAX_SVG:
        return Picture(svg.encode(), "image/svg+xml", *size, scene.title)
    return thumbnail_of(scene, min(size[0], 800))


def thumbnail_of(scene: Scene, width: float) -> Picture:
    """Return a scene as a small PNG file, twice as fine as the pixels of most screens.

    Args:
        scene: the scene.
        width: its width on a screen, and the most of its height.
    """
    scale = min(1.0, width / max(scene.width, scene.height))
    size = scale * scene.width, scale * scene.height
    pixels = round(2 * size[0]) or 1, round(2 * size[1]) or 1
    return Picture(to_png(scene, pixels, colors=PNG_COLORS), "image/png", *size, scene.title)


def strip(pictures: Sequence[tuple[Picture, str]], columns: int | None = None) -> str:
    """Return pictures with labels side by side, in as many rows as they need.

    Where there is little room, they are a little smaller, and then in more rows.

    Args:
        pictures: each with its label, which may be empty.
        columns: the number of columns; by default, as many as there is room for.
    """
    width = max((picture.width for picture, _ in pictures), default=0)
    count = min(columns or len(pictures), len(pictures))
    least = 0 if columns else f"min(100%, {0.65 * width:.0f}px)"
    repeated = columns or "auto-fit"
    most = count * (width + _GAP) - _GAP
    style = (
        f"display: grid; grid-template-columns: repeat({repeated}, minmax({least}, 1fr)); "
        f"gap: {_GAP}px; justify-items: start; max-width: {most:.0f}px"
    )
    figures = "".join(
        f'<div style="text-align: center">{picture.html()}'
        f"{label and f'<div>{escape(label)}</div>'}</div>"
        for picture, label in pictures
    )
    return f'<div style="{style}">{figures}</div>'


def beside(*parts: str) -> str:
    """Return parts side by side, or below each other where there is no room."""
    items = "".join(f'<div style="max-width: 100%">{part}</div>' for part in parts if part)
    style = f"display: flex; flex-wrap: wrap; gap: {_GAP}px; align-items: flex-start"
    return f'<div style="{style}">{items}</div>'


def facts(rows: Iterable[tuple[str, str]]) -> str:
    """Return names and values as a table; rows without a value are left out."""
    lines = (
        f'<tr><th style="text-align: left">{escape(name)}</th>'
        f'<td style="text-align: left">{escape(value)}</td></tr>'
        for name, value in rows
        if value
    )
    return f"<table><tbody>{''.join(lines)}</tbody></table>"


def table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table. Its cells are HTML, and what they say is escaped by the caller."""
    style = 'style="text-align: left"'
    head = "".join(f"<th {style}>{escape(name)}</th>" for name in heading)
    body = "".join(
        f"<tr>{''.join(f'<td {style}>{cell}</td>' for cell in row)}</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


# -- the front end ---------------------------------------------------------------------------------


class Frontend(Enum):
    """What happens to displayed output."""

    NONE = auto()
    """There is no notebook."""
    PROGRAM = auto()
    """A program runs the notebook, as nbconvert and Papermill do: only the final output counts."""
    PICTURES = auto()
    """A person sees pictures, but not ipycanvas."""
    CANVAS = auto()
    """A person sees pictures, and ipycanvas if the front end has its extension."""


def in_notebook() -> bool:
    """Return whether this is a Jupyter kernel; IPython in a terminal is not."""
    return _kernel() is not None


def frontend() -> Frontend:
    """Return the current front end."""
    kernel = _kernel()
    if kernel is None:
        return Frontend.NONE
    if "google.colab" in sys.modules:
        return Frontend.CANVAS if _colab_shows_widgets() else Frontend.PICTURES
    is_voila = os.environ.get("SERVER_SOFTWARE", "").startswith("voila")
    if is_voila or _takes_input(kernel):
        return Frontend.CANVAS
    return Frontend.PROGRAM


def _kernel() -> Any:
    # A kernel has imported IPython.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return getattr(shell, "kernel", None)


def _takes_input(kernel: Any) -> bool:
    """Return whether `input()` would be answered; programs report that they do not."""
    parent = kernel.get_parent() if hasattr(kernel, "get_parent") else {}
    return bool(parent.get("content", {}).get("allow_stdin", True))


def _colab_shows_widgets() -> bool:
    """Return whether custom widgets have been enabled."""
    widgets = sys.modules.get("google.colab.output._widgets")
    return getattr(widgets, "_installed_url", None) is not None
