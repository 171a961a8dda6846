"""`babyrobot gallery`: web pages on which many levels can be browsed and played."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import FINDINGS, STANDARD_OUTPUT, fail, note, write
from babyrobot_levels.cli.levels import LevelsArgument, SplitOption, levels_named, valid_levels
from babyrobot_levels.cli.parallel import JobsOption, jobs_for, working
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.suites.suite import Suite

WORTH_IT = 16
"""With fewer levels, starting processes takes longer than it saves."""


def gallery(
    levels: LevelsArgument,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DIR", help="Folder to write to."),
    ] = Path("site"),
    title: Annotated[
        str | None,
        typer.Option(
            metavar="TEXT",
            help="Title of the gallery.  [default: that of the suite, or the name of the folder]",
            show_default=False,
        ),
    ] = None,
    split: SplitOption = None,
    count: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Only the first N levels.", show_default=False),
    ] = None,
    no_answers: Annotated[
        bool,
        typer.Option(
            "--no-answers",
            help="Leave out optimal values, policies, returns and difficulty, and the films.",
        ),
    ] = False,
    key: Annotated[
        bool,
        typer.Option("--key", help="Show values and policies from the start: for teachers."),
    ] = False,
    home: Annotated[
        str | None,
        typer.Option(
            metavar="URL", help="A page that the gallery links back to.", show_default=False
        ),
    ] = None,
    keep_going: Annotated[
        bool, typer.Option("--keep-going", help="Leave out levels with errors.")
    ] = False,
    force: Annotated[
        bool,
        typer.Option(
            "--force", help="Replace also a gallery to which other files were added, with these."
        ),
    ] = False,
    jobs: JobsOption = None,
) -> None:
    """Write web pages on which levels can be browsed, played and downloaded, offline.

    The folder has index.html with a tile for each level, a page for each of them with its
    picture, film and facts, and gallery.json for other programs. It works from a disk, from any
    web server and on GitHub Pages, with nothing to install.

    A gallery that is there already is replaced when the new one is whole; any other folder is
    refused. The maze of a level with `seed: random` is that of seed 0.

    Exits with status 1 if a level has an error; with --keep-going, the others are in the gallery.

    Examples:

      babyrobot gallery levels -o site

      babyrobot gallery small-mazes --split test --count 100 -o site

      babyrobot gallery final-maze frozen-lake --title "Week 1" -o site

      babyrobot gallery levels --no-answers -o students

      babyrobot gallery levels --key -o teacher
    """
    from babyrobot_levels.publish.gallery import check_place
    from babyrobot_levels.publish.gallery import gallery as written
    from babyrobot_levels.scoring.many import reason
    from babyrobot_levels.suites.batch import FolderError

    if key and no_answers:
        fail("--key and --no-answers cannot be combined", "leave out one of the two")
    if output == STANDARD_OUTPUT:
        fail("a gallery is a folder, and cannot be piped", "name the folder: -o DIR")
    try:
        check_place(output, force=force)
        found: Suite | list[Any] = levels_named(levels, split)[:count]
        broken = 0
        if isinstance(found, list):
            found, broken = valid_levels(found, "gallery was", jobs=jobs, keep_going=keep_going)
        with working("writing") as report:
            made = written(
                found,
                output,
                title=title if title is not None else _title(levels),
                answers=not no_answers,
                key=key,
                home=home,
                force=force,
                keep_going=keep_going,
                jobs=jobs_for(len(found), jobs, WORTH_IT),
                progress=report,
            )
    except FolderError as error:
        fail(str(error), error.help)
    except ValueError as error:
        fail(str(error))
    for index, why in made.left_out.items():
        note(f"level {index} left out: {one_line(reason(why))}")
    random = sum(each["maze_seed"] is not None for each in made.levels)
    if random:
        note(f"random mazes are shown with seed 0: {random:,} level{'s' * (random != 1)}")
    size = len(made.levels)
    write(f"wrote {size:,} level{'s' * (size != 1)} to {one_line(str(output / 'index.html'))}\n")
    if broken or made.left_out:
        raise typer.Exit(FINDINGS)


def _title(words: list[str]) -> str | None:
    """Return the name of the only argument, if it is a folder or a pack."""
    from babyrobot_levels.suites.named import folder_named, suite_named

    if len(words) > 1 or suite_named(words[0]) is not None or folder_named(words[0]) is None:
        return None
    return Path(words[0]).resolve().name
