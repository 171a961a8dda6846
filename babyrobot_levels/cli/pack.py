"""`babyrobot pack`: a folder of levels as one file."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    ForceOption,
    FormatOption,
    ReportFormat,
    fail,
    note,
    save,
    write,
    write_json,
)
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.library.packs.build import Packed

MAX_SHOWN = 10
"""The largest number of files that a message names."""


def pack(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the pack.")] = Path(),
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Write to this file.  [default: NAME-VERSION.brlpack]",
            show_default=False,
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
    from babyrobot_levels.library.packs import build as packing
    from babyrobot_levels.library.packs.archive import SUFFIX
    from babyrobot_levels.library.packs.format import PackError
    from babyrobot_levels.linter.linting import lint
    from babyrobot_levels.text.files import PACK_FILE

    if not folder.is_dir():
        fail(f"{folder} is not a folder" if folder.exists() else f"no such folder: {folder}")
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
        packed = packing.pack(folder, lint)
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


def _report(packed: Packed, folder: Path, report_format: ReportFormat) -> None:
    from babyrobot_levels.cli.reporting import FindingsFormat, write_report

    files = [folder / path for path in packed.paths]
    write_report(FindingsFormat(report_format), packed.diagnostics, files, clean="clean")


def _warn(packed: Packed) -> None:
    """Write the findings that do not prevent a pack to standard error."""
    if packed.diagnostics:
        from babyrobot_levels.cli.reporting import findings_text, summary

        report = findings_text(packed.diagnostics, sys.stderr)
        sys.stderr.write(f"{report}\n{summary(packed.diagnostics, len(packed.paths))}\n")


def _inside(packed: Packed) -> dict[str, Any]:
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
