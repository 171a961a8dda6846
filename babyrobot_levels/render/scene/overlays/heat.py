"""How often the robot was where, as heat on the ground."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.overlays.rooms import Cell, Rooms
from babyrobot_levels.render.scene.shapes import Rect

_INSET = 4.0
_FAINTEST, _STRONGEST = 0.1, 0.6


def heat_shapes(
    visits: Sequence[tuple[Cell, float]], rooms: Rooms, layout: Layout, color: str
) -> Iterator[Rect]:
    """Yield a square for each cell, the stronger the more often it was visited.

    Strength grows with the logarithm: the first visits count most, and the busiest cell does not
    make all others pale.
    """
    most = max((math.log1p(count) for _, count in visits), default=0.0)
    for cell, count in visits:
        share = math.log1p(count) / most
        opacity = round(_FAINTEST + (_STRONGEST - _FAINTEST) * share, 2)
        left, upper = layout.corner(*cell)
        top, foot = rooms[cell]
        yield Rect(left + _INSET, upper + top, CELL - 2 * _INSET, foot - top, color, 7.0, opacity)
