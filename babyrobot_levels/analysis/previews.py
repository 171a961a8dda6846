"""What shows itself in a notebook: a level's facts, pictures, films and pages."""

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.analysis.picture_formats import FORMATS, format_for
from babyrobot_levels.language.metric_names import MAX_SOLVED, NEEDS, PUSHES, SOLVED
from babyrobot_levels.mdp.gridworld import GridWorld, LevelLike, world_of
from babyrobot_levels.registry.later import Shown, later
from babyrobot_levels.text.budget import READ, OverBudgetError, within
from babyrobot_levels.text.words import no_format


@dataclass(frozen=True, eq=False, repr=False)
class Preview(Shown, public=True):
    """A picture, a film or a page of a level; a notebook shows it.

    Attributes:
        level: the level, with the maze that is shown.
        format: `"svg"`, `"pdf"`, `"png"`, `"gif"` or `"html"`.
        data: the contents of the file: a text for SVG and HTML.
        path: the file that it was written to, None for none.
    """

    level: GridWorld
    format: str
    data: str | bytes = field(repr=False)
    path: Path | None = None

    def __repr__(self) -> str:
        return self.level.draw()

    _html = later("babyrobot_levels.analysis.notebooks:preview_html")


def preview(
    level: LevelLike,
    path: str | os.PathLike[str] | None = None,
    *,
    format: str | None = None,  # noqa: A002
    maze_seed: int | None = None,
    **shown: Any,
) -> Preview:
    """Return a picture, a film or a page of a level, as `babyrobot preview` makes it.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        path: a file to write it to; an existing one is replaced.
        format: `"svg"`, `"pdf"`, `"png"`, `"gif"` or `"html"`; by default that of the file's
            suffix, else `"svg"`.
        maze_seed: the seed of the maze of a level with a random maze; by default 0.
        shown: what is shown, and how: the arguments of `level.to_svg` (`values`, `policy`,
            `rules`, `held`, …), `to_gif` or `to_html`, whichever is made.

    Raises:
        LevelNotFoundError: nothing has that name.
        LevelError: the level is not valid, or there is no such theme.
        UndefinedReturnError: the level has no solution that could be shown.
        ValueError: there is no such format, or an argument does not fit the level.
        OSError: the file cannot be written.
    """
    file = None if path is None else Path(path)
    suffix = "" if file is None else file.suffix.lower()
    chosen = format or ("svg" if file is None else format_for(suffix) or suffix.removeprefix("."))
    make = FORMATS[chosen].make if chosen in FORMATS else None
    if make is None:
        told = "; the drawing as text is `level.draw()`" * (chosen in FORMATS)
        known = [name for name, each in FORMATS.own.items() if each.make is not None]
        raise ValueError(no_format(format or suffix.removeprefix("."), known) + told)
    world = world_of(level)
    if maze_seed is not None or world.has_random_maze:
        world = world.with_maze_seed(maze_seed or 0)
    return Preview(world, chosen, make(world, file, **shown), file)


def play(
    level: LevelLike,
    path: str | os.PathLike[str] | None = None,
    *,
    maze_seed: int | None = None,
    **shown: Any,
) -> Preview:
    """Return a page on which a level can be played: in a notebook's cell, or in a browser.

    `babyrobot play` plays in the terminal instead.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        path: a file to write the page to; an existing one is replaced.
        maze_seed: the seed of the maze of a level with a random maze; by default 0.
        shown: the arguments of `level.to_html`: `seed`, `policy`, `values`, `answers`, …

    Errors are those of `preview`.
    """
    return preview(level, path, format="html", maze_seed=maze_seed, **shown)


class Facts(Shown, dict[str, Any], public=True):
    """The facts about a level by name, as plain data; it shows itself as a table."""

    left_out = ""
    """Why there are neither digest nor metrics, if the tables are too large."""

    def lines(self) -> dict[str, str]:
        """Return the facts as texts, those of the metrics among them, without the drawing.

        A metric that a level does not have says why.
        """
        texts = {
            name: text_of(value)
            for name, value in self.items()
            if name not in ("drawing", "metrics")
        }
        for name, value in (self["metrics"] or {}).items():
            texts[name] = self._reasons.get(name) or text_of(value) or "nothing"
        if self.left_out:
            texts |= {name: self.left_out for name in ("digest", "metrics") if self[name] is None}
        if self["metrics"] and "difficulty" not in self["metrics"]:
            pushes = PUSHES if "boxes" in self["metrics"] else ()
            names = (*pushes, *SOLVED, *(NEEDS if "items" in self["metrics"] else ()))
            texts |= dict.fromkeys(names, f"not computed above {MAX_SOLVED:,} states")
        return texts

    def __repr__(self) -> str:
        rows = {name: text for name, text in self.lines().items() if text}
        width = max(map(len, rows)) + 1
        lines = [f"{name + ':':{width}} {text}" for name, text in rows.items()]
        return "\n".join([*lines, *(["", self["drawing"].rstrip()] if self["drawing"] else [])])

    _html = later("babyrobot_levels.analysis.notebooks:facts_html")

    level: GridWorld
    _reasons: Mapping[str, str]
    """Why the level does not have some of the metrics."""


def show(level: LevelLike) -> Facts:
    """Return the facts about a level, as `babyrobot show` does.

    The metrics are those of `brl.metrics`. The ones that need the level to be solved are left out
    above 5,000 states; digest and metrics above 1,048,576 states times outcomes of an action.
    Many levels are measured by `brl.metrics_many`.

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
            "ending": None,
            "drawing": None,
        }
    )
    found.level = world
    if world.has_random_maze:
        return found
    try:
        with within(READ):
            _add_tables(found, world)
    except OverBudgetError as error:
        found.left_out = f"not computed: {error}"
    found["drawing"] = world.draw()
    return found


def _add_tables(found: Facts, level: GridWorld) -> None:
    """Add what the tables of a level say.

    Raises:
        OverBudgetError: it takes too long; what is known is added.
    """
    from babyrobot_levels.analysis.solver.policies import space_of

    mdp = level.compile()
    happens = mdp.probability > 0
    # Of the pairs of configuration and cell, those that an episode reaches.
    reached = ~space_of(level, "all").without_value
    found["outcomes"] = int((happens[reached] if level.has_things else happens).sum())
    # In a step, or at the reset.
    most = int(happens[~mdp.is_terminal].sum(axis=2).max(initial=0))
    found["chance"] = max(most, int((mdp.start > 0).sum())) > 1
    found["digest"] = level.digest
    measured = metrics(level)
    found["states"] = measured.states
    is_solved = measured.states <= MAX_SOLVED
    numbers = measured.to_dict(solve=is_solved)
    found["metrics"] = {name: _number(value) for name, value in numbers.items()}
    found._reasons = {
        name: f"none: {measured.why_none(name)}" for name, value in numbers.items() if value is None
    }
    found["ending"] = measured.ending if is_solved else None


def _number(value: Any) -> Any:
    """Return a metric for JSON: strings for infinities."""
    if isinstance(value, tuple):
        return list(value)
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
