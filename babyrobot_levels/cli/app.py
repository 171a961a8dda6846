"""The application: its commands, and what happens when one of them fails."""

from __future__ import annotations

import gc
import io
import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from babyrobot_levels import __version__
from babyrobot_levels.cli import (
    compare,
    diff,
    export_level,
    format_levels,
    generate,
    import_level,
    install,
    lint,
    list_levels,
    new_level,
    pack,
    play,
    preview,
    print_schema,
    resolve,
    rule,
    share,
    show,
    solve,
    validate,
)
from babyrobot_levels.cli.console import FINDINGS, WRONG_CALL, note


class _Commands(TyperGroup):
    """The commands."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was asked for, or say what is wrong with the call."""
        try:
            return super().invoke(ctx)
        except typer.BadParameter as error:
            # What a user typed was a word, not a value that raised an error.
            error.message = error.message.removeprefix("Value error, ")
            raise


app = typer.Typer(
    name="babyrobot",
    cls=_Commands,
    help="Grid worlds as files: make, check, preview and play levels.",
    epilog="A LEVEL is a name (`babyrobot list` shows them), pack/name, the path of a "
    "file, a share code, or `-` for standard input.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)

app.command("new-level", short_help="Write a new level file.")(new_level.new_level)
app.command("generate", short_help="Write levels to order.")(generate.generate)
app.command("validate", short_help="Check level files.")(validate.validate)
app.command("lint", short_help="Find faults of play and style.")(lint.lint)
app.command("format", short_help="Write level files in one form.")(format_levels.format_levels)
app.command("rule", short_help="Explain what can be found.")(rule.rule)
app.command("preview", cls=preview.PreviewCommand)(preview.preview)
app.command("play", short_help="Walk a level with the arrow keys.")(play.play)
app.command("list", short_help="List the levels that have names.")(list_levels.list_levels)
app.command("show", short_help="Tell all about one level.")(show.show)
app.command("solve", short_help="Solve a level exactly.")(solve.solve)
app.command("compare", short_help="Compare a level with another game.")(compare.compare)
app.command("diff", short_help="Tell what changed in the game.")(diff.diff)
app.command("resolve", short_help="Write a maze out as walls.")(resolve.resolve)
app.command("share", short_help="Print a level as a share code.")(share.share)
app.command("import", short_help="Read worlds of other programs.")(import_level.import_level)
app.command("export", short_help="Write for other programs.")(export_level.export_level)
app.command("pack", short_help="Write a folder of levels as one file.")(pack.pack)
app.command("install", short_help="Install a pack of levels.")(install.install)
app.command("uninstall", short_help="Take an installed pack away.")(install.uninstall)
app.command("schema", short_help="Print the JSON schema.")(print_schema.print_schema)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"babyrobot-levels {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", "-V", callback=_print_version, is_eager=True, help="Show the version."
        ),
    ] = False,
) -> None:
    """Grid worlds as files: make, check, preview and play levels."""


def main() -> None:
    """Run the command line. Nothing that a user types or feeds it ends in a traceback."""
    from babyrobot_levels.text.errors import BabyRobotError, LevelError

    _prepare_streams()
    # Levels make many small matrices, over which the threads of BLAS only wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Nothing that a command makes lives in circles for long: looking for them can wait.
    gc.set_threshold(100_000, 50, 50)
    try:
        app(prog_name="babyrobot")
    except LevelError as error:
        note(str(error))
        sys.exit(FINDINGS)
    except BabyRobotError as error:
        note(f"error: {error}")
        sys.exit(WRONG_CALL)
    except OSError as error:
        note(
            f"error: {error.strerror or error}" + (f": {error.filename}" if error.filename else "")
        )
        sys.exit(WRONG_CALL)


def _prepare_streams() -> None:
    """Make sure that there are streams, and that they take every character.

    What goes to a file or a pipe is the same on every system: UTF-8, as level files and pictures
    are, with LF at the end of lines. `PYTHONIOENCODING` may say otherwise.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
        stream = getattr(sys, name)
        if not isinstance(stream, io.TextIOWrapper):
            continue
        if stream.isatty():
            stream.reconfigure(errors="backslashreplace")
        else:
            told = os.environ.get("PYTHONIOENCODING", "").partition(":")[0]
            stream.reconfigure(encoding=told or "utf-8", errors="backslashreplace", newline="\n")


if __name__ == "__main__":
    main()
