"""Pictures, GIFs and pages of levels, and what they show of a solution."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import typer

from babyrobot_levels.cli.console import FINDINGS, fail, note, speaks_unicode, wants_color
from babyrobot_levels.render.numbers import number_lines

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.render.animation import Step
    from babyrobot_levels.render.pagedata import Guide
    from babyrobot_levels.render.scene.overlays import Overlay

MAX_STEPS = 500
"""Films of episodes that do not end are cut after so many steps."""

MAX_SCALE = 100.0


class Walker(StrEnum):
    """Who walks in films and on pages."""

    BEST = "best"
    RANDOM = "random"


@dataclass(frozen=True, slots=True)
class Wishes:
    """What a picture is to show, and how.

    Attributes:
        values: whether it shows what cells are worth.
        policy: the policy that a still picture shows, and that walks in a film.
        seed: what the chance of films and pages is drawn from.
        scale: how large it is, where 1 is 64 pixels a cell. None takes what suits the level.
    """

    values: bool = False
    policy: Walker | None = None
    seed: int = 0
    scale: float | None = None


def picture(level: Level, wishes: Wishes, *, svg: bool) -> str | bytes:
    """Return a still picture: an SVG document, or a PNG file."""
    from babyrobot_levels.render.scene.build import build_scene

    if wishes.policy is Walker.RANDOM:
        fail(
            "a random walk cannot be seen in a still picture",
            "`--policy random` is for gif and html; `--policy` shows the best moves",
        )
    if wishes.values or wishes.policy:
        # The robot would only hide what his cell says.
        scene = build_scene(level, robot=False, overlay=_overlay(level, wishes))
    else:
        scene = build_scene(level)
    if svg:
        from babyrobot_levels.render.svg import to_svg

        return to_svg(scene, wishes.scale or 1.0)
    from babyrobot_levels.render.raster import to_png

    scale = wishes.scale
    size = scale and (round(scale * scene.width), round(scale * scene.height))
    try:
        return to_png(scene, size or None)
    except ValueError as error:
        fail(str(error), "make it smaller with --scale or --cell")


def film(level: Level, wishes: Wishes) -> bytes:
    """Return an episode as a GIF file."""
    from babyrobot_levels.render.animation import to_gif

    steps = _episode(level, wishes.policy or Walker.BEST, wishes.seed)
    overlay = None
    if wishes.values:
        overlay = overlay_of(solution_of(level), values=True, policy=False)
    try:
        return to_gif(level, steps, overlay=overlay, scale=wishes.scale)
    except ValueError as error:
        fail(str(error), "make it smaller with --scale or --cell")


def page(level: Level, wishes: Wishes) -> str:
    """Return a page on which the level is played."""
    from babyrobot_levels.render.page import to_html

    is_asked_for = wishes.values or wishes.policy is Walker.BEST
    guide = guide_of(level, needed=is_asked_for)
    try:
        return to_html(
            level,
            guide=guide,
            walker="random" if wishes.policy is Walker.RANDOM else "best",
            seed=wishes.seed,
            values=wishes.values,
            arrows=wishes.policy is Walker.BEST,
        )
    except ValueError as error:
        fail(str(error))


def _overlay(level: Level, wishes: Wishes) -> Overlay:
    return overlay_of(solution_of(level), values=wishes.values, policy=wishes.policy is Walker.BEST)


def _episode(level: Level, walker: Walker, seed: int) -> list[Step]:
    """Play the environment's episode of a seed."""
    from babyrobot_levels.render.animation import Step

    policy = policy_of(solution_of(level)) if walker is Walker.BEST else None
    env = level.make(observation="index")
    state, _ = env.reset(seed=seed)
    env.action_space.seed(seed)
    steps: list[Step] = []
    is_over = False
    while not is_over and len(steps) < MAX_STEPS:
        action = int(env.action_space.sample()) if policy is None else policy[state]
        next_state, reward, terminated, truncated, info = env.step(action)
        steps.append(Step(int(state), action, int(next_state), float(reward), info["skidded"]))
        state, is_over = next_state, terminated or truncated
    env.close()
    if not is_over:
        note(f"the episode does not end within {MAX_STEPS} steps; the film is cut there")
    return steps


def solution_of(level: Level, discount: float | None = None) -> Solution:
    """Return the solution of a level; where there is none, end the command and say why."""
    from babyrobot_levels.analysis.solver.errors import NoTotalError
    from babyrobot_levels.analysis.solver.optimum import solve

    try:
        return solve(level, discount)
    except NoTotalError as error:
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
    from babyrobot_levels.render.scene.overlays import Overlay

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
    from babyrobot_levels.analysis.solver.errors import NoTotalError
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.render.pagedata import Guide

    if needed:
        solution = solution_of(level)
    else:
        try:
            solution = solve(level)
        except NoTotalError as error:
            note(f"the page shows no best moves: {error}")
            return None
    overlay = overlay_of(solution, values=True, policy=True)
    return Guide(policy_of(solution), overlay, solution.expected_return)


def text_picture(level: Level, *, plain: bool = False) -> str:
    """Return the level for standard output: in Unicode and colour on a terminal, else in ASCII."""
    if plain or not takes_pictures():
        return level.draw()
    from babyrobot_levels.render.text import unicode_drawing

    return unicode_drawing(level, level.grid(), color=True)


def takes_pictures() -> bool:
    """Return whether standard output shows Unicode and colour."""
    return wants_color(sys.stdout) and speaks_unicode(sys.stdout)
