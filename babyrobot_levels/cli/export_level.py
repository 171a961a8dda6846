"""`babyrobot export`: levels as worlds of other programs, and as pictures."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from babyrobot_levels.cli.console import ForceOption, OutputOption, fail, note, save, write
from babyrobot_levels.cli.conversions import StrictOption, WorldFormat, tell_losses
from babyrobot_levels.cli.pictures import Wishes, picture
from babyrobot_levels.cli.preview import LevelArgument, load_level
from babyrobot_levels.cli.resolve import with_seed


class ExportFormat(StrEnum):
    """What levels are written as."""

    BABYROBOT = WorldFormat.BABYROBOT
    FROZEN_LAKE = WorldFormat.FROZEN_LAKE
    MAZE_MAP = WorldFormat.MAZE_MAP
    MAZE_DATASET = WorldFormat.MAZE_DATASET
    MINIGRID = WorldFormat.MINIGRID
    SOKOBAN = WorldFormat.SOKOBAN
    TILED = WorldFormat.TILED
    PNG = "png"
    SVG = "svg"


_SUFFIXES = {".tmj": ExportFormat.TILED, ".png": ExportFormat.PNG, ".svg": ExportFormat.SVG}


def export_level(
    level: LevelArgument,
    to: Annotated[
        ExportFormat | None,
        typer.Option(
            "--to",
            metavar="FORMAT",
            help=f"What to make: {', '.join(ExportFormat)}.  "
            "[default: by the file's suffix, .tmj, .png or .svg]",
            show_default=False,
        ),
    ] = None,
    output: OutputOption = None,
    maze_seed: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Of a level with random mazes, the seed to take.", show_default=False
        ),
    ] = None,
    strict: StrictOption = False,
    force: ForceOption = False,
) -> None:
    """Write a level in the format of another program.

    What the format has no place for is told on standard error, by the names of the fields.

    Examples:

      babyrobot export final-maze --to babyrobot

      babyrobot export frozen-lake --to frozen-lake -o lake.json

      babyrobot export glass-wall -o glass-wall.tmj

      babyrobot export random-maze --maze-seed 7 --to sokoban
    """
    chosen = to or _by_suffix(output)
    loaded = with_seed(load_level(level), maze_seed)
    made: str | bytes
    beside: Mapping[str, bytes] = {}
    if chosen in (ExportFormat.PNG, ExportFormat.SVG):
        made = picture(loaded, Wishes(), svg=chosen is ExportFormat.SVG)
    else:
        from babyrobot_levels.convert.formats import export

        conversion = export(loaded, chosen.value)
        tell_losses(conversion.warnings, strict=strict)
        made, beside = conversion.text, conversion.beside
    if output is not None:
        for name, data in beside.items():
            save(output.parent / name, data, force=force)
        save(output, made, force=force)
        return
    for name in beside:
        note(f"note: {name}, the picture of the tiles, is written with -o FILE only")
    if isinstance(made, str):
        write(made)
    elif sys.stdout.isatty():
        fail("a PNG cannot be shown in a terminal", "name a file with -o FILE")
    else:
        sys.stdout.buffer.write(made)


def _by_suffix(output: Path | None) -> ExportFormat:
    suffix = output.suffix.lower() if output is not None else ""
    if suffix not in _SUFFIXES:
        fail("it is not said what to make", f"say --to one of {', '.join(ExportFormat)}")
    return _SUFFIXES[suffix]
