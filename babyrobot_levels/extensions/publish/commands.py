"""The commands that publish levels: `gallery`, `dataset`, `sheet` and `course`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    STANDARD_OUTPUT,
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
from babyrobot_levels.cli.inputs import (
    LevelsArgument,
    RuntimeOption,
    SplitOption,
    levels_named,
    valid_levels,
)
from babyrobot_levels.cli.parallel import JobsOption, jobs_for, working
from babyrobot_levels.cli.pictures import format_by_suffix
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError

WORTH_IT = 16
"""With fewer levels, starting processes takes longer than it saves."""


def gallery(
    levels: LevelsArgument,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")
    ] = Path("site"),
    title: Annotated[
        str | None,
        value_option(
            "TEXT", "Title of the gallery.  [default: that of the suite, or the name of the folder]"
        ),
    ] = None,
    split: SplitOption = None,
    count: Annotated[int | None, value_option("N", "Only the first N levels.", min=1)] = None,
    no_answers: Annotated[
        bool,
        flag(
            "--no-answers",
            "Leave out optimal values, policies, returns and difficulty, and the films.",
        ),
    ] = False,
    key: Annotated[
        bool, flag("--key", "Show values and policies from the start: for teachers.")
    ] = False,
    home: Annotated[
        str | None, value_option("URL", "A page that the gallery links back to.")
    ] = None,
    editor: Annotated[
        str | None,
        value_option("URL", "A site of `babyrobot edit --site`, in which levels can be edited."),
    ] = None,
    keep_going: Annotated[bool, flag("--keep-going", "Leave out levels with errors.")] = False,
    force: Annotated[
        bool, flag("--force", "Replace also a gallery to which other files were added, with these.")
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
    from babyrobot_levels.agents.many import reason
    from babyrobot_levels.extensions.publish.gallery import check_place

    if key and no_answers:
        fail("--key and --no-answers cannot be combined", "leave out one of the two")
    if output == STANDARD_OUTPUT:
        fail("a gallery is a folder, and cannot be piped", "name the folder: -o DIR")
    try:
        check_place(output, force=force)
        found, title = _found(levels, split, count, title)
        broken = 0
        if isinstance(found, list):
            found, broken = valid_levels(found, "gallery was", jobs=jobs, keep_going=keep_going)
        with working("writing") as report:
            made = brl.gallery(
                found,
                output,
                title=title,
                answers=not no_answers,
                key=key,
                home=home,
                editor=editor,
                force=force,
                keep_going=keep_going,
                jobs=jobs_for(len(found), jobs, WORTH_IT),
                progress=report,
            )
    except brl.FolderError as error:
        fail(str(error), error.help)
    except ValueError as error:
        fail(str(error))
    for index, why in made.left_out.items():
        note(f"level {index} left out: {one_line(reason(why))}")
    if random := sum(each["maze_seed"] is not None for each in made.levels):
        note(f"random mazes are shown with seed 0: {random:,} level{'s' * (random != 1)}")
    size = len(made.levels)
    write(f"wrote {size:,} level{'s' * (size != 1)} to {one_line(str(output / 'index.html'))}\n")
    if broken or made.left_out:
        raise typer.Exit(FINDINGS)


def _found(
    words: list[str], split: str | None, count: int | None, title: str | None
) -> tuple[brl.Suite | list[Any], str]:
    """Return the levels that arguments name, in their order, and the title of all of them."""
    from babyrobot_levels.extensions.publish.gallery import in_order, title_of

    named: Any = words[0] if len(words) == 1 else words
    found = levels_named(words, split)
    found = in_order(named, found) if isinstance(found, list) else found
    return found[:count], title if title is not None else title_of(named, found)


def dataset(
    levels: LevelsArgument,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")
    ] = Path("dataset"),
    title: Annotated[
        str | None,
        value_option(
            "TEXT",
            "Title of the data set.  [default: that of the suite, or the name of the folder]",
        ),
    ] = None,
    split: SplitOption = None,
    count: Annotated[int | None, value_option("N", "Only the first N levels.", min=1)] = None,
    data_license: Annotated[
        str | None,
        value_option("ID", "License of the data set: cc-by-4.0, for example.", "--license"),
    ] = None,
    force: Annotated[bool, flag("--force", "Replace a data set.")] = False,
    jobs: JobsOption = None,
) -> None:
    """Write levels as a data set that other tools read: a row for each level.

    A row has the file of the level, its digest, share code, metrics and picture. There is a
    Parquet file for each split; README.md, with which the Hugging Face Hub and `datasets` know
    splits and columns; and croissant.json, the same for tools that read Croissant. It needs the
    extra `parquet`.

    Examples:

      babyrobot dataset classics -o classics

      babyrobot dataset small-mazes --split test --count 20 -o mazes

      babyrobot dataset levels --license cc-by-4.0 -o gallery
    """
    if output == STANDARD_OUTPUT:
        fail("a data set is a folder, and cannot be piped", "name the folder: -o DIR")
    try:
        found, title = _found(levels, split, count, title)
        if isinstance(found, list):
            found, _ = valid_levels(found, "data set was", jobs=jobs)
        with working("writing") as report:
            made = brl.dataset(
                found,
                output,
                title=title,
                license=data_license,
                force=force,
                jobs=jobs_for(len(found), jobs, WORTH_IT),
                progress=report,
            )
    except brl.FolderError as error:
        fail(str(error), error.help)
    except (ImportError, ValueError) as error:
        fail(str(error))
    splits = ", ".join(f"{size:,} in {name}" for name, size in made.splits.items())
    write(f"wrote a data set to {one_line(str(output))}: {splits}\n")


SheetFormat = Literal["pdf", "html", "png"]
"""Output formats of sheets."""


Paper = Literal["a4", "letter"]
"""Papers."""


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
        str | None, value_option("TEXT", "Title of the sheet.  [default: Exercise sheet]")
    ] = None,
    key: Annotated[
        bool,
        flag(
            "--key",
            "Make the teacher's copy: values, optimal actions and returns, grids filled in.",
        ),
    ] = False,
    values: Annotated[bool, flag("--values", "Show the optimal value of each cell.")] = False,
    policy: Annotated[bool, flag("--policy", "Show optimal actions.")] = False,
    grids: Annotated[
        int,
        typer.Option(
            min=0,
            max=11,
            metavar="N",
            help="Empty grids beside each level, for the values of N sweeps of value iteration.",
        ),
    ] = 0,
    lines: Annotated[
        int,
        typer.Option(
            min=0,
            max=24,
            metavar="N",
            help="Lines to write answers on below each level, as far as there is room.",
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
        value_option(
            "N", "Number of levels on a page.  [default: 4, with --grids 3]", min=1, max=24
        ),
    ] = None,
    paper: Annotated[Paper, typer.Option(help="Size of the pages.")] = "a4",
    landscape: Annotated[bool, flag("--landscape", "Make the pages wider than high.")] = False,
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

      babyrobot sheet final-maze first-key --per-page 2 --lines 8 -o questions.pdf

      babyrobot sheet classics --landscape --paper letter --no-rules -o sheet.html
    """
    from babyrobot_levels.extensions.publish.sheet import MAX_LEVELS

    chosen = _chosen_format(sheet_format, output)
    named = levels_named(levels, split)
    if len(named) > MAX_LEVELS:
        fail(f"a sheet has at most {MAX_LEVELS} levels, not {len(named):,}", "make several sheets")
    if isinstance(named, list):
        named, _ = valid_levels(named, "sheet was")
    loaded = [_with_maze(level) for level in map(brl.load, named)]
    with working("drawing") as report:
        try:
            made = brl.sheet(
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
                lines=lines,
                key=key,
                progress=report,
            )
        except LevelError as error:
            found = error.diagnostics[0]
            fail(found.message, found.help)
        except ValueError as error:
            fail(str(error))
        _put(made, chosen, output)


def _with_maze(level: brl.Level) -> brl.Level:
    if not level.has_random_maze:
        return level
    name = one_line(level.name or "a level")
    note(f"the maze of {name} is random: this is the one of seed 0 (see `babyrobot resolve`)")
    return level.with_maze_seed(0)


def _chosen_format(sheet_format: SheetFormat | None, output: Path | None) -> SheetFormat:
    if sheet_format is not None or output is None:
        return sheet_format or "pdf"
    return format_by_suffix(output, {f".{each}": each for each in get_args(SheetFormat)})


def _put(made: brl.Sheet, chosen: SheetFormat, output: Path | None) -> None:
    """Write a sheet to a file, several PNG files, or standard output."""
    if chosen == "png" and _has_other_letters(made):
        note("PNG files show Latin letters only, and there are others: use --format html")
    files = made.files(output or "sheet", chosen)
    if output is not None:
        for path, content in files.items():
            save(path, content())
    elif len(files) > 1:
        fail("several pages are several PNG files", "save them with -o FILE.png")
    else:
        (page,) = files.values()
        put(made.to_html() if chosen == "html" else page(), None, chosen.upper())


def _has_other_letters(made: brl.Sheet) -> bool:
    """Return whether a sheet has letters that are not Latin, which Pillow's own font lacks."""
    from babyrobot_levels.render.scene.shapes import Text

    texts = (shape.text for page in made.pages for shape in page.shapes if isinstance(shape, Text))
    return any(letter.isalpha() and letter > "\u024f" for text in texts for letter in text)


Step = Literal["new", "build"]
"""What is done with a course."""


def course(
    step: Annotated[Step, typer.Argument(help="Write an example to change, or build a course.")],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the course.")],
    output: Annotated[
        Path | None,
        value_option(
            "DIR", "Folder to build in.  [default: the folder's name with -built]", "--output", "-o"
        ),
    ] = None,
    browser: Annotated[
        bool, typer.Option("--browser", help="Build a page in which functions are written and run.")
    ] = False,
    runtime: RuntimeOption = None,
) -> None:
    """Begin a course, or build all that students and teachers get of it.

    `new` writes ten levels from a first step to a vault with a guard, files in which students fill
    in value iteration, policy iteration, Q-learning and approximate Q-learning, and grade.py, which
    tells them what is right. pack.yaml lists the levels with their points.

    `build` makes for students, without hidden levels and answers: a site, sheets, a pack, share
    codes, and the code with the levels; for teachers: the site and the sheets with the answers,
    autograders for Gradescope, PrairieLearn, Classroom 50 and GitHub Classroom, and pages that
    report to a school's system (SCORM). With --browser there is a page for students who cannot
    install anything: functions are written and run there. What was built before is replaced.

    Exits with status 1 if a file of the course has an error.

    Examples:

      babyrobot course new robots

      babyrobot course build robots -o robots-built

      babyrobot course build robots --browser
    """
    from babyrobot_levels.extensions.editor.runtime import TARBALL, RuntimeFileError
    from babyrobot_levels.extensions.publish import course as courses

    try:
        if step == "new":
            if output is not None:
                fail("`new` writes to the folder itself", "leave out --output")
            made = courses.new_course(folder)
            write(f"wrote a course to {one_line(str(made))}: change it, then run\n")
            write(f"  babyrobot course build {quoted(made)}\n")
            return
        whole = folder.resolve()
        with working("building") as report:
            target = output or whole.with_name(f"{whole.name}-built")
            built = courses.course(
                folder, target, browser=browser, runtime=runtime, progress=report
            )
    except RuntimeFileError as error:
        fail(str(error), f"get {TARBALL.name} from npm, and give its folder with --runtime")
    except brl.FolderError as error:
        fail(str(error), error.help)
    except brl.PackError as error:
        note(f"error: {one_line(str(error))}")
        if error.help:
            note(f"  help: {one_line(error.help)}")
        raise typer.Exit(FINDINGS) from None
    size = f"{len(built.files):,} files, {built.size / 1e6:.1f} MB"
    write(f"built {one_line(built.title)} in {one_line(str(built.folder))}: {size}\n")
    for name in ("students", "teacher"):
        parts = sorted({each.split("/")[1] for each in built.files if each.startswith(f"{name}/")})
        write(f"  {name}: {', '.join(map(one_line, parts))}\n")
