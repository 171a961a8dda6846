"""Samples of what is in a level, each as large as a cell: the pictures of a legend."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from babyrobot_levels.language.cells import Puddle, Rectangle
from babyrobot_levels.language.looks import Display
from babyrobot_levels.language.moves import Wind
from babyrobot_levels.language.walls import Wall
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.effects import Effects, effects_of
from babyrobot_levels.render.scene.ground import ground_shapes, puddle_shapes
from babyrobot_levels.render.scene.icons import Spot, default_color, item_shapes
from babyrobot_levels.render.scene.layout import CELL, Layout
from babyrobot_levels.render.scene.marks import effect_shapes
from babyrobot_levels.render.scene.movers import mover_shapes
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.shapes import Shape, scaled, shifted
from babyrobot_levels.render.scene.situation import situation_of
from babyrobot_levels.render.scene.slots import Slots
from babyrobot_levels.render.scene.things import pieces
from babyrobot_levels.render.scene.walls import casing_shapes, wall_shapes

_HERE = (0, 0)
_SPOT = Spot(CELL / 2, CELL / 2)
_PARTS: dict[str, dict[str, Any]] = {
    "exit": {"exit": _HERE},
    "blocked": {"blocked": (Rectangle(at=_HERE),)},
    "puddle-small": {"puddles": (Puddle(at=_HERE, size="small"),)},
    "puddle-large": {"puddles": (Puddle(at=_HERE, size="large"),)},
}
"""What the cell of a sample has."""


def sample_shapes(level: GridWorld, sample: str, size: float = CELL) -> tuple[Shape, ...]:
    """Return what a rule is about as the picture of a cell, in the colours of the level.

    Args:
        level: the level.
        sample: the `sample` of one of the level's rules.
        size: the side of the picture in pixels; its upper left corner is (0, 0).
    """
    return tuple(scaled(_shapes(level, sample), size / CELL)) if sample else ()


def _shapes(level: GridWorld, sample: str) -> Iterator[Shape]:
    kind, _, what = sample.partition(":")
    if kind == "cell":
        x, y = map(int, what.split(","))
        yield from _cell(level, (x, y))
        return
    yield from _ground(_small(level, shows_start=kind == "start", **_PARTS.get(kind, {})))
    if kind in ("wall", "glass"):
        yield from _wall(level, is_glass=kind == "glass")
    elif kind == "wind":
        small = _small(level, wind=Wind(**{what: (1,)}), skid=None)
        yield from _effects(small, effects_of(small))
    elif kind == "ground":
        small = _small(level)
        yield from _effects(small, effects_of(small))
    elif kind == "item":
        item = next(item for item in level.items if item.name == what)
        color = item.color or default_color(item.picture, level.resolved_theme.colors)
        yield from item_shapes(item.picture, color, _SPOT)
    elif kind == "switch":
        switch = next(switch for switch in level.switches if switch.name == what)
        plate = switch.model_copy(update={"at": _HERE, "label": None})
        small = _small(level, switches=(plate,))
        for piece in pieces(small, _layout(), situation_of(small, None), _slots(small)):
            yield from piece.shapes
    elif kind == "mover":
        yield from mover_shapes(level, int(what), _SPOT)


def _small(level: GridWorld, *, shows_start: bool = False, **fields: Any) -> GridWorld:
    """Return a level of one cell that looks and pays like another one, and has no outer wall."""
    theme = level.resolved_theme
    widths = theme.widths.model_copy(update={"border": 0.0})
    given = {
        "size": (1, 1),
        "skid": level.skid,
        "rewards": level.rewards,
        "theme": theme.model_copy(update={"widths": widths}),
        "display": Display(start_text=False, exit_text=False),
    }
    kind = GridWorld if shows_start else _Startless
    return kind.model_construct(version=1, **{**given, **fields})


class _Startless(GridWorld):
    """A level whose start is not drawn."""

    @property
    def starts(self) -> tuple[tuple[int, int], ...]:
        """No cells."""
        return ()


def _layout(columns: int = 1) -> Layout:
    return Layout(columns, 1, 0.0, 0.0, 0.0)


def _slots(small: GridWorld, columns: int = 1) -> Slots:
    return Slots(small, _layout(columns), Overlay())


def _ground(small: GridWorld) -> Iterator[Shape]:
    yield from ground_shapes(small, _layout())
    yield from puddle_shapes(small, _layout(), _slots(small))


def _cell(level: GridWorld, cell: tuple[int, int]) -> Iterator[Shape]:
    """Yield what areas, puddles and warps make of a cell."""
    x, y = cell
    areas = [
        area.model_copy(update={"at": _HERE, "size": (1, 1), "label": None})
        for area in level.areas
        if 0 <= x - area.at[0] < area.size[0] and 0 <= y - area.at[1] < area.size[1]
    ]
    puddles = [Puddle(at=_HERE, size=puddle.size) for puddle in level.puddles if puddle.at == cell]
    yield from _ground(_small(level, areas=tuple(areas), puddles=tuple(puddles)))
    effects = effects_of(level).at(cell)
    warps = [warp.model_copy(update={"at": _HERE}) for warp in level.warps if warp.at == cell]
    if warps and warps[0].to != "start":
        # The arrow to the next cell, in half the size.
        there = warps[0].model_copy(update={"to": (1, 0)})
        shapes = _effects(_small(level, size=(2, 1), warps=(there,)), effects)
        yield from shifted(scaled(shapes, 0.5), 0, CELL / 4)
    else:
        yield from _effects(_small(level, warps=tuple(warps)), effects)


def _effects(small: GridWorld, effects: Effects) -> Iterator[Shape]:
    layout = _layout(small.size[0])
    yield from effect_shapes(small, layout, _slots(small, layout.columns), effects)


def _wall(level: GridWorld, *, is_glass: bool) -> Iterator[Shape]:
    """Yield a wall through the middle, upright."""
    share = next(iter(level.grid().glass.values())) if is_glass else 0.0
    wall = Wall.model_validate({"at": _HERE, "side": "E", "pass": share})
    small, layout = _small(level, size=(2, 1), walls=(wall,)), _layout(2)
    shapes = (*casing_shapes(small, layout), *wall_shapes(small, layout, _slots(small, 2)))
    yield from shifted(shapes, -CELL / 2, 0)
