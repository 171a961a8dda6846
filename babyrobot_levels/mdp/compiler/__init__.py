"""From level and grid to the exact tables.

`terrain` says what each cell does, and where moves and warps end; `outcomes` what a step comes to;
`compile_cells` puts them together. Of levels with things, `layers` finds the configurations that
occur, `movers` says where movers go, and `things` puts it all together.
"""

from __future__ import annotations

import numpy as np

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.compiler.outcomes import (
    Arrivals,
    Outcomes,
    Room,
    ended,
    merged,
    plain_branches,
    stochastic_branches,
    stochastic_rows,
)
from babyrobot_levels.mdp.compiler.terrain import (
    build_moves,
    build_terrain,
    build_warps,
    obstructions,
)
from babyrobot_levels.mdp.configurations import MAX_WIDE_STATES, most_outcomes, too_large
from babyrobot_levels.mdp.grid import Grid, build_grid
from babyrobot_levels.mdp.tables import REFUSED, Mdp, parts_of

__all__ = ["compile_mdp"]


def compile_mdp(level: LevelFields, grid: Grid | None = None, most: int = MAX_WIDE_STATES) -> Mdp:
    """Compile a level into its exact tables.

    Args:
        level: the level.
        grid: its grid, if it is known.
        most: the most states times outcomes of the longest row.

    Raises:
        TooLargeError: there are more than `most`.
        LevelError: the level's maze has no seed yet (`seed: random`); or, with things, the level
            has more states, or a row more outcomes, than the language allows.
    """
    grid = grid or build_grid(level)
    if not level.has_things:
        return compile_cells(level, grid, most)
    # Most levels have none.
    from babyrobot_levels.mdp.compiler.things import compile_things

    return compile_things(level, grid, most)


def compile_cells(level: LevelFields, grid: Grid, most: int = MAX_WIDE_STATES) -> Mdp:
    """Compile a level without things, whose states are the cells, into its exact tables.

    Raises:
        TooLargeError: there are more than `most` states times outcomes.
    """
    terrain = build_terrain(level, grid)
    moves = build_moves(level, grid)
    warps = build_warps(level, grid)
    arrivals = Arrivals(level.rewards, terrain, warps)
    starts = np.array([y * grid.width + x for x, y in level.starts])

    count = terrain.over.size
    room = Room(count, max(1, min(most_outcomes(level), most // count)))
    for part in parts_of(count):
        plain = plain_branches(moves, terrain, warps, part)
        next_state = arrivals.next_states(plain)
        # A plain row that leads to one of several starts is a chance too.
        lost = next_state == count
        stochastic = stochastic_rows(moves, terrain, warps, part)
        sure = ~(lost | stochastic.ravel())
        row, next_state = plain.row[sure], next_state[sure]
        reward = arrivals.rewards_of(plain.select(sure), next_state)
        first = np.zeros(row.size, np.int8)
        room.put(Outcomes(row, first, first + 1.0, next_state, reward, terrain.over[next_state]))
        by_chance = [
            *stochastic_branches(moves, terrain, stochastic, part),
            plain.select(lost & ~stochastic.ravel()),
        ]
        branches = by_chance[0].joined(*by_chance[1:])
        branches = branches.select(branches.probability > 0)
        if branches.row.size:
            branches, next_state = ended(branches, arrivals, starts)
            # Before equal ones are merged: rewards decide nothing.
            width = int(np.bincount(branches.row - plain.row[0]).max())
            if width * count > most:
                raise too_large(level, count, width, most)
            reward = arrivals.rewards_of(branches, next_state)
            outcomes = merged(
                branches.row, branches.probability, next_state, reward, terrain.over[next_state]
            )
            room.put(outcomes)

    obstruction, intended = obstructions(moves, terrain, warps)
    action_mask = (obstruction != REFUSED).astype(np.int8)
    action_mask[terrain.over, 1:] = 0
    start = np.zeros(count)
    start[starts] = 1.0 / starts.size
    return Mdp(
        width=grid.width,
        height=grid.height,
        start=start,
        is_terminal=terrain.over,
        action_mask=action_mask,
        intended_next_state=intended,
        obstruction=obstruction,
        **room.tables(),
    ).freeze()
