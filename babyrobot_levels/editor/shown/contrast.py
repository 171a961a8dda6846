"""Which colours of a theme stand out from which, and the themes to choose from."""

from __future__ import annotations

from math import floor
from pathlib import Path
from typing import Any

from babyrobot_levels.language.documents import read_theme, theme_folders, theme_names
from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.render.colors import GRAPHICS, TEXT, contrast

OUTLINED = "pictures outline it in black or white"
REPLACED = "pictures write it in black or white"

PAIRS = (
    ("walls", "base", GRAPHICS, OUTLINED),
    ("border", "base", GRAPHICS, OUTLINED),
    ("puddle", "base", GRAPHICS, OUTLINED),
    ("start", "base", GRAPHICS, None),
    ("exit", "base", GRAPHICS, None),
    ("robot", "base", GRAPHICS, None),
    ("start_text", "start", TEXT, REPLACED),
    ("exit_text", "exit", TEXT, REPLACED),
    ("text_fg", "text_bg", TEXT, "pictures choose another ground"),
)
"""What lies on what, the least contrast that it needs, and what pictures do if it has less."""


MOST_THEMES = 50
"""The most themes of files that are offered."""


def contrasts(theme: Theme) -> list[dict[str, Any]]:
    """Return the contrasts of a theme's colours as plain data.

    The keys: `color` and `ground`, the names of the two; `ratio`, from 1 to 21; `least`, what it
    needs; `is_enough`; and `remedy`, what pictures do where it is not, None for nothing.
    """
    found = []
    for color, ground, least, remedy in PAIRS:
        ratio = contrast(getattr(theme.colors, color), getattr(theme.colors, ground))
        found.append(
            {
                "color": color,
                "ground": ground,
                "ratio": floor(100 * ratio) / 100,
                "least": least,
                "is_enough": ratio >= least,
                "remedy": remedy,
            }
        )
    return found


def themes() -> dict[str, Any]:
    """Return the built-in themes as plain data, by their names."""
    return {name: theme.model_dump() for name, theme in BUILTIN_THEMES.items()}


def themes_beside(path: Path | None) -> dict[str, Any]:
    """Return the valid themes that stand beside a level's file as plain data, by their names."""
    if path is None:
        return {}
    folders = theme_folders(path.parent)
    names = [name for name in theme_names(folders) if name not in BUILTIN_THEMES]
    found = {name: read_theme(name, folders).value for name in names[:MOST_THEMES]}
    return {name: theme.model_dump() for name, theme in found.items() if theme is not None}


def look_of(theme: Theme) -> dict[str, Any]:
    """Return a theme as the editor shows it: `theme`, its colours and widths, and `contrast`."""
    return {"theme": theme.model_dump(), "contrast": contrasts(theme)}
