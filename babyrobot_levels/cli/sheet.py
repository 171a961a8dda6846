"""`babyrobot sheet`: levels on pages for print, and the teacher's copy of them."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import OutputOption, fail, note, save, write
from babyrobot_levels.cli.levels import (
    LevelsArgument,
    SplitOption,
    each_loaded,
    levels_named,
    valid_levels,
)
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.pictures import format_by_suffix
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.publish.sheet import Sheet


class SheetFormat(StrEnum):
    """Output formats of sheets."""

    PDF = "pdf"
    HTML = "html"
    PNG = "png"


class Paper(StrEnum):
    """Papers."""

    A4 = "a4"
    LETTER = "letter"


def sheet(
    levels: LevelsArgument,
    output: OutputOption = None,
    sheet_format: Annotated[
        SheetFormat | None,
        typer.Option(
            "--format",
            help="Output format.  [default: by the suffix of the file, else pdf]",
            show_default=False,
        ),
    ] = None,
    title: Annotated[
        str | None,
        typer.Option(
            metavar="TEXT",
            help="Title of the sheet.  [default: Exercise sheet]",
            show_default=False,
        ),
    ] = None,
    key: Annotated[
        bool,
        typer.Option(
            "--key",
            help="Make the teacher's copy: values, optimal actions and returns, grids filled in.",
        ),
    ] = False,
    values: Annotated[
        bool, typer.Option("--values", help="Show the optimal value of each cell.")
    ] = False,
    policy: Annotated[bool, typer.Option("--policy", help="Show optimal actions.")] = False,
    grids: Annotated[
        int,
        typer.Option(
            min=0,
            max=11,
            metavar="N",
            help="Empty grids beside each level, for the values of N sweeps of value iteration.",
        ),
    ] = 0,
    rules: Annotated[
        bool,
        typer.Option(
            "--rules/--no-rules", help="Tell on each page what its levels do, pay and cost."
        ),
    ] = True,
    per_page: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=24,
            metavar="N",
            help="Number of levels on a page.  [default: 4, with --grids 3]",
            show_default=False,
        ),
    ] = None,
    paper: Annotated[Paper, typer.Option(help="Size of the pages.")] = Paper.A4,
    landscape: Annotated[
        bool, typer.Option("--landscape", help="Make the pages wider than high.")
    ] = False,
    theme: Annotated[
        str, typer.Option(metavar="THEME", help="Theme of the pictures; `print` is grey.")
    ] = "print",
    split: SplitOption = None,
) -> None:
    """Print levels on an exercise sheet: n on a page, with titles, rules and room to write.

    The suffix of FILE chooses the format: .pdf, .html, which prints page by page, or .png. Several
    pages are several PNG files: sheet-1.png, sheet-2.png and so on. Below each level stand its name
    and the beginning of its digest.

    Examples:

      babyrobot sheet levels/ -o sheet.pdf

      babyrobot sheet levels/ --key -o key.pdf

      babyrobot sheet frozen-lake cliff-walking final-maze --per-page 1 -o large.pdf

      babyrobot sheet frozen-lake gridworld-3-5 --grids 3 --title "Value iteration" -o sweeps.pdf

      babyrobot sheet classics --landscape --paper letter --no-rules -o sheet.html
    """
    from babyrobot_levels.publish.sheet import MAX_LEVELS
    from babyrobot_levels.publish.sheet import sheet as make

    chosen = _chosen_format(sheet_format, output)
    named = levels_named(levels, split)
    if len(named) > MAX_LEVELS:
        fail(f"a sheet has at most {MAX_LEVELS} levels, not {len(named):,}", "make several sheets")
    if isinstance(named, list):
        named, _ = valid_levels(named, "sheet was")
    loaded = [_with_maze(level) for level in each_loaded(named)]
    with working("drawing") as report:
        try:
            made = make(
                loaded,
                title=title,
                per_page=per_page,
                paper=paper,
                landscape=landscape,
                theme=theme,
                values=values,
                policy=policy,
                rules=rules,
                grids=grids,
                key=key,
                progress=report,
            )
        except LevelError as error:
            found = error.diagnostics[0]
            fail(found.message, found.help)
        except ValueError as error:
            fail(str(error))
        _put(made, chosen, output)


def _with_maze(level: Level) -> Level:
    if not level.has_random_maze:
        return level
    name = one_line(level.name or "a level")
    note(f"the maze of {name} is random: this is the one of seed 0 (see `babyrobot resolve`)")
    return level.with_maze_seed(0)


def _chosen_format(sheet_format: SheetFormat | None, output: Path | None) -> SheetFormat:
    if sheet_format is not None or output is None:
        return sheet_format or SheetFormat.PDF
    return format_by_suffix(output, {f".{each}": each for each in SheetFormat})


def _put(made: Sheet, chosen: SheetFormat, output: Path | None) -> None:
    """Write a sheet to a file, several PNG files, or standard output."""
    if chosen is SheetFormat.PNG and _has_other_letters(made):
        note("PNG files show Latin letters only, and there are others: use --format html")
    files = made.files(output or "sheet", chosen)
    if output is not None:
        for path, content in files.items():
            save(path, content())
    elif len(files) > 1:
        fail("several pages are several PNG files", "save them with -o FILE.png")
    elif chosen is SheetFormat.HTML:
        write(made.to_html())
    elif sys.stdout.isatty():
        fail(f"a {chosen.upper()} cannot be shown in a terminal", "save it with -o FILE")
    else:
        sys.stdout.buffer.write(next(iter(files.values()))())


def _has_other_letters(made: Sheet) -> bool:
    """Return whether a sheet has letters that are not Latin, which Pillow's own font lacks."""
    from babyrobot_levels.render.scene.shapes import Text

    texts = (shape.text for page in made.pages for shape in page.shapes if isinstance(shape, Text))
    return any(letter.isalpha() and letter > "\u024f" for text in texts for letter in text)
