"""`babyrobot validate`: report errors with their positions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from babyrobot_levels.cli.console import FINDINGS
from babyrobot_levels.cli.parallel import JobsOption, RayAddressOption, RayOption, Workers, map_all
from babyrobot_levels.cli.reporting import (
    STANDARD_INPUT,
    FindingsFormat,
    FindingsOption,
    PathsArgument,
    level_paths,
    read_path,
    write_report,
)
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    from babyrobot_levels.text.diagnostics import Diagnostic


def validate(
    paths: PathsArgument = None,
    report_format: FindingsOption = FindingsFormat.TEXT,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
) -> None:
    """Check level files and report every error with its position and a suggestion.

    Exit status: 0 if all files are valid, 1 if there are errors.

    Examples:

      babyrobot validate levels/first.yaml

      babyrobot validate --format json levels/
    """
    files, workers = level_paths(paths), Workers(jobs, ray, ray_address)
    found = [each for errors in map_all(errors_of, files, workers, "checking") for each in errors]
    write_report(report_format, found, files)
    if found:
        raise typer.Exit(FINDINGS)


def errors_of(path: Path) -> list[Diagnostic]:
    """Return the errors of a file, or of standard input for `-`."""
    from babyrobot_levels.suites import checking

    try:
        source = read_path(path)
    except LevelError as error:
        return [*error.diagnostics]
    return checking.errors_of(source, None if path == STANDARD_INPUT else path)
