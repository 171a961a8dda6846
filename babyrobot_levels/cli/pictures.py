"""Pictures, GIFs and pages of levels, and what they show of a solution."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import typer

from babyrobot_levels.cli.console import FINDINGS, fail, note, speaks_unicode, wants_color
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.render.text import number_lines

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.render.gif import Step
    from babyrobot_levels.render.page_data import Guide
    from babyrobot_levels.render.scene.overlay import Overlay

MAX_STEPS = 500
"""The largest number of steps in a GIF."""

MAX_SCALE = 100.0


class PolicyName(StrEnum):
    """Policies of GIFs and pages."""

    BEST = "best"
    RANDOM = "random"


@dataclass(frozen=True, slots=True)
class PictureOptions:
    """What a picture shows, and how.

    Attributes:
        values: whether to show the optimal value of each cell.
        policy: the policy that a still picture shows, or that a GIF or page follows.
        seed: the random seed of GIFs and pages.
        scale: the size, where 1 is 64 pixels per cell; None chooses one for the level.
        configuration: the number of the configuration that a still picture shows; None shows the
            level as a whole, and the solution where episodes begin.
    """

    values: bool = False
    policy: PolicyName | None = None
    seed: int = 0
    scale: float | None = None
    configuration: int | None = None


def picture(level: Level, options: PictureOptions, *, svg: bool) -> str | bytes:
    """Return a still picture: an SVG document, or a PNG file."""
    from babyrobot_levels.render.scene.build import build_scene

    if options.policy is PolicyName.RANDOM:
        fail(
            "a still picture cannot show a random policy",
            "use --policy best, or a GIF or HTML output",
        )
    configuration = options.configuration
    if options.values or options.policy:
        # The robot would hide what its cell shows.
        shown = shown_configuration(level, configuration)
        overlay = _overlay(level, options)
        scene = build_scene(level, configuration=shown, robot=False, overlay=overlay)
    else:
        robot = configuration is None
        scene = build_scene(level, configuration=configuration, robot=robot)
    if svg:
        from babyrobot_levels.render.svg import to_svg

        return to_svg(scene, options.scale or 1.0)
    from babyrobot_levels.render.raster import to_png

    scale = options.scale
    size = scale and (round(scale * scene.width), round(scale * scene.height))
    try:
        return to_png(scene, size or None)
    except ValueError as error:
        fail(str(error), "use a smaller --scale or --cell")


def gif(level: Level, options: PictureOptions) -> bytes:
    """Return an episode as an animated GIF."""
    from babyrobot_levels.render.gif import to_gif

    steps = _episode(level, options.policy or PolicyName.BEST, options.seed)
    overlay = None
    if options.values:
        overlay = all_overlays(level, solution_of(level), values=True, policy=False)
    try:
        return to_gif(level, steps, overlay=overlay, scale=options.scale)
    except ValueError as error:
        fail(str(error), "use a smaller --scale or --cell")


def page(level: Level, options: PictureOptions) -> str:
    """Return an HTML page on which the level can be played."""
    from babyrobot_levels.render.page import to_html

    check_page_size(level, "save a picture instead: -o FILE.svg or -o FILE.png")
    is_asked_for = options.values or options.policy is PolicyName.BEST
    guide = guide_of(level, needed=is_asked_for)
    try:
        return to_html(
            level,
            guide=guide,
            policy="random" if options.policy is PolicyName.RANDOM else "best",
            seed=options.seed,
            values=options.values,
            arrows=options.policy is PolicyName.BEST,
        )
    except ValueError as error:
        fail(str(error))


def check_page_size(level: Level, help_text: str) -> None:
    """End the command if a level is too large for a page, before it is solved for one."""
    from babyrobot_levels.render.page_data import TooLargeError, without_panels

    try:
        without_panels(level)
    except TooLargeError as error:
        fail(str(error), help_text)


def _overlay(level: Level, options: PictureOptions) -> Overlay:
    return overlay_of(
        solution_of(level),
        values=options.values,
        policy=options.policy is PolicyName.BEST,
        configuration=shown_configuration(level, options.configuration),
    )


def shown_configuration(level: Level, configuration: int | None) -> int | None:
    """Return the configuration whose values are shown; None without things.

    By default it is the one in which episodes begin.
    """
    if not level.has_things or configuration is not None:
        return configuration
    from babyrobot_levels.mdp.states import initial_configuration

    return initial_configuration(level)


def _episode(level: Level, policy_name: PolicyName, seed: int) -> list[Step]:
    """Return the steps of one episode."""
    from babyrobot_levels.render.gif import Step

    policy = policy_of(solution_of(level)) if policy_name is PolicyName.BEST else None
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
        note(f"the episode does not end within {MAX_STEPS} steps; the GIF shows those")
    return steps


def solution_of(level: Level, discount: float | None = None, actions: str = "all") -> Solution:
    """Return the solution of a level; end the command if it has none."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError

    try:
        return solve(level, discount, actions=actions)
    except UndefinedReturnError as error:
        note(f"error: the level has no optimal policy: {error}")
        raise typer.Exit(FINDINGS) from None


def policy_text(
    level: Level, solution: Solution, *, plain: bool, configuration: int | None = None
) -> str:
    """Return a drawing of an optimal policy, in ASCII if `plain`."""
    from babyrobot_levels.render.text import policy_drawing

    width, height = level.size
    number = shown_configuration(level, configuration)
    first = (number or 0) * width * height
    policy = policy_of(solution)[first : first + width * height]
    actions = [policy[start : start + width] for start in range(0, len(policy), width)]
    return policy_drawing(level, level.grid(), actions, configuration=number, plain=plain)


def policy_of(solution: Solution) -> list[int]:
    """Return the optimal action of each state, as an `Action`; -1 for terminal states."""
    actions: list[int] = (
        (solution.policy + solution.first_action * (solution.policy >= 0)).ravel().tolist()
    )
    return actions


def values_text(level: Level, solution: Solution, configuration: int | None = None) -> str:
    """Return the values in rows and columns, with two decimals."""
    values = _at(solution, solution.values, shown_configuration(level, configuration))
    return "".join(f"{line}\n" for line in number_lines(values.tolist(), 2))


def overlay_of(
    solution: Solution, *, values: bool, policy: bool, configuration: int | None = None
) -> Overlay:
    """Return what a picture shows of a solution: nothing in terminal states.

    Args:
        solution: the solution of a level.
        values: whether to show values.
        policy: whether to show optimal actions.
        configuration: the configuration of the picture, for a level with things.
    """
    from babyrobot_levels.render.scene.overlay import Overlay

    terminal = (_at(solution, solution.policy, configuration) < 0).tolist()
    numbers = _at(solution, solution.values, configuration).tolist()
    shown = [
        [None if end else value for end, value in zip(ends, row, strict=True)]
        for ends, row in zip(terminal, numbers, strict=True)
    ]
    actions = [
        [
            tuple(number for number, best in enumerate(cell, solution.first_action) if best)
            for cell in row
        ]
        for row in _at(solution, solution.greedy, configuration).tolist()
    ]
    return Overlay(shown if values else None, actions if policy else None)


def all_overlays(level: Level, solution: Solution, *, values: bool, policy: bool) -> Overlay:
    """Return what a film shows of a solution: in each configuration the part of that one."""
    make = partial(overlay_of, solution, values=values, policy=policy)
    if not level.has_things:
        return make()
    import numpy as np

    shown = solution.values[(solution.policy >= 0) & np.isfinite(solution.values)]
    extent = (float(shown.min()), float(shown.max())) if shown.size else None

    @lru_cache(maxsize=64)
    def part(configuration: int | None, heading: int | None) -> Overlay:
        overlay = make(configuration=shown_configuration(level, configuration))
        return replace(overlay, extent=extent)

    return replace(part(None, None), parts=part)


def _at(solution: Solution, table: Any, configuration: int | None) -> Any:
    """Return the part of an array that belongs to a configuration: `[height, width, …]`."""
    return table[configuration or 0] if solution.values.ndim > 2 else table


def guide_of(level: Level, *, needed: bool, turns: bool = False) -> Guide | None:
    """Return what a page shows of the solution; None without one, unless it is `needed`.

    Args:
        level: the level.
        needed: whether the command ends without a solution.
        turns: whether the robot of the page turns; it can, too, if the level sets a heading.
    """
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError
    from babyrobot_levels.render.page_data import Guide

    if needed:
        solution = solution_of(level)
    else:
        try:
            solution = solve(level)
        except UndefinedReturnError as error:
            note(f"the page shows no optimal moves: {error}")
            return None
    overlay = all_overlays(level, solution, values=True, policy=True)
    turning = _turning_guide(level) if turns or "heading" in level.model_fields_set else None
    return Guide(policy_of(solution), overlay, solution.expected_return, turning)


def _turning_guide(level: Level) -> Guide | None:
    """Return what a page shows of the solution for a robot that turns; None without one."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError
    from babyrobot_levels.render.page_data import Guide
    from babyrobot_levels.render.scene.overlay import Overlay

    try:
        solution = solve(level, actions="turns")
    except UndefinedReturnError:
        return None

    def part(configuration: int | None, heading: int | None) -> Overlay:
        found = solution.at(configuration or 0, SIDES[heading or 0])
        return overlay_of(found, values=True, policy=False)

    policy: list[int] = solution.policy.ravel().tolist()
    return Guide(policy, Overlay(parts=part), solution.expected_return)


def text_picture(level: Level, *, plain: bool = False, configuration: int | None = None) -> str:
    """Return the level for standard output: in Unicode and colour on a terminal, else in ASCII."""
    plain = plain or not takes_pictures()
    if plain and configuration is None:
        return level.draw()
    from babyrobot_levels.render.text import policy_drawing, unicode_drawing

    if plain:
        return policy_drawing(level, level.grid(), None, configuration=configuration, plain=True)
    return unicode_drawing(level, level.grid(), configuration=configuration, color=True)


def takes_pictures() -> bool:
    """Return whether standard output shows Unicode and colour."""
    return wants_color(sys.stdout) and speaks_unicode(sys.stdout)
