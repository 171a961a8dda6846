"""`babyrobot install` and `babyrobot uninstall`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    FormatOption,
    ReportFormat,
    fail,
    note,
    write,
    write_json,
)
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.library.packs.archive import Archive
    from babyrobot_levels.library.packs.store import Installation

MAX_SHOWN = 20
"""The largest number of levels that are listed."""


def install(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Pack to install, a .brlpack file.")],
    force: Annotated[
        bool,
        typer.Option(
            "--force",
            help="Replace also a later version, or another pack of the same version.",
        ),
    ] = False,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Install a pack of levels, which are then called PACK/LEVEL.

    The checksums of all files and the digests of all levels are verified first. An earlier version
    is replaced atomically: an interrupted call changes nothing.

    Exits with status 1 if the pack is not valid.

    Examples:

      babyrobot install zoo-1.0.0.brlpack

      babyrobot preview zoo/lion
    """
    from babyrobot_levels.library.packs import store
    from babyrobot_levels.library.packs.format import PackConflictError, PackError

    try:
        done = store.install(file, force=force)
    except PackError as error:
        note(f"error: {one_line(f'{file} was not installed: {error}')}")
        raise typer.Exit(FINDINGS) from None
    except PackConflictError as error:
        fail(f"{file} was not installed: {error}", error.help)
    except IsADirectoryError:
        fail(f"{file} is a folder", "use `babyrobot pack` to make a pack of it")
    except FileNotFoundError as error:
        if error.filename != str(file):
            raise
        fail(f"no such file: {file}", "give the path of a .brlpack file")
    except OSError as error:
        where = f": {error.filename}" if error.filename else ""
        fail(f"{file} was not installed: {error.strerror or error}{where}")
    if report_format is ReportFormat.JSON:
        write_json(_to_dict(done.archive, done))
    else:
        _write_summary(done.archive, done)


def uninstall(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the pack.")],
) -> None:
    """Remove an installed pack.

    Examples:

      babyrobot uninstall zoo
    """
    from babyrobot_levels.library.packs import store
    from babyrobot_levels.library.packs.format import PackConflictError, PackNotFoundError
    from babyrobot_levels.library.packs.known import carried_packs

    try:
        gone = store.uninstall(name)
    except PackNotFoundError as error:
        for carried in carried_packs():
            if carried.name == name:
                package = carried.package_name
                fail(
                    f"{name} is part of the Python package {package or 'without a name'}",
                    f"pip uninstall {package}" if package else None,
                )
        fail(str(error), "see `babyrobot list --packs`")
    except PackConflictError as error:
        fail(str(error), error.help)
    write(f"uninstalled {gone.name}{f' {gone.version}' if gone.version else ''}\n")


def _to_dict(archive: Archive, done: Installation) -> dict[str, Any]:
    return {
        "name": done.pack.name,
        "version": done.pack.version,
        "before": done.before,
        "changed": done.contents is not None,
        "folder": str(done.pack.folder),
        "sha256": archive.sha256,
        "levels": [
            {"name": f"{done.pack.name}/{name}", "digest": entry.digest}
            for name, entry in sorted(archive.manifest.levels.items())
        ],
    }


def _write_summary(archive: Archive, done: Installation) -> None:
    name, version = done.pack.name, done.pack.version
    if done.contents is None:
        write(f"{name} {version} is already installed\n")
        return
    if done.before is None:
        what = f"installed {name} {version}"
    elif done.before == version:
        what = f"reinstalled {name} {version}"
    else:
        what = f"replaced {name} {done.before} with {version}"
    write(f"{what}: {done.contents.summary()}\n")
    names = sorted([*archive.manifest.levels, *done.contents.suites])
    for level in names[:MAX_SHOWN]:
        write(f"  {name}/{level}\n")
    if len(names) > MAX_SHOWN:
        write(f"  and {len(names) - MAX_SHOWN:,} more\n")
