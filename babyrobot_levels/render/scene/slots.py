"""What stands where in a cell, and what gives way: the one place that decides it.

A cell has a strip at its top (the label of an area, coordinates, a second number), a strip at its
foot (a number, or START and EXIT), and the middle. Where a picture shows answers, these come first:
the number at the foot, the arrow in the middle, and what the world has there becomes an icon in the
upper left corner; the robot is a small figure in the upper right one. Then come labels,
coordinates, and START, which the colour of its cell tells as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.render.scene.layout import (
    CELL,
    CHARACTER_WIDTH,
    Layout,
    Overlay,
    each_cell,
    fit,
)
from babyrobot_levels.render.scene.shapes import Commands

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from babyrobot_levels.mdp.gridworld import GridWorld


NUMBER = 13.0
"""The height of the strip for a number."""

ICON = 40.0
"""The side of the box of an icon that has the middle of a cell to itself."""

SMALL_ROBOT = 0.48
"""The scale of the robot beside an arrow or values of actions."""

ROBOT_CORNER = (33.0, 0.5)
"""The upper left corner of the small robot's box in its cell."""

_TOP, _FOOT, _EDGE, _GAP = 4.0, CELL - 4.0, 3.0, 2.0
_WORD, _COORDINATES = 10.25, 12.0
_LONGEST = 15.0
_SHORTEST, _BESIDE_ACTIONS = 5.0, 7.5
_CORNER, _CORNER_OF_ACTIONS, _TINY = 20.0, 14.0, 9.0
_LABEL_ROOM = 16.0

LABEL_MARGIN = 4.0
"""How far arrows keep away from labels, if they can, in pixels."""

Arrow = tuple[Commands, Commands]
"""Shaft and head."""


class Box(NamedTuple):
    """A rectangle in pixels: of a plan, from the upper left corner of its cell."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def centre(self) -> tuple[float, float]:
        """The centre `(x, y)`."""
        return (self.left + self.right) / 2, (self.top + self.bottom) / 2

    @property
    def width(self) -> float:
        """The width."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """The height."""
        return self.bottom - self.top

    def moved(self, x: float, y: float) -> Box:
        """Return the box so many pixels to the right, and down."""
        return Box(self.left + x, self.top + y, self.right + x, self.bottom + y)


class Label(NamedTuple):
    """The label of an area.

    Attributes:
        box: its box in the picture.
        size: its font size.
        text: as much of it as fits.
        columns: the columns of the area.
    """

    box: Box
    size: float
    text: str
    columns: range


class ShownInCells(NamedTuple):
    """What a picture shows in its cells."""

    number: bool
    second: bool
    arrows: bool
    actions: bool
    coordinates: bool

    @property
    def is_crowded(self) -> bool:
        """Whether arrows or values of actions take the middle of the cells."""
        return self.arrows or self.actions

    @property
    def fills_cells(self) -> bool:
        """Whether cells show something besides coordinates."""
        return self.number or self.second or self.is_crowded


class Contents(NamedTuple):
    """What is in a cell.

    Attributes:
        acts: whether the robot can stand and act there, or the end of an episode tells a number.
        word: whether START or EXIT is written there.
        label_foot: the lower edge of a label at the top, 0 for none.
        label_top: the upper edge of a label at the foot, `CELL` for none.
    """

    acts: bool
    word: bool = False
    label_foot: float = 0.0
    label_top: float = CELL


class Plan(NamedTuple):
    """The boxes of a cell; None for what gives way.

    Attributes:
        icon: for what the world has in the cell: ends, rewards, costs, items, wind, rings of warps
            and their arrow heads.
        arrow: for the arrows of a policy, a square.
        number: for a value, or a count where no values are shown.
        second: for a count beside a value.
        coordinates: for the coordinates.
        word: for START or EXIT.
        free: the part from top to bottom without texts and numbers.
    """

    icon: Box
    arrow: Box
    number: Box
    second: Box
    coordinates: Box | None
    word: Box | None
    free: Box


class Slots:
    """The boxes of all cells of a picture.

    Args:
        level: the level.
        layout: where its cells are.
        overlay: what is shown over it.

    Attributes:
        shown: what the picture shows in its cells.
        acting: the cells in which the robot can stand and act.
        ends: the cells in which it can stand, and the episode is over.
        labels: the labels of areas.
        rings: the cells with the ring of a warp.
        arrows: the arrows of warps, by their first and last cells, as far as they are known.
    """

    def __init__(self, level: GridWorld, layout: Layout, overlay: Overlay) -> None:
        self._layout = layout
        values, visits = overlay.values is not None, overlay.visits is not None
        self.shown = ShownInCells(
            # The best value of the actions is that of the state.
            number=(values or visits) and overlay.action_values is None,
            second=visits and (values or overlay.action_values is not None),
            arrows=overlay.actions is not None,
            actions=overlay.action_values is not None,
            coordinates=level.display.coordinates or overlay.coordinates,
        )
        self.acting, self.ends = (
            standing_cells(level) if self.shown.fills_cells else (frozenset(), frozenset())
        )
        at_foot = level.display.coordinates and not self.shown.fills_cells
        self.labels = tuple(_labels(level, layout, at_foot=at_foot))
        self.rings = frozenset(warp.at for warp in level.warps)
        self.arrows: dict[tuple[Cell, Cell], Arrow] = {}
        self._near = _near(self.labels, layout)
        self._covered = dict(_covered(self.labels, layout, at_foot=at_foot))
        display = level.display
        starts = level.starts if display.start_text else ()
        exits = level.exits if display.exit_text and level.exit_one_of is None else ()
        self._words = {*starts, *exits}
        numbers = (overlay.values, overlay.visits)
        told = {cell for rows in numbers for cell, number in each_cell(rows, layout) if number}
        self._answered = self.acting | (self.ends & told)

    @property
    def is_crowded(self) -> bool:
        """Whether the robot is small: arrows or values of actions take the middle of cells."""
        return self.shown.is_crowded

    def plan(self, cell: Cell) -> Plan:
        """Return the boxes of a cell, from its upper left corner."""
        label = self._covered.get(cell, (0.0, CELL))
        return _plan(Contents(cell in self._answered, cell in self._words, *label), self.shown)

    def near(self, cell: Cell) -> Sequence[Box]:
        """Return the boxes in a cell from which arrows keep away: labels with their margins."""
        return self._near.get(cell, ())

    def is_small(self, cell: Cell) -> bool:
        """Whether words in a cell are small: beside answers, on a ground of their own."""
        return self.shown.fills_cells and cell in self._answered

    def icon(self, cell: Cell) -> Box:
        """Return the box for what the world has in a cell, in pixels of the picture.

        Its side is at most `ICON`.
        """
        return self.plan(cell).icon.moved(*self._layout.corner(*cell))


def standing_cells(level: GridWorld) -> tuple[frozenset[Cell], frozenset[Cell]]:
    """Return the cells in which the robot can stand and act, and those in which it can only stand.

    An episode is over in the latter. Neither are blocked cells, and cells from which a robot is
    moved on as soon as it enters.
    """
    import numpy as np

    mdp = level.compile()
    going_on = ~mdp.is_terminal
    states = np.arange(mdp.num_states)[:, None, None]
    enters = (mdp.probability > 0) & (mdp.next_state != states) & going_on[:, None, None]
    stands = mdp.start > 0
    stands[mdp.next_state[enters]] = True

    def cells(flags: NDArray[np.bool_]) -> frozenset[Cell]:
        (found,) = np.nonzero(flags.reshape(-1, mdp.cells).any(axis=0))
        return frozenset((cell % mdp.width, cell // mdp.width) for cell in found.tolist())

    acting = cells(stands & going_on)
    return acting, cells(stands) - acting


@lru_cache(maxsize=256)
def _plan(contents: Contents, shown: ShownInCells) -> Plan:
    top, foot = _TOP, _FOOT
    is_labelled = contents.label_foot > 0
    if is_labelled:
        top = max(top, contents.label_foot + _GAP)
    foot = min(foot, contents.label_top - _GAP)
    answers = contents.acts and shown.fills_cells
    coordinates: Box | None = None
    if shown.coordinates and not (is_labelled and answers and shown.is_crowded):
        coordinates = Box(6, top, CELL / 2, top + 10)
    word: Box | None = None
    if contents.word and not answers:
        word = Box(4, CELL - 5 - _WORD, CELL - 4, CELL - 5)
        foot = min(foot, word.top - _GAP)
    elif contents.word and not (shown.coordinates or shown.second or shown.actions or is_labelled):
        word = Box(_EDGE, _EDGE, _EDGE + 33, _EDGE + _WORD)
    is_left_taken = coordinates is not None or (word is not None and answers)
    number = Box(2, foot - NUMBER, CELL - 2, foot)
    second = Box(CELL / 2, top, CELL - 7, top + _COORDINATES)
    if shown.number and answers:
        foot = number.top - _GAP
    upper = top + (_COORDINATES if is_left_taken or shown.second or shown.arrows else 0)
    if shown.actions and not (is_left_taken or shown.second):
        upper = top
    if is_labelled and not is_left_taken and not shown.second:
        upper = top
    reach = _BESIDE_ACTIONS if shown.actions else min(max((foot - upper) / 2, _SHORTEST), _LONGEST)
    middle = (upper + foot) / 2 if shown.actions else CELL / 2
    y = min(max(middle, upper + reach), foot - reach)
    arrow = Box(CELL / 2 - reach, y - reach, CELL / 2 + reach, y + reach)
    if answers and shown.is_crowded:
        icon = _corner(top, is_left_taken, is_labelled, shown)
    else:
        # A little below coordinates, which are at the left.
        start = top + (_COORDINATES - 4 if is_left_taken else 0)
        side = min(ICON, foot - start)
        middle = min(max(CELL / 2, start + side / 2), foot - side / 2)
        icon = Box(CELL / 2 - side / 2, middle - side / 2, CELL / 2 + side / 2, middle + side / 2)
    free = Box(_EDGE, upper, CELL - _EDGE, foot)
    return Plan(icon, arrow, number, second, coordinates, word, free)


def _corner(top: float, is_left_taken: bool, is_labelled: bool, shown: ShownInCells) -> Box:
    """Return the box of an icon in a corner, clear of the arrows, which point to the sides."""
    side = _CORNER_OF_ACTIONS if shown.actions or is_labelled else _CORNER
    upper = top - 1
    if is_left_taken and shown.second:
        # Both upper corners are taken.
        upper += _COORDINATES
        return Box(_EDGE, upper, _EDGE + _TINY, upper + _TINY)
    left = CELL - _EDGE - side if is_left_taken else _EDGE
    return Box(left, upper, left + side, upper + side)


# -- labels of areas ---------------------------------------------------------------------------


def _labels(level: GridWorld, layout: Layout, *, at_foot: bool) -> Iterator[Label]:
    """Yield the labels of areas: at the top, or at the foot."""
    for area in level.areas:
        label = " ".join((area.label or "").split())
        if not label:
            continue
        size, text = fit(label, area.size[0] * CELL - _LABEL_ROOM)
        width, height = len(text) * size * CHARACTER_WIDTH + size, 1.35 * size
        x, top = layout.corner(area.at[0] + area.size[0] / 2, area.at[1])
        top += area.size[1] * CELL - height - _TOP if at_foot else _TOP
        box = Box(x - width / 2, top, x + width / 2, top + height)
        yield Label(box, size, text, range(area.at[0], area.at[0] + area.size[0]))


def _near(labels: tuple[Label, ...], layout: Layout) -> dict[Cell, list[Box]]:
    near: dict[Cell, list[Box]] = {}
    for (left, top, right, bottom), *_ in labels:
        more = LABEL_MARGIN
        box = Box(left - more, top - more, right + more, bottom + more)
        (first_x, first_y), (last_x, last_y) = layout.cell(box[:2]), layout.cell(box[2:])
        for y in range(first_y, last_y + 1):
            for x in range(first_x, last_x + 1):
                near.setdefault((x, y), []).append(box)
    return near


def _covered(
    labels: tuple[Label, ...], layout: Layout, *, at_foot: bool
) -> Iterator[tuple[Cell, tuple[float, float]]]:
    """Yield the cells beside labels, with `label_foot` and `label_top` of their contents.

    What stands in one row of an area is in line.
    """
    for label in labels:
        y = int((label.box.top - layout.margin) // CELL)
        edge = layout.corner(0, y)[1]
        for x in label.columns:
            yield (
                (x, y),
                (0.0, label.box.top - edge) if at_foot else (label.box.bottom - edge, CELL),
            )
