"""The levels in which estimates are compared: mazes of 6x6 cells, in three families."""

from __future__ import annotations

from typing import Any

from ppo_jax import DISCOUNT

import babyrobot_levels as brl

SIZE, MAX_STEPS = 6, 60
MAZES: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "size": [SIZE, SIZE],
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 1}},
    "start": "random",
    "exit": "random",
    # Only the exit pays, as where the estimates come from; the sooner, the more.
    "rewards": {"step": 0, "exit": 100},
    "discount": DISCOUNT,
    "max_steps": MAX_STEPS,
}
DRY = {size: {"reward": 0} for size in ("small", "large")}
FAMILIES: dict[str, dict[str, Any]] = {
    "walls": {},
    "stochastic": {"puddles": {"min": 3, "max": 8}, "wind": {"max": 2}},
    "keys": {"keys": 1},
}
# The whole level, with the robot in the middle.
VIEW: dict[str, Any] = {
    "observation": "view",
    "view_radius": SIZE - 1,
    "see_through": True,
    "actions": "moves",
}


def levels_of(family: str, count: int) -> list[brl.Level]:
    """Return levels of a family; their puddles make the robot skid, but cost nothing."""
    suite = brl.load_suite({**MAZES, "count": count, "seed": 1, **FAMILIES[family]})
    return [brl.load({**level.to_dict(whole=True), "puddle_types": DRY}) for level in suite]
