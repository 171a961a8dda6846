"""`babyrobot preview`: a level in the terminal, as a picture, as a film, or as a page to play."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

from babyrobot_levels.cli.console import (
    ForceOption,
    OutputOption,
    fail,
    note,
    save,
    write,
)
from babyrobot_levels.cli.inputs import LevelArgument, load_level
from babyrobot_levels.cli.pictures import (
    MAX_SCALE,
    Walker,
    Wishes,
    film,
    page,
    picture,
    policy_text,
    solution_of,
    takes_pictures,
    text_picture,
    values_text,
)
from babyrobot_levels.render.numbers import WIDEST

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level


class PictureFormat(StrEnum):
    """What a picture is made of."""

    TEXT = "text"
    ASCII = "ascii"
    SVG = "svg"
    PNG = "png"
    GIF = "gif"
    HTML = "html"


_SUFFIXES = {
    ".txt": "ascii",
    ".svg": "svg",
    ".png": "png",
    ".gif": "gif",
    ".html": "html",
    ".htm": "html",
}
_TEXTS = (PictureFormat.TEXT, PictureFormat.ASCII)
_SCALED = (PictureFormat.SVG, PictureFormat.PNG, PictureFormat.GIF)
_PLAYED = (PictureFormat.GIF, PictureFormat.HTML)


class PreviewCommand(TyperCommand):
    """A command whose `--policy` may stand alone: it then means the best one."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Say in full what was said in short."""
        whole: list[str] = []
        for index, word in enumerate(args):
            whole.append(word)
            following = args[index + 1] if index + 1 < len(args) else ""
            if word == "--policy" and following not in list(Walker):
                whole.append(Walker.BEST)
        return super().parse_args(ctx, whole)


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
    output: OutputOption = None,
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
        Walker | None,
        typer.Option(
            metavar="[best|random]",
            help="Show where the best actions lead from each cell; in a gif and in html, whom to "
            "watch.  [default of gif and html: best]",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            min=0,
            metavar="N",
            help="Of a gif and html: what chance is drawn from, as in `env.reset(seed=N)`.  "
            "[default: 0]",
            show_default=False,
        ),
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            help="Make a picture or a gif X times its usual size of 64 pixels a cell.",
            show_default=False,
        ),
    ] = None,
    cell: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Make a picture or a gif with N pixels a cell.", show_default=False
        ),
    ] = None,
    maze_seed: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Of a level with random mazes, show the one of this seed.  [default: 0]",
            show_default=False,
        ),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Show a level.

    Examples:

      babyrobot preview final-maze

      babyrobot preview levels/first.yaml -o first.png

      babyrobot preview frozen-lake --values --policy -o answers.svg

      babyrobot preview final-maze --policy best --seed 3 -o walk.gif

      babyrobot preview final-maze -o play.html
    """
    chosen = _chosen_format(picture_format, output)
    if seed is not None and chosen not in _PLAYED:
        fail("--seed is for what moves (gif, html)")
    wishes = Wishes(values, policy, seed or 0, _scale(scale, cell, chosen))
    shown = _prepared(load_level(level), theme, coordinates, maze_seed)
    made: str | bytes
    if chosen in _TEXTS:
        if coordinates:
            note("--coordinates is for pictures (svg, png, gif, html); a text has no room for them")
        made = _text(shown, wishes, plain=chosen is PictureFormat.ASCII or output is not None)
    elif chosen is PictureFormat.GIF:
        made = film(shown, wishes)
    elif chosen is PictureFormat.HTML:
        made = page(shown, wishes)
    else:
        made = picture(shown, wishes, svg=chosen is PictureFormat.SVG)
    if output is not None:
        save(output, made, force=force)
    elif isinstance(made, str):
        write(made)
    elif sys.stdout.isatty():
        fail(f"a {chosen.upper()} cannot be shown in a terminal", "name a file with -o FILE")
    else:
        sys.stdout.buffer.write(made)


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


def _scale(scale: float | None, cell: int | None, chosen: PictureFormat) -> float | None:
    """Return how many times larger than usual a picture is to be."""
    from babyrobot_levels.render.scene.layout import CELL

    if scale is None and cell is None:
        return None
    if scale is not None and cell is not None:
        fail("--scale and --cell say the same thing", "give one of them")
    if chosen not in _SCALED:
        fail("--scale and --cell are for pictures (svg, png, gif)")
    times = scale if scale is not None else (cell or 0) / CELL
    if not 0 < times <= MAX_SCALE:
        fail(
            f"--scale must be above 0 and at most {MAX_SCALE:g}"
            if cell is None
            else f"--cell must be 1 to {MAX_SCALE * CELL:g} pixels"
        )
    return times


def _prepared(level: Level, theme: str | None, coordinates: bool, maze_seed: int | None) -> Level:
    """Return the level as it is to be shown."""
    from babyrobot_levels.text.errors import LevelError

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


def _text(level: Level, wishes: Wishes, *, plain: bool) -> str:
    if wishes.policy is Walker.RANDOM:
        fail("a random walk cannot be shown as a text", "`--policy random` is for gif and html")
    if not (wishes.values or wishes.policy):
        return text_picture(level, plain=plain)
    solution = solution_of(level)
    plain = plain or not takes_pictures()
    if wishes.policy:
        text = policy_text(level, solution, plain=plain)
    else:
        text = text_picture(level, plain=plain)
    if wishes.values and level.size[0] > WIDEST:
        note(f"the values of more than {WIDEST} columns are left to pictures (svg, png)")
    elif wishes.values:
        text += "\n" + values_text(solution)
    return text


preview.command_class = PreviewCommand  # type: ignore[attr-defined]
