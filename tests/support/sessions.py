"""Sessions at the command line, written down as one would see them, and run again.

A session file holds commands (`$ babyrobot …`), comments (`## …`) and, below each command, what it
printed: standard output as it is, standard error behind `2> `, and the exit status if it is not 0.
Escape characters are shown as `\\e`, the bytes of pictures as `SIZE`. Besides `babyrobot`, a
session knows `cat`, `ls`, `mkdir` and `touch`; a command may begin with `NAME=value` and end with
`< FILE`.
`FOLDER/user` is the folder of a user who has packs.

`python scripts/renew.py tests/cli` writes them anew after a change that is meant.
"""

from __future__ import annotations

import contextlib
import gc
import io
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

from babyrobot_levels.library.search_path import gallery_folder
from support.places import ROOT, TESTS

FOLDER = TESTS / "cli" / "expected"
FILES = TESTS / "cli" / "files"
USER = TESTS / "cli" / "user"
HOME = Path(gallery_folder().parent)
MODULE = "python -m babyrobot_levels"
_TERMINALS = ("NO_COLOR", "FORCE_COLOR", "TERM", "COLORTERM", "TERM_PROGRAM", "COLUMNS",
              "PYTHONIOENCODING")  # fmt: skip
_PICTURE_SIZE = re.compile(
    r"^(2> wrote \S+\.(?:svg|png|gif|html?|pdf) \((?:\d+ × \d+, )?)[\d.]+ (?:bytes|KB|MB)\)$",
    re.M | re.I,
)
"""How long the files of pictures are depends on the versions of libraries, and is not expected."""


@dataclass(frozen=True)
class Result:
    """What a command printed, and how it ended."""

    out: str
    err: str
    status: int


Runner = Callable[[list[str], dict[str, str], bytes], Result]


def environment(folder: Path, **more: str) -> dict[str, str]:
    """Return the variables under which a command in `folder` finds nothing of this machine."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("BABYROBOT", "XDG_", "_TYPER", "COVERAGE"))
        and name not in _TERMINALS
    }
    nobody = str(folder / "nobody")
    package = str(ROOT)
    return {
        **kept,
        "HOME": nobody,
        "XDG_DATA_HOME": nobody,
        "COLUMNS": "80",
        "PYTHONUTF8": "1",
        "PYTHONPATH": package,
        **more,
    }


def babyrobot(
    *arguments: str | Path, given: bytes = b"", status: int | None = None, **variables: str
) -> Result:
    """Run the command in this process, for the current folder; it ends as it should."""
    result = run_here([*map(str, arguments)], environment(Path.cwd(), **variables), given)
    assert result.status in ((0, 1, 2) if status is None else (status,)), result
    assert "Traceback" not in result.err
    return result


def run_here(arguments: list[str], variables: dict[str, str], given: bytes = b"") -> Result:
    """Run the command in this process, from the current folder: much faster."""
    from babyrobot_levels.cli.app import main

    raw = [io.BytesIO(), io.BytesIO()]
    streams = [io.TextIOWrapper(stream, "utf-8", write_through=True) for stream in raw]
    status: Any = 0
    handler = signal.getsignal(signal.SIGINT)
    with (
        mock.patch.dict(os.environ, variables, clear=True),
        mock.patch.object(sys, "argv", ["babyrobot", *arguments]),
        mock.patch.object(sys, "stdin", io.TextIOWrapper(io.BytesIO(given), "utf-8")),
        # The name in the help is that of the script, unless a package is run.
        mock.patch.object(sys.modules["__main__"], "__package__", None),
        contextlib.redirect_stdout(streams[0]),
        contextlib.redirect_stderr(streams[1]),
    ):
        try:
            main()
        except SystemExit as end:
            status = end.code or 0
        finally:
            # The command ends here, and not the process.
            gc.unfreeze()
            with contextlib.suppress(ValueError):
                signal.signal(signal.SIGINT, handler)
    out, err = (stream.getvalue().decode() for stream in raw)
    return Result(out, err, status)


def run_there(arguments: list[str], variables: dict[str, str], given: bytes = b"") -> Result:
    """Run the command as a user does, in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", "babyrobot_levels", *arguments],
        env=variables,
        input=given,
        capture_output=True,
        timeout=60,
        check=False,
    )
    out, err = (text.decode().replace(MODULE, "babyrobot") for text in (done.stdout, done.stderr))
    return Result(out, err, done.returncode)


@contextlib.contextmanager
def prepared_folder() -> Iterator[Path]:
    """Stand in a fresh folder that holds the sessions' files."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve() / "project"
        shutil.copytree(FILES, folder)
        shutil.copytree(USER, folder.with_name("user"))
        os.chdir(folder)
        try:
            yield folder
        finally:
            os.chdir(before)


def played(text: str, runner: Runner = run_here) -> str:
    """Return a session's text with what its commands print now."""
    shown = ""
    with prepared_folder() as folder:
        for line in text.splitlines():
            if not line.startswith(("## ", "$ ")):
                continue
            last = shown.rstrip("\n").rpartition("\n")[2]
            shown += ("\n" if last and not last.startswith("## ") else "") + line + "\n"
            if line.startswith("$ "):
                shown += _told(_run(line[2:], folder, runner), folder)
    return shown


def _run(line: str, folder: Path, runner: Runner) -> Result:
    words = shlex.split(line)
    variables = {}
    while "=" in words[0]:
        name, _, value = words.pop(0).partition("=")
        variables[name] = value.replace("FOLDER", str(folder.parent))
    given = b""
    if "<" in words:
        given = Path(words[words.index("<") + 1]).read_bytes()
        words = words[: words.index("<")]
    command, *arguments = words
    if command == "babyrobot":
        return runner(arguments, environment(folder, **variables), given)
    return Result(_small_tool(command, arguments), "", 0)


def _small_tool(command: str, arguments: list[str]) -> str:
    paths = [Path(argument) for argument in arguments]
    if command == "cat":
        return "".join(path.read_text(encoding="utf-8") for path in paths)
    if command == "ls":
        return "".join(sorted(f"{found.name}\n" for path in paths for found in path.iterdir()))
    for path in paths:
        if command == "mkdir":
            path.mkdir(parents=True)
        elif command == "touch":
            path.touch()
        else:
            raise ValueError(f"a session has no command {command!r}")
    return ""


def _told(result: Result, folder: Path) -> str:
    errors = "".join(f"2> {line}".rstrip(" ") + "\n" for line in result.err.splitlines())
    text = result.out + ("" if result.out.endswith("\n") or not result.out else "[no line end]\n")
    text += errors + (f"[exit {result.status}]\n" if result.status else "")
    # Where this machine keeps the package and the session is not part of what is expected.
    for place, name in ((HOME, "PACKAGE"), (folder.parent, "FOLDER")):
        text = text.replace(place.as_uri(), f"file:///{name}").replace(str(place), name)
    text = _PICTURE_SIZE.sub(r"\1SIZE)", text)
    return text.replace("\x1b", "\\e")
