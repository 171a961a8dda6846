"""`babyrobot grade`: all that a class hands in, graded by a course."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    TableFormat,
    TableOption,
    fail,
    note,
    short,
    value_option,
    write,
    write_json,
    write_table,
)
from babyrobot_levels.cli.inputs import levels_named
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.extensions.scoring.commands.score import LONGEST, Rule, told
from babyrobot_levels.text.files import write_text

RESULTS, KEPT = "grades.json", ".kept"
"""Of a folder of grades: by what it is known, and what is not run again."""


def grade(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="HAND-INS",
            help="What was handed in: a folder or a zip file as the school's system exports it, "
            "with a folder, a zip file or files for each student; or several.",
        ),
    ],
    course: Annotated[
        str,
        value_option(
            "COURSE", "The course; of plays also a level, or a folder or a pack of levels."
        ),
    ],
    functions: Annotated[
        list[str] | None,
        value_option("NAME", "Run only this function; several times for several.", "--function"),
    ] = None,
    points: Annotated[
        Rule, typer.Option("--points", help="By what the points of the best play are given.")
    ] = "regret",
    seconds: Annotated[
        float, value_option("S", "Seconds of a function in a level.  [default: 60]")
    ] = 60.0,
    memory: Annotated[
        float, value_option("GIB", "GiB of memory of a function.  [default: 4; Linux only]")
    ] = 4.0,
    jobs: Annotated[
        int | None,
        value_option(
            "N",
            "Students whose code runs at the same time.  [default: one per processor]",
            "--jobs",
            "-j",
            min=1,
        ),
    ] = None,
    roster: Annotated[
        Path | None,
        value_option(
            "FILE", "With -o: the list of students that the school's system exports as CSV, filled."
        ),
    ] = None,
    column: Annotated[
        str | None, value_option("NAME", "With --roster: the column of points.  [default: Grade]")
    ] = None,
    table_format: TableOption = TableFormat.TEXT,
    output: Annotated[
        Path | None,
        value_option(
            "DIR",
            "Write pages for the class and for each student, grades.csv and grades.json to this "
            "folder. Where it is there already, only new files are graded.",
            "--output",
            "-o",
        ),
    ] = None,
) -> None:
    """Grade all that a class hands in: code, notebooks, tables of answers, and plays.

    Each function of the course is run in each level, in a process with limits of time and memory,
    and its answers are compared with the exact ones. Recorded episodes are verified. The code of
    strangers is run: `docs/course.md` says in what container. The exit status is 1 if something
    does not count, or could not be graded.

    Examples:

      babyrobot grade handed-in --course robots

      babyrobot grade moodle.zip --course robots -o grades

      babyrobot grade plays --course frozen-lake --format csv

      babyrobot grade canvas.zip --course robots --roster gradebook.csv --column Robots -o grades
    """
    # What is wrong with a level, its errors tell.
    try:
        if any(brl.load(each).has_random_maze for each in levels_named([course])):
            fail("the maze of a level is random", "give the level with its seed: a file, or a code")
    except brl.LevelNotFoundError:
        fail(f"there is no course, folder or level {course!r}", "give the folder of the course")
    if ((roster or column) and output is None) or (column and roster is None):
        fail("--roster needs -o, and --column needs --roster")
    if output is not None and not _is_free(output):
        fail(f"{output} is something else than a folder of grades", "choose a new folder")
    with working("grading") as report:
        try:
            found = brl.grade(
                files,
                course,
                points=points,
                functions=functions or None,
                seconds=seconds,
                memory=memory,
                jobs=jobs,
                progress=report,
                kept=None if output is None else output / KEPT,
            )
        except ValueError as error:
            fail(str(error))
    if output is not None:
        _save(found, output, roster, column)
    if table_format is TableFormat.CSV:
        write(found.totals_to_csv())
    elif table_format is TableFormat.JSON:
        write_json(found.to_dict())
    else:
        _put(found)
    if output is not None:
        note(f"wrote {output / 'index.html'}, and pages of {len(found.totals):,} students")
    if not found.are_valid:
        raise typer.Exit(FINDINGS)


def _is_free(output: Path) -> bool:
    """Return whether a folder can be written: a new, an empty one, or one of grades."""
    if not output.exists():
        return True
    return output.is_dir() and ((output / KEPT).is_dir() or not any(output.iterdir()))


def _save(found: brl.Grades, output: Path, roster: Path | None, column: str | None) -> None:
    """Write the folder of grades."""
    from babyrobot_levels.extensions.scoring.class_page import write_pages
    from babyrobot_levels.extensions.scoring.rosters import filled

    (output / KEPT).mkdir(parents=True, exist_ok=True)
    write_text(output / RESULTS, found.to_json())
    write_text(output / "grades.csv", found.totals_to_csv())
    write_pages(found, output)
    if roster is not None:
        try:
            text, missing = filled(roster, found, column)
        except OSError as error:
            fail(f"{roster} cannot be read ({error.strerror or error})")
        except ValueError as error:
            fail(f"{roster}: {error}")
        write_text(output / roster.name, text)
        for player, reason in missing.items():
            note(f"warning: {told(player)} is not in {roster.name}: {reason}")


def _put(found: brl.Grades) -> None:
    """Write tables of the points, and of what does not count."""
    rows = [
        [told(name), *("not graded" if each != each else short(each) for each in row.values())]
        for name, row in found.totals.items()
    ]
    write_table(["player", *found.worth, "total"], rows, [*found.worth])
    for heading, lines in {
        ("player", "place", "does not count"): [
            [told(each.player), told(each.place), told(each.reason, LONGEST)]
            for each in found.defects
        ],
        ("player", "read all the same"): [
            [told(player), told(each, LONGEST)]
            for player, notes in found.notes.items()
            for each in notes
        ],
        ("task", "the same in what these handed in"): [
            [task, told(", ".join(players), LONGEST)]
            for task, groups in found.shared.items()
            for players in groups
        ],
    }.items():
        if lines:
            write("\n")
            write_table([*heading], lines)
