"""What there is to know about a level: texts, numbers, digest, metrics and drawing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.analysis.shown import MAX_SOLVED, WIDTH, Shown, image, level_picture
from babyrobot_levels.mdp.gridworld import LevelLike, world_of

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld


class Facts(Shown, dict[str, Any]):
    """The facts about a level by name, as plain data; it shows itself as a table."""

    __module__ = "babyrobot_levels"

    def lines(self) -> dict[str, str]:
        """Return the facts as texts, those of the metrics among them, without the drawing."""
        facts = {name: value for name, value in self.items() if name != "drawing"}
        facts |= facts.pop("metrics") or {}
        return {name: text_of(value) for name, value in facts.items()}

    def __repr__(self) -> str:
        rows = {name: text for name, text in self.lines().items() if text}
        width = max(map(len, rows)) + 1
        lines = [f"{name + ':':{width}} {text}" for name, text in rows.items()]
        return "\n".join([*lines, *(["", self["drawing"].rstrip()] if self["drawing"] else [])])

    def _html(self) -> str:
        from babyrobot_levels.render.notebook.html import beside, facts

        rows = [(name, text) for name, text in self.lines().items() if text]
        return beside(image(level_picture(self._level, WIDTH)), facts(rows))

    _level: GridWorld


def show(level: LevelLike) -> Facts:
    """Return the facts about a level, as `babyrobot show` does.

    The metrics are those of `brl.metrics`. The ones that need the level to be solved are left out
    above 5,000 states. Many levels are measured by `brl.metrics_many`.

    Args:
        level: a name, a path, a share code, a mapping, or a level.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid.
    """
    world = world_of(level)
    found = Facts(
        {
            "name": world.name,
            "title": world.title,
            "description": world.description.strip() if world.description else None,
            "author": world.author,
            "license": world.license,
            "source": world.source,
            "tags": list(world.tags),
            "size": list(world.size),
            "starts": [list(cell) for cell in world.starts],
            "exits": [list(cell) for cell in world.exits],
            "max_steps": world.max_steps,
            "discount": world.discount,
            "theme": world.theme if isinstance(world.theme, str) else None,
            "random_maze": world.has_random_maze,
            "states": None,
            "outcomes": None,
            "chance": None,
            "digest": None,
            "metrics": None,
            "drawing": None,
        }
    )
    found._level = world
    return found if world.has_random_maze else _with_tables(found, world)


def _with_tables(found: Facts, level: GridWorld) -> Facts:
    """Add what the tables of a level say."""
    from babyrobot_levels.analysis.solver.space import space_of

    mdp = level.compile()
    happens = mdp.probability > 0
    found["states"] = int((~level.grid().blocked).sum())
    found["outcomes"] = int(happens.sum())
    if level.has_things:
        # Of the pairs of configuration and cell, those that an episode reaches.
        reached = ~space_of(level, "all").without_value
        found["states"], found["outcomes"] = int(reached.sum()), int(happens[reached].sum())
    found["chance"] = bool(happens[~mdp.is_terminal].sum(axis=2).max(initial=0) > 1)
    found["digest"] = level.digest
    measured = metrics(level)
    states = mdp.num_states if level.has_things else measured.cells
    numbers = measured.to_dict(solve=states <= MAX_SOLVED)
    found["metrics"] = {name: _number(value) for name, value in numbers.items()}
    found["drawing"] = level.draw()
    return found


def _number(value: Any) -> Any:
    """Return a number for JSON: strings for infinities."""
    if not isinstance(value, float):
        return value
    # Nine digits are the same on every platform; the last ones are not.
    return float(f"{value:.9g}") if math.isfinite(value) else str(value)


def text_of(value: Any) -> str:
    """Return a fact as people read it; empty for one that is not known."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list) and value and isinstance(value[0], list):
        return ", ".join(f"[{x}, {y}]" for x, y in value)
    if isinstance(value, list) and value and isinstance(value[0], int):
        return f"{value[0]} x {value[1]}"
    if isinstance(value, list):
        return ", ".join(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    return "" if value is None else str(value)
