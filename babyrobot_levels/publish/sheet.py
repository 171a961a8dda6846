"""Hand-outs: levels on pages for print, as PDF, HTML or PNG, and the teacher's copy of them."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.shown import Shown as ShownInNotebook
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.publish.sheet_entries import Entry, SheetContents, entry_of
from babyrobot_levels.publish.sheet_pages import PageStyle, pages_of
from babyrobot_levels.render.notebook.html import picture_of, strip
from babyrobot_levels.render.pdf import to_pdf
from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.svg import number, to_svg
from babyrobot_levels.render.templates import as_html, html
from babyrobot_levels.suites.named import Levels, named_levels
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.files import write_bytes

TITLE = "Exercise sheet"

PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}
"""The papers, with width and height in millimetres."""

KINDS = ("pdf", "html", "png")
"""The formats of files in which a sheet is saved."""

MAX_LEVELS = 500
MAX_PER_PAGE = 24
MAX_GRIDS = 11
MAX_CELLS = 10_000
"""The largest level of which a sheet has a picture."""

_PER_PAGE, _WITH_GRIDS = 4, 3
"""The number of levels on a page, if it is not given."""

_INCH = 25.4
_PIXELS = 96 / _INCH
"""Pixels of scenes per millimetre."""

_DPI = 150
"""Pixels per inch of PNG files."""


def sheet(
    levels: Levels,
    *,
    title: str | None = None,
    per_page: int | None = None,
    paper: str = "a4",
    landscape: bool = False,
    theme: Any = "print",
    values: bool = False,
    policy: bool = False,
    rules: bool = True,
    grids: int = 0,
    key: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Sheet:
    """Return levels on pages for print, which show themselves in notebooks.

    Args:
        levels: a level, a folder, a pack or a suite: a name, a path, a mapping, a `Level` or a
            `Suite`; or several levels. Mazes need a seed.
        title: the title of the sheet; "Exercise sheet" by default.
        per_page: the number of levels on a page; by default 4, with `grids` 3.
        paper: `"a4"` or `"letter"`.
        landscape: whether pages are wider than high.
        theme: the theme of the pictures; `"print"` has greys only, None is each level's own.
        values: whether to show the optimal values of cells.
        policy: whether to show optimal actions.
        rules: whether to tell on each page what its levels do, pay and cost.
        grids: the number of empty grids beside each level into which values of the sweeps of value
            iteration are written.
        key: whether it is the teacher's copy: with values, actions, the optimal return, and grids
            that are filled in.
        progress: told of the levels that are drawn: how many of how many.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, its maze has no seed yet, or there is no such theme.
        ValueError: there are no levels, or more than 500; one has more than 10,000 cells; or
            another argument has an invalid value.
    """
    size = _paper(paper, landscape=landscape)
    _check("per_page", per_page, 1, MAX_PER_PAGE)
    _check("grids", grids, 0, MAX_GRIDS)
    found = list(islice(named_levels(levels), MAX_LEVELS + 1))
    if not found:
        raise ValueError("a sheet needs at least one level")
    if len(found) > MAX_LEVELS:
        raise ValueError(f"a sheet has at most {MAX_LEVELS} levels")
    shown = SheetContents(theme, values, policy, rules, grids, key)
    entries: list[Entry] = []
    for each in found:
        entries.append(_entry(load(each), shown))
        if progress is not None:
            progress(len(entries), len(found))
    style = PageStyle(
        " ".join(one_line(title or TITLE).split())[:200],
        size[0] * _PIXELS,
        size[1] * _PIXELS,
        per_page or (_WITH_GRIDS if grids else _PER_PAGE),
        key,
    )
    return Sheet(tuple(pages_of(entries, style)), style.title)


@dataclass(frozen=True, eq=False, repr=False)
class Sheet(ShownInNotebook):
    """Levels on pages for print.

    Attributes:
        pages: the pages as scenes, whose pixels are 1/96 inch.
        title: the title.
    """

    __module__ = "babyrobot_levels"

    pages: tuple[Scene, ...]
    title: str

    def _html(self) -> str:
        return strip([(picture_of(page, 480), "") for page in self.pages], None)

    def __repr__(self) -> str:
        return f"<Sheet {self.title!r} of {len(self.pages)} page{'s' * (len(self.pages) > 1)}>"

    def to_pdf(self) -> bytes:
        """Return the sheet as a PDF file: the same bytes for the same levels."""
        return to_pdf(self.pages, title=self.title)

    def to_html(self) -> str:
        """Return the sheet as an HTML document, which prints page by page."""
        width, height = (side / _PIXELS for side in (self.pages[0].width, self.pages[0].height))
        return html(
            "publish/static/sheet.html",
            title=self.title,
            width=number(width),
            height=number(height),
            pages=(as_html(to_svg(page)) for page in self.pages),
        )

    def to_png(self, page: int = 0) -> bytes:
        """Return a page as a PNG file of 150 pixels per inch.

        Args:
            page: its number, counted from 0.

        Raises:
            IndexError: there is no such page.
        """
        scene = self.pages[page]
        return to_png(scene, (round(scene.width * _DPI / 96), round(scene.height * _DPI / 96)))

    def files(self, path: str | os.PathLike[str], kind: str) -> dict[Path, Callable[[], bytes]]:
        """Return the files in which the sheet is saved, each with a function that makes it.

        Args:
            path: where. Several pages are several PNG files, as in `save`.
            kind: `"pdf"`, `"html"` or `"png"`.
        """
        path = Path(path)
        if kind == "pdf":
            return {path: self.to_pdf}
        if kind == "html":
            return {path: lambda: self.to_html().encode("utf-8")}
        numbers = range(len(self.pages))
        names = [path.with_stem(f"{path.stem}-{each + 1}") for each in numbers]
        return {
            name: partial(self.to_png, each)
            for each, name in zip(numbers, names if len(names) > 1 else [path], strict=True)
        }

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the sheet to a file, atomically; an existing one is replaced.

        Args:
            path: a `.pdf`, `.html` or `.png` file. Several pages are several PNG files:
                `sheet-1.png`, `sheet-2.png` and so on.

        Raises:
            ValueError: it has another suffix.
        """
        kind = Path(path).suffix.lower().removeprefix(".")
        if kind not in KINDS:
            raise ValueError(f"a sheet is saved as one of {', '.join(KINDS)}, not {kind!r}")
        for file, made in self.files(path, kind).items():
            write_bytes(file, made())


def _entry(level: Level, shown: SheetContents) -> Entry:
    width, height = level.size
    if width * height > MAX_CELLS:
        raise ValueError(
            f"{level.name or 'a level'} has {width * height:,} cells; "
            f"a sheet shows levels of at most {MAX_CELLS:,}"
        )
    return entry_of(level, shown)


def _paper(paper: str, *, landscape: bool) -> tuple[float, float]:
    """Return width and height of a page in millimetres."""
    if paper not in PAPERS:
        raise ValueError(f"paper must be {' or '.join(map(repr, PAPERS))}, not {paper!r}")
    width, height = PAPERS[paper]
    return (height, width) if landscape else (width, height)


def _check(name: str, given: Any, least: int, most: int) -> None:
    if given is None or (type(given) is int and least <= given <= most):
        return
    raise ValueError(f"{name} must be a whole number from {least} to {most}, not {given!r}")
