"""The names of all metrics, in the order in which they are shown."""

SHAPE = ("cells", "dead_ends", "corridors", "junctions", "loops")
PATHS = ("states", "reachable", "path_length", "turns")
THINGS = ("items", "doors", "switches", "movers", "configurations", "detour")
"""Only levels with things have these."""

BOXES = ("boxes", "targets")
"""Only levels with boxes or targets have these."""

PUSHES = ("pushes",)
"""Only levels with boxes or targets have it, and for it they are solved."""

RETURNS = ("best_return", "best_steps", "random_return", "random_steps", "success")

UNLIMITED = (*RETURNS, *PUSHES)
"""What is expected of episodes without a limit."""

MISTAKES = ("irreversible", "decisions", "fragility")
"""What is lost by leaving what optimal policies do."""

SOLVED = (*RETURNS, "wet_share", "difficulty", *MISTAKES)
"""Those for which each level is solved."""

MAX_SOLVED = 5_000
"""The most states of a level that is solved without being asked for, as larger ones take longer."""

NEEDS = ("needs", "dependencies", "distractors")
"""Those for which it is compiled without the effect of some things; only levels with things."""

SEEN = ("sight_cost",)
"""Those that are computed only where they are asked for: a search among beliefs takes a while."""

METRICS = (*SHAPE, *PATHS, *THINGS, *BOXES, *PUSHES, *SOLVED, *NEEDS)
"""Those that are shown of each level."""

STATED = (*METRICS, *SEEN)
"""Those that a level can state, and that can be asked of one that is generated."""

SHARES = ("reachable", "success", "wet_share", "irreversible")
"""Shares and probabilities: of these, 0 and 1 are never rounded."""
