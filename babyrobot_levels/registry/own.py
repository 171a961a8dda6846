"""What the package's own extensions do for earlier rooms, by name.

No room imports an extension. What one does for a function, a format or a command of an earlier room
is named here, and imported when it is used.
"""

from typing import Any

from babyrobot_levels.registry.entries import resolve

PLACES = {
    "export_sight": "babyrobot_levels.extensions.sight.export:export_sight",
    "foreign_level": "babyrobot_levels.extensions.formats.reading:foreign_level",
    "page_sight": "babyrobot_levels.extensions.sight.page:page_sight",
    "solve_sight": "babyrobot_levels.extensions.sight.solve:solve_sight",
    "tracker_of": "babyrobot_levels.extensions.sight.tracking:tracker_of",
}
"""Where each function is, as `package.module:name`."""


def own(name: str) -> Any:
    """Import a function of `PLACES`."""
    return resolve(PLACES[name])
