"""What results show beside their numbers: a picture of the level, with arrays over its states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.render.notebook.html import Picture
    from babyrobot_levels.render.scene.layout import Overlay, Rows

WIDTH = 480.0
"""The most width of a picture beside a table."""


def overlay_given(level: GridWorld, given: Mapping[str, Any]) -> Overlay:
    """Return what a picture shows over the cells, of results and arrays as `show_info` takes them.

    Raises:
        ValueError: an array does not fit the level.
    """
    from babyrobot_levels.render.scene.info import overlay_from

    return overlay_from({key: _going_on(level, key, value) for key, value in given.items()}, level)


def actions_shown(solution: Any, configuration: int | None) -> Rows[tuple[int, ...]]:
    """Return the optimal action of each cell, the first one of several, as overlays have it."""
    policy, first = solution.at(configuration or 0).policy, solution.first_action
    if solution.level is not None and solution.level.robots:
        # Pictures show the actions of the first robot.
        policy = solution.level.compile().robot_actions(policy)[..., 0]
    return [[(action + first,) if action >= 0 else () for action in row] for row in policy.tolist()]


def _going_on(level: GridWorld, key: str, given: Any) -> Any:
    """Return values of states or actions without those of configurations in which all is over.

    Pictures leave them out where no episode can go on in any configuration.
    """
    import numpy as np

    table = getattr(given, key, given)
    if not (level.has_things and key in ("values", "action_values") and hasattr(table, "ndim")):
        return given

    mdp = level.compile()
    axes = table.ndim - (key == "action_values")
    if (*table.shape[:1], *table.shape[axes - 2 : axes]) != mdp.shape or axes not in (3, 4):
        return given
    over = mdp.is_terminal.reshape(mdp.shape)
    # Of a robot that turns, there is an axis of headings before height.
    over = over[:, np.newaxis] if axes == 4 else over
    return np.where(over[..., np.newaxis] if key == "action_values" else over, np.nan, table)


def state_picture(result: Any, extent: tuple[float, float] | None = None) -> Picture | None:
    """Return the picture of a result with arrays over states, None if there can be none.

    Args:
        result: the result.
        extent: the lowest and highest value of all pictures that are to have the same colours.
    """
    from babyrobot_levels.mdp.states import initial_configuration
    from babyrobot_levels.render.notebook.html import is_too_large, picture_of
    from babyrobot_levels.render.page import bare
    from babyrobot_levels.render.scene.build import build_scene

    level: GridWorld | None = getattr(result, "level", None)
    if level is None or is_too_large(level):
        return None
    kinds = [kind for kind in ("values", "policy", "visits") if hasattr(result, kind)]
    given = dict.fromkeys(kinds, result)
    try:
        overlay = overlay_given(level, given)
    except ValueError:
        # The part of one configuration, but of all headings, fits no picture.
        return None
    configuration = initial_configuration(level) if level.has_things else None
    if extent is not None:
        overlay = replace(overlay.at(configuration), extent=extent)
    scene = build_scene(bare(level), configuration=configuration, robot=False, overlay=overlay)
    return picture_of(scene)


def extent_of(results: Sequence[Any]) -> tuple[float, float] | None:
    """Return the lowest and highest value of some results, without ends; None without any."""
    import numpy as np

    tables = []
    for values, policy in ((each.values, getattr(each, "policy", None)) for each in results):
        tables.append(values[np.isfinite(values) & (True if policy is None else policy >= 0)])
    found = np.concatenate(tables) if tables else np.zeros(0)
    return (float(found.min()), float(found.max())) if found.size else None


def level_picture(level: GridWorld, width: float, *, small: bool = False) -> Picture | None:
    """Return a picture of a level, or a thumbnail; None if the level is too large."""
    from babyrobot_levels.render.notebook.html import is_too_large, picture_of, thumbnail_of
    from babyrobot_levels.render.page import bare
    from babyrobot_levels.render.scene.build import build_scene

    if is_too_large(level):
        return None
    if level.has_random_maze:
        level = level.with_maze_seed(0)
    scene = build_scene(bare(level))
    return thumbnail_of(scene, width) if small else picture_of(scene, width)


def image(picture: Picture | None) -> str:
    """Return a picture as HTML; an empty text without one."""
    return "" if picture is None else picture.html()
