"""What moves come to among boxes, of many pairs of configuration and cell at a time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.cells import gusts, shifts
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.mdp.actions import NUM_MOVES
from babyrobot_levels.mdp.compiler.layers import Ways
from babyrobot_levels.mdp.compiler.outcomes import PUSHED, WAY
from babyrobot_levels.mdp.compiler.terrain import (
    BACK,
    SIGN,
    VERTICAL,
    Air,
    Moves,
    Terrain,
    Warps,
    build_moves,
    build_terrain,
    build_warps,
    windy_cells,
)
from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.mdp.tables import Flags, Floats, Ints


@dataclass(frozen=True, eq=False)
class Yard:
    """What does not depend on the boxes, while some doors are closed; arrays over the cells.

    Attributes:
        grid: the grid with walls at closed doors.
        open: `[4, cells]`: whether nothing closes that side.
        glass: `[4, cells]`: the probability of getting through glass, else 0.
        slides: `[4, cells]`: whether a box can be pushed that way, if none is ahead.
        terrain: the terrain, in which no cell is an exit.
        warps: the warps.
        is_exit: whether the cell is an exit.
        ways: where a step takes the movers; see `Crowd.steps`.
        winds: of each wind that may blow, its probability, how far south it pushes in each column,
            and how far east in each row.
        windy: `[cells]`: whether the wind pushes there.
    """

    grid: Grid
    open: Flags
    glass: Floats
    slides: Flags
    terrain: Terrain
    warps: Warps
    is_exit: Flags
    ways: Ways
    winds: tuple[tuple[float, Ints, Ints], ...]
    windy: Flags

    @cached_property
    def delta(self) -> NDArray[np.int32]:
        """How much farther the next cell is in each direction."""
        return np.array([-self.grid.width, 1, self.grid.width, -1], np.int32)

    def left_from(self, cell: Ints) -> tuple[Terrain, Warps]:
        """Return what cells do: by pairs to who leaves them, by cells to who comes there."""
        terrain, warps = self.terrain, self.warps
        return (
            replace(
                terrain,
                skid=terrain.skid[cell],
                rule=terrain.rule[cell],
                over=np.zeros(cell.size, bool),
            ),
            warps.left_from(cell),
        )

    def air(self, cell: NDArray[np.int32], boxes: NDArray[np.int32]) -> Air:
        """Return what moves come to, of pairs with cells and boxes `[pairs, boxes]`."""
        moves = self._moves(cell, boxes)
        blown = [
            self._blown(moves, boxes, south, east) if south.any() or east.any() else moves
            for _, south, east in self.winds
        ]
        return Air((*blown,), tuple(chance for chance, *_ in self.winds), self.windy[cell])

    def _moves(self, cell: NDArray[np.int32], boxes: NDArray[np.int32]) -> Moves:
        """Return what each direction comes to without wind."""
        shape = NUM_MOVES, cell.size
        open_ = self.open[:, cell]
        glass: Floats = self.glass[:, cell]
        landing, pushed = np.empty(shape, np.int32), np.zeros(shape, np.int8)
        for way in range(NUM_MOVES):
            ahead = np.where(open_[way] | (glass[way] > 0), cell + self.delta[way], cell)
            boxed = stands_on(boxes, ahead) & (ahead != cell)
            slides = boxed & self.slides[way, ahead]
            slides &= ~stands_on(boxes, ahead + self.delta[way])
            stuck = boxed & ~slides
            open_[way] &= ~stuck
            glass[way, stuck] = 0.0
            pushed[way, slides] = PUSHED + WAY * way
            landing[way] = np.where(open_[way], ahead, cell)
        back, through = [*BACK], np.where(glass > 0, cell + self.delta[:, None], cell)
        comes = pushed * open_
        return Moves(
            cell,
            open_,
            landing,
            ~open_,
            glass,
            through,
            landing[back],
            comes,
            pushed * (glass > 0),
            comes[back],
        )

    def _blown(self, moves: Moves, boxes: NDArray[np.int32], south: Ints, east: Ints) -> Moves:
        """Return what a wind makes of moves: it pushes the robot until a box stops it."""
        y, x = np.divmod(moves.here, self.grid.width)
        shift = {True: south[x], False: east[y]}
        landing, through = moves.landing.copy(), moves.through.copy()
        refused, glass = moves.refused.copy(), moves.glass.copy()
        pushed, through_pushed = moves.pushed.copy(), moves.through_pushed.copy()
        for way in range(NUM_MOVES):
            vertical, sign = VERTICAL[way], SIGN[way]
            along, across = shift[vertical] + sign, shift[not vertical]
            pushing = along * sign > 0
            refused[way] &= pushing
            glass[way] *= pushing
            pushed[way] *= pushing
            through_pushed[way] *= pushing
            moved, ahead = boxes.copy(), moves.here + self.delta[way]
            slid = (pushed[way] | through_pushed[way]) != 0
            moved[slid] = np.where(
                moved[slid] == ahead[slid, None], ahead[slid, None] + self.delta[way], moved[slid]
            )
            for ends, goes in ((landing, moves.open[way]), (through, glass[way] > 0)):
                # A push against something is over, a step leaves the rest of the wind's.
                rest = np.where(pushing, np.where(goes, along - sign, 0), along)
                at = np.where(pushing & goes, ahead, moves.here)
                at = self._walk(moved, at, rest, vertical)
                ends[way] = self._walk(moved, at, across, not vertical)
        return Moves(
            moves.here,
            moves.open,
            landing,
            refused,
            glass,
            through,
            moves.bounce,
            pushed,
            through_pushed,
            moves.bounce_pushed,
        )

    def _walk(
        self, boxes: NDArray[np.int32], begin: NDArray[np.int32], amount: Ints, vertical: bool
    ) -> NDArray[np.int32]:
        """Walk `amount` cells along an axis, each robot until a wall or a box stops it."""
        at, left = begin, amount
        while left.any():
            way = np.where(left > 0, 2 if vertical else 1, 0 if vertical else 3)
            ahead = at + self.delta[way]
            goes = (left != 0) & self.open[way, at] & ~stands_on(boxes, ahead)
            at = np.where(goes, ahead, at)
            left = np.where(goes, left - np.sign(left), 0)
        return at


def build_yard(level: LevelFields, grid: Grid, exits: tuple[Cell, ...], ways: Ways) -> Yard:
    """Return what does not depend on boxes.

    Args:
        level: the level.
        grid: its grid, with walls at closed doors.
        exits: the exits of an episode.
        ways: where a step takes the movers.
    """
    width, size = grid.width, grid.width * grid.height
    painted, moves = build_terrain(level, grid, exits), build_moves(level, grid, None)
    barred = np.zeros(size + 1, bool)
    for warp in level.warps:
        for x, y in level.targets_of(warp):
            barred[y * width + x] = True
    delta = np.array([-width, 1, width, -1])[:, None]
    beyond = np.where(moves.open, np.arange(size) + delta, size)
    winds = []
    for chance, stronger in gusts(level.wind):
        south, east = shifts(level.wind, width, grid.height, stronger)
        winds.append((chance, np.array(south), np.array(east)))
    return Yard(
        grid=grid,
        open=moves.open,
        glass=moves.glass,
        slides=moves.open & ~barred[beyond],
        terrain=replace(painted, exit=np.zeros(size, bool), over=painted.ends),
        warps=build_warps(level, grid),
        is_exit=painted.exit,
        ways=ways,
        winds=(*winds,),
        windy=windy_cells(level, grid),
    )


def stands_on(boxes: NDArray[Any], cell: NDArray[np.int32] | int) -> Flags:
    """Return whether one of the boxes `[pairs, boxes]` stands in a cell of each pair, or of all."""
    stands = np.zeros(len(boxes), bool)
    for each in boxes.T:
        stands |= each == cell
    return stands
