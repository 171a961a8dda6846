"""What commands tell of a level's solution: the policy as a drawing, the values as numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from babyrobot_levels.cli.console import FINDINGS, note
from babyrobot_levels.render.text import number_lines

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.render.page_data import Guide
    from babyrobot_levels.render.scene.overlay import Overlay


def solution_of(level: Level, discount: float | None = None) -> Solution:
    """Return the solution of a level; where there is none, end the command and say why."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError

    try:
        return solve(level, discount)
    except UndefinedReturnError as error:
        note(f"error: the level has no solution: {error}")
        raise typer.Exit(FINDINGS) from None


def policy_text(level: Level, solution: Solution, *, plain: bool) -> str:
    """Return the drawing of an optimal policy, in ASCII if `plain`."""
    from babyrobot_levels.render.text import policy_drawing

    width = level.size[0]
    policy = policy_of(solution)
    actions = [policy[start : start + width] for start in range(0, len(policy), width)]
    return policy_drawing(level, level.grid(), actions, plain=plain)


def policy_of(solution: Solution) -> list[int]:
    """Return the best action of each state, as an `Action`; -1 where there is none."""
    actions: list[int] = (
        (solution.policy + solution.first_action * (solution.policy >= 0)).ravel().tolist()
    )
    return actions


def values_text(solution: Solution) -> str:
    """Return the values in rows and columns, with two decimals."""
    return "".join(f"{line}\n" for line in number_lines(solution.values.tolist(), 2))


def overlay_of(solution: Solution, *, values: bool, policy: bool) -> Overlay:
    """Return the solution as it is shown on a picture: nothing where the episode is over."""
    from babyrobot_levels.render.scene.overlay import Overlay

    over = (solution.policy < 0).tolist()
    shown = [
        [None if end else value for end, value in zip(ends, row, strict=True)]
        for ends, row in zip(over, solution.values.tolist(), strict=True)
    ]
    actions = [
        [
            tuple(number for number, best in enumerate(cell, solution.first_action) if best)
            for cell in row
        ]
        for row in solution.greedy.tolist()
    ]
    return Overlay(shown if values else None, actions if policy else None)


def guide_of(level: Level, *, needed: bool) -> Guide | None:
    """Return the solution as a page tells it; None if there is none and it is not needed."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError
    from babyrobot_levels.render.page_data import Guide

    if needed:
        solution = solution_of(level)
    else:
        try:
            solution = solve(level)
        except UndefinedReturnError as error:
            note(f"the page shows no best moves: {error}")
            return None
    overlay = overlay_of(solution, values=True, policy=True)
    return Guide(policy_of(solution), overlay, solution.expected_return)
