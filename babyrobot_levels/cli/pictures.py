"""What `babyrobot preview` makes for files: pictures, films and pages."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from babyrobot_levels.cli.answers import guide_of, overlay_of, policy_of, solution_of
from babyrobot_levels.cli.console import fail, note

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.render.gif import Step
    from babyrobot_levels.render.scene.overlay import Overlay

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
    from babyrobot_levels.render.gif import to_gif

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
            policy="random" if wishes.policy is Walker.RANDOM else "best",
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
    from babyrobot_levels.render.gif import Step

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
