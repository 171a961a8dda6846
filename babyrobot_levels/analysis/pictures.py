"""Pictures, films and pages of a level, and what they show of a solution.

The methods of `Level` and the command line make them here, and therefore make the same ones.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.gif import Step
    from babyrobot_levels.render.page_data import Guide, WatchedPolicy
    from babyrobot_levels.render.raster import Progress
    from babyrobot_levels.render.scene.overlay import Overlay
    from babyrobot_levels.render.scene.shapes import Scene

World = TypeVar("World", bound="GridWorld")

MAX_STEPS = 500
"""The largest number of steps in a film."""

MAX_SCALE = 100.0
"""The largest scale of a picture."""

BEST, RANDOM = "best", "random"
"""The policies that have names."""

NOTHING = "nothing"
"""What is held when nothing is, as a word."""


def _warn(text: str) -> None:
    # The caller is the user of a method of `Level`.
    warnings.warn(text, stacklevel=4)


# -- pictures ------------------------------------------------------------------------------


def to_svg(level: GridWorld, *, scale: float | None = None, **shown: Any) -> str:
    """Return a picture as an SVG document.

    Args:
        level: the level; a maze needs a seed.
        scale: the size, where 1 is 64 pixels per cell; None for 1.
        shown: what is shown, and how; see `still`.

    Raises:
        UndefinedReturnError: a solution is asked for, and the level has none.
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        ValueError: what is shown does not fit the level.
    """
    from babyrobot_levels.render.svg import to_svg as paint

    times = _checked(scale)
    return paint(still(level, **shown), times or 1.0)


def to_pdf(level: GridWorld, *, scale: float | None = None, **shown: Any) -> bytes:
    """Return a picture as a PDF file; args and errors are those of `to_svg`."""
    from babyrobot_levels.render.pdf import to_pdf as paint

    times = _checked(scale)
    return paint([still(level, **shown)], times or 1.0)


def to_png(
    level: GridWorld, *, scale: float | None = None, progress: Progress | None = None, **shown: Any
) -> bytes:
    """Return a picture as a PNG file.

    Args:
        level: the level; a maze needs a seed.
        scale: the size, where 1 is 64 pixels per cell; None for the largest up to 1 with which no
            side has more than 4,000 pixels.
        progress: told of the shapes that are painted.
        shown: what is shown, and how; see `still`.

    Raises:
        UndefinedReturnError: a solution is asked for, and the level has none.
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        ValueError: what is shown does not fit the level, or the picture is too large.
    """
    from babyrobot_levels.render.raster import to_png as paint

    times = _checked(scale)
    scene = still(level, **shown)
    size = times and (round(times * scene.width), round(times * scene.height))
    return paint(scene, size or None, progress=progress)


def still(
    level: GridWorld,
    *,
    values: Any = None,
    policy: Any = None,
    action_values: Any = None,
    visits: Any = None,
    coordinates: bool | None = None,
    theme: Any = None,
    held: str | Iterable[str] | None = None,
    rules: bool = False,
) -> Scene:
    """Return a picture of a level.

    The robot is left out where it would hide what its cell shows.

    Args:
        level: the level; a maze needs a seed.
        values: values of cells: True for the optimal ones, a result such as a `Solution` or a
            `Sweep`, or what `show_info` takes. None and False show none; so do terminal states.
        policy: actions, likewise; `"best"` is the same as True.
        action_values: values of actions, likewise.
        visits: counts of visits, as `show_info` takes them.
        coordinates: whether cells show their coordinates; None for what the level says.
        theme: another theme: a name, or a mapping as in a level.
        held: the names of the items that are held and the switches that are on, in a list or
            separated by commas; `"nothing"` for none. None shows the level as a whole, and a
            solution where episodes begin.
        rules: whether the rules of the level are shown: in its panel, or below the picture.

    Raises:
        UndefinedReturnError: a solution is asked for, and the level has none.
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        ValueError: what is shown does not fit the level.
    """
    from babyrobot_levels.render.scene.build import build_scene

    if isinstance(policy, str) and policy == RANDOM:
        raise ValueError("a still picture cannot show a random policy")
    level = dressed(level, theme=theme, coordinates=coordinates)
    configuration = None if held is None else configuration_of(level, held)
    info = {"values": values, "policy": policy, "action_values": action_values, "visits": visits}
    overlay = overlay_of(level, info)
    if overlay is not None and configuration is None and level.has_things:
        from babyrobot_levels.mdp.states import initial_configuration

        configuration = initial_configuration(level)
    robot = overlay is None and held is None
    overlay = _with_rules(overlay) if rules else overlay
    return build_scene(level, configuration=configuration, robot=robot, overlay=overlay)


def _with_rules(overlay: Overlay | None) -> Overlay:
    from babyrobot_levels.render.scene.overlay import Overlay

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
    """Return the configuration in which exactly some items are held and switches are on.

    Args:
        level: the level.
        held: their names, in a list or separated by commas; `"nothing"` for none.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
        ValueError: a name is not that of an item or switch, or no episode comes to this.
    """
    from babyrobot_levels.mdp.states import configuration_with

    names = held.split(",") if isinstance(held, str) else held
    wanted = [name for name in (part.strip() for part in names) if name]
    return configuration_with(level, () if wanted == [NOTHING] else wanted)


def _checked(scale: float | None) -> float | None:
    if scale is not None and not 0 < scale <= MAX_SCALE:
        raise ValueError(f"scale must be above 0 and at most {MAX_SCALE:g}, not {scale!r}")
    return scale


# -- what is shown of a solution -----------------------------------------------------------


def overlay_of(level: GridWorld, info: Mapping[str, Any]) -> Overlay | None:
    """Return what a picture shows over the cells.

    Args:
        level: the level.
        info: as for `show_info`; True, and "best" for a policy, stand for the level's solution,
            and what is None or False is not shown.

    Raises:
        UndefinedReturnError: a solution is asked for, and the level has none.
        ValueError: an array does not fit the level.
    """
    from babyrobot_levels.analysis.shown import overlay_given

    given = {key: value for key, value in info.items() if value is not None and value is not False}
    if not given:
        return None
    asked = [key for key, value in given.items() if _asks(key, value)]
    if asked:
        from babyrobot_levels.analysis.solver.optimum import solve

        given |= dict.fromkeys(asked, solve(level))
    return overlay_given(level, given)


def _asks(key: str, value: Any) -> bool:
    """Return whether the level is to be solved for something that is shown."""
    if key == "policy" and isinstance(value, str) and value != BEST:
        raise ValueError(f"a policy given by name is {BEST!r}, not {value!r}")
    return key != "visits" and (value is True or (key == "policy" and isinstance(value, str)))


def policy_of(solution: Solution) -> list[int]:
    """Return the optimal action of each state, as an `Action`; -1 for terminal states."""
    actions: list[int] = (
        (solution.policy + solution.first_action * (solution.policy >= 0)).ravel().tolist()
    )
    return actions


# -- films ---------------------------------------------------------------------------------


def to_gif(
    level: GridWorld,
    *,
    policy: Any = BEST,
    seed: int = 0,
    values: Any = None,
    coordinates: bool | None = None,
    theme: Any = None,
    rules: bool = False,
    scale: float | None = None,
    progress: Progress | None = None,
    tell: Callable[[str], None] = _warn,
) -> bytes:
    """Return an episode as an animated GIF.

    Args:
        level: the level; a maze needs a seed.
        policy: the policy that is followed: `"best"` (None and True are the same), `"random"`, or
            whatever `evaluate` takes, of a robot that does not turn.
        seed: the random seed; it is the same episode as after `env.reset(seed=…)`.
        values: values below the robot, as in `still`.
        coordinates: whether cells show their coordinates; None for what the level says.
        theme: another theme.
        rules: whether the rules of the level are shown, as in `still`.
        scale: the size, where 1 is 64 pixels per cell; None for the largest up to 1 with which no
            side has more than 800 pixels.
        progress: told of the frames that are done.
        tell: told if the episode is longer than the film. By default this is a warning.

    Raises:
        UndefinedReturnError: a solution is asked for, and the level has none.
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        ValueError: what is shown does not fit the level, or the film is too large.
    """
    from babyrobot_levels.render.gif import to_gif as paint

    times = _checked(scale)
    level = dressed(level, theme=theme, coordinates=coordinates)
    steps, ends = episode(level, policy, seed)
    if not ends:
        tell(f"the episode does not end within {MAX_STEPS} steps; the GIF shows those")
    overlay = overlay_of(level, {"values": values})
    overlay = _with_rules(overlay) if rules else overlay
    return paint(level, steps, overlay=overlay, scale=times, progress=progress)


def episode(level: GridWorld, policy: Any, seed: int) -> tuple[list[Step], bool]:
    """Return the steps of an episode, at most `MAX_STEPS`, and whether they lead to its end."""
    from babyrobot_levels.analysis.environments import make
    from babyrobot_levels.render.gif import Step

    env = make(level, observation="index")
    state, _ = env.reset(seed=seed)
    env.action_space.seed(seed)
    choose = _chooser(level, policy, seed) or (lambda _: int(env.action_space.sample()))
    steps: list[Step] = []
    is_over = False
    while not is_over and len(steps) < MAX_STEPS:
        action = choose(state)
        next_state, reward, terminated, truncated, info = env.step(action)
        steps.append(Step(int(state), action, int(next_state), float(reward), info["skidded"]))
        state, is_over = next_state, terminated or truncated
    env.close()
    return steps, is_over


def _chooser(level: GridWorld, policy: Any, seed: int) -> Callable[[int], int] | None:
    """Return the function that chooses an action in a state; None to draw one at random."""
    from babyrobot_levels.analysis.solver.results import TURNS

    if isinstance(policy, str) and policy == RANDOM:
        return None
    if policy is None or policy is True or (isinstance(policy, str) and policy == BEST):
        from babyrobot_levels.analysis.solver.optimum import solve

        return policy_of(solve(level)).__getitem__
    import numpy as np

    from babyrobot_levels.analysis.solver.policies import read_policy
    from babyrobot_levels.mdp.actions import NUM_ACTIONS, NUM_MOVES

    if getattr(policy, "actions", None) == TURNS:
        raise ValueError("a film cannot show a robot that turns; give a policy of moves")
    mdp, shape = level.compile(), np.shape(getattr(policy, "policy", policy))
    is_of_moves = len(shape) > len(mdp.shape) and shape[-1] == NUM_MOVES
    weights = read_policy(policy, mdp, "moves" if is_of_moves else "all", level.things())
    random, first = np.random.default_rng(seed), NUM_ACTIONS - weights.shape[1]
    return lambda state: first + int(random.choice(weights.shape[1], p=weights[state]))


# -- pages ---------------------------------------------------------------------------------


def to_html(
    level: GridWorld,
    *,
    values: bool = False,
    policy: str | bool | None = None,
    seed: int = 0,
    coordinates: bool | None = None,
    theme: Any = None,
    answers: bool = True,
    tell: Callable[[str], None] = _warn,
) -> str:
    """Return a page on which the level can be played.

    Args:
        level: the level; a maze needs a seed.
        values: whether optimal values are shown at first.
        policy: the policy that can be watched, `"best"` or `"random"`; `"best"` or True shows
            optimal actions at first.
        seed: the random seed of the first episode.
        coordinates: whether cells show their coordinates; None for what the level says.
        theme: another theme.
        answers: whether the page knows the level's solution: values, optimal actions, hints, and
            what returns are good.
        tell: told if the level has no solution that the page could show, where none is asked for.
            By default this is a warning.

    Raises:
        UndefinedReturnError: a solution is asked for, and the level has none.
        LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
        ValueError: the level is too large for a page, or answers are shown without answers.
    """
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError
    from babyrobot_levels.render.page import to_html as paint
    from babyrobot_levels.render.page_data import without_panels

    is_known = policy is None or isinstance(policy, bool) or policy in (BEST, RANDOM)
    if not is_known:
        raise ValueError(f"the policy of a page is {BEST!r} or {RANDOM!r}, not {policy!r}")
    level = dressed(level, theme=theme, coordinates=coordinates)
    # A level that is too large is refused before it is solved.
    without_panels(level)
    arrows = policy is True or policy == BEST
    if not answers and (values or arrows):
        raise ValueError("a page without answers shows neither values nor optimal actions")
    guide = None
    try:
        guide = guide_of(level) if answers else None
    except UndefinedReturnError as error:
        if values or arrows:
            raise
        tell(f"the page shows no optimal moves: {error}")
    watched: WatchedPolicy = "random" if policy == RANDOM else "best"
    return paint(level, guide=guide, policy=watched, seed=seed, values=values, arrows=arrows)


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
    turning = _turning_guide(level) if turns or "heading" in level.model_fields_set else None
    return replace(solution_guide(level, solution), turning=turning, **_luck(level, solution))


def solution_guide(level: GridWorld, solution: Solution) -> Guide:
    """Return what a page shows of a solution but for what it tells of luck, which takes longer.

    Args:
        level: the level.
        solution: its solution, for a robot that moves.
    """
    from babyrobot_levels.render.page_data import Guide

    overlay = overlay_of(level, {"values": solution, "policy": solution})
    assert overlay is not None
    return Guide(policy_of(solution), overlay, best_average(level, solution))


def _turning_guide(level: GridWorld) -> Guide | None:
    """Return what a page shows of the solution for a robot that turns; None without one."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import TURNS, UndefinedReturnError
    from babyrobot_levels.render.page_data import Guide

    try:
        solution = solve(level, actions=TURNS)
    except UndefinedReturnError:
        return None
    overlay = overlay_of(level, {"values": solution})
    assert overlay is not None
    policy: list[int] = solution.policy.ravel().tolist()
    guide = Guide(policy, overlay, best_average(level, solution))
    return replace(guide, **_luck(level, solution))


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


def _random_within(level: GridWorld, actions: str) -> float:
    """Return the expected return of random actions within the time limit that the level has."""
    from babyrobot_levels.analysis.solver.chain import weights_of
    from babyrobot_levels.analysis.solver.many import worth_within
    from babyrobot_levels.analysis.solver.space import space_of

    assert level.max_steps is not None
    space = space_of(level, actions)
    weights = weights_of(RANDOM, space)
    found = worth_within([space], [level.max_steps], [level.discount], [weights], quick=True)
    return float(found.returns[0])


def _luck(level: GridWorld, solution: Solution) -> dict[str, Any]:
    """Return what a page compares a return with, within the level's time limit.

    These are quantiles of the optimal policy's return, and the expected return of random actions.
    """
    import numpy as np

    from babyrobot_levels.analysis.solver.distribution import distribution_of
    from babyrobot_levels.analysis.solver.evaluation import MAX_STEPS as FOLLOWED
    from babyrobot_levels.analysis.solver.space import space_of

    actions, limit = solution.actions, level.max_steps or FOLLOWED
    luck: dict[str, Any] = {"random_return": random_return(level, actions)}
    with suppress(ArithmeticError):
        # Each stands for one in a hundred episodes.
        found = distribution_of(
            space_of(level, actions), solution, level.discount, limit, quick=True
        )
        quantiles = found.quantiles((np.arange(100) + 0.5) / 100)
        alike = np.unique(quantiles).size == 1
        luck["quantiles"] = quantiles[: 1 if alike else None].tolist()
    return luck


def random_return(level: GridWorld, actions: str = "all") -> float | None:
    """Return the expected return of random actions, within the level's time limit.

    It is None where that is undefined, or takes too long to be computed exactly.
    """
    from babyrobot_levels.analysis.solver.evaluation import evaluation_of

    with suppress(ArithmeticError):
        if level.max_steps is not None:
            return _random_within(level, actions)
        return evaluation_of(level, RANDOM, actions=actions).expected_return
    return None
