"""The formats of pictures, films and pages: the suffixes of their files, and their options."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.picture_options import (
    FilmOptions,
    PageOptions,
    StillOptions,
    TextOptions,
)
from babyrobot_levels.registry.entries import Entries
from babyrobot_levels.registry.later import later


@dataclass(frozen=True, slots=True)
class PictureFormat:
    """A format of pictures.

    Attributes:
        name: its name on the command line.
        title: what messages call it.
        kind: what is in it: `"text"`, `"still picture"`, `"film"` or `"page"`.
        media_type: the media type of its files.
        suffixes: the suffixes of its files, the usual one first.
        shows: the typed dictionary of its options.
        make: returns a picture of a level; None for texts, which the command line makes for the
            terminal that it writes to.
        hears: what the function takes to be told things by: `progress`, `tell`.
    """

    name: str
    title: str
    kind: str
    media_type: str
    suffixes: tuple[str, ...]
    shows: Any
    make: Callable[..., str | bytes] | None = None
    hears: tuple[str, ...] = ()

    @property
    def options(self) -> frozenset[str]:
        """The names of its options."""
        return frozenset(self.shows.__annotations__)


_SVG, _PDF, _PNG, _GIF, _PAGE = (
    later(f"babyrobot_levels.analysis.pictures:to_{name}")
    for name in ("svg", "pdf", "png", "gif", "html")
)
TEXT, STILL, FILM, PAGE = "text", "still picture", "film", "page"
_PROGRESS, _BOTH = ("progress",), ("progress", "tell")
_HTML = (".html", ".htm")

_OWN = {
    each.name: each
    for each in (
        PictureFormat("text", "text", TEXT, "text/plain", (".txt",), TextOptions),
        PictureFormat("ascii", "text", TEXT, "text/plain", (".txt",), TextOptions),
        PictureFormat("svg", "SVG", STILL, "image/svg+xml", (".svg",), StillOptions, _SVG),
        PictureFormat("pdf", "PDF", STILL, "application/pdf", (".pdf",), StillOptions, _PDF),
        PictureFormat("png", "PNG", STILL, "image/png", (".png",), StillOptions, _PNG, _PROGRESS),
        PictureFormat("gif", "GIF", FILM, "image/gif", (".gif",), FilmOptions, _GIF, _BOTH),
        PictureFormat("html", "HTML", PAGE, "text/html", _HTML, PageOptions, _PAGE, ("tell",)),
    )
}

FORMATS = Entries("pictures", _OWN, lambda each: isinstance(each, PictureFormat))
"""The formats by name; of several with the same suffix, the last one is meant by it."""

SUFFIXES = {suffix: each.name for each in _OWN.values() for suffix in each.suffixes}
"""The format of a file, by its suffix; see `format_for` for those of extensions."""


def format_for(suffix: str) -> str | None:
    """Return the name of the format of a file, by its suffix; None if there is none."""
    if suffix in SUFFIXES or not suffix:
        return SUFFIXES.get(suffix)
    others = (name for name, each in FORMATS.added() if suffix in each.suffixes)
    return next(others, None)


def titles_of(option: str) -> list[str]:
    """Return the titles of the formats that have an option."""
    return [*dict.fromkeys(each.title for each in _OWN.values() if option in each.options)]


def maker_of(path: str | os.PathLike[str]) -> str | None:
    """Return the method of levels that makes files of such a name; None if none does."""
    name = SUFFIXES.get(Path(path).suffix.lower())
    return f"to_{name}" if name and _OWN[name].make else None
