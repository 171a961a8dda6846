"""From level and grid to the exact tables.

`terrain` says what each cell does, `moves` where each move ends, `warps` where warps lead;
`branches` are the chances of a step, `arrivals` what they come to; `tables` puts them together.
"""

from babyrobot_levels.mdp.compiler.tables import compile_mdp

__all__ = ["compile_mdp"]
