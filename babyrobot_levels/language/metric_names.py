"""The names of all metrics, in the order in which they are shown."""

SHAPE = ("cells", "dead_ends", "corridors", "junctions", "loops")
PATHS = ("reachable", "path_length", "turns")
THINGS = ("items", "doors", "switches", "movers", "configurations", "detour")
"""Only levels with things have these."""

UNLIMITED = ("best_return", "best_steps", "random_return", "random_steps")
"""What is expected of episodes without a limit."""

SOLVED = (*UNLIMITED, "wet_share", "difficulty")
"""Those for which the level is solved."""

METRICS = (*SHAPE, *PATHS, *THINGS, *SOLVED)
