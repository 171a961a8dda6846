"""`babyrobot preview`: a level as a picture, in the terminal or in a file."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.answers import (
    WIDEST,
    overlay_of,
    policy_text,
    solution_of,
    values_text,
)
from babyrobot_levels.cli.console import fail, note, save, speaks_unicode, wants_color, write

if TYPE_CHECKING:
    from babyrobot_levels.level import Level


class PictureFormat(StrEnum):
    """What a picture is made of."""

    TEXT = "text"
    ASCII = "ascii"
    SVG = "svg"
    PNG = "png"


LevelArgument = Annotated[
    str, typer.Argument(metavar="LEVEL", help="A name, pack/name, or the path of a file.")
]

_SUFFIXES = {".txt": "ascii", ".svg": "svg", ".png": "png"}


def preview(
    level: LevelArgument,
    picture_format: Annotated[
        PictureFormat | None,
        typer.Option(
            "--format",
            help="What to make: `text` in colour on a terminal, elsewhere the same as `ascii`, "
            "the drawing that a `map` may hold.  [default: by the file's suffix, else text]",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Write to a file.", show_default=False),
    ] = None,
    theme: Annotated[
        str | None,
        typer.Option(metavar="THEME", help="Show it in another theme.", show_default=False),
    ] = None,
    coordinates: Annotated[
        bool, typer.Option("--coordinates", help="Write each cell's coordinates into it.")
    ] = False,
    values: Annotated[
        bool, typer.Option("--values", help="Write into each cell what it is worth at best.")
    ] = False,
    policy: Annotated[
        bool, typer.Option("--policy", help="Show where the best actions lead from each cell.")
    ] = False,
    maze_seed: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Of a level with random mazes, show the one of this seed.  [default: 0]",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file.")] = False,
) -> None:
    """Show a level.

    Examples:

      babyrobot preview final-maze

      babyrobot preview levels/first.yaml -o first.png

      babyrobot preview frozen-lake --values --policy -o answers.svg
    """
    chosen = _chosen_format(picture_format, output)
    shown = _prepared(load_level(level), theme, coordinates, maze_seed)
    if chosen in (PictureFormat.TEXT, PictureFormat.ASCII):
        plain = chosen is PictureFormat.ASCII or output is not None
        picture: str | bytes = _text(shown, values=values, policy=policy, plain=plain)
        if coordinates:
            note("--coordinates is for pictures (svg, png); a text has no room for them")
    else:
        picture = _painted(shown, chosen, values=values, policy=policy)
    if output is not None:
        save(output, picture, force=force)
    elif isinstance(picture, str):
        write(picture)
    elif sys.stdout.isatty():
        fail("a PNG cannot be shown in a terminal", "name a file with -o FILE")
    else:
        sys.stdout.buffer.write(picture)


def load_level(text: str) -> Level:
    """Return the level that an argument names."""
    from babyrobot_levels.catalogue import load
    from babyrobot_levels.errors import LevelNotFoundError

    if "\n" in text:
        raise LevelNotFoundError(text)
    return load(text)


def _chosen_format(picture_format: PictureFormat | None, output: Path | None) -> PictureFormat:
    if picture_format is not None:
        return picture_format
    if output is None:
        return PictureFormat.TEXT
    suffix = output.suffix.lower()
    if suffix not in _SUFFIXES:
        fail(
            f"the file's suffix {suffix or '(none)'} does not tell what to make",
            f"use one of {', '.join(_SUFFIXES)}, or say it with --format",
        )
    return PictureFormat(_SUFFIXES[suffix])


def _prepared(level: Level, theme: str | None, coordinates: bool, maze_seed: int | None) -> Level:
    """Return the level as it is to be shown."""
    from babyrobot_levels.errors import LevelError

    if theme is not None:
        try:
            level = level.replace(theme=theme)
        except LevelError as error:
            found = error.diagnostics[0]
            fail(found.message, found.help)
    if coordinates:
        display = level.display.model_dump(exclude_unset=True)
        level = level.replace(display={**display, "coordinates": True})
    if level.has_random_maze:
        if maze_seed is None:
            note("each reset grows another maze; this is the one of seed 0 (see --maze-seed)")
        level = level.with_maze_seed(maze_seed or 0)
    elif maze_seed is not None:
        fail("the level's maze is not random", "--maze-seed is for `maze: {seed: random}`")
    return level


def _text(level: Level, *, values: bool, policy: bool, plain: bool) -> str:
    if not (values or policy):
        return text_picture(level, plain=plain)
    solution = solution_of(level)
    plain = plain or not _takes_pictures()
    text = policy_text(level, solution, plain=plain) if policy else text_picture(level, plain=plain)
    if values and level.size[0] > WIDEST:
        note(f"the values of more than {WIDEST} columns are left to pictures (svg, png)")
    elif values:
        text += "\n" + values_text(solution)
    return text


def text_picture(level: Level, *, plain: bool = False) -> str:
    """Return the level for standard output: in Unicode and colour on a terminal, else in ASCII."""
    if plain or not _takes_pictures():
        return level.draw()
    from babyrobot_levels.render.text import unicode_drawing

    return unicode_drawing(level, level.grid(), color=True)


def _takes_pictures() -> bool:
    return wants_color(sys.stdout) and speaks_unicode(sys.stdout)


def _painted(level: Level, chosen: PictureFormat, *, values: bool, policy: bool) -> str | bytes:
    from babyrobot_levels.scene.build import build_scene

    if values or policy:
        overlay = overlay_of(solution_of(level), values=values, policy=policy)
        # The robot would only hide what his cell says.
        scene = build_scene(level, robot=False, overlay=overlay)
    else:
        scene = build_scene(level)
    if chosen is PictureFormat.SVG:
        from babyrobot_levels.render.svg import to_svg

        return to_svg(scene)
    from babyrobot_levels.render.raster import to_png

    return to_png(scene)
