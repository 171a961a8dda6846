"""Commands that begin something: `babyrobot new-level` and `schema`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, get_args

import typer

from babyrobot_levels.cli.console import (
    ForceOption,
    OutputOption,
    fail,
    flag,
    note,
    put,
    quoted,
    save,
    value_option,
    write,
)
from babyrobot_levels.cli.inputs import check_name, is_folder
from babyrobot_levels.language.cells import Algorithm
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import schema_for, source_of

if TYPE_CHECKING:
    from babyrobot_levels.generation.starter import StarterOptions


Template = Literal["grid", "maze", "drawing"]
"""Templates for new levels."""


def new_level(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME", help="Name of the level: lower-case letters, digits and `-`."
        ),
    ],
    size: Annotated[str, typer.Option(metavar="WxH", help="Width and height in cells.")] = "8x5",
    maze_seed: Annotated[int | None, value_option("N", "Add the maze of this seed.")] = None,
    algorithm: Annotated[
        Algorithm,
        typer.Option(metavar="A", help="Maze algorithm: " + ", ".join(get_args(Algorithm)) + "."),
    ] = "depth-first",
    loops: Annotated[
        float, typer.Option(min=0, max=1, metavar="R", help="Share of the dead ends to open.")
    ] = 0.0,
    puddles: Annotated[
        int, typer.Option(min=0, max=10_000, metavar="N", help="Number of puddles.")
    ] = 0,
    key: Annotated[
        bool, flag("--key", "Add a locked door on the way to the exit, and its key.")
    ] = False,
    coins: Annotated[
        int, typer.Option(min=0, max=10, metavar="N", help="Number of coins to take.")
    ] = 0,
    theme: Annotated[
        str,
        typer.Option(
            metavar="THEME",
            help="Theme: default, babyrobot, black_orange, blue_green, dark, green, high_contrast "
            "or print.",
        ),
    ] = "default",
    template: Annotated[
        Template, typer.Option(help="Start from fields, from a maze, or from a drawing.")
    ] = "grid",
    output: Annotated[
        Path | None,
        value_option(
            "PATH", "Write to this file or folder.  [default: levels/NAME.yaml]", "--output", "-o"
        ),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Write a new level file, with comments that explain it.

    With a maze, the exit is placed in the dead end that is nearest to the lower right corner: in
    a corridor it would cut off the cells behind it.

    Examples:

      babyrobot new-level first

      babyrobot new-level wet-maze --size 10x6 --maze-seed 7 --puddles 4

      babyrobot new-level vault --maze-seed 7 --key --coins 3

      babyrobot new-level hedges --maze-seed 7 --algorithm recursive-division --loops 0.5
    """
    from babyrobot_levels.generation.starter import StarterOptions, starter
    from babyrobot_levels.library.search_path import gallery_folder, yaml_files

    check_name(name)
    if template != "maze" and maze_seed is None:
        for option, given in (("--loops", loops), ("--algorithm", algorithm != "depth-first")):
            if given:
                fail(f"{option} needs a maze", "add --maze-seed N or --template maze")
    path = output or Path("levels", f"{name}.yaml")
    if is_folder(path):
        path /= f"{name}.yaml"
    options = StarterOptions(
        name,
        str(template),
        _size(size),
        maze_seed,
        str(algorithm),
        loops,
        puddles,
        theme,
        key,
        coins,
    )
    try:
        text = starter(options, schema_for(path))
    except ValueError as error:
        things = "fewer --puddles" if not options.has_things else "fewer --puddles or --coins"
        fail(str(error), f"use {things} or a larger --size")
    _check(text, path)
    save(path, text, force=force)
    if any(path.stem == name for path in yaml_files(gallery_folder())):
        if path == Path("levels", f"{name}.yaml"):
            note(f"in this folder, {name!r} is now your level; the gallery's is gallery/{name}")
        else:
            note(f"the gallery has a level {name!r} too: load yours by its path")
    _report(options, path)


def _report(options: StarterOptions, path: Path) -> None:
    """Write where the exit is, if not in the corner, and what to do next."""
    from babyrobot_levels.generation.starter import exit_of

    typed, exit_ = quoted(path), exit_of(options)
    text = ""
    if exit_ != (options.size[0] - 1, options.size[1] - 1):
        text = (
            f"the exit is in a dead end, at [{exit_[0]}, {exit_[1]}]: "
            "in the corner it would cut off other cells\n\n"
        )
    steps = {
        "edit it, then check it": f"babyrobot validate {typed}",
        "look at it": f"babyrobot preview {typed}",
        "use it in Python": "import babyrobot_levels as brl",
        "": f'env = brl.load("{one_line(path.as_posix())}").make()',
    }
    write(f"{text}next:\n" + "".join(f"  {what:<28}{how}\n" for what, how in steps.items()))


def _size(text: str) -> tuple[int, int]:
    from babyrobot_levels.language.base import MAX_SIZE

    match = re.fullmatch(r"([0-9]{1,5})[xX×,]([0-9]{1,5})", text)
    if not match:
        fail(f"invalid size {text!r}", "expected WIDTHxHEIGHT, for example 8x5")
    width, height = int(match[1]), int(match[2])
    if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
        fail(f"width and height must be from 1 to {MAX_SIZE}, not {text}")
    if width * height == 1:
        fail("a level of one cell has no room for both a start and an exit")
    return width, height


def _check(text: str, path: Path) -> None:
    """Check that the file is valid before it is written: a theme may be unknown."""
    from babyrobot_levels.suites.checking import errors_of

    try:
        source = source_of(text.encode("utf-8"), str(path))
    except LevelError as error:
        reason = error.diagnostics[0].message
        fail(f"the level is too large for one file: {reason}", "use a smaller --size")
    if diagnostics := errors_of(source, path):
        fail(diagnostics[0].message, diagnostics[0].help)


SchemaName = Literal["level", "pack", "play", "suite", "theme"]
"""Kinds of files that have a schema."""


def print_schema(
    name: Annotated[
        SchemaName,
        typer.Argument(metavar="NAME", help="`level`, `pack`, `play`, `suite` or `theme`."),
    ] = "level",
    output: OutputOption = None,
    force: ForceOption = False,
) -> None:
    """Print the JSON schema of level, suite or theme files, of `pack.yaml`, or of a play's lines.

    In a folder with `schemas/level.schema.json`, `new-level`, `generate` and `import` let their
    files refer to it, so that editors complete and check them.

    Examples:

      babyrobot schema level -o schemas/level.schema.json
    """
    from babyrobot_levels.language.json_schema import schema_text

    put(schema_text(name), output, force=force)
