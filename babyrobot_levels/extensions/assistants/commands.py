"""Commands for assistants that write levels: `babyrobot mcp` and `skill`."""

import multiprocessing
import os
import signal
from pathlib import Path
from typing import Annotated

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import ForceOption, OutputOption, fail, put, value_option
from babyrobot_levels.text.files import ENDINGS


def mcp(
    folder: Annotated[
        Path | None, value_option("DIR", "Let levels in this folder be read and written.")
    ] = None,
    seconds: Annotated[
        float, typer.Option(metavar="S", min=1, help="How long a call may take.")
    ] = 60.0,
) -> None:
    """Serve tools for assistants that write levels, by the Model Context Protocol.

    It is started by an assistant, and speaks on standard input and output. The tools take levels
    as texts; without --folder they read and write no files.

    Examples:

      babyrobot mcp

      babyrobot mcp --folder levels
    """
    try:
        server = brl.mcp(folder, seconds=seconds)
    except ImportError as error:
        if error.name != "mcp":
            raise
        message, _, advice = str(error).partition(": ")
        fail(message, advice)
    except NotADirectoryError as error:
        fail(str(error))
    for number in ENDINGS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)
    server.run()


def _end(number: int, _frame: object) -> None:
    """End at once: a thread may wait for input for ever, and a process may work for a call."""
    for process in multiprocessing.active_children():
        process.kill()
    os._exit(128 + number)


def skill(output: OutputOption = None, force: ForceOption = False) -> None:
    """Print a page for assistants that write levels: the language, the loop of commands, traps.

    It is a SKILL.md, for the folder in which an assistant looks for skills.

    Examples:

      babyrobot skill

      babyrobot skill -o SKILL.md
    """
    put(brl.skill(), output, force=force)
