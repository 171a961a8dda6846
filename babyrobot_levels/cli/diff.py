"""`babyrobot diff`: what changed in the game from one level to another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    WRONG_CALL,
    FormatOption,
    ReportFormat,
    fail,
    note,
    write,
    write_json,
)
from babyrobot_levels.cli.git import is_from_git, text_for_git
from babyrobot_levels.cli.preview import load_two
from babyrobot_levels.cli.reporting import shown_name

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level


def diff(
    levels: Annotated[
        list[str],
        typer.Argument(
            metavar="A B",
            help="Two levels: names, pack/name, paths of files, or share codes; one of them may be "
            "`-`, standard input.",
        ),
    ],
    limit: Annotated[
        int,
        typer.Option(
            min=0, metavar="N", help="How many cells, walls and transitions to tell, 0 for all."
        ),
    ] = 10,
    maze_seed: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Of levels with random mazes, compare the mazes of this seed.  [default: 0]",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Tell what changed in the game from one level to another.

    Ends with status 0 if the two are the same game, with 1 if they differ, and with 2 if that
    cannot be told. It also takes the seven arguments that git gives to a diff driver: to see games
    in `git diff`, set `diff.babyrobot.command` to `babyrobot diff` in git's configuration, and
    give level files the attribute `diff=babyrobot`.

    Examples:

      babyrobot diff default side-panel

      babyrobot diff default side-panel --format json --limit 0
    """
    if is_from_git(levels):
        write(text_for_git(levels, limit or None))
        return
    if len(levels) != 2:
        fail(f"diff takes two levels, not {len(levels)}")
    before, after = _loaded(*levels)
    names = [shown_name(text) for text in levels]
    if maze_seed is None and (before.has_random_maze or after.has_random_maze):
        note("each reset grows another maze; those of seed 0 are compared (see --maze-seed)")
    from babyrobot_levels.analysis.diff import diff as difference_of
    from babyrobot_levels.cli.differences import difference_data, difference_text

    difference = difference_of(before, after, limit=limit or None, maze_seed=maze_seed or 0)
    if report_format is ReportFormat.JSON:
        write_json({"before": names[0], "after": names[1], **difference_data(difference)})
    else:
        told = "the same game" if difference.same_game else "different games"
        write(difference_text(difference, f"{names[0]} and {names[1]} are {told}"))
    if not difference.same_game:
        raise typer.Exit(FINDINGS)


def _loaded(before: str, after: str) -> tuple[Level, Level]:
    """Return two levels; one that is not valid is no difference, but cannot be compared."""
    from babyrobot_levels.text.errors import LevelError

    try:
        return load_two(before, after)
    except LevelError as error:
        note(str(error))
        raise typer.Exit(WRONG_CALL) from None
