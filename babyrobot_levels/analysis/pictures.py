"""Pictures, films and pages of a level.

The methods of `Level` and the command line make them here, and therefore make the same ones.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, Unpack

from babyrobot_levels.analysis.guides import guide_of, lost_of, overlay_of
from babyrobot_levels.analysis.picture_formats import maker_of
from babyrobot_levels.analysis.picture_options import FilmOptions, PageOptions, StillOptions, takes
from babyrobot_levels.registry.own import own
from babyrobot_levels.text.errors import warn
from babyrobot_levels.text.words import BEST, RANDOM

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.gif import Step
    from babyrobot_levels.render.page import WatchedPolicy
    from babyrobot_levels.render.page_sight import PageSight
    from babyrobot_levels.render.raster import Progress
    from babyrobot_levels.render.scene.layout import Overlay
    from babyrobot_levels.render.scene.shapes import Scene

World = TypeVar("World", bound="GridWorld")
Made = TypeVar("Made", str, bytes)

MAX_STEPS = 500
"""The largest number of steps in a film."""

MAX_SCALE = 100.0
"""The largest scale of a picture."""

NOTHING = "nothing"
"""What is held when nothing is, as a word."""


# -- pictures ------------------------------------------------------------------------------


@takes(StillOptions, lost=False, rules=False)
def to_svg(
    level: GridWorld, path: str | os.PathLike[str] | None = None, **shown: Unpack[StillOptions]
) -> str:
    """Return the level's picture as an SVG document, as `babyrobot preview` makes it.

    With values, actions or counts, the robot is left out, and terminal states show none.

    Args:
        level: the level; a maze needs a seed.
        path: a file to write it to as well, atomically; an existing one is replaced.
        values: what cells show: True for the optimal values, a `Solution`, an `Evaluation` or
            a `Sweep` for theirs, or an array as `show_info` takes it.
        policy: the same for actions; `"best"` means True.
        action_values: the same for the values of actions.
        visits: counts of visits, as `show_info` takes them, or an `Occupancy`; `"best"` and
            `"random"` for the expected visits of the optimal policy and of random actions.
        coordinates: whether cells show their coordinates; by default, what the level says.
        theme: another theme: a name, or a mapping as in a level file.
        held: the names of the things that are held or on, in a list or separated by commas;
            `"nothing"` or an empty list for none. By default, the level is
            shown as a whole, with values and actions where episodes begin.
        lost: whether cells are crossed from which a box can be pushed to no target, even if there
            were no other box and all doors were open. Without boxes and targets there are none.
        rules: whether the rules of the level are shown: in its panel, or below the picture.
        scale: the size; 1, the default, is 64 pixels per cell.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        UndefinedReturnError: the level has no solution that could be shown.
        ValueError: another argument does not fit the level.
    """
    from babyrobot_levels.render.svg import to_svg as paint

    times = _checked(shown.get("scale"))
    return _saved(paint(still(level, **shown), times or 1.0), path, "svg")


@takes(StillOptions, lost=False, rules=False)
def to_pdf(
    level: GridWorld, path: str | os.PathLike[str] | None = None, **shown: Unpack[StillOptions]
) -> bytes:
    """Return the level's picture as a PDF file of one page, as `babyrobot preview` makes it.

    Args and errors are those of `to_svg`; a `scale` of 1 is 48 points per cell.
    """
    from babyrobot_levels.render.pdf import to_pdf as paint

    times = _checked(shown.get("scale"))
    return _saved(paint([still(level, **shown)], times or 1.0), path, "pdf")


@takes(StillOptions, lost=False, rules=False)
def to_png(
    level: GridWorld,
    path: str | os.PathLike[str] | None = None,
    *,
    progress: Progress | None = None,
    **shown: Unpack[StillOptions],
) -> bytes:
    """Return the level's picture as a PNG file, as `babyrobot preview` makes it.

    Args and errors are those of `to_svg`. Without a `scale`, a cell has 64 pixels, and fewer in
    large levels: no side of the picture has more than 4,000. `progress` is called with the number
    of shapes that are painted, and that of all.
    """
    from babyrobot_levels.render.raster import to_png as paint

    times = _checked(shown.get("scale"))
    scene = still(level, **shown)
    size = times and (round(times * scene.width), round(times * scene.height))
    return _saved(paint(scene, size or None, progress=progress), path, "png")


def still(level: GridWorld, **shown: Unpack[StillOptions]) -> Scene:
    """Return a picture of a level, of whatever size; args and errors are those of `to_svg`.

    The robot is left out where it would hide what its cell shows.
    """
    from babyrobot_levels.render.scene.build import build_scene
    from babyrobot_levels.render.scene.layout import Overlay
    from babyrobot_levels.render.scene.shapes import told_as_shapes

    policy, held = shown.get("policy"), shown.get("held")
    if isinstance(policy, str) and policy == RANDOM:
        raise ValueError("a still picture cannot show a random policy")
    level = dressed(level, theme=shown.get("theme"), coordinates=shown.get("coordinates"))
    configuration = None if held is None else configuration_of(level, held)
    kinds = ("values", "policy", "action_values", "visits")
    overlay = overlay_of(level, {kind: shown.get(kind) for kind in kinds})
    if overlay is not None and configuration is None and level.has_things:
        from babyrobot_levels.mdp.states import initial_configuration

        configuration = initial_configuration(level)
    robot = overlay is None and held is None
    if shown.get("lost"):
        overlay = replace((overlay or Overlay()).at(configuration), lost=lost_of(level))
    overlay = _with_rules(overlay) if shown.get("rules") else overlay
    with told_as_shapes():
        return build_scene(level, configuration=configuration, robot=robot, overlay=overlay)


def _with_rules(overlay: Overlay | None) -> Overlay:
    from babyrobot_levels.render.scene.layout import Overlay

    return replace(overlay or Overlay(), rules=True)


def dressed(level: World, *, theme: Any = None, coordinates: bool | None = None) -> World:
    """Return a level with another theme, and with or without coordinates; None changes nothing.

    Raises:
        LevelError: there is no such theme.
    """
    if theme is not None:
        level = level.replace(theme=theme)
    if coordinates is not None and coordinates != level.display.coordinates:
        display = level.display.model_dump(exclude_unset=True)
        level = level.replace(display={**display, "coordinates": coordinates})
    return level


def configuration_of(level: GridWorld, held: str | Iterable[str]) -> int:
    """Return the configuration in which exactly some things are held or on.

    Args:
        level: the level.
        held: their names, in a list or separated by commas; `"nothing"` for none.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: a name is not that of such a thing, or no episode comes to this.
    """
    from babyrobot_levels.mdp.states import configuration_with

    names = held.split(",") if isinstance(held, str) else held
    wanted = [name for name in (part.strip() for part in names) if name]
    return configuration_with(level, () if wanted == [NOTHING] else wanted)


def _checked(scale: float | None) -> float | None:
    if scale is not None and not 0 < scale <= MAX_SCALE:
        raise ValueError(f"scale must be above 0 and at most {MAX_SCALE:g}, not {scale!r}")
    return scale


def _saved(made: Made, path: str | os.PathLike[str] | None, kind: str) -> Made:
    """Write what was made to a file, if one is given, and return it.

    Raises:
        ValueError: the name of the file is that of another kind.
    """
    from babyrobot_levels.text.files import write_bytes

    if path is not None:
        if maker_of(path) not in (None, f"to_{kind}"):
            raise ValueError(f"this makes {kind.upper()}, not {path}: use {maker_of(path)}")
        write_bytes(Path(path), made.encode("utf-8") if isinstance(made, str) else made)
    return made


# -- films ---------------------------------------------------------------------------------


@takes(FilmOptions, policy=BEST, seed=0, rules=False)
def to_gif(
    level: GridWorld,
    path: str | os.PathLike[str] | None = None,
    *,
    progress: Progress | None = None,
    tell: Callable[[str], None] = warn,
    **shown: Unpack[FilmOptions],
) -> bytes:
    """Return an episode as an animated GIF, as `babyrobot preview` makes it.

    It is cut after 500 steps, with a warning.

    Args:
        level: the level; a maze needs a seed.
        path: a file to write it to as well, atomically; an existing one is replaced.
        policy: the policy that is followed: `"best"`, `"random"`, a `Solution`, an array, or
            what else `evaluate` takes, of a robot that does not turn.
        seed: the random seed; it is the same episode as after `env.reset(seed=…)`.
        values: what cells show below the robot; see `to_svg`.
        coordinates: whether cells show their coordinates; by default, what the level says.
        theme: another theme: a name, or a mapping as in a level file.
        rules: whether the rules of the level are shown below the film.
        scale: the size; 1 is 64 pixels per cell. By default it is the largest up to 1 with
            which no side has more than 800 pixels.
        progress: called with the number of frames that are done, and that of all.
        tell: called with a text if the film is cut; by default, this is a warning.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        UndefinedReturnError: the level has no solution that could be followed or shown.
        ValueError: another argument does not fit the level, or the film is too large.
    """
    from babyrobot_levels.render.gif import to_gif as paint

    times = _checked(shown.get("scale"))
    level = dressed(level, theme=shown.get("theme"), coordinates=shown.get("coordinates"))
    steps, ends = episode(level, shown["policy"], shown["seed"])
    if not ends:
        tell(f"the episode does not end within {MAX_STEPS} steps; the GIF shows those")
    overlay = overlay_of(level, {"values": shown.get("values")})
    overlay = _with_rules(overlay) if shown["rules"] else overlay
    return _saved(paint(level, steps, overlay=overlay, scale=times, progress=progress), path, "gif")


def episode(level: GridWorld, policy: Any, seed: int) -> tuple[list[Step], bool]:
    """Return the steps of an episode, at most `MAX_STEPS`, and whether they lead to its end."""
    import numpy as np

    from babyrobot_levels.analysis.environments import make
    from babyrobot_levels.render.gif import Step

    env = make(level, observation="index")
    state, _ = env.reset(seed=seed)
    env.action_space.seed(seed)
    numbering = level.numbering()
    choose = _chooser(level, policy, seed) or (lambda _: env.action_space.sample())
    steps: list[Step] = []
    is_over = False
    while not is_over and len(steps) < MAX_STEPS:
        action = choose(state)
        if level.robots:
            action = numbering.robot_actions(action) if np.ndim(action) == 0 else action
        next_state, reward, terminated, truncated, info = env.step(action)
        # What the film shows of an action is that of the first robot.
        taken = int(np.ravel(action)[0])
        steps.append(Step(int(state), taken, int(next_state), float(reward), info["skidded"]))
        state, is_over = next_state, terminated or truncated
    env.close()
    return steps, is_over


def _chooser(level: GridWorld, policy: Any, seed: int) -> Callable[[int], Any] | None:
    """Return the function that chooses an action in a state; None to draw one at random."""
    if isinstance(policy, str) and policy == RANDOM:
        return None
    import numpy as np

    from babyrobot_levels.analysis.agent_guides import weights_of_moves

    followed = BEST if policy is None or policy is True else policy
    weights, random = weights_of_moves(level, followed), np.random.default_rng(seed)
    return lambda state: int(random.choice(weights.shape[1], p=weights[state]))


# -- pages ---------------------------------------------------------------------------------


@takes(PageOptions, values=False, seed=0, answers=True)
def to_html(
    level: GridWorld,
    path: str | os.PathLike[str] | None = None,
    *,
    tell: Callable[[str], None] = warn,
    **shown: Unpack[PageOptions],
) -> str:
    """Return a page on which the level can be played, as `babyrobot preview` makes it.

    Args:
        level: the level; a maze needs a seed.
        path: a file to write it to as well, atomically; an existing one is replaced.
        values: whether values are shown at first.
        policy: the policy that can be watched, `"best"` or `"random"`. By default it is the
            best one; with `"best"` or True, optimal actions are shown at first. Or an agent: a
            policy as `evaluate` takes it, of a robot that does not turn, such as a `Solution`, a
            `Sweep` of learning, an array, or what `brl.policy_table` returns. The page shows its
            actions and values beside the optimum, where they differ, and what that costs.
        seed: the random seed of the first episode.
        coordinates: whether cells show their coordinates; by default, what the level says.
        theme: another theme: a name, or a mapping as in a level file.
        answers: whether the page knows the solution: values, optimal actions, hints, and how
            good a return is. With False, nothing of it is in the page, and of an agent only its
            actions.
        previous_page: the address of the page of another level, as its file's name beside this
            page: the page leads back to it.
        next_page: the same for the level that follows; the result of a good end leads there, too.
            Pages with either keep what is reached, in the browser.
        learn: whether algorithms can learn the level on the page, by which it also finds the
            solution; by default, if it has answers.
        sight: what one sees who plays, such as `"view"`, an observation of environments: the rest
            is in fog. The page knows no solution then, but what can be believed, and how the best
            agent with this sight acts; with `answers=False`, what can be seen alone.
        view_radius: of the sight `"view"`, how many cells it shows in each direction.
        tell: called with a text if there is no solution that the page could show, and none is
            asked for; by default, this is a warning.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        UndefinedReturnError: the level has no solution that could be shown.
        ValueError: the level is too large for a page, the policy is none for it, or answers are
            to be shown without answers.
    """
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError
    from babyrobot_levels.render.page import to_html as paint
    from babyrobot_levels.render.page import without_panels

    policy, values = shown.get("policy"), shown["values"]
    is_named = policy is None or isinstance(policy, bool)
    is_named = is_named or (isinstance(policy, str) and policy in (BEST, RANDOM))
    level = dressed(level, theme=shown.get("theme"), coordinates=shown.get("coordinates"))
    # A level that is too large is refused before it is solved.
    without_panels(level)
    arrows = is_named and (policy is True or policy == BEST)
    if not shown["answers"] and (values or arrows):
        raise ValueError("a page without answers shows neither values nor optimal actions")
    seen = _page_sight(level, shown)
    solution, guide, agent = None, None, None
    try:
        if shown["answers"] and seen is None:
            solution = solve(level)
            guide = guide_of(level, solution)
    except UndefinedReturnError as error:
        if values or arrows:
            raise
        tell(f"the page shows no optimal moves: {error}")
    watched: WatchedPolicy = "random" if is_named and policy == RANDOM else "best"
    if not is_named:
        from babyrobot_levels.analysis.agent_guides import page_agent

        best = None if guide is None else guide.expected_return
        agent = page_agent(level, policy, solution, best)
        watched, arrows = "agent", True
    page = paint(
        level,
        guide=guide,
        agent=agent,
        policy=watched,
        seed=shown["seed"],
        values=values,
        arrows=arrows,
        previous_page=page_address("previous_page", shown.get("previous_page")),
        next_page=page_address("next_page", shown.get("next_page")),
        learn=shown.get("learn"),
        sight=seen,
    )
    return _saved(page, path, "html")


def _page_sight(level: GridWorld, shown: PageOptions) -> PageSight | None:
    """Return the sight through which a page is played, if it is; None for full sight."""
    sight, radius = shown.get("sight"), shown.get("view_radius")
    if sight is None:
        if radius is not None:
            raise ValueError("view_radius is for a sight: give sight='view'")
        return None
    for name in ("values", "policy", "learn"):
        if shown.get(name):
            raise ValueError(f"{name} is of one who sees everything: leave it or the sight out")
    options = {} if radius is None else {"view_radius": radius}
    found: PageSight = own("page_sight")(level, sight, has_agent=shown["answers"], **options)
    return found


def page_address(name: str, given: str | None) -> str | None:
    """Return an address that a page leads to.

    Raises:
        ValueError: it is none of a page, but of a script, for example.
    """
    scheme = re.match(r"\s*([^/?#:]*):", given or "")
    if scheme and scheme[1].lower() not in ("http", "https", "file"):
        raise ValueError(
            f"{name} must be the address of a page, such as ../index.html, not {given}"
        )
    return given


class Pictured:
    """The pictures of a level as its methods, for type checkers; see `library.level.Offered`."""

    to_svg = to_svg
    to_pdf = to_pdf
    to_png = to_png
    to_gif = to_gif
    to_html = to_html
