"""`babyrobot install` and `babyrobot uninstall`: packs in the user's folder."""

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
"""So many levels are named."""


def install(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The pack, a .brlpack file.")],
    force: Annotated[
        bool,
        typer.Option(
            "--force",
            help="Also in the place of a later version, or of another pack of this version.",
        ),
    ] = False,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Put a pack into your own folder: its levels are then called PACK/LEVEL.

    The pack is checked first: every byte against its sums, every level against its digest. A
    damaged one is refused, and changes nothing. An earlier version of the pack is replaced, in one
    step: if something interrupts it, the old one is there as before.

    Ends with status 1 if the pack is refused.

    Examples:

      babyrobot install zoo-1.0.0.brlpack

      babyrobot preview zoo/lion
    """
    from babyrobot_levels.library.packs import archive, store
    from babyrobot_levels.library.packs.errors import PackConflictError, PackError

    try:
        read = archive.read_archive(file)
        done = store.install(read, force=force)
    except PackError as error:
        note(f"error: {one_line(f'{file} is not installed: {error}')}")
        raise typer.Exit(FINDINGS) from None
    except PackConflictError as error:
        fail(f"{file} is not installed: {error}", error.help)
    except IsADirectoryError:
        fail(f"{file} is a folder", "`babyrobot pack` makes a pack of one")
    except FileNotFoundError as error:
        if error.filename != str(file):
            raise
        fail(f"there is no file {file}", "a pack is installed from its .brlpack file")
    except OSError as error:
        where = f": {error.filename}" if error.filename else ""
        fail(f"{file} is not installed: {error.strerror or error}{where}")
    if report_format is ReportFormat.JSON:
        write_json(_to_dict(read, done))
    else:
        _tell(read, done)


def uninstall(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The pack's name.")],
) -> None:
    """Take a pack out of your own folder again.

    Examples:

      babyrobot uninstall zoo
    """
    from babyrobot_levels.library.packs import store
    from babyrobot_levels.library.packs.carried import carried_packs
    from babyrobot_levels.library.packs.errors import PackConflictError, PackNotFoundError

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
        fail(str(error), "`babyrobot list --packs` shows all packs")
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


def _tell(archive: Archive, done: Installation) -> None:
    name, version = done.pack.name, done.pack.version
    if done.contents is None:
        write(f"{name} {version} is there already\n")
        return
    if done.before is None:
        what = f"installed {name} {version}"
    elif done.before == version:
        what = f"installed {name} {version} anew"
    else:
        what = f"replaced {name} {done.before} by {version}"
    write(f"{what}: {done.contents.summary()}\n")
    names = sorted([*archive.manifest.levels, *done.contents.suites])
    for level in names[:MAX_SHOWN]:
        write(f"  {name}/{level}\n")
    if len(names) > MAX_SHOWN:
        write(f"  and {len(names) - MAX_SHOWN:,} more\n")
