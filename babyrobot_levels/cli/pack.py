"""`babyrobot pack`: a folder of levels as one file that can be passed on."""

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
    wants_color,
    write,
    write_json,
)
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.library.packs.build import Packed

MAX_SHOWN = 10
"""So many of some files are named."""


def pack(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="The pack's folder.")] = Path(),
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="The file to write.  [default: NAME-VERSION.brlpack, in the current folder]",
            show_default=False,
        ),
    ] = None,
    force: ForceOption = False,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Check a folder of levels, and write it as a pack, which `babyrobot install` takes.

    The folder has a file pack.yaml, which says what the pack is:

      name: zoo

      version: 1.0.0

      description: Mazes with animals in them.

    All YAML files below it belong to the pack: levels, suites, and themes in folders called
    themes. They are checked as by `babyrobot lint`: errors are refused, other findings are shown
    on standard error. Files called README.md and LICENSE are included, other files are left out.
    The same files give the same pack, byte for byte.

    Exit status: 0 if the pack is written, even with warnings; 1 if there are errors.

    Examples:

      babyrobot pack

      babyrobot pack zoo -o zoo.brlpack
    """
    from babyrobot_levels.library.packs import build as packing
    from babyrobot_levels.library.packs.archive import SUFFIX
    from babyrobot_levels.library.packs.errors import PackError
    from babyrobot_levels.lint.runner import lint_files
    from babyrobot_levels.text.files import PACK_FILE

    if not folder.is_dir():
        fail(f"{folder} is not a folder" if folder.exists() else f"there is no folder {folder}")
    if (folder / PACK_FILE).is_dir():
        fail(
            f"{folder / PACK_FILE} is a folder", "it has to be a file, which says what the pack is"
        )
    if not (folder / PACK_FILE).exists():
        other = (folder / PACK_FILE).with_suffix(".yml")
        fail(
            f"there is no {PACK_FILE} in {folder.resolve()}",
            f"rename {other.name}"
            if other.exists()
            else "it says what the pack is; `babyrobot pack --help` shows one",
        )
    try:
        packed = packing.pack(folder, lint_files)
    except PackError as error:
        note(f"error: {one_line(f'{folder} cannot be a pack: {error}')}")
        raise typer.Exit(FINDINGS) from None
    fields, data = packed.contents.fields, packed.data
    if fields is None or data is None:
        _report(packed, folder, report_format)
        note("no pack was written: fix the errors first")
        raise typer.Exit(FINDINGS)
    _warn(packed)
    path = output or Path(f"{fields.name}-{fields.version}{SUFFIX}")
    save(path, data, force=force)
    told = {
        "name": fields.name,
        "version": fields.version,
        "file": str(path),
        "size": len(data),
        "sha256": hashlib.sha256(data).hexdigest(),
        **_inside(packed),
    }
    if report_format is ReportFormat.JSON:
        write_json(told)
    else:
        _tell(told, packed.contents.summary())
    if packed.local:
        names = _few(packed.local)
        note(f"the schema line says where a file lies on your machine, for all to read: {names}")


def _report(packed: Packed, folder: Path, report_format: ReportFormat) -> None:
    from babyrobot_levels.cli.reporting import FindingsFormat, write_report

    files = [folder / path for path in packed.paths]
    write_report(FindingsFormat(report_format), packed.diagnostics, files, clean="clean")


def _warn(packed: Packed) -> None:
    """Write the findings that do not prevent a pack to standard error."""
    if packed.diagnostics:
        from babyrobot_levels.lint.reporters import text

        report = text.render(packed.diagnostics, color=wants_color(sys.stderr))
        sys.stderr.write(f"{report}\n{text.summary(packed.diagnostics, len(packed.paths))}\n")


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


def _tell(told: dict[str, Any], summary: str) -> None:
    write(f"{told['name']} {told['version']}: {summary}\n")
    width = max((len(each["name"]) for each in (*told["levels"], *told["suites"])), default=0)
    for level in told["levels"]:
        what = level["digest"] or "another maze at each reset"
        write(f"  {level['name'].ljust(width)}  {what}\n")
    for suite in told["suites"]:
        write(f"  {suite['name'].ljust(width)}  a suite\n")
    if told["left_out"]:
        write(f"left out: {_few(told['left_out'])}\n")
    write(f"wrote {one_line(told['file'])}: {told['size']:,} bytes, sha256:{told['sha256']}\n")


def _few(names: Sequence[str]) -> str:
    """Return the first of some names, and how many more there are."""
    more = len(names) - MAX_SHOWN
    told = ", ".join(map(one_line, names[:MAX_SHOWN]))
    return f"{told} and {more:,} more" if more > 0 else told
