"""Pictures side by side: sweeps of learning, frames of an episode, variants of a level."""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np

from babyrobot_levels.analysis.shown import extent_of, state_picture
from babyrobot_levels.analysis.solver.results import StateResult, check_count
from babyrobot_levels.extensions.learning.results import Run, Sweep
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.registry.later import Shown
from babyrobot_levels.render.notebook.html import Picture, picture_of
from babyrobot_levels.render.notebook.html import strip as strip_html
from babyrobot_levels.render.raster import pixels_to_png
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import FONT, escaped, number
from babyrobot_levels.text.files import write_text

PAGE_WIDTH = 1200.0
"""The most width of a strip in a file, in pixels, if the number of columns is not given."""

_GAP, _LABEL = 16.0, 24.0
"""The space between pictures, and the height of a label below them, in pixels."""

_PNG = b"\x89PNG\r\n\x1a\n"


def strip(
    pictures: Iterable[Any], labels: Sequence[str] | None = None, columns: int | None = None
) -> Strip:
    """Return pictures side by side, which show themselves in notebooks.

    They are in as many rows as the width of the notebook asks for. The same values have the same
    colours in all results.

    Args:
        pictures: each a result that knows its level (a `Sweep`, `Trials`, `Solution` or
            `Evaluation`), a `Level`, an SVG document such as `level.to_svg(…)` returns, a PNG
            file, or a frame: uint8 `[height, width, 3]`.
        labels: a text below each picture; by default, sweeps are numbered.
        columns: the number of columns; by default, as many as there is room for.

    Raises:
        ValueError: there is no picture, or not a label for each; a picture is none of these; or
            `columns` is not at least 1.
    """
    given = list(pictures)
    if not given:
        raise ValueError("a strip needs at least one picture")
    if labels is not None and len(labels) != len(given):
        raise ValueError(f"{len(given)} pictures need as many labels, not {len(labels)}")
    if columns is not None:
        check_count("columns", columns)
    texts = [*map(_label, given)] if labels is None else [*map(str, labels)]
    extent = extent_of([each for each in given if isinstance(each, StateResult)])
    made = [_picture(each, extent) for each in given]
    # What a picture does not say of itself, its label does.
    told = [replace(each, title=each.title or text) for each, text in zip(made, texts, strict=True)]
    return Strip(tuple(zip(told, texts, strict=True)), columns)


@dataclass(frozen=True, repr=False)
class Strip(Shown):
    """Pictures side by side.

    Attributes:
        pictures: each with its label, which may be empty.
        columns: the number of columns; None for as many as there is room for.
    """

    pictures: tuple[tuple[Picture, str], ...]
    columns: int | None = None

    def __repr__(self) -> str:
        labels = ", ".join(label for _, label in self.pictures if label)
        count = len(self.pictures)
        return f"<Strip of {count} picture{'s' * (count > 1)}{labels and ': ' + labels}>"

    def _html(self) -> str:
        return strip_html(self.pictures, self.columns)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the strip to an SVG file, atomically; an existing one is replaced.

        Without a number of columns, it is at most 1,200 pixels wide.
        """
        write_text(Path(path), self._svg())

    def _svg(self) -> str:
        width = max(picture.width for picture, _ in self.pictures)
        height = max(picture.height for picture, _ in self.pictures)
        row = height + _GAP + _LABEL * any(label for _, label in self.pictures)
        fitting = int((PAGE_WIDTH + _GAP) // (width + _GAP))
        columns = min(self.columns or max(1, fitting), len(self.pictures))
        rows = -(-len(self.pictures) // columns)
        size = columns * (width + _GAP) - _GAP, rows * row - _GAP
        box = f'width="{number(size[0])}" height="{number(size[1])}"'
        lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" {box} '
            f'viewBox="0 0 {number(size[0])} {number(size[1])}" font-family="{FONT}" '
            'font-size="15" text-anchor="middle">'
        ]
        for index, (picture, label) in enumerate(self.pictures):
            down, right = divmod(index, columns)
            x, y = right * (width + _GAP), down * row
            lines += _placed(picture, label, x, y, width)
        return "\n".join([*lines, "</svg>"]) + "\n"


def _placed(picture: Picture, label: str, x: float, y: float, width: float) -> Iterator[str]:
    left = x + (width - picture.width) / 2
    yield (
        f'<image x="{number(left)}" y="{number(y)}" width="{number(picture.width)}" '
        f'height="{number(picture.height)}" href="{picture.address}"/>'
    )
    if label:
        base = y + picture.height + 0.75 * _LABEL
        yield f'<text x="{number(x + width / 2)}" y="{number(base)}">{escaped(label)}</text>'


def _label(given: Any) -> str:
    match given:
        case Sweep(run=Run() as run):
            return f"{run.unit.title()} {given.number:,}"
        case GridWorld():
            return given.title or given.name or ""
        case _:
            return ""


def _picture(given: Any, extent: tuple[float, float] | None) -> Picture:
    found = None
    match given:
        case StateResult():
            found = state_picture(given, extent)
        case GridWorld():
            found = picture_of(build_scene(given))
        case str():
            found = _of_svg(given)
        case bytes() if given.startswith(_PNG):
            width, height = struct.unpack_from(">II", given, 16)
            found = Picture(given, "image/png", width, height)
        case np.ndarray() if given.ndim == 3 and given.shape[2] == 3 and given.dtype == np.uint8:
            height, width = given.shape[:2]
            found = Picture(pixels_to_png(given), "image/png", width, height)
    if found is None:
        raise ValueError(
            f"no picture can be made of this {type(given).__name__}; expected a level, a result "
            "that knows its level, an SVG document, a PNG file, or a frame uint8 "
            "[height, width, 3]"
        )
    return found


def _of_svg(text: str) -> Picture | None:
    root = re.search(r"<svg\b[^>]*>", text)
    if root is None:
        return None
    sides = [re.search(rf'\s{name}="([\d.]+)(?:px)?"', root[0]) for name in ("width", "height")]
    box = re.search(r'\sviewBox="[\d.-]+ [\d.-]+ ([\d.]+) ([\d.]+)"', root[0])
    if sides[0] and sides[1]:
        size = float(sides[0][1]), float(sides[1][1])
    elif box:
        size = float(box[1]), float(box[2])
    else:
        return None
    title = re.search(r"<title\b[^>]*>([^<]*)</title>", text)
    return Picture(text.encode(), "image/svg+xml", *size, unescape(title[1]) if title else "")
