"""What is shown of a solution: over the cells of a picture, and what pages tell of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING, Any

from babyrobot_levels import mdp
from babyrobot_levels.mdp.actions import NUM_MOVES
from babyrobot_levels.text.words import BEST, is_agent

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.language.geometry import Cell
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.page import Guide
    from babyrobot_levels.render.scene.layout import Overlay


def overlay_of(level: GridWorld, info: Mapping[str, Any]) -> Overlay | None:
    """Return what a picture shows over the cells.

    Args:
        level: the level.
        info: as for `show_info`; True, and "best" for a policy, stand for the level's solution,
            and what is None or False is not shown. A policy may be any agent without memory, and
            visits that are True or a text are those of the optimal policy, or of an agent.

    Raises:
        UndefinedReturnError: a solution is asked for, and the level has none.
        ValueError: an array does not fit the level.
    """
    from babyrobot_levels.analysis.shown import overlay_given

    given = {key: value for key, value in info.items() if value is not None and value is not False}
    if not given:
        return None
    if given.get("visits") is True or isinstance(given.get("visits"), str):
        given["visits"] = _visits_of(level, given["visits"])
    policy = given.get("policy")
    if isinstance(policy, str) and policy == BEST:
        given["policy"] = True
    elif isinstance(policy, str | PathLike) or is_agent(policy):
        given["policy"] = mdp.public("policy_table")(level, policy)
    if asked := [key for key, value in given.items() if value is True]:
        from babyrobot_levels.analysis.solver.optimum import solve

        given |= dict.fromkeys(asked, solve(level))
    return overlay_given(level, given)


def lost_of(level: GridWorld) -> frozenset[Cell]:
    """Return the cells from which boxes of a level can reach no target; none without boxes."""
    from babyrobot_levels.mdp.pushing import lost_cells

    lost = lost_cells(level) if level.boxes else ()
    return frozenset(divmod(cell, level.size[0])[::-1] for cell in lost)


class EndlessVisitsError(ValueError):
    """Visits that cannot be drawn, as there are infinitely many."""


def _visits_of(level: GridWorld, policy: str | bool) -> Any:
    """Return how often a policy that is given by name visits the cells."""
    from babyrobot_levels.analysis.solver.occupancy import occupancy

    found = occupancy(level, BEST if policy is True else policy)
    if not math.isfinite(found.visits.max()):
        raise EndlessVisitsError("an episode may go on for ever, so that visits have no picture")
    return found


def policy_of(solution: Solution) -> list[int]:
    """Return the optimal action of each state, as an `Action`; -1 for terminal states."""
    actions: list[int] = (
        (solution.policy + solution.first_action * (solution.policy >= 0)).ravel().tolist()
    )
    return actions


def guide_of(level: GridWorld, solution: Solution | None = None, *, turns: bool = False) -> Guide:
    """Return what a page shows of the solution.

    Args:
        level: the level; a maze needs a seed.
        solution: its solution for a robot that moves, if it is known already.
        turns: whether the robot of the page turns; it can, too, if the level sets a heading.

    Raises:
        UndefinedReturnError: the level has no solution.
    """
    from babyrobot_levels.analysis.solver.optimum import solve

    solution = solve(level) if solution is None else solution
    is_headed = "heading" in level.model_fields_set and level.moves == NUM_MOVES
    turning = _turning_guide(level) if turns or is_headed else None
    return replace(solution_guide(level, solution), turning=turning, **_graded(level, solution))


def solution_guide(level: GridWorld, solution: Solution) -> Guide:
    """Return what a page shows of a solution but for what it grades decisions by.

    Args:
        level: the level.
        solution: its solution, for a robot that moves.
    """
    from babyrobot_levels.render.page import Guide

    overlay = overlay_of(level, {"values": solution, "policy": solution})
    assert overlay is not None
    return Guide(policy_of(solution), overlay, best_average(level, solution))


def _turning_guide(level: GridWorld) -> Guide | None:
    """Return what a page shows of the solution for a robot that turns; None without one."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import TURNS, UndefinedReturnError
    from babyrobot_levels.render.page import Guide

    try:
        solution = solve(level, actions=TURNS)
    except UndefinedReturnError:
        return None
    overlay = overlay_of(level, {"values": solution})
    assert overlay is not None
    policy: list[int] = solution.policy.ravel().tolist()
    guide = Guide(policy, overlay, best_average(level, solution))
    return replace(guide, **_graded(level, solution))


def best_average(level: GridWorld, solution: Solution) -> float:
    """Return the optimal expected return within the level's time limit, if it has one.

    It is nan where that takes too long to be computed.

    Args:
        level: the level.
        solution: its solution without a limit.
    """
    from babyrobot_levels.analysis.solver.horizon import best_return_within

    steps, actions = level.max_steps, solution.actions
    if steps is None:
        return solution.expected_return
    with suppress(ArithmeticError):
        return best_return_within(
            level, steps, actions=actions, discount=level.discount, quick=True
        )
    return math.nan


def _graded(level: GridWorld, solution: Solution) -> dict[str, Any]:
    """Return what a page grades decisions by, besides its tables."""
    values = solution.values.ravel().tolist() if level.max_steps is None else ()
    return {"random_return": random_return(level, solution.actions), "values": values}


def random_return(level: GridWorld, actions: str = "all") -> float | None:
    """Return the expected return of random actions, within the level's time limit.

    It is None where that is undefined, or takes too long to be computed exactly.
    """
    from babyrobot_levels.analysis.solver import evaluation
    from babyrobot_levels.analysis.solver.policies import space_of

    with suppress(ArithmeticError):
        space = space_of(level, actions)
        return evaluation.random_return(space, level.max_steps, level.discount, quick=True)
    return None
