"""The files that all pages of a gallery share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from urllib.parse import quote

from babyrobot_levels.language.looks import Theme
from babyrobot_levels.render.page import common_data, common_module, icon_svg
from babyrobot_levels.render.templates import put_together

_SHAPES = {
    "easy": '<path d="M5 20v-5"/><path opacity=".25" d="M12 20V10M19 20V4"/>',
    "medium": '<path d="M5 20v-5M12 20V10"/><path opacity=".25" d="M19 20V4"/>',
    "hard": '<path d="M5 20v-5M12 20V10M19 20V4"/>',
    "deterministic": '<path d="M3 12h17M14 6l6 6-6 6"/>',
    "stochastic": '<rect x="3.5" y="3.5" width="17" height="17" rx="4"/>'
    '<path d="M8.5 8.5h.01M15.5 8.5h.01M12 12h.01M8.5 15.5h.01M15.5 15.5h.01"/>',
    "items": '<path d="M7 4h10l4 6-9 11L3 10zM3 10h18M12 21l-3.5-11M12 21l3.5-11"/>',
    "doors": '<path d="M6 21V5a2 2 0 0 1 2-2h8a2 2 0 0 1 2 2v16M3 21h18M14 12.5h.01"/>',
    "switches": '<path d="M4 20h16M12 20l3.8-10.5"/><circle cx="17" cy="6" r="3"/>',
    "movers": '<path d="M3 12h18M7 8l-4 4 4 4M17 8l4 4-4 4"/>',
    "areas": '<path d="M4 4h16v16H4zM4 13l9-9M4 20L20 4M11 20l9-9"/>',
    "ends": '<circle cx="12" cy="12" r="9"/><path d="M9 9l6 6M15 9l-6 6"/>',
    "glass": '<path d="M4 3h16v18H4zM8 11l4-4M8 17l8-8"/>',
    "maze": '<path d="M20 21H4V3h16v13h-8v-5"/><path d="M12 11h3M8 16V8h8"/>',
    "puddles": '<path d="M12 3s7 7 7 11.5a7 7 0 0 1-14 0C5 10 12 3 12 3z"/>',
    "warps": '<path d="M3 17a9 9 0 0 1 16.5-2.5M20.5 8v7h-7M3 17h.01"/>',
    "wind": '<path d="M3 9h11.5a3 3 0 1 0-3-3M3 14h15a3 3 0 1 1-3 3M3 19h7"/>',
    "search": '<circle cx="10.5" cy="10.5" r="6.5"/><path d="M15.5 15.5L21 21"/>',
    "filters": '<path d="M3 7h18M6.5 12h11M10 17h4"/>',
}
"""The shapes of each icon, in a square of 24 by 24."""

_STYLE = """\
.icon {
  flex: none;
  display: inline-block;
  width: 1.1rem;
  height: 1.1rem;
  background: currentColor;
  -webkit-mask: var(--shape) center / contain no-repeat;
  mask: var(--shape) center / contain no-repeat;
  print-color-adjust: exact;
  -webkit-print-color-adjust: exact;
}
@media (forced-colors: active) { .icon { forced-color-adjust: none; background: CanvasText; } }
"""


def icons_style() -> str:
    """Return the style sheet of the icons."""
    return _STYLE + "".join(
        f".i-{name} {{ --shape: url('data:image/svg+xml,{_svg(shapes)}'); }}\n"
        for name, shapes in _SHAPES.items()
    )


def _svg(shapes: str) -> str:
    svg = (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 24" fill="none" stroke="#000" '
        f'stroke-width="2.2" stroke-linecap="round" stroke-linejoin="round">{shapes}</svg>'
    )
    return quote(svg, safe=' =:/"<>,.')


# -- files -----------------------------------------------------------------------------------------


def _player_script() -> str:
    """Return the script of levels that can be played, with what is the same for all of them."""
    common = common_module(common_data())
    return _script("publish/static/played_level.js", common)


def _script(path: str, given: Mapping[str, str] | None = None) -> str:
    """Return a script that is no module, which browsers would not load from a disk."""
    return f'"use strict";\n{put_together(path, given)}\n'


def _style(path: str) -> str:
    return put_together(path) + "\n"


ASSETS: dict[str, Callable[[], str]] = {
    "icon.svg": lambda: icon_svg(Theme()),
    "icons.css": icons_style,
    "site.css": lambda: _style("publish/static/site.css"),
    "level.css": lambda: _style("publish/static/level.css"),
    "level.js": lambda: _script("publish/static/level.js"),
    "player.css": lambda: _style("render/static/player.css"),
    "player.js": _player_script,
    "wall.css": lambda: _style("publish/static/wall.css"),
    "wall.js": lambda: _script("publish/static/wall.js"),
}
"""The text of each file, by its name in the folder `assets`."""
