"""The shapes that scenes are made of. A painter that knows these four can paint every scene.

Lengths are pixels, x grows to the right, y downwards. Colours are CSS strings, as levels write
them; `opacity` comes on top of a colour's own alpha.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Command = tuple[str, tuple[float, ...]]
"""A step of a path, in SVG's letters: `M` x y, `L` x y, `C` x1 y1 x2 y2 x y, or `Z`."""


@dataclass(frozen=True, slots=True)
class Rect:
    """A filled rectangle; `x`, `y` is its top-left corner, `radius` rounds its corners."""

    x: float
    y: float
    width: float
    height: float
    fill: str
    radius: float = 0.0
    opacity: float = 1.0


@dataclass(frozen=True, slots=True)
class Ellipse:
    """A filled ellipse; `x`, `y` is its centre."""

    x: float
    y: float
    rx: float
    ry: float
    fill: str
    opacity: float = 1.0


@dataclass(frozen=True, slots=True)
class Path:
    """Lines and curves, filled, stroked, or both; each `M` begins a new piece.

    Strokes have round joins. `dash` gives the lengths of a dash and of the gap after it; each
    piece begins with a dash.
    """

    commands: tuple[Command, ...]
    fill: str | None = None
    stroke: str | None = None
    width: float = 1.0
    dash: tuple[float, float] | None = None
    cap: Literal["butt", "round"] = "butt"
    opacity: float = 1.0


@dataclass(frozen=True, slots=True)
class Text:
    """A line of text; `y` is its baseline, `x` its start, middle or end as `anchor` says."""

    x: float
    y: float
    text: str
    size: float
    fill: str
    anchor: Literal["start", "middle", "end"] = "middle"
    bold: bool = False
    opacity: float = 1.0


Shape = Rect | Ellipse | Path | Text


@dataclass(frozen=True, slots=True)
class Scene:
    """A picture: shapes in painting order, on nothing. `width` and `height` are in pixels."""

    width: float
    height: float
    shapes: tuple[Shape, ...]
    title: str = ""
