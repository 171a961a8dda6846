"""`babyrobot course`: a course to begin with, and all that is made of one."""

from pathlib import Path
from typing import Annotated, Literal

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import FINDINGS, fail, note, quoted, value_option, write
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.text.diagnostics import one_line

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
) -> None:
    """Begin a course, or build all that students and teachers get of it.

    `new` writes ten levels from a first step to a vault with a guard, files in which students fill
    in value iteration, policy iteration, Q-learning and approximate Q-learning, and grade.py, which
    tells them what is right. pack.yaml lists the levels with their points.

    `build` makes for students, without hidden levels and answers: a site, sheets, a pack, share
    codes, and the code with the levels; for teachers: the site and the sheets with the answers,
    autograders for Gradescope, PrairieLearn, Classroom 50 and GitHub Classroom, and pages that
    report to a school's system (SCORM). What was built before is replaced.

    Exits with status 1 if a file of the course has an error.

    Examples:

      babyrobot course new robots

      babyrobot course build robots -o robots-built
    """
    from babyrobot_levels.publish import course as courses

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
            built = courses.course(folder, target, progress=report)
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
