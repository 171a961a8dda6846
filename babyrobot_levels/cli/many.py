"""Many levels in commands: folders, packs and suites, and a row for each level."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.app import INTERRUPTED
from babyrobot_levels.cli.console import (
    FINDINGS,
    STANDARD_OUTPUT,
    TableFormat,
    fail,
    flag,
    note,
    value_option,
    write,
    write_table,
)
from babyrobot_levels.cli.inputs import is_one_level, levels_named
from babyrobot_levels.cli.meant import NO_LEVEL
from babyrobot_levels.cli.parallel import Workers, track
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    Row = brl.LevelValue | brl.LevelMetrics
    Rows = Callable[..., Generator[Row]]

RowsOption = Annotated[
    Path | None,
    value_option(
        "FILE", "Write a row for each level to this file, as lines of JSON.", "--output", "-o"
    ),
]
ResumeOption = Annotated[
    bool, flag("--resume", "Keep the rows of the same call in the file, and append the others.")
]
OverwriteOption = Annotated[bool, flag("--force", "Overwrite the file.")]
KeepGoingOption = Annotated[
    bool, flag("--keep-going", "Go on after a level with an error, which then stands in its row.")
]


@dataclass(frozen=True, slots=True)
class RowOptions:
    """The options of commands that write a row for each level."""

    split: str | None
    kind: TableFormat
    output: Path | None
    resume: bool
    force: bool
    keep_going: bool
    workers: Workers

    @property
    def want_rows(self) -> bool:
        """Whether the options ask for rows, even of a single level."""
        rows_only = self.kind is TableFormat.CSV or self.resume
        return rows_only or self.split is not None or self.output is not None


@dataclass(frozen=True, slots=True)
class Columns:
    """What is written of rows.

    Attributes:
        names: the columns of CSV: the keys of rows as plain data.
        shown: the columns of a table for people: heading, key, and how a value is written.
        verb: what is done, for the progress bar.
    """

    names: Sequence[str]
    shown: Sequence[tuple[str, str, Callable[[Any], str]]]
    verb: str


def number(value: float | str) -> str:
    """Return a number of plain data, where infinities are texts, as people read it."""
    return value if isinstance(value, str) else f"{value:.6g}"


def levels_for_rows(words: list[str], options: RowOptions) -> brl.Suite | list[Any] | None:
    """Return the levels that arguments name; None for one level that is shown as a whole."""
    if not options.want_rows and is_one_level(words):
        return None
    return levels_named(words, options.split)


# -- rows ----------------------------------------------------------------------------------


def write_rows(
    make: Rows, levels: brl.Suite | list[Any], columns: Columns, options: RowOptions
) -> None:
    """Write a row for each level; end the command with status 1 if a level has an error.

    Args:
        make: `solve_many` or one like it, with its options.
        levels: the levels.
        columns: what is written.
        options: how, and where to.
    """
    from babyrobot_levels.agents.many import reason

    target = _target(columns, options, len(levels))
    first, errors = target.first, 0
    part = levels[first:]
    try:
        executor = options.workers.executor(len(part))
        with closing(make(part, executor=executor, keep_going=True)) as rows:
            for found in track(rows, len(part), columns.verb):
                row = replace(found, index=first + found.index)
                if row.error is not None:
                    errors += 1
                    name = f" ({one_line(row.name)})" if row.name else ""
                    note(f"level {row.index}{name}: {one_line(reason(row.error))}")
                    if not options.keep_going:
                        break
                target.put(_plain(row))
    except KeyboardInterrupt:
        target.interrupt()
        raise
    target.close()
    if errors:
        raise typer.Exit(FINDINGS)


def _plain(row: Row) -> dict[str, Any]:
    """Return a row as plain data."""
    # Nine digits are the same on every machine; the last ones are not.
    return {
        name: float(f"{value:.9g}") if isinstance(value, float) else value
        for name, value in row.to_dict().items()
    }


def _target(columns: Columns, options: RowOptions, count: int) -> _Lines:
    """Return where rows are written."""
    if options.output is not None:
        if options.kind is TableFormat.CSV or NO_LEVEL.fullmatch(options.output.name):
            fail(
                "--output writes lines of JSON",
                "give a file such as rows.jsonl, or redirect the output: --format csv > rows.csv",
            )
        return _File.opened(options.output, count, resume=options.resume, force=options.force)
    if options.resume:
        fail("--resume continues a file", "name it with --output")
    if options.kind is TableFormat.JSON:
        return _Lines()
    return _Csv(columns) if options.kind is TableFormat.CSV else _Table(columns)


def _line(row: dict[str, Any]) -> str:
    return json.dumps(row, allow_nan=False)


class _Lines:
    """Lines of JSON on standard output; other classes write rows elsewhere."""

    first = 0
    """The index of the first row that is needed."""

    def put(self, row: dict[str, Any]) -> None:
        """Write a row."""
        write(_line(row) + "\n")

    def interrupt(self) -> None:
        """Write what there is to say after Ctrl-C: nothing."""

    def close(self) -> None:
        """Write what comes after the last row: nothing."""


class _Csv(_Lines):
    """CSV on standard output."""

    def __init__(self, columns: Columns):
        self._rows = csv.DictWriter(sys.stdout, columns.names, lineterminator="\n")
        self._rows.writeheader()

    def put(self, row: dict[str, Any]) -> None:
        texts = {
            name: " ".join(map(str, value))
            for name, value in row.items()
            if isinstance(value, list)
        }
        self._rows.writerow({**row, **texts})


class _Table(_Lines):
    """A table for people."""

    def __init__(self, columns: Columns):
        self._columns = columns.shown
        self._cells: list[list[str]] = []

    def put(self, row: dict[str, Any]) -> None:
        name = row["name"] or row["digest"] or f"level {row['index']}"
        values = [(row.get(key), text) for _, key, text in self._columns]
        cells = ("-" if value is None else text(value) for value, text in values)
        self._cells.append([printable(name), *cells])

    def close(self) -> None:
        if self._cells:
            headings = [heading for heading, _, _ in self._columns]
            less = [each for each in ("loops", "dead_ends") if each in headings]
            write_table(("level", *headings), self._cells, less)


MAX_LINE = 1 << 20
"""The most bytes of a row."""


@dataclass
class _File(_Lines):
    """Lines of JSON in a file, which grows line by line: what is done stays, whatever happens.

    Attributes:
        path: the file.
        count: the number of levels.
        kept: the number of rows that it has.
        last: the last of them. It is made again, to see that it is of the same call.
        size: the length of these rows, without what may follow of a row that was cut off.
        written: the number of new rows.
    """

    path: Path
    count: int
    kept: int = 0
    last: bytes = b""
    size: int = 0
    written: int = field(default=0, init=False)

    @classmethod
    def opened(cls, path: Path, count: int, *, resume: bool, force: bool) -> _File:
        """Return a file to which rows can be written; end the command if it must not be."""
        if path == STANDARD_OUTPUT:
            fail("--output is the path of a file", "use --format json for standard output")
        if path.is_dir() or (path.exists() and not path.is_file()):
            fail(f"{path} is not a regular file")
        if path.exists() and not (resume or force):
            fail(f"{path} already exists", "use --resume to continue it, or --force to overwrite")
        file = cls(path, count)
        if resume and path.exists():
            file._read()
        file.first = max(0, file.kept - 1)
        return file

    def _read(self) -> None:
        """Read which rows there are."""
        with self.path.open("rb") as file:
            while line := file.readline(MAX_LINE):
                begins = b'{"index": %d,' % self.kept
                if self.kept == self.count or not line.startswith(begins[: len(line)]):
                    self._refuse()
                if not line.endswith(b"\n"):
                    return
                self.kept, self.last, self.size = self.kept + 1, line, self.size + len(line)

    def _refuse(self) -> None:
        fail(
            f"{self.path} was written for other levels or with other options",
            "choose another file, or use --force without --resume to overwrite this one",
        )

    def put(self, row: dict[str, Any]) -> None:
        """Append a row, or compare it with the last one that was there."""
        line = _line(row).encode("ascii")
        if self.last:
            if line + b"\n" != self.last:
                self._refuse()
            self.last = b""
            return
        self._append(line)
        self.written += 1

    def _append(self, line: bytes) -> None:
        """Append a line, the first one behind the rows that are kept."""
        from babyrobot_levels.text.files import append_line, write_bytes

        try:
            if not (self.written or self.size):
                # What was there stays until there is something in its place.
                write_bytes(self.path, line + b"\n" if line else b"")
                return
            if not self.written:
                with self.path.open("rb+") as file:
                    file.truncate(self.size)
            append_line(self.path, line)
        except OSError as error:
            there = self.kept + self.written
            rows = f"{there:,} of {self.count:,} rows are in it; use --resume to continue it"
            why = f"{self.path} cannot be written ({error.strerror or error})"
            fail(why, rows if there else None)

    def interrupt(self) -> None:
        """Say how many rows there are."""
        there = self.kept + self.written
        note(f"stopped: {there:,} of {self.count:,} rows are in {self.path}")
        note("  help: continue with the same call and --resume")
        raise typer.Exit(INTERRUPTED) from None

    def close(self) -> None:
        """Say what was written."""
        if not self.written:
            # There is a file in any case, and nothing of a row that was cut off.
            self._append(b"")
        kept = f"; kept {self.kept:,}" if self.kept else ""
        rows = f"{self.written:,} row{'s' * (self.written != 1)}"
        write(f"wrote {rows} to {one_line(str(self.path))}{kept}\n")
