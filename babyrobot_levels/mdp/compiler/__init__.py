"""From level and grid to the exact tables.

`terrain` says what each cell does, and where moves and warps end; `outcomes` what a step comes to;
`compile_cells` puts them together. Of levels with things, `layers` finds the configurations that
occur, `movers` says where movers go, and `things` puts it all together; `boxes` does both where
there are boxes, with `yards`. `robots` steps several robots, with `meetings`, and `joint` makes
tables of that.
"""

from collections.abc import Iterator

import numpy as np

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.compiler.assembly import assembled
from babyrobot_levels.mdp.compiler.outcomes import (
    Arrivals,
    Branches,
    Outcomes,
    Room,
    chance_branches,
    ended,
    merged,
    plain_branches,
)
from babyrobot_levels.mdp.compiler.terrain import (
    build_air,
    build_terrain,
    build_warps,
    obstructions,
)
from babyrobot_levels.mdp.configurations import check_room, most_columns
from babyrobot_levels.mdp.grid import Grid, build_grid
from babyrobot_levels.mdp.tables import Ints, Mdp, parts_of
from babyrobot_levels.text import budget

__all__ = ["checked_mdp", "compile_mdp"]

STEPS = 100
"""The steps of work for a state and each of its outcomes."""


def compile_mdp(level: LevelFields, grid: Grid | None = None) -> Mdp:
    """Compile a level into its exact tables.

    Args:
        level: the level.
        grid: its grid, if it is known.

    Raises:
        LevelError: the level's maze has no seed yet (`seed: random`); or the level has more states,
            or a row more outcomes, than the language allows.
        OverBudgetError: it takes more than the budget at hand.
    """
    grid = grid or build_grid(level)
    if not level.has_things:
        return compile_cells(level, grid)
    # Most levels have none.
    from babyrobot_levels.mdp.compiler.things import compile_things

    return compile_things(level, grid)


def checked_mdp(level: LevelFields, grid: Grid) -> Mdp | None:
    """Check that a level can be compiled; return its tables if they are small and had to be made.

    Raises:
        LevelError: as `compile_mdp`.
    """
    if not level.has_things:
        for _ in _Cells(level, grid).branches():
            pass
        return None
    from babyrobot_levels.mdp.compiler.things import checked_things

    return checked_things(level, grid)


class _Cells:
    """What a level without things is compiled from."""

    def __init__(self, level: LevelFields, grid: Grid):
        self.level = level
        self.terrain = build_terrain(level, grid)
        self.air = build_air(level, grid)
        self.warps = build_warps(level, grid)
        here = self.air.given.here
        self.arrivals = Arrivals(level.rewards, self.terrain, self.warps, here, 1 + level.moves)

    def branches(self) -> Iterator[tuple[Branches, Ints, Branches, Ints]]:
        """Yield, in parts, branches without chance and by chance, each with where they end.

        Raises:
            LevelError: there are too many states times branches of a row.
            OverBudgetError: there are more than the budget allows.
        """
        terrain, air, warps = self.terrain, self.air, self.warps
        count = terrain.over.size
        for part in parts_of(count):
            plain = plain_branches(air.given, terrain, warps, part)
            next_state = self.arrivals.next_states(plain)
            # A plain row whose end is drawn, or its reward, is a chance too.
            lost = self.arrivals.is_drawn(next_state)
            rows, branches = chance_branches(air, terrain, warps, part)
            sure = ~(lost | rows.ravel())
            chances, ends = ended(
                branches.joined(plain.select(lost & ~rows.ravel())), self.arrivals
            )
            # Before equal ones are merged: rewards decide nothing.
            sizes = None if terrain.draws is None else terrain.draws.count(ends)
            width = int(np.bincount(chances.row - plain.row[0], sizes).max(initial=0))
            check_room(self.level, count, max(1, width))
            budget.spend(STEPS * (part.stop - part.start) * max(1, width))
            yield plain.select(sure), next_state[sure], chances, ends


def compile_cells(level: LevelFields, grid: Grid) -> Mdp:
    """Compile a level without things, whose states are the cells, into its exact tables.

    Errors are those of `compile_mdp`.
    """
    cells = _Cells(level, grid)
    terrain, rewards_of = cells.terrain, cells.arrivals.rewards_of
    count = terrain.over.size
    room = Room(count, 1 + level.moves, most_columns(level, count))
    for plain, next_state, chances, ends in cells.branches():
        first = np.zeros(plain.row.size, np.int8)
        (*_, reward), over = rewards_of(plain, next_state), terrain.over[next_state]
        room.put(Outcomes(plain.row, first, plain.probability, next_state, reward, over))
        if chances.row.size:
            which, chance, reward = rewards_of(chances, ends)
            row, probability, ends = chances.row[which], chances.probability[which], ends[which]
            room.put(merged(row, probability * chance, ends, reward, terrain.over[ends]))

    obstruction, intended = obstructions(cells.air, terrain, cells.warps)
    start = np.zeros(count)
    starts, weights = cells.warps.lots[0]
    start[starts] = weights / weights.sum()
    return assembled(
        grid,
        start=start,
        over=terrain.over,
        intended=np.where(intended < 0, count - 1 - intended, intended),
        obstruction=obstruction,
        tables=room.tables(),
        drawn=cells.warps.drawn,
    )
