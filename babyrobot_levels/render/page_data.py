"""What a page knows about a level: texts, tables, picture, and optimal behaviour.

One mapping that JSON can hold. A page contains that of its own level, a link that of another
one: the page's script plays and paints either, and knows nothing else about levels.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from babyrobot_levels.language.looks import Colors, Theme
from babyrobot_levels.mdp.actions import DELTAS, NUM_ACTIONS, Action
from babyrobot_levels.mdp.events import Event, events_of
from babyrobot_levels.render.page_shapes import Palette, hexadecimal, pack
from babyrobot_levels.render.scene.build import build_layers
from babyrobot_levels.render.scene.layout import CELL, layout_of
from babyrobot_levels.render.scene.overlay import Overlay
from babyrobot_levels.render.scene.pose import STANDING, Mood, Pose, pose_of
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.svg import number

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.mdp.tables import Mdp

MAX_CELLS = 16_384
"""The most cells of a level on a page: 128 by 128."""

LAYERS = {"base": "base", "grid": "grid", "policy": "underlay", "values": "overlay"}
"""The layers of a page's picture and their names in a scene; the robot is not one of them."""

WatchedPolicy = Literal["best", "random"]

_ROBOT_COLORS = ("robot", "puddle")
"""The colours of a theme in the robot's pictures: of its body, and of splashes."""

EVENTS = ("stay", "move", "carried", "bump", "skid", "bounce")
"""The events of a step: warps and wind carry the robot, walls bump it, glass bounces it."""

CHEER = 1
"""The index of the pose at an exit."""

POSES = (
    STANDING,
    Pose(mood=Mood.CHEER),
    *(Pose(action) for action in Action if action is not Action.STAY),
    *(Pose(action, Mood.SLIP) for action in Action),
)
"""All poses after a step; outcomes give their indices. The first one is that of the start."""

PHASES = 4
"""The number of pictures of the robot for a move from cell to cell."""

Row = tuple[float | int, ...]

_NAMES: dict[int, str] = {Event.BUMPED: "bump", Event.SKIDDED: "skid", Event.BOUNCED: "bounce"}
_NUMBERS = {pose: number for number, pose in enumerate(POSES)}


class TooLargeError(ValueError):
    """A level that is too large for a page or a link."""


@dataclass(frozen=True, slots=True)
class Guide:
    """The solution of a level, as far as the page shows it.

    Attributes:
        policy: the optimal action of each state, as `Action`s, `[states]`; -1 where there is none.
        overlay: the values and optimal actions of the cells, which the page can show.
        expected_return: the policy's expected return from the starts; it may be infinite.
    """

    policy: Sequence[int]
    overlay: Overlay
    expected_return: float


def without_panels(level: GridWorld) -> GridWorld:
    """Return the level without the panels and the compass, which a page does not need.

    Raises:
        TooLargeError: the level is too large for a page.
    """
    width, height = level.size
    if width * height > MAX_CELLS:
        raise TooLargeError(
            f"a level of {width} x {height} cells is too large for a page; "
            f"the limit is {MAX_CELLS:,} cells"
        )
    display = {"side_panel": "none", "bottom_panel": "none", "compass": False}
    return level.model_copy(update={"display": level.display.model_copy(update=display)})


def page_data(
    level: GridWorld,
    *,
    guide: Guide | None = None,
    policy: WatchedPolicy = "best",
    seed: int = 0,
    values: bool = False,
    arrows: bool = False,
) -> dict[str, Any]:
    """Return everything that a page needs to show and play a level.

    Args and errors are those of `to_html`.
    """
    level = without_panels(level)
    colors = level.resolved_theme.colors
    return {
        "title": title_of(level),
        "description": (level.description or "").strip(),
        "facts": list(facts(level)),
        **playable(level),
        "robot": [hexadecimal(getattr(colors, name)) for name in _ROBOT_COLORS],
        "picture": _picture(level, guide),
        "seed": str(seed),
        "walker": policy if guide is not None or policy == "random" else None,
        "shown": [name for name, shown in (("policy", arrows), ("values", values)) if shown],
        "policy": list(guide.policy) if guide is not None else None,
        "best": _best(guide),
    }


def common_data() -> dict[str, Any]:
    """Return what is the same for all levels: the robot's pictures, and the meaning of codes."""
    palette = Palette(_ROBOT_COLORS)
    theme = Theme.model_construct(colors=Colors.model_construct(robot="robot", puddle="puddle"))
    sprites = [
        [
            pack(robot_shapes(theme, 0, 0, Pose(pose.facing, pose.mood, phase / PHASES)), palette)
            for phase in range(PHASES)
        ]
        for pose in POSES
    ]
    return {
        "cell": round(CELL),
        "events": EVENTS,
        "cheer": CHEER,
        "phases": PHASES,
        "max_cells": MAX_CELLS,
        "robot": _ROBOT_COLORS,
        "palette": palette.colors,
        "sprites": sprites,
    }


def title_of(level: GridWorld) -> str:
    """Return the heading of a level's page."""
    return level.title or level.name or "Level"


def facts(level: GridWorld) -> Iterator[tuple[str, str]]:
    """Yield the facts about a level, each with its name."""
    width, height = level.size
    values = {
        "Level": level.name,
        "Size": f"{width} × {height}",
        "Author": level.author,
        "Source": level.source,
        "License": level.license,
        "Time limit": f"{level.max_steps} steps" if level.max_steps is not None else None,
        "Digest": level.digest,
    }
    yield from ((name, text) for name, text in values.items() if text)


def _picture(level: GridWorld, guide: Guide | None) -> dict[str, Any]:
    overlay = guide.overlay if guide is not None else None
    layers = build_layers(level, robot=False, overlay=overlay)
    margin, palette = layout_of(level).margin, Palette()
    return {
        "width": round(layers["base"].width),
        "height": round(layers["base"].height),
        "layers": {
            name: pack(layers[layer].shapes, palette, margin) for name, layer in LAYERS.items()
        },
        "palette": palette.colors,
    }


def _best(guide: Guide | None) -> str:
    if guide is None or not math.isfinite(guide.expected_return):
        return ""
    return number(guide.expected_return).replace("-", "\N{MINUS SIGN}")


def playable(level: GridWorld) -> dict[str, Any]:
    """Return what the page's script plays: the tables, and the event and pose of each outcome.

    `rows` are the distinct outcome distributions, and `table` gives the row of each state and
    action (`NUM_ACTIONS * state + action`): -1 for terminal states. A row is one list with six
    numbers for each outcome: probability, next state minus state, reward, terminal, and the
    indices of event and pose. `possible` has a bit for each action. Lengths are those of the
    scene.

    Args:
        level: the level; a maze needs a seed.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    mdp = level.compile()
    events = events_of(mdp)
    rows: dict[Row, int] = {}
    table: list[int] = []
    for state, over in enumerate(mdp.is_terminal.tolist()):
        for action in range(NUM_ACTIONS):
            row = None if over else tuple(_row(mdp, events[state, action].tolist(), state, action))
            table.append(-1 if row is None else rows.setdefault(row, len(rows)))
    return {
        "width": mdp.width,
        "height": mdp.height,
        "margin": _short(layout_of(level).margin),
        "speed": _short(level.display.robot.speed),
        "starts": mdp.start.nonzero()[0].tolist(),
        "exits": [y * mdp.width + x for x, y in level.exits],
        "max_steps": level.max_steps,
        "rows": [list(row) for row in rows],
        "table": table,
        "possible": [
            sum(possible << action for action, possible in enumerate(row))
            for row in mdp.action_mask.tolist()
        ],
    }


def _row(mdp: Mdp, events: list[int], state: int, action: int) -> list[float | int]:
    row: list[float | int] = []
    outcomes = mdp.outcomes(state, action)
    for (probability, next_state, reward, terminal), code in zip(outcomes, events, strict=False):
        event = _NAMES.get(code) or _movement(mdp.width, state, action, next_state)
        pose = pose_of(state, next_state, action, mdp.width, skidded=event == "skid")
        row += [_short(probability), next_state - state, _short(reward), int(terminal)]
        row += [EVENTS.index(event), _NUMBERS[pose]]
    return row


def _movement(width: int, state: int, action: int, next_state: int) -> str:
    """Return how the robot comes where its action leads: by its own move, or carried there."""
    if next_state == state:
        return "stay"
    before_y, before_x = divmod(state, width)
    y, x = divmod(next_state, width)
    is_own_move = DELTAS.get(Action(action)) == (x - before_x, y - before_y)
    return "move" if is_own_move else "carried"


def _short(value: float) -> float | int:
    return int(value) if float(value).is_integer() else value
