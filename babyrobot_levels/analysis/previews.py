"""Pictures, films and pages as objects that show themselves in a notebook: `preview`, `play`."""

from __future__ import annotations

import base64
import os
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.analysis.pictures import FORMATS, SUFFIXES
from babyrobot_levels.analysis.shown import Shown
from babyrobot_levels.mdp.gridworld import LevelLike, world_of

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_MAKERS = {name: each.make for name, each in FORMATS.items() if each.make is not None}
_HEIGHT = 720
"""The height of a page in a notebook, in pixels."""


@dataclass(frozen=True, eq=False, repr=False)
class Preview(Shown):
    """A picture, a film or a page of a level; a notebook shows it.

    Attributes:
        level: the level, with the maze that is shown.
        format: `"svg"`, `"pdf"`, `"png"`, `"gif"` or `"html"`.
        data: the contents of the file: a text for SVG and HTML.
        path: the file that it was written to, None for none.
    """

    __module__ = "babyrobot_levels"

    level: GridWorld
    format: str
    data: str | bytes = field(repr=False)
    path: Path | None = None

    def __repr__(self) -> str:
        return self.level.draw()

    def _html(self) -> str:
        if isinstance(self.data, str) and self.format == "html":
            style = f'style="width: 100%; height: {_HEIGHT}px; border: 0"'
            return f'<iframe srcdoc="{escape(self.data)}" {style}></iframe>'
        media_type = FORMATS[self.format].media_type
        if not media_type.startswith("image/"):
            return f"<pre>{escape(repr(self))}</pre>"
        data = self.data.encode() if isinstance(self.data, str) else self.data
        address = f"data:{media_type};base64,{base64.b64encode(data).decode()}"
        return f'<img src="{address}" style="max-width: 100%; height: auto">'


def preview(
    level: LevelLike,
    path: str | os.PathLike[str] | None = None,
    *,
    format: str | None = None,  # noqa: A002
    maze_seed: int | None = None,
    **shown: Any,
) -> Preview:
    """Return a picture, a film or a page of a level, as `babyrobot preview` makes it.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        path: a file to write it to; an existing one is replaced.
        format: `"svg"`, `"pdf"`, `"png"`, `"gif"` or `"html"`; by default that of the file's
            suffix, else `"svg"`.
        maze_seed: the seed of the maze of a level with a random maze; by default 0.
        shown: what is shown, and how: the arguments of `level.to_svg` (`values`, `policy`,
            `rules`, `held`, …), `to_gif` or `to_html`, whichever is made.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid, or there is no such theme.
        UndefinedReturnError: the level has no solution that could be shown.
        ValueError: there is no such format, or an argument does not fit the level.
        OSError: the file cannot be written.
    """
    file = None if path is None else Path(path)
    suffix = "" if file is None else file.suffix.lower()
    chosen = format or ("svg" if file is None else SUFFIXES.get(suffix, suffix.removeprefix(".")))
    if chosen not in _MAKERS:
        raise ValueError(f"there is no format {chosen!r}; use one of {', '.join(_MAKERS)}")
    world = world_of(level)
    if maze_seed is not None or world.has_random_maze:
        world = world.with_maze_seed(maze_seed or 0)
    return Preview(world, chosen, _MAKERS[chosen](world, file, **shown), file)


def play(
    level: LevelLike,
    path: str | os.PathLike[str] | None = None,
    *,
    maze_seed: int | None = None,
    **shown: Any,
) -> Preview:
    """Return a page on which a level can be played: in a notebook's cell, or in a browser.

    `babyrobot play` plays in the terminal instead.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        path: a file to write the page to; an existing one is replaced.
        maze_seed: the seed of the maze of a level with a random maze; by default 0.
        shown: the arguments of `level.to_html`: `seed`, `policy`, `values`, `answers`, …

    Errors are those of `preview`.
    """
    return preview(level, path, format="html", maze_seed=maze_seed, **shown)
