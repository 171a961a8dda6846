"""How levels of the catalogue show themselves in notebooks: pictures, and what is known of them."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from babyrobot_levels.analysis.shown import image, level_picture
from babyrobot_levels.language.metric_names import MAX_SOLVED
from babyrobot_levels.library.level import load_file
from babyrobot_levels.render.notebook.html import beside, facts, table
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.library.catalogue import LevelInfo, LevelList

MAX_THUMBNAILS = 50
"""How many levels of a list are shown with a picture."""

MAX_ROWS = 500
"""How many levels of a list are shown at all."""

_THUMBNAIL, _SMALL = 200.0, 72.0
"""The most width of a level's picture beside its facts, and in a list."""


def info_html(info: LevelInfo) -> str:
    """Return a picture of a level, and its facts."""
    rows = [
        ("Name", info.name),
        ("Title", info.title or ""),
        ("Size", _size(info)),
        ("Tags", ", ".join(info.tags)),
        ("Source", info.source or ""),
        ("From", info.origin),
    ]
    return beside(_thumbnail(info, _THUMBNAIL), facts(rows))


def list_html(levels: LevelList) -> str:
    """Return a table of levels."""
    rows = [
        (
            _thumbnail(info, _SMALL) if number < MAX_THUMBNAILS else "",
            f"<code>{escape(info.name)}</code>",
            escape(info.title or ""),
            escape(_size(info)),
            escape(", ".join(info.tags)),
            escape(info.origin),
        )
        for number, info in enumerate(levels[:MAX_ROWS])
    ]
    more = f"<p>… and {len(levels) - MAX_ROWS:,} more</p>" if len(levels) > MAX_ROWS else ""
    return table(("", "Name", "Title", "Size", "Tags", "From"), rows) + more


def _thumbnail(info: LevelInfo, width: float) -> str:
    """Return a small picture; nothing of a level that is too large, or that is not there now."""
    if info.size[0] * info.size[1] > MAX_SOLVED:
        return ""
    try:
        level = load_file(info.path)
    except LevelError:
        return ""
    return image(level_picture(level, width, small=True))


def _size(info: LevelInfo) -> str:
    return f"{info.size[0]} × {info.size[1]}"
