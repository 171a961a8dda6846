"""From level and grid to the exact tables.

`terrain` says what each cell does, `moves` where moves and warps end, `outcomes` what a step comes
to; `tables` puts them together. Of levels with things, `layers` finds the configurations that
occur, `movers` says where movers go, and `things` puts it all together.
"""

from __future__ import annotations

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.compiler.tables import compile_cells
from babyrobot_levels.mdp.grid import Grid, build_grid
from babyrobot_levels.mdp.tables import Mdp

__all__ = ["compile_mdp"]


def compile_mdp(level: LevelFields, grid: Grid | None = None) -> Mdp:
    """Compile a level into its exact tables.

    Raises:
        LevelError: the level's maze has no seed yet (`seed: random`); or, with things, the level
            has more states, or a row more outcomes, than the language allows.
    """
    grid = grid or build_grid(level)
    if not level.has_things:
        return compile_cells(level, grid)
    # Most levels have none.
    from babyrobot_levels.mdp.compiler.things import compile_things

    return compile_things(level, grid)
