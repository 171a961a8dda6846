"""`babyrobot share` and `babyrobot resolve`: levels in a form that travels alone."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import ForceOption, OutputOption, fail, note, save, write
from babyrobot_levels.cli.inputs import LevelArgument, load_level, with_seed
from babyrobot_levels.cli.schema import schema_for

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level


def share(
    level: LevelArgument,
    link: Annotated[
        str | None,
        typer.Option(
            metavar="BASE",
            help="Print a link instead: BASE is the address of a page that `preview` has made, "
            "and plays what the link holds.",
            show_default=False,
        ),
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
    force: ForceOption = False,
) -> None:
    """Print a level as a share code: one line that every command takes for a LEVEL.

    A code holds all that the level says, its texts and looks included, but no comments. It has a
    checksum: a code that was cut off or mistyped says so.

    A link is a code with all that a page needs to play the level. Any page that `babyrobot preview
    LEVEL -o page.html` has made, of whatever level, plays it: on a web server, or as a file
    (`file:///…/page.html`).

    Examples:

      babyrobot share final-maze

      babyrobot share final-maze --link https://example.org/play.html

      babyrobot share brl1.24.R4BZv8Oakkoy8yqVkLIv0EYA -o tiny.yaml
    """
    if link is not None and output is not None:
        fail("--link and --output do not go together")
    if link is not None and not re.fullmatch(r"[^\s#]+", link):
        fail(f"{link!r} cannot be the beginning of a link", "it has no blanks, and no `#` yet")
    loaded = load_level(level)
    if output is not None:
        from babyrobot_levels.text.emitter import emit

        save(output, emit(loaded.to_dict(whole=True)), force=force)
    elif link is not None:
        write(f"{link}#{_fragment(loaded)}\n")
    else:
        write(f"{loaded.share_code()}\n")


def _fragment(level: Level) -> str:
    """Return what a link to a level has behind its `#`."""
    from babyrobot_levels.cli.pictures import guide_of
    from babyrobot_levels.render.link import link_fragment
    from babyrobot_levels.render.pagedata import MAX_CELLS, TooLargeError

    game = level
    if level.has_random_maze:
        note("each reset grows another maze; the page plays the one of seed 0 (see `resolve`)")
        game = level.with_maze_seed(0)
    guide = guide_of(game, needed=False)
    if guide is not None:
        with suppress(TooLargeError):
            return link_fragment(level, game, guide)
    try:
        fragment = link_fragment(level, game)
        if guide is not None:
            note("the page shows no best moves: with them, the link would be too long")
        return fragment
    except TooLargeError as error:
        fail(
            str(error),
            f"send the file; up to {MAX_CELLS:,} cells, "
            "there is `babyrobot preview LEVEL -o p.html`",
        )


_RELATIVE_SCHEMA = re.compile(
    r"^(# yaml-language-server: *\$schema=)(?![A-Za-z][\w+.-]*:|/)\S+[ \t]*(?:\n|\Z)", re.M
)


def resolve(
    level: LevelArgument,
    maze_seed: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Of a level with random mazes, the seed to take.", show_default=False
        ),
    ] = None,
    output: OutputOption = None,
    force: ForceOption = False,
) -> None:
    """Write out a level's maze as walls; game and picture stay the same.

    `maze` and `openings` are gone from the file then, and each wall can be moved by hand.
    The other fields keep their comments.

    Examples:

      babyrobot resolve final-maze

      babyrobot resolve random-maze --maze-seed 7 -o seven.yaml
    """
    from babyrobot_levels.text.reader import MAX_BYTES

    loaded = with_seed(load_level(level), maze_seed)
    if loaded.maze is None:
        note(f"{loaded.name or 'the level'} has no maze; nothing is to be written out")
    resolved = loaded.resolve()
    text = resolved.to_yaml(comments=True)
    if output is not None:
        text = _text_for(resolved, text, output)
    if len(text.encode("utf-8")) > MAX_BYTES:
        fail("the walls of this maze are too many for a level file, which has room for 1 MiB")
    if output is not None:
        save(output, text, force=force)
    else:
        write(text)


def _text_for(level: Level, text: str, path: Path) -> str:
    """Return the text for a file: away from its folder, a level carries its theme with it."""
    from babyrobot_levels.language.looks import BUILTIN_THEMES
    from babyrobot_levels.library.reading import read_level
    from babyrobot_levels.text.source import SourceFile

    if isinstance(level.theme, str) and level.theme not in BUILTIN_THEMES:
        found, _ = read_level(SourceFile(str(path), text), path)
        if found is None or found.colors_and_widths != level.colors_and_widths:
            text = level.replace(theme=level.colors_and_widths).to_yaml(comments=True)
    # The path of the schema is relative to the level's own folder.
    schema = schema_for(path)
    return _RELATIVE_SCHEMA.sub(f"\\g<1>{schema}\n" if schema else "", text, count=1)
