"""The files of a level in a gallery: its page, its text, its pictures and its film."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from babyrobot_levels.analysis import pictures
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.publish.facts import Facts, Files, facts_of, measured
from babyrobot_levels.publish.level_page import level_html
from babyrobot_levels.publish.level_values import values_svg
from babyrobot_levels.render.page_data import bare
from babyrobot_levels.render.raster import reduced, to_png
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.text.source import with_schema

if TYPE_CHECKING:
    from babyrobot_levels.analysis.solver.results import Solution
    from babyrobot_levels.render.scene.shapes import Scene

MAZE_SEED = 0
"""The seed of the maze that is shown of a level whose maze is random."""

MAX_SIDE = 1600
"""The largest width and height of a picture in pixels."""

TILE_SIDE = 400
"""The largest width and height of a picture on the wall in pixels."""

FILM_SIDE = 280
"""The largest width and height of a film in pixels."""

MAX_FILM_STEPS = 150
"""Episodes of more steps have no film."""


@dataclass(frozen=True, slots=True)
class GalleryPages:
    """What the pages of a gallery show.

    Attributes:
        title: the title of the gallery.
        answers: whether it knows the answers.
        key: whether it is the teacher's copy, which shows the answers from the start.
    """

    title: str
    answers: bool
    key: bool


def write_level(level: Level, folder: Path, *, name: str, split: str, shown: GalleryPages) -> Facts:
    """Write the files of a level, and return its facts.

    Args:
        level: the level.
        folder: the folder of the gallery.
        name: the name of the level's own folder in it.
        split: the split of the suite that the level belongs to; may be empty.
        shown: what the pages show.
    """
    own = folder / name
    own.mkdir()
    # Comments may tell what the level is worth.
    text = with_schema(level.to_yaml(comments=shown.answers))
    is_random = level.has_random_maze
    level = level.with_maze_seed(MAZE_SEED) if is_random else level
    found = measured(level) if shown.answers else None
    solution = found.solution if found is not None else None
    # In a small picture, the texts of panels cannot be read.
    plain = bare(level)
    film = _film(plain, solution, shown) if solution is not None else None
    files = Files(
        page=f"{name}/index.html",
        level=f"{name}/level.yaml",
        svg=f"{name}/picture.svg",
        png=f"{name}/picture.png",
        tile=f"{name}/tile.png",
        film=f"{name}/film.gif" if film is not None else None,
        values=f"{name}/values.svg" if solution is not None else None,
    )
    facts = facts_of(
        level,
        name,
        files,
        split=split,
        metrics=found,
        maze_seed=MAZE_SEED if is_random else None,
    )
    guide = guide_of(level, solution) if solution is not None else None
    over = solution if shown.key else None
    scene = pictures.still(level, values=over, policy=over)
    png = _png(scene)
    has_panels = plain.display != level.display
    small = _png(pictures.still(plain, values=over, policy=over)) if has_panels else png
    made = {
        files.level: text,
        files.svg: to_svg(scene),
        files.png: png,
        files.tile: reduced(small, TILE_SIDE),
        files.film: film,
        files.values: values_svg(level, guide) if guide is not None else None,
    }
    written = {
        path: data.encode("utf-8") if isinstance(data, str) else data
        for path, data in made.items()
        if path is not None and data is not None
    }
    page = level_html(
        level,
        facts,
        text=text,
        guide=guide,
        answers=shown.answers,
        key=shown.key,
        title=shown.title,
        sizes={path: len(data) for path, data in written.items()},
    )
    for path, data in {**written, files.page: page.encode("utf-8")}.items():
        (folder / path).write_bytes(data)
    return facts


def _png(scene: Scene) -> bytes:
    scale = min(1.0, MAX_SIDE / max(scene.width, scene.height))
    return to_png(scene, (round(scale * scene.width), round(scale * scene.height)))


def _film(level: Level, solution: Solution, shown: GalleryPages) -> bytes | None:
    """Return an episode of the optimal policy as a film; None if it is too long, or too large."""
    if not solution.expected_steps <= MAX_FILM_STEPS:
        return None
    with suppress(ValueError):
        side = CELL * max(level.size)
        return pictures.to_gif(
            level,
            policy=solution,
            values=solution if shown.key else None,
            scale=min(1.0, FILM_SIDE / side),
            tell=lambda _: None,
        )
    return None
