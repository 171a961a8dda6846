"""From level and grid to the exact tables.

`terrain` says what each cell does, `moves` where moves and warps end, `outcomes` what a step comes
to; `tables` puts them together.
"""

from babyrobot_levels.mdp.compiler.tables import compile_mdp

__all__ = ["compile_mdp"]
