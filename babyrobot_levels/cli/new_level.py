"""`babyrobot new-level`: a file to begin with."""

from __future__ import annotations

import re
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from babyrobot_levels.cli.console import ForceOption, fail, note, save, write
from babyrobot_levels.cli.schema import schema_for
from babyrobot_levels.text.diagnostics import one_line

MAX_PUDDLES = 10_000


class Template(StrEnum):
    """What a new level begins as."""

    GRID = "grid"
    MAZE = "maze"
    DRAWING = "drawing"


class Algorithm(StrEnum):
    """How a maze is grown."""

    DEPTH_FIRST = "depth-first"
    WILSON = "wilson"
    ALDOUS_BRODER = "aldous-broder"
    KRUSKAL = "kruskal"
    PRIM = "prim"
    GROWING_TREE = "growing-tree"
    HUNT_AND_KILL = "hunt-and-kill"
    RECURSIVE_DIVISION = "recursive-division"
    BINARY_TREE = "binary-tree"
    SIDEWINDER = "sidewinder"
    ELLER = "eller"


def new_level(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="The level's name: small letters, digits and `-`.")
    ],
    size: Annotated[str, typer.Option(metavar="WxH", help="Width and height in cells.")] = "8x5",
    maze_seed: Annotated[
        int | None,
        typer.Option(metavar="N", help="Grow a maze from this seed.", show_default=False),
    ] = None,
    algorithm: Annotated[
        Algorithm,
        typer.Option(metavar="A", help="How the maze is grown: " + ", ".join(Algorithm) + "."),
    ] = Algorithm.DEPTH_FIRST,
    loops: Annotated[
        float,
        typer.Option(metavar="R", help="The share of the maze's dead ends that are opened up."),
    ] = 0.0,
    puddles: Annotated[int, typer.Option(metavar="N", help="How many puddles.")] = 0,
    theme: Annotated[
        str, typer.Option(metavar="THEME", help="The theme: default, black_orange, …")
    ] = "default",
    template: Annotated[
        Template, typer.Option(help="Begin with fields, with a maze, or with a drawing.")
    ] = Template.GRID,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Where to write it.  [default: levels/NAME.yaml]",
            show_default=False,
        ),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Write a new level file, with comments, and say what to type next.

    Examples:

      babyrobot new-level first

      babyrobot new-level wet-maze --size 10x6 --maze-seed 7 --puddles 4

      babyrobot new-level hedges --maze-seed 7 --algorithm recursive-division --loops 0.5
    """
    from babyrobot_levels.generate.starter import Order, starter
    from babyrobot_levels.library.level import slug
    from babyrobot_levels.library.search_path import gallery_folder, yaml_files

    if slug(name) != name:
        good = slug(name)
        fail(
            f"{name!r} cannot be a level's name: it takes small letters and digits, joined by `-`",
            f"for example {good!r}" if good else None,
        )
    if template is Template.DRAWING and maze_seed is not None:
        fail("a drawing has no maze", "leave out --maze-seed or --template drawing")
    if template is not Template.MAZE and maze_seed is None:
        for option, given in (
            ("--loops", loops),
            ("--algorithm", algorithm is not Algorithm.DEPTH_FIRST),
        ):
            if given:
                fail(f"{option} is for mazes", "add --maze-seed N or --template maze")
    if not 0 <= loops <= 1:
        fail(f"--loops is a share from 0 to 1, not {loops:g}")
    if not 0 <= puddles <= MAX_PUDDLES:
        fail(f"there can be 0 to {MAX_PUDDLES:,} puddles, not {puddles:,}")
    path = output or Path("levels", f"{name}.yaml")
    order = Order(
        name, str(template), _size(size), maze_seed, str(algorithm), loops, puddles, theme
    )
    try:
        text = starter(order, schema_for(path))
    except ValueError as error:
        fail(str(error), "ask for fewer puddles, or for a larger --size")
    _check(text, path)
    save(path, text, force=force)
    if any(path.stem == name for path in yaml_files(gallery_folder())):
        note(f"{name!r} is the name of a level of the gallery too: load yours by its path")
    typed = one_line(_quoted(str(path)))
    write(
        f"wrote {one_line(str(path))}\n\n"
        "next:\n"
        f"  edit it, then check it      babyrobot validate {typed}\n"
        f"  see it                      babyrobot preview {typed}\n"
        "  play it in Python           "
        "import babyrobot_levels as brl\n"
        "                              "
        f'env = brl.load("{one_line(path.as_posix())}").make()\n'
    )


def _quoted(word: str) -> str:
    """Return a word as it is typed into the system's shell."""
    if sys.platform == "win32":
        from subprocess import list2cmdline

        return list2cmdline([word])
    from shlex import quote

    return quote(word)


def _size(text: str) -> tuple[int, int]:
    from babyrobot_levels.language.base import MAX_SIZE

    match = re.fullmatch(r"([0-9]{1,5})[x,]([0-9]{1,5})", text)
    if not match:
        fail(f"{text!r} is no size", "write it as width and height: 8x5")
    width, height = int(match[1]), int(match[2])
    if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
        fail(f"a level is 1 to {MAX_SIZE} cells wide and high, not {text}")
    if width * height == 1:
        fail("a level of one cell has no room for a start and an exit")
    return width, height


def _check(text: str, path: Path) -> None:
    """Make sure that the file is valid before it is written: a theme may not be known."""
    from babyrobot_levels.library.reading import read_level
    from babyrobot_levels.text.files import ReadFault, decode

    try:
        _, diagnostics = read_level(decode(text.encode("utf-8"), str(path)), path)
    except ReadFault as fault:
        fail(f"the level would be too much for one file: {fault}", "ask for a smaller --size")
    if diagnostics:
        fail(diagnostics[0].message, diagnostics[0].help)
