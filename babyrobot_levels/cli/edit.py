"""`babyrobot edit`: a level in the browser, changed by drawing."""

from __future__ import annotations

import sys
import webbrowser
from threading import Thread
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import fail, note, write
from babyrobot_levels.cli.reporting import STANDARD_INPUT, read_path
from babyrobot_levels.text.errors import how_to_install

if TYPE_CHECKING:
    from babyrobot_levels.editor.session import Session


def edit(
    level: Annotated[
        str | None,
        typer.Argument(
            metavar="LEVEL",
            help="A name, PACK/NAME, the path of a file, a share code, or `-` for standard input.  "
            "[default: an empty grid]",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(
            min=1024,
            max=65535,
            metavar="N",
            help="Port of the server.  [default: a free one]",
            show_default=False,
        ),
    ] = None,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only print the address; open no browser.")
    ] = False,
) -> None:
    """Edit a level in the browser, by drawing and as text.

    A file is saved in its place; a file that does not exist is made when it is saved. Levels of
    the gallery and of packs, share codes and standard input are opened as copies, which the
    browser downloads. Nothing but this file is written.

    The page is served to this machine only, until it is closed by its button, or by Ctrl-C here.
    The address holds a password: keep it to yourself.

    Examples:

      babyrobot edit

      babyrobot edit levels/first.yaml

      babyrobot edit final-maze

      babyrobot resolve final-maze | babyrobot edit -
    """
    from babyrobot_levels.editor.sources import session_of

    try:
        from babyrobot_levels.editor.hosts.server import EditorServer
    except ModuleNotFoundError as error:
        if error.name not in ("starlette", "uvicorn"):
            raise
        fail(f"the package `{error.name}` is not installed", how_to_install("editor"))
    session = _piped() if level == str(STANDARD_INPUT) else session_of(level)
    server = EditorServer(session, port=port or 0, warn=_warn)
    note(f"editing {session.path or session.name}; press Ctrl-C to end")
    write(f"{server.address}\n")
    sys.stdout.flush()
    if not no_browser:
        # Some browsers return only when they are closed.
        Thread(target=_open, args=[server.address], daemon=True).start()
    server.run()


def _open(address: str) -> None:
    """Open the page in the user's browser."""
    if not webbrowser.open(address):
        note("no browser was found: open the address in one")


def _piped() -> Session:
    """Return a session for the text on standard input, valid or not."""
    from babyrobot_levels.editor.session import Session
    from babyrobot_levels.editor.sources import NAME

    return Session(read_path(STANDARD_INPUT).text, name=NAME)


def _warn() -> None:
    note("there are unsaved changes: save them in the page, or press Ctrl-C again to lose them")
