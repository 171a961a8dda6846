"""`babyrobot pack`, `install` and `uninstall`: folders of levels as files, and back."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    ForceOption,
    FormatOption,
    ReportFormat,
    fail,
    flag,
    note,
    quoted,
    save,
    value_option,
    write,
    write_json,
)
from babyrobot_levels.extensions.packs import build as packing
from babyrobot_levels.extensions.packs import store
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.words import no_file

if TYPE_CHECKING:
    from babyrobot_levels.extensions.packs.archive import Archive

MAX_SHOWN = 10
"""The largest number of files that a message names."""


def pack(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the pack.")] = Path(),
    output: Annotated[
        Path | None,
        value_option(
            "FILE", "Write to this file.  [default: NAME-VERSION.brlpack]", "--output", "-o"
        ),
    ] = None,
    force: ForceOption = False,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Check a folder of levels, and pack it into one file for `babyrobot install`.

    The folder needs a file pack.yaml that describes the pack:

      name: zoo

      version: 1.0.0

      description: Mazes with animals in them.

    All YAML files in it and its subfolders belong to the pack: levels, suites, and themes in
    folders named themes. They are checked as by `babyrobot lint`: errors are refused, other
    findings are shown on standard error. Files named README.md and LICENSE are included, other
    files are left out. The same files make the same pack, byte for byte.

    Exits with status 1 if there are errors.

    Examples:

      babyrobot pack

      babyrobot pack zoo -o zoo.brlpack
    """
    from babyrobot_levels.extensions.packs.archive import SUFFIX, PackError
    from babyrobot_levels.text.files import PACK_FILE

    if not folder.is_dir():
        if folder.exists():
            fail(
                f"{folder} is not a folder",
                f"give the folder: babyrobot pack {quoted(folder.parent)}",
            )
        fail(f"no such folder: {folder}")
    if (folder / PACK_FILE).is_dir():
        fail(f"{folder / PACK_FILE} is a folder, not a file")
    if not (folder / PACK_FILE).exists():
        other = (folder / PACK_FILE).with_suffix(".yml")
        fail(
            f"no {PACK_FILE} in {folder.resolve()}",
            f"rename {other.name}"
            if other.exists()
            else "it describes the pack; see `babyrobot pack --help` for an example",
        )
    try:
        packed = packing.pack(folder, brl.lint)
    except PackError as error:
        note(f"error: {one_line(f'{folder} cannot be packed: {error}')}")
        raise typer.Exit(FINDINGS) from None
    fields, data = packed.contents.fields, packed.data
    if fields is None or data is None:
        _report(packed, folder, report_format)
        note("no pack was written: fix the errors first")
        raise typer.Exit(FINDINGS)
    _warn(packed)
    path = output or Path(f"{fields.name}-{fields.version}{SUFFIX}")
    save(path, data, force=force)
    facts = {
        "name": fields.name,
        "version": fields.version,
        "file": str(path),
        "size": len(data),
        "sha256": hashlib.sha256(data).hexdigest(),
        **_inside(packed),
    }
    if report_format is ReportFormat.JSON:
        write_json(facts)
    else:
        _write_summary(facts, packed.contents.summary())
    if packed.local:
        names = _few(packed.local)
        note(f"the $schema line contains a path of your machine: {names}")


def _report(packed: brl.Packed, folder: Path, report_format: ReportFormat) -> None:
    from babyrobot_levels.cli.reporting import write_report

    files = [folder / path for path in packed.paths]
    as_json = report_format is ReportFormat.JSON
    write_report("json" if as_json else "text", packed.diagnostics, files, clean="clean")


def _warn(packed: brl.Packed) -> None:
    """Write the findings that do not prevent a pack to standard error."""
    if packed.diagnostics:
        from babyrobot_levels.cli.reporting import findings_text, summary

        report = findings_text(packed.diagnostics, sys.stderr)
        sys.stderr.write(f"{report}\n{summary(packed.diagnostics, len(packed.paths))}\n")


def _inside(packed: brl.Packed) -> dict[str, Any]:
    return {
        "levels": [
            {"name": name, "file": entry.file, "digest": entry.digest}
            for name, entry in sorted(packed.contents.levels.items())
        ],
        "suites": [
            {"name": name, "file": file} for name, file in sorted(packed.contents.suites.items())
        ],
        "themes": packed.contents.themes,
        "left_out": packed.left_out,
    }


def _write_summary(facts: dict[str, Any], summary: str) -> None:
    write(f"{facts['name']} {facts['version']}: {summary}\n")
    width = max((len(each["name"]) for each in (*facts["levels"], *facts["suites"])), default=0)
    for level in facts["levels"]:
        what = level["digest"] or "random maze"
        write(f"  {level['name'].ljust(width)}  {what}\n")
    for suite in facts["suites"]:
        write(f"  {suite['name'].ljust(width)}  suite\n")
    if facts["left_out"]:
        write(f"left out: {_few(facts['left_out'])}\n")
    write(f"{facts['size']:,} bytes, sha256:{facts['sha256']}\n")


def _few(names: Sequence[str]) -> str:
    """Return the first few names, and the number of the others."""
    more = len(names) - MAX_SHOWN
    text = ", ".join(map(one_line, names[:MAX_SHOWN]))
    return f"{text} and {more:,} more" if more > 0 else text


MAX_LISTED = 20
"""The largest number of levels that are listed."""


def install(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Pack to install, a .brlpack file.")],
    force: Annotated[
        bool, flag("--force", "Replace also a later version, or another pack of the same version.")
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
    try:
        done = store.install(file, force=force)
    except brl.PackError as error:
        note(f"error: {one_line(f'{file} was not installed: {error}')}")
        raise typer.Exit(FINDINGS) from None
    except brl.PackConflictError as error:
        fail(f"{file} was not installed: {error}", error.help)
    except IsADirectoryError:
        fail(f"{file} is a folder", "use `babyrobot pack` to make a pack of it")
    except FileNotFoundError as error:
        if error.filename != str(file):
            raise
        fail(f"no such file: {file}{no_file(str(file))}", "give the path of a .brlpack file")
    except OSError as error:
        where = f": {error.filename}" if error.filename else ""
        fail(f"{file} was not installed: {error.strerror or error}{where}")
    if report_format is ReportFormat.JSON:
        write_json(_to_dict(done.archive, done))
    else:
        _write_installed(done.archive, done)


def uninstall(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the pack.")],
) -> None:
    """Remove an installed pack.

    Examples:

      babyrobot uninstall zoo
    """
    from babyrobot_levels.library.packs import carried_packs

    try:
        gone = store.uninstall(name)
    except brl.PackNotFoundError as error:
        for carried in carried_packs():
            if carried.name == name:
                package = carried.package_name
                fail(
                    f"{name} is part of the Python package {package or 'without a name'}",
                    f"pip uninstall {package}" if package else None,
                )
        fail(str(error), "see `babyrobot list --packs`")
    except brl.PackConflictError as error:
        fail(str(error), error.help)
    write(f"uninstalled {gone.name}{f' {gone.version}' if gone.version else ''}\n")


def _to_dict(archive: Archive, done: brl.Installation) -> dict[str, Any]:
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


def _write_installed(archive: Archive, done: brl.Installation) -> None:
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
    for level in names[:MAX_LISTED]:
        write(f"  {name}/{level}\n")
    if len(names) > MAX_LISTED:
        write(f"  and {len(names) - MAX_LISTED:,} more\n")
