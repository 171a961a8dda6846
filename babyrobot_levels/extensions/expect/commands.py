"""The command that states facts: `babyrobot expect`."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.check import show_changes
from babyrobot_levels.cli.console import FINDINGS, WRONG_CALL, fail, flag, note, value_option, write
from babyrobot_levels.cli.parallel import JobsOption, RayAddressOption, RayOption, Workers, map_all
from babyrobot_levels.cli.reporting import STANDARD_INPUT, findings_text, level_paths, shown_name
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source, write_text

if TYPE_CHECKING:
    from babyrobot_levels.extensions.expect.expecting import Stated


def expect(
    paths: Annotated[
        list[Path], typer.Argument(metavar="PATHS", help="Level files and folders of level files.")
    ],
    add: Annotated[
        list[str] | None,
        value_option("METRIC", "State this metric too, or `lint`; can be repeated."),
    ] = None,
    diff: Annotated[
        bool, flag("--diff", "Show what would change, without changing files.")
    ] = False,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
) -> None:
    """Write what is true of levels today into their files, in `expect`.

    Facts that are true stay as they are written. A figure that is not gets as many decimals as it
    had, and a range is widened; what has no value goes. A level that states nothing gets `success`,
    `best_return`, `best_steps`, `path_length`, `difficulty` and, with things, `needs`. `babyrobot
    lint` then tells which facts are not true any more.

    Exits with status 1 if a file has errors.

    Examples:

      babyrobot expect levels/first.yaml

      babyrobot expect --add fragility --add lint levels/first.yaml
    """
    from babyrobot_levels.extensions.expect.expecting import check_names

    try:
        check_names(add or [])
    except ValueError as error:
        fail(f"--add: {error}", "`babyrobot show` shows the metrics of a level")
    if STANDARD_INPUT in paths:
        fail("facts are written into files, and not to standard output")
    files, workers = level_paths(paths), Workers(jobs, ray, ray_address)
    found = map_all(partial(stated_in, tuple(add or ())), files, workers, "measuring")
    outcomes = dict(zip(files, found, strict=True))
    stated = {path: each for path, each in outcomes.items() if not isinstance(each, LevelError)}
    changed = {path: each for path, each in stated.items() if each.text != each.source.text}
    unwritten = 0
    if diff:
        show_changes((path, each.source.text, each.text) for path, each in changed.items())
    else:
        unwritten = sum(not _written(path, each) for path, each in changed.items())
    errors = [each for each in outcomes.values() if isinstance(each, LevelError)]
    write(findings_text([found for each in errors for found in each.diagnostics], sys.stdout))
    counts = [
        (len(changed) - unwritten, "would change" if diff else "changed"),
        (len(stated) - len(changed), "left unchanged"),
        (len(errors), "with errors"),
    ]
    write(", ".join(f"{n} file{'s' * (n != 1)} {what}" for n, what in counts if n) + "\n")
    if unwritten:
        raise typer.Exit(WRONG_CALL)
    if errors:
        raise typer.Exit(FINDINGS)


def stated_in(add: tuple[str, ...], path: Path) -> Stated | LevelError:
    """State the facts of a file, or return what is wrong with it. Nothing is written."""
    from babyrobot_levels.extensions.expect.expecting import stated

    try:
        return stated(read_source(path), path, add)
    except LevelError as error:
        return error


def _written(path: Path, stated: Stated) -> bool:
    """Write a file, and what changed in it. Return False if that failed."""
    try:
        write_text(path, stated.source.mark + stated.text)
    except OSError as error:
        note(f"error: {path} cannot be written ({error.strerror or error})")
        return False
    for change in stated.changes:
        write(f"{one_line(shown_name(path))}: {change}\n")
    return True
