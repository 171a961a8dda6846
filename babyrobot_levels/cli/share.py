"""`babyrobot share`: a level as a code for chats, links and papers; and a code as a file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from babyrobot_levels.cli.console import fail, save, write
from babyrobot_levels.cli.preview import LevelArgument, load_level


def share(
    level: LevelArgument,
    link: Annotated[
        str | None,
        typer.Option(metavar="BASE", help="Print a link instead: BASE#CODE.", show_default=False),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Write the level to a file instead: the way back from a code.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file.")] = False,
) -> None:
    """Print a level as a share code: one line that every command takes for a LEVEL.

    A code holds all that the level says, its texts and looks included, but no comments. It has a
    checksum: a code that was cut off or mistyped says so.

    Examples:

      babyrobot share final-maze

      babyrobot share final-maze --link https://example.org/play.html

      babyrobot share brl1.24.R4BZv8Oakkoy8yqVkLIv0EYA -o tiny.yaml
    """
    if link is not None and output is not None:
        fail("--link and --output do not go together")
    loaded = load_level(level)
    if output is not None:
        from babyrobot_levels.syntax.emitter import emit

        save(output, emit(loaded.to_dict(whole=True)), force=force)
    elif link is not None:
        if not re.fullmatch(r"[^\s#]+", link):
            fail(f"{link!r} cannot be the beginning of a link", "it has no blanks, and no `#` yet")
        write(f"{link}#{loaded.share_code()}\n")
    else:
        write(f"{loaded.share_code()}\n")
